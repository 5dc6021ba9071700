/// When a factor is used again, and which tangents are refused.
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/engine_problem.hpp"

namespace stickslip::singular_tangents_test {
namespace {

TEST(FactorReuse, SavesTheFactorisationOfTheSameTangentAndNoOther) {
  EngineProblem problem(scenes::two_boxes(5, 7));
  auto check = [&](auto engine) {
    const Matrix<double> r = engine.reduce(problem.rows(1)).kept,
                         l = derivatives::arbitrary(problem.model.multiplier_count, 7);
    const auto tangents = problem.tangents();
    EngineProblem other = problem;
    for (auto& state : other.states) state = ContactState::stick;
    Counters counters;
    ASSERT_TRUE(engine.factorise(tangents, counters));
    const auto first = engine.solve({r, l});
    const long once = counters.factorizations;
    ASSERT_TRUE(engine.factorise(tangents, counters));
    EXPECT_EQ(counters.factorizations, once);
    const auto reused = engine.solve({r, l});
    EXPECT_EQ(reused.u, first.u);
    EXPECT_EQ(reused.l, first.l);
    ASSERT_TRUE(engine.factorise(other.tangents(), counters));
    EXPECT_GT(counters.factorizations, once);
    EXPECT_GT(derivatives::relative_difference(engine.solve({r, l}).u, first.u), 1e-6);  // another matrix
    ASSERT_TRUE(engine.factorise(tangents, counters));
    EXPECT_EQ(engine.solve({r, l}).u, first.u);  // and back, to the last bit
  };
  check(problem.sparse(true));
  check(problem.condensed(true));
}

TEST(SingularTangents, OfABodyThatNothingHoldsAreReported) {
  for (int cells : {2, 5, 8, 13})
    for (bool friction : {true, false})
      for (bool unknown : {true, false}) {
        EngineProblem problem(floating(cells, friction));
        const auto open = problem.open_tangents();
        auto check = [&](auto engine) {
          Counters counters;
          EXPECT_FALSE(engine.factorise(open, counters)) << engine.name() << " " << cells;
          EXPECT_FALSE(engine.message().empty()) << engine.name();
        };
        check(problem.sparse(unknown));
        check(problem.condensed(unknown));
      }
}

TEST(SingularTangents, AreForgottenOnceContactHoldsTheBody) {
  for (bool unknown : {true, false}) {
    EngineProblem problem(floating(5, true));
    problem.states.assign(problem.states.size(), ContactState::stick);
    const auto stuck = problem.tangents();
    const auto open = problem.open_tangents();
    auto check = [&](auto engine) {
      Counters counters;
      ASSERT_TRUE(engine.factorise(stuck, counters)) << engine.message();
      const Matrix<double> r = engine.reduce(problem.rows(1)).kept,
                           l = Matrix<double>::Zero(problem.model.multiplier_count, 1);
      const auto before = engine.solve({r, l});
      engine.factorise(open, counters);
      ASSERT_TRUE(engine.factorise(stuck, counters)) << engine.message();
      EXPECT_TRUE(engine.message().empty());
      EXPECT_EQ(engine.solve({r, l}).u, before.u);
    };
    check(problem.sparse(unknown));
    check(problem.condensed(unknown));
  }
}

TEST(SingularTangents, ThatAreNotFiniteAreRefused) {
  EngineProblem problem(scenes::two_boxes(5, 7));
  problem.rho[3].normal = std::numeric_limits<double>::quiet_NaN();
  problem.states.assign(problem.states.size(), ContactState::stick);
  auto check = [&](auto engine) {
    Counters counters;
    EXPECT_FALSE(engine.factorise(problem.tangents(), counters)) << engine.name();
    EXPECT_FALSE(engine.message().empty());
  };
  check(problem.sparse(true));
  check(problem.condensed(true));
}

TEST(SingularTangents, ThatAreNotFiniteAreNotTakenForTheOnesBefore) {
  EngineProblem problem(scenes::two_boxes(5, 7));
  const auto sound = problem.tangents();
  auto broken = sound;
  broken[1].force_w.setConstant(std::numeric_limits<double>::quiet_NaN());
  auto check = [&](auto engine) {
    Counters counters;
    ASSERT_TRUE(engine.factorise(sound, counters));
    EXPECT_FALSE(engine.factorise(broken, counters)) << engine.name();
  };
  check(problem.sparse(true));
  check(problem.condensed(true));
}

}  // namespace
}  // namespace stickslip::singular_tangents_test
