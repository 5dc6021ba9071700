/// Derivatives of objectives: backward in time against those of the responses, method by method.
#include "sensitivity/adjoint.hpp"

#include <gtest/gtest.h>

#include "tests/support/largest.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/solved.hpp"
#include "tests/support/solved_run.hpp"

namespace stickslip::adjoint_test {
namespace {

/// Each response at the end, summed over the steps, and squared against a target that is a parameter itself.
Scene with_objectives(Scene scene) {
  const int responses = static_cast<int>(scene.responses.size());
  const Number target = scenes::parameter(scene, "target", 0.3);
  const double end = scene.legs.back().end;
  for (int i = 0; i < responses; ++i) {
    const std::string name = scene.responses[i].name;
    scene.objectives.push_back({name + " at the end", i, end});
    scene.objectives.push_back({"sum of " + name, i, {}});
    scene.objectives.push_back({name + " on target", i, {}, scenes::table({{0, 0.0}, {end, target}})});
  }
  return scene;
}

struct Both {
  Matrix<double> direct, adjoint, scale;
  Gradients forward, backward;
  double condition = 0;
};

Both both(const Scene& scene, const Method& method, LinearAlgebra::Engine engine = LinearAlgebra::Engine::automatic) {
  RunOptions options;
  options.linear_algebra.engine = engine;
  scenes::SolvedRun run(scene, method, options);
  Both out;
  out.forward = run.direct();
  out.direct = run.objectives_of(out.forward);
  out.condition = run.workspace.engine->condition_estimate();  // of the scheme's
  out.backward = run.backward();
  out.adjoint = out.backward.of_objectives;
  // what an objective adds up: its size over that of the parameter, or its largest derivative
  const Vector<double> values = objective_values(run.model, run.slots, run.trajectory);
  out.scale = out.direct.cwiseAbs();
  for (Eigen::Index i = 0; i < out.scale.rows(); ++i)
    for (Eigen::Index j = 0; j < out.scale.cols(); ++j)
      out.scale(i, j) = std::max(largest_entry(out.direct.row(i)), std::abs(values[i] / scene.parameters[j].value));
  return out;
}

/// The two agree to rounding: `least`, or 50 u cond where the tangent lets more rounding through.
void expect_agreement(const Scene& scene, const Method& method,
                      LinearAlgebra::Engine engine = LinearAlgebra::Engine::automatic, double least = 1e-11) {
  const auto b = both(scene, method, engine);
  const std::string what = scene.title + " " + std::string(name_of(method));
  ASSERT_EQ(b.direct.rows(), static_cast<Eigen::Index>(scene.objectives.size())) << what << ": " << b.forward.message;
  ASSERT_EQ(b.adjoint.rows(), b.direct.rows()) << what << b.backward.message;
  const double allowed = std::max(least, 50 * unit_roundoff * b.condition);
  bool something = false;
  for (Eigen::Index i = 0; i < b.direct.rows(); ++i)
    for (Eigen::Index j = 0; j < b.direct.cols(); ++j) {
      something |= b.direct(i, j) != 0;
      EXPECT_LE(std::abs(b.adjoint(i, j) - b.direct(i, j)), allowed * b.scale(i, j))
          << what << ": " << scene.objectives[i].name << " / " << scene.parameters[j].name << " " << b.adjoint(i, j)
          << " " << b.direct(i, j);
    }
  EXPECT_TRUE(something) << what;
}

std::vector<Scene> all_scenes() {
  auto scenes = scenes::all();
  for (auto& scene : scenes::of_every_element()) scenes.push_back(std::move(scene));
  for (auto& scene : scenes::shaped()) scenes.push_back(std::move(scene));
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    scenes[i] = with_objectives(std::move(scenes[i]));
    scenes[i].title = "scene " + std::to_string(i);
  }
  return scenes;
}

UzawaAL uzawa(UzawaAL::Sensitivity sensitivity, double tolerance, int cap) {
  UzawaAL method;
  method.sensitivity = sensitivity;
  method.tolerance = tolerance;
  method.max_augmentations = cap;
  return method;
}

TEST(Adjoint, EqualsDirectForTheMonolithicMethod) {
  for (const auto& scene : all_scenes()) expect_agreement(scene, MonolithicAL{});
}

TEST(Adjoint, EqualsDirectForThePenaltyWhoseHistoryIsTheTraction) {
  for (const auto& scene : all_scenes()) {
    Penalty method{scenes::relative(20)};
    method.tangential_ratio = 0.4;
    expect_agreement(scene, method);
  }
}

TEST(Adjoint, EqualsDirectForTheFixedPointOfUzawa) {
  for (const auto& scene : all_scenes()) expect_agreement(scene, uzawa(UzawaAL::Sensitivity::iterated, 1e-13, 5000));
}

TEST(Adjoint, EqualsDirectForTheTruncatedLoopOfUzawa) {
  for (const auto& scene : all_scenes())
    for (int cap : {1, 3}) expect_agreement(scene, uzawa(UzawaAL::Sensitivity::truncated, 1e-10, cap));
}

TEST(Adjoint, EqualsDirectForTheOversizedScheme) {
  for (const auto& scene : all_scenes()) expect_agreement(scene, uzawa(UzawaAL::Sensitivity::oversized, 1e-13, 5000));
}

TEST(Adjoint, EqualsDirectForThePreconditionedScheme) {
  for (const auto& scene : all_scenes())
    expect_agreement(scene, uzawa(UzawaAL::Sensitivity::preconditioned, 1e-13, 5000));
}

TEST(Adjoint, EqualsDirectForAFrozenConeAndForAcceleratedUpdates) {
  UzawaAL frozen = uzawa(UzawaAL::Sensitivity::iterated, 1e-13, 5000), anderson = frozen;
  frozen.cone = UzawaAL::Cone::frozen;
  anderson.acceleration = UzawaAL::Acceleration::anderson;
  for (const auto& scene :
       {scenes::greco_plate(8, 0.2), scenes::two_boxes(6, 9), scenes::shaped_boxes(5, 4, "Q4", false)})
    for (const auto& method : {frozen, anderson}) expect_agreement(with_objectives(scene), method);
}

TEST(Adjoint, EqualsDirectInBothEnginesAndForTheOtherCone) {
  MonolithicAL method;
  method.cone = MonolithicAL::Cone::multiplier;
  for (const auto& scene : {scenes::greco_plate(8), scenes::two_boxes(6, 9), scenes::driven_block()})
    for (auto engine : {LinearAlgebra::Engine::sparse, LinearAlgebra::Engine::condensed})
      expect_agreement(with_objectives(scene), method, engine);
}

TEST(Adjoint, EqualsDirectAtAndAfterTies) {
  using S = UzawaAL::Sensitivity;
  for (const auto& scene : {scenes::pull_out(10, {0, 1, 0}, 4), scenes::slider({{0, 0}, {1, 0.03}, {2, 0.02}}, 2),
                            scenes::stop(10, 1000, 0.01)})
    for (const Method& method : {Method(MonolithicAL{}), Method(Penalty{scenes::relative(100)}),
                                 Method(uzawa(S::iterated, 1e-13, 5000)), Method(uzawa(S::preconditioned, 1e-13, 5000)),
                                 Method(uzawa(S::oversized, 1e-13, 5000)), Method(uzawa(S::truncated, 1e-10, 400))})
      // (the preconditioned factor is 300 stiffnesses or more, and magnifies the rounding of a gap; 1.4e-11 was seen)
      expect_agreement(with_objectives(scene), method, LinearAlgebra::Engine::automatic, 1e-10);
}

TEST(Adjoint, TakesOneTransposedSolveAnObjectiveAndIncrementHoweverManyParameters) {
  auto scene = with_objectives(scenes::two_boxes(6, 9));
  const auto all = both(scene, MonolithicAL{});
  scene.parameters.resize(1);
  const auto one = both(scene, MonolithicAL{});
  const auto increments = static_cast<long>(all.forward.of_responses.size());
  const long solves = increments * static_cast<long>(scene.objectives.size());
  EXPECT_EQ(all.backward.counters.sensitivity_backsolves, one.backward.counters.sensitivity_backsolves);
  EXPECT_GE(all.backward.counters.sensitivity_backsolves, solves);
  // (of an updated factor a solution is refined, for a solve more, after one for each column of the update; the sparse
  // solver's residual is at rounding: no pass more)
  EXPECT_LE(all.backward.counters.sensitivity_backsolves,
            2 * solves + increments * static_cast<long>(TangentUpdate::most));
}

TEST(Adjoint, UpdatesTheFactorOfTheIncrementBehindWhereFewPointsChanged) {
  for (auto engine : {LinearAlgebra::Engine::sparse, LinearAlgebra::Engine::condensed}) {
    // (its sole is slipping along: a point or two change in an increment)
    const auto b = both(with_objectives(scenes::pull_out(40, {0, 1}, 20)), MonolithicAL{}, engine);
    const auto increments = static_cast<long>(b.forward.of_responses.size());
    EXPECT_LT(2 * b.backward.counters.sensitivity_factorizations, increments);
    EXPECT_GT(b.backward.counters.sensitivity_factorizations, 0);
  }
}

TEST(Adjoint, DoesNotChangeTheSolution) {
  for (const Method& method : {Method(Penalty{}), Method(UzawaAL{}), Method(MonolithicAL{})}) {
    const Scene scene = with_objectives(scenes::two_boxes(6, 9));
    Scene alone = scene;
    alone.parameters.clear();
    alone.objectives.clear();
    const auto expected = scenes::SolvedRun(alone, method).trajectory;
    scenes::SolvedRun run(scene, method);
    EXPECT_GT(run.backward().of_objectives.size(), 0);
    expect_same_bits(run.trajectory, expected, std::string(name_of(method)) + " with its adjoint");
    expect_same_bits(run.again(), expected, std::string(name_of(method)) + " solved again after it");
  }
}

TEST(Adjoint, OfNoObjectiveIsNothing) {
  EXPECT_EQ(scenes::SolvedRun(scenes::two_boxes(6, 9), MonolithicAL{}).backward().of_objectives.size(), 0);
}

}  // namespace
}  // namespace stickslip::adjoint_test
