/// A factor updated where few points changed is the factor of the changed tangent.
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/engine_problem.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::tangent_update_test {
namespace {

/// The problem with points 1, 2, ... turned into other branches: stick, slip, open by turns.
EngineProblem turned(EngineProblem problem, int count) {
  for (int p = 1; p <= count; ++p)
    problem.states[p] = static_cast<ContactState>((static_cast<int>(problem.states[p]) + p) % 3);
  return problem;
}

/// One whose points all stick, and hold the upper box up.
EngineProblem stuck(int cells) {
  EngineProblem problem(floating(cells, true));
  problem.states.assign(problem.states.size(), ContactState::stick);
  return problem;
}

/// check(make, unknown) of both engines, with multipliers that are unknown and that are not; make() is a new one.
template <class Check>
void for_each_engine(const EngineProblem& problem, Check&& check) {
  for (bool unknown : {true, false}) {
    check([&] { return problem.sparse(unknown); }, unknown);
    check([&] { return problem.condensed(unknown); }, unknown);
  }
}

/// Two right-hand sides of an engine's rows.
BlockVector<double> right_hand_sides(Engine<double>& engine, const EngineProblem& problem) {
  return {engine.reduce(problem.rows(2)).kept,
          derivatives::arbitrary(problem.model.multiplier_count, 7) * Matrix<double>::Ones(1, 2)};
}

TEST(TangentUpdate, SolvesWithTheChangedTangent) {
  const EngineProblem problem = stuck(20);
  for_each_engine(problem, [&](auto make, bool unknown) {
    auto engine = make();
    const auto [r, l] = right_hand_sides(engine, problem);
    Counters counters;
    ASSERT_TRUE(engine.factorise(problem.tangents(), counters));
    for (int count : {1, 3, 2}) {
      const auto other = turned(problem, count).tangents();
      const long factorisations = counters.factorizations;
      ASSERT_TRUE(engine.update(other, counters)) << engine.name() << unknown << count;
      EXPECT_EQ(counters.factorizations, factorisations);
      auto anew = make();
      ASSERT_TRUE(anew.factorise(other, counters));
      const auto updated = engine.solve({r, l}), exact = anew.solve({r, l});
      EXPECT_LT(derivatives::relative_difference(updated.u, exact.u), solved) << engine.name() << unknown << count;
      EXPECT_EQ(engine.reversed(), anew.reversed()) << engine.name() << unknown << count;
      if (!unknown) continue;
      EXPECT_LT(derivatives::relative_difference(updated.l, exact.l), solved) << engine.name() << count;
    }
  });
}

TEST(TangentUpdate, SolvesWithTheTransposeOfTheChangedTangent) {
  const EngineProblem problem = stuck(20);
  for_each_engine(problem, [&](auto make, bool unknown) {
    auto engine = make();
    const auto [r, l] = right_hand_sides(engine, problem);
    Counters counters;
    ASSERT_TRUE(engine.factorise(problem.tangents(), counters));
    for (int count : {1, 3, 2}) {
      const auto other = turned(problem, count).tangents();
      ASSERT_TRUE(engine.update(other, counters)) << engine.name() << unknown << count;
      auto anew = make();
      ASSERT_TRUE(anew.factorise(other, counters));
      const auto updated = engine.solve({r, l}, Solving::transposed), exact = anew.solve({r, l}, Solving::transposed);
      EXPECT_LT(derivatives::relative_difference(updated.u, exact.u), solved) << engine.name() << unknown << count;
      if (!unknown) continue;
      EXPECT_LT(derivatives::relative_difference(updated.l, exact.l), solved) << engine.name() << count;
    }
  });
}

TEST(TangentUpdate, SolvesWithoutARefinementWhereThatIsCheckedElsewhere) {
  const EngineProblem problem = stuck(20);
  for_each_engine(problem, [&](auto make, bool unknown) {
    auto engine = make();
    const auto [r, l] = right_hand_sides(engine, problem);
    Counters counters;
    ASSERT_TRUE(engine.factorise(problem.tangents(), counters));
    ASSERT_TRUE(engine.update(turned(problem, 2).tangents(), counters));
    const auto once = engine.solve({r, l}, Solving::unrefined), twice = engine.solve({r, l});
    EXPECT_NE(once.u, twice.u) << engine.name() << unknown;
    // the change may lose six digits (TangentUpdate::take)
    EXPECT_LT(derivatives::relative_difference(once.u, twice.u), 1e6 * solved) << engine.name() << unknown;
  });
}

TEST(TangentUpdate, TellsWhenTheDeterminantTurns) {
  // friction far beyond its critical value
  EngineProblem problem = stuck(20);
  bool turns = false;
  for (double friction : {0.3, 10.0, 100.0}) {
    problem.slots.friction[0] = friction;
    for_each_engine(problem, [&](auto make, bool unknown) {
      auto engine = make();
      Counters counters;
      ASSERT_TRUE(engine.factorise(problem.tangents(), counters));
      for (int p = 0; p < 4; ++p) {
        EngineProblem other = problem;
        for (int q = 0; q <= p; ++q) other.states[q] = ContactState::slip;
        auto anew = make();
        ASSERT_TRUE(engine.update(other.tangents(), counters)) << engine.name() << unknown << friction;
        ASSERT_TRUE(anew.factorise(other.tangents(), counters));
        EXPECT_EQ(engine.reversed(), anew.reversed()) << engine.name() << unknown << friction << " " << p;
        turns |= anew.reversed();
      }
    });
  }
  EXPECT_TRUE(turns);
}

TEST(TangentUpdate, SolvesForNewColumnsAlone) {
  const EngineProblem problem = stuck(20);
  for_each_engine(problem, [&](auto make, bool) {
    auto engine = make();
    const auto slipping = [&](int count) {
      EngineProblem other = problem;
      for (int p = 0; p < count; ++p) other.states[p] = ContactState::slip;
      return other.tangents();
    };
    Counters counters;
    ASSERT_TRUE(engine.factorise(problem.tangents(), counters));
    ASSERT_TRUE(engine.update(slipping(2), counters));
    const long before = counters.backsolves;
    ASSERT_TRUE(engine.update(slipping(3), counters));
    EXPECT_EQ(counters.backsolves - before, 1);
    EXPECT_EQ(engine.solves(), 2);  // and the refinement
    ASSERT_TRUE(engine.update(problem.tangents(), counters));
    EXPECT_EQ(counters.backsolves - before, 1);  // nothing is left of it
    EXPECT_EQ(engine.solves(), 1);
  });
}

TEST(TangentUpdate, EndsWithTheNextFactorisation) {
  const EngineProblem problem = stuck(20);
  for_each_engine(problem, [&](auto make, bool) {
    auto engine = make();
    const Matrix<double> r = engine.reduce(problem.rows(1)).kept,
                         l = derivatives::arbitrary(problem.model.multiplier_count, 7);
    Counters counters;
    ASSERT_TRUE(engine.factorise(problem.tangents(), counters));
    const auto before = engine.solve({r, l});
    ASSERT_TRUE(engine.update(turned(problem, 2).tangents(), counters));
    EXPECT_GT(derivatives::relative_difference(engine.solve({r, l}).u, before.u), 1e-6);
    ASSERT_TRUE(engine.factorise(problem.tangents(), counters));
    EXPECT_EQ(engine.solve({r, l}).u, before.u);
  });
}

TEST(TangentUpdate, IsRefusedWhereItDoesNotPayOrCannotBe) {
  const EngineProblem problem = stuck(20);
  for_each_engine(problem, [&](auto make, bool unknown) {
    auto engine = make();
    Counters counters;
    EXPECT_FALSE(engine.update(problem.tangents(), counters)) << "nothing is factorised yet";
    ASSERT_TRUE(engine.factorise(problem.tangents(), counters));
    EXPECT_FALSE(engine.update(turned(problem, 12).tangents(), counters)) << "more than 8 columns are new";
    const Vector<double> hold = Vector<double>::Ones(static_cast<Eigen::Index>(problem.model.contact_nodes.size()));
    EXPECT_FALSE(engine.update(turned(problem, 1).tangents(), counters, hold)) << "springs came";
    auto broken = problem.tangents();
    broken[1].force_w.setConstant(std::numeric_limits<double>::quiet_NaN());
    EXPECT_FALSE(engine.update(broken, counters)) << engine.name() << unknown;
  });
}

TEST(TangentUpdate, IsRefusedWhereNothingWouldHoldABody) {
  EngineProblem problem = stuck(20);
  problem.states.assign(problem.states.size(), ContactState::open);
  problem.states[3] = problem.states[17] = ContactState::stick;
  EngineProblem loose = problem;  // turns about the one point that is closed
  loose.states[17] = ContactState::open;
  for_each_engine(problem, [&](auto make, bool unknown) {
    auto engine = make();
    Counters counters;
    ASSERT_TRUE(engine.factorise(problem.tangents(), counters)) << engine.message();
    EXPECT_FALSE(engine.update(loose.tangents(), counters)) << engine.name() << unknown;
    EXPECT_FALSE(engine.factorise(loose.tangents(), counters)) << engine.name() << unknown;
  });
}

TEST(TangentUpdate, NeedsTheMultiplierRowsOfTheFactor) {
  EngineProblem problem = stuck(20);
  problem.states[2] = ContactState::open;
  EngineProblem closed = problem;
  closed.states[2] = ContactState::stick;
  Counters counters;
  auto condensed = problem.condensed(true);
  ASSERT_TRUE(condensed.factorise(problem.tangents(), counters));
  EXPECT_FALSE(condensed.update(closed.tangents(), counters));  // (it factorises closed points' rows alone)
  auto sparse = problem.sparse(true);
  ASSERT_TRUE(sparse.factorise(problem.tangents(), counters));
  EXPECT_TRUE(sparse.update(closed.tangents(), counters));
}

}  // namespace
}  // namespace stickslip::tangent_update_test
