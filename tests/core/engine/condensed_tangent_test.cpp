/// Tangents of bodies that change, condensed: the sparse engine with them against the same with one sparse factor.
#include "core/engine/condensed_tangent.hpp"

#include <gtest/gtest.h>

#include "core/engine/sparse_system.hpp"
#include "tests/support/engine_problem.hpp"
#include "tests/support/sliding_scenes.hpp"

namespace stickslip::condensed_tangent_test {
namespace {

struct Pair {
  EngineProblem problem;
  bool unknown;
  Engine<double> plain, condensed;

  Pair(const Scene& scene, bool unknown_multipliers)
      : problem(scene),
        unknown(unknown_multipliers),
        plain(problem.sparse(unknown)),
        condensed(engine_that_condenses()) {
    for (auto* engine : {&plain, &condensed}) engine->begin(1, problem.u, memory());
  }
  Engine<double> engine_that_condenses() const {
    const auto kind = problem.kind(unknown);
    auto bodies = std::make_unique<FullBodies<double>>(problem.model, problem.slots);
    auto system = std::make_unique<CondensedTangent<double>>(problem.model, problem.slots, kind, *bodies);
    auto instead = std::make_unique<SparseSystem<double>>(problem.model, problem.slots, kind, *bodies);
    return {problem.model, problem.slots, std::move(bodies), std::move(system), std::move(instead)};
  }
  Vector<double> memory() const { return Vector<double>::Zero(problem.model.memory_count); }
  /// Both engines at a motion, with the tangents of the problem.
  void factorise(const Vector<double>& u, Counters& of_plain, Counters& of_condensed) {
    const Vector<double> before = memory();
    plain.linearise({u, before, 1});
    condensed.linearise({u, before, 1});
    ASSERT_TRUE(plain.factorise(problem.tangents(), of_plain));
    ASSERT_TRUE(condensed.factorise(problem.tangents(), of_condensed));
  }
  void expect_same_solutions() {
    const Matrix<double> r = problem.rows(3);
    const int multipliers = unknown ? problem.model.multiplier_count : 0;
    Matrix<double> l(multipliers, 3);
    for (int j = 0; j < 3; ++j) l.col(j) = derivatives::arbitrary(multipliers, 20 + j);
    for (const auto how : {Solving::refined, Solving::transposed}) {
      const auto a = plain.solve({r, l}, how), b = condensed.solve({r, l}, how);
      EXPECT_LE((a.u - b.u).norm(), solved * a.u.norm());
      EXPECT_LE((a.l - b.l).norm(), solved * a.l.norm());
      EXPECT_GT(a.u.norm(), 0);
    }
  }
};

std::vector<Scene> scenes_that_change() {
  return {scenes::pressed_metal(false), scenes::pressed_metal(true), scenes::sliding_die()};
}

TEST(CondensedTangent, SolvesAsOneSparseFactorDoes) {
  for (const auto& scene : scenes_that_change())
    for (const bool unknown : {false, true}) {
      Pair pair(scene, unknown);
      ASSERT_TRUE(can_condense_tangents(pair.problem.model));
      Counters of_plain, of_condensed;
      pair.factorise(0.01 * pair.problem.u, of_plain, of_condensed);
      EXPECT_TRUE(pair.condensed.condenses_tangents());
      pair.expect_same_solutions();
    }
}

TEST(CondensedTangent, TakesOtherBranchesWithoutASparseFactor) {
  Pair pair(scenes::pressed_metal(true), true);
  Counters of_plain, of_condensed;
  pair.factorise(0.01 * pair.problem.u, of_plain, of_condensed);
  const auto open = pair.problem.open_tangents();
  ASSERT_TRUE(pair.plain.factorise(open, of_plain));
  ASSERT_TRUE(pair.condensed.factorise(open, of_condensed));
  pair.expect_same_solutions();
  EXPECT_EQ(of_plain.factorizations, 2);
  EXPECT_EQ(of_condensed.factorizations, 1);
}

/// A die of five nodes on a side of thirteen, at two places: the points come to touch what none has touched before.
TEST(CondensedTangent, HasTheDenseRowsThatPointsTouch) {
  for (const bool unknown : {false, true}) {
    Pair pair(scenes::sliding_die(), unknown);
    auto& problem = pair.problem;
    FullBodies<double> bodies(problem.model, problem.slots);
    const CondensedTangent<double> tangent(problem.model, problem.slots, problem.kind(unknown), bodies);
    const int multipliers = unknown ? problem.model.multiplier_count : 0;
    EXPECT_LT(tangent.dense_rows(), tangent.kept() + multipliers);
    Counters of_plain, of_condensed;
    pair.factorise(0.01 * problem.u, of_plain, of_condensed);
    pair.expect_same_solutions();
    const auto& die = problem.model.bodies[1];
    for (int node = die.first_node; node < die.first_node + die.mesh.node_count; ++node) problem.u[2 * node] += 0.9;
    const auto moved = problem.tangents();
    ASSERT_TRUE(pair.plain.factorise(moved, of_plain));
    ASSERT_TRUE(pair.condensed.factorise(moved, of_condensed));
    pair.expect_same_solutions();
    const Vector<double> hold =
        Vector<double>::Constant(static_cast<Eigen::Index>(problem.model.contact_nodes.size()), 3.0);
    ASSERT_TRUE(pair.plain.factorise(moved, of_plain, hold));
    ASSERT_TRUE(pair.condensed.factorise(moved, of_condensed, hold));
    pair.expect_same_solutions();
    EXPECT_EQ(of_condensed.factorizations, 1);
  }
}

TEST(CondensedTangent, IsUsedAgainCloseToWhereItWasMadeUnlessBodiesRemember) {
  for (const bool metal : {false, true}) {
    Pair pair(metal ? scenes::pressed_metal(true) : scenes::sliding_die(), true);
    auto& engine = pair.condensed;
    const Vector<double> u = 0.01 * pair.problem.u, near = (1 + 1e-9) * u, far = 2 * u, before = pair.memory();
    EXPECT_FALSE(engine.has_tangent_near({u, before, 1}));
    Counters unused, counters;
    pair.factorise(u, unused, counters);
    EXPECT_EQ(engine.has_tangent_near({u, before, 1}), !metal);
    EXPECT_EQ(engine.has_tangent_near({near, before, 1}), !metal);
    EXPECT_FALSE(engine.has_tangent_near({far, before, 1}));
    engine.fix_linearisation({far, before, 1}, far, FixedTangent::last);
    ASSERT_TRUE(engine.factorise(pair.problem.tangents(), counters));
    engine.release_linearisation();
    EXPECT_EQ(counters.factorizations, 1);
    pair.expect_same_solutions();  // (those of the first tangent)
  }
}

TEST(CondensedTangent, IsCarriedToTheLastBit) {
  Pair pair(scenes::sliding_die(), true);
  auto& engine = pair.condensed;
  const Vector<double> here = 0.01 * pair.problem.u, there = -here, before = pair.memory();
  const Matrix<double> r = pair.problem.rows(1), l = Matrix<double>::Ones(pair.problem.model.multiplier_count, 1);
  const auto solve_with_last = [&] {
    Counters counters;
    engine.fix_linearisation({here, before, 1}, here, FixedTangent::last);
    EXPECT_TRUE(engine.factorise(pair.problem.tangents(), counters));
    engine.release_linearisation();
    EXPECT_EQ(counters.factorizations, 0);
    return engine.solve({r, l});
  };
  Counters unused, counters;
  pair.factorise(here, unused, unused);
  const auto first = solve_with_last();
  const auto memory = engine.memory();
  pair.factorise(there, unused, unused);
  engine.restore(memory, counters);
  EXPECT_EQ(counters.factorizations, 1);
  const auto again = solve_with_last();
  EXPECT_TRUE(again.u == first.u && again.l == first.l);
}

TEST(CondensedTangent, GivesWayWhereABodyIsNotDefiniteInsideUntilTheNextIncrement) {
  Pair pair(scenes::pressed_metal(true), true);
  Counters of_plain, of_condensed;
  Vector<double> crushed = pair.problem.u;  // far beyond what is stable, not inverted
  const auto& model = pair.problem.model;
  for (int node = 0; node < model.node_count; ++node) {
    crushed[2 * node] = 0;
    crushed[2 * node + 1] = -0.9 * pair.problem.slots.points(1, node);
  }
  pair.factorise(crushed, of_plain, of_condensed);
  EXPECT_FALSE(pair.condensed.condenses_tangents());
  pair.expect_same_solutions();
  pair.condensed.begin(1, pair.problem.u, pair.memory());
  EXPECT_TRUE(pair.condensed.condenses_tangents());
  pair.factorise(0.01 * pair.problem.u, of_plain, of_condensed);
  pair.expect_same_solutions();
}

TEST(CondensedTangent, IsOfContactBetweenBodiesThatChange) {
  EXPECT_FALSE(can_condense_tangents(make_model(scenes::two_boxes(3, 4))));  // linear
  auto without = scenes::pressed_metal(true);
  without.contacts.clear();
  EXPECT_FALSE(can_condense_tangents(make_model(without)));
}

}  // namespace
}  // namespace stickslip::condensed_tangent_test
