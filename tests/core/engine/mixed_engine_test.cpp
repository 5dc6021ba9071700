/// A body condensed beside one that flows: the sparse engine with it against the same with the bodies in full.
#include <gtest/gtest.h>

#include "core/engine/engine_price.hpp"
#include "core/model/frames.hpp"
#include "tests/support/engine_problem.hpp"

namespace stickslip::mixed_engine_test {
namespace {

/// The two engines of a mixed scene at a time at which the supports have moved. What is inside the condensed body is in
/// balance, so both have the same rows at all other dofs.
struct Pair {
  static constexpr double time = 1.5;
  EngineProblem problem;
  Vector<double> memory;
  std::shared_ptr<Condensation<double>> condensation = problem.condensation();
  Engine<double> full, mixed;
  Vector<double> of_mixed;  ///< engine displacement

  explicit Pair(const Scene& scene, bool unknown = false)
      : problem(scene),
        memory(1e-3 * derivatives::arbitrary(problem.model.memory_count, 7).cwiseAbs()),
        full(problem.sparse(unknown)),
        mixed(condensed_engine(problem.model, problem.slots, problem.kind(unknown), condensation)) {
    full.begin(time, problem.u, memory);
    of_mixed = mixed.begin(time, problem.u, memory);
  }
  Vector<double> contact() const {
    return derivatives::arbitrary(2 * static_cast<int>(problem.model.contact_nodes.size()), 4);
  }
  /// Engine displacement of the engine in full where that of the other is `u`.
  Vector<double> in_full(const Vector<double>& u) {
    return into_frames(problem.model, problem.slots.frames, NodalLayout::all, mixed.all(u));
  }
  void expect_same_rows(const Vector<double>& u) {
    ForceScale scale, scale_of_mixed;
    const Vector<double> rows = full.residual(in_full(u), contact(), scale);
    const Vector<double> reduced = mixed.residual(u, contact(), scale_of_mixed);
    // forces of E times 0.01 that cancel inside, some fifty to a row, and the condition of the bodies
    const double rounding = 1e-12 * scale.force;
    for (int dof : problem.model.free_dofs)
      EXPECT_LE(std::abs(mixed.is_free(dof) ? rows[dof] - reduced[dof] : rows[dof]), rounding);
    EXPECT_GT(largest_entry(reduced), 1e6 * rounding);
  }
};

std::vector<Scene> mixed_scenes() { return {scenes::punched_metal(5), scenes::punched_metal(5, 0.3, true)}; }

TEST(MixedEngine, HasTheResidualOfTheBodiesInFull) {
  for (const auto& scene : mixed_scenes()) {
    Pair pair(scene);
    ASSERT_TRUE(pair.condensation->valid());
    pair.expect_same_rows(pair.of_mixed);
  }
}

TEST(MixedEngine, HoldsBodiesAsTheEngineInFullDoes) {
  for (const auto& scene : mixed_scenes()) {
    Pair pair(scene);
    const auto& model = pair.problem.model;
    // about another displacement, of which supports prescribe other values too
    Vector<double> about = pair.of_mixed + 1e-3 * derivatives::arbitrary(model.dof_count(), 8);
    const Vector<double> moved = pair.mixed.all(about), moved_of_mixed = pair.mixed.spread(about);
    pair.mixed.fix_linearisation({moved_of_mixed, pair.memory, Pair::time}, pair.of_mixed);
    pair.full.fix_linearisation({moved, pair.memory, Pair::time}, pair.in_full(pair.of_mixed));
    pair.expect_same_rows(pair.of_mixed);
    pair.mixed.release_linearisation();
    pair.full.release_linearisation();
    pair.expect_same_rows(pair.of_mixed);
  }
}

TEST(MixedEngine, SolvesAsTheEngineInFullDoes) {
  for (const auto& scene : mixed_scenes())
    for (bool unknown : {false, true}) {
      Pair pair(scene, unknown);
      const auto& model = pair.problem.model;
      const Vector<double> moved = pair.mixed.all(pair.of_mixed);
      const BodyMotion<double> at{moved, pair.memory, Pair::time};
      Counters counters;
      const Matrix<double> r = pair.problem.rows(2);
      const Matrix<double> l =
          unknown ? Matrix<double>(
                        derivatives::arbitrary(2 * model.multiplier_count, 30).reshaped(model.multiplier_count, 2))
                  : Matrix<double>();
      std::vector<Matrix<double>> u, multipliers;
      for (auto* engine : {&pair.full, &pair.mixed}) {
        engine->linearise(at);
        ASSERT_TRUE(engine->factorise(pair.problem.tangents(), counters)) << engine->message();
        const auto reduced = engine->reduce(r);
        const auto solution = engine->solve({reduced.kept, l});
        u.push_back(engine->expand(solution.u, reduced.others));
        multipliers.push_back(solution.l);
        const auto transposed = engine->solve({reduced.kept, l}, Solving::transposed);
        u.push_back(engine->expand(transposed.u, reduced.others));
        u.push_back(engine->apply_stiffness(solution.u) - reduced.kept);  // what is left to the contact
      }
      EXPECT_LE(derivatives::relative_difference(u[3], u[0]), solved);
      EXPECT_LE(derivatives::relative_difference(u[4], u[1]), solved);
      for (int dof : model.free_dofs)
        if (pair.mixed.is_free(dof)) {
          EXPECT_LE(largest_entry(u[5].row(dof) - u[2].row(dof)), 1e4 * solved * largest_entry(u[2])) << dof;
        }
      if (unknown) {
        EXPECT_LE(derivatives::relative_difference(multipliers[1], multipliers[0]), solved);
      }
    }
}

TEST(MixedEngine, LeavesOutWhatIsInside) {
  Pair pair(scenes::punched_metal(5), true);
  const auto& model = pair.problem.model;
  int inside = 0;
  for (int dof : model.free_dofs) inside += !pair.mixed.is_free(dof);
  EXPECT_GT(inside, 0);
  EXPECT_EQ(pair.full.unknowns() - pair.mixed.unknowns(), inside);
  EXPECT_EQ(pair.mixed.unknowns(), mixed_displacements(model) + model.multiplier_count);
  for (int node : model.contact_nodes)
    for (int i = 0; i < 2; ++i) EXPECT_TRUE(pair.mixed.is_free(2 * node + i));
  EXPECT_GT(pair.mixed.report().bodies_factor, 0);
}

TEST(MixedEngine, ExpandsWhatIsWantedAsItExpandsAll) {
  Pair pair(scenes::punched_metal(9));
  const auto& interior = pair.condensation->interior();
  const Matrix<double> r = pair.problem.rows(3);
  const auto reduced = pair.condensation->reduce(r);
  const Matrix<double> all = pair.condensation->expand(reduced.kept, reduced.others);
  const std::vector<int> wanted{interior[4], interior[5], interior.back()};
  const Matrix<double> some = pair.condensation->expand(reduced.kept, reduced.others, &wanted);
  for (int dof : wanted) EXPECT_LE(largest_entry(some.row(dof) - all.row(dof)), solved * largest_entry(all));
  if (has_backend(Backend::cholmod)) {
    EXPECT_GT(largest_entry(some - all), 0.01 * largest_entry(all));  // what nobody reads is left out
  }
}

// --- the choice ------------------------------------------------------------------------------------------------------

EnginePrice price_of(const Scene& scene) {
  const Model model = make_model(scene);
  return predict_price(model, Multipliers::given, Symmetry::general, bodies_factor(model));
}

TEST(MixedEngine, IsChosenWhereItIsCheaper) {
  // a punch of 40 x 40 cells on a strip of 42 x 4: by far the most unknowns are inside the punch
  auto scene = scenes::punched_metal(40);
  const auto price = price_of(scene);
  EXPECT_LT(price.condensed, 0.5 * price.sparse);
  EXPECT_TRUE(prefers_condensed(make_model(scene), price));
  // a punch of one layer of cells above the contact has next to nothing inside, which would be a dense block for it
  std::get<BoxMesh>(scene.bodies[0].mesh).cells = {400, 2};
  scene.legs = {{3, 1}};
  const auto other = price_of(scene);
  EXPECT_GT(other.condensed, other.sparse);
  EXPECT_FALSE(prefers_condensed(make_model(scene), other));
}

TEST(MixedEngine, IsOfMixedScenesAlone) {
  auto scene = scenes::punched_metal(4);
  EXPECT_TRUE(has_mixed_bodies(make_model(scene)));
  auto elastic = scenes::two_boxes(4, 6);
  EXPECT_FALSE(has_mixed_bodies(make_model(elastic)));
  EXPECT_TRUE(can_condense(make_model(elastic)));
  scene.bodies[0].material = scene.bodies[1].material;
  EXPECT_FALSE(can_condense(make_model(scene)));
  EXPECT_EQ(price_of(scene).condensed, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace stickslip::mixed_engine_test
