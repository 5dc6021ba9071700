/// Runs that let states go: the adjoint solves them again, and its gradient has the same bits; and what that spares.
#include "methods/stepping/checkpoints.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/both_modes.hpp"
#include "tests/support/sliding_scenes.hpp"

namespace stickslip::checkpoints_test {
namespace {

// --- the same bits ---------------------------------------------------------------------------------------------------

std::vector<Method> all_schemes() {
  using S = UzawaAL::Sensitivity;
  std::vector<Method> methods{Penalty{}, MonolithicAL{}};
  for (const S scheme : {S::iterated, S::truncated, S::preconditioned, S::oversized}) {
    UzawaAL uzawa;
    uzawa.sensitivity = scheme;
    methods.emplace_back(uzawa);
  }
  return methods;
}

struct KeptRun {
  Trajectory<double> trajectory;
  Gradients gradients;
};

/// `states`: whole ones that there is room for.
KeptRun run_keeping(const Scene& scene, const Method& method, RunOptions options, double states) {
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  options.state_memory = states * thinned_bytes(model);
  Workspace<double> workspace;
  KeptRun out{solve(model, slots, method, options, workspace), {}};
  out.gradients = adjoint(model, slots, method, out.trajectory, workspace);
  return out;
}

std::size_t whole_states(const Trajectory<double>& trajectory) {
  return std::count_if(trajectory.increments.begin(), trajectory.increments.end(),
                       [](const auto& increment) { return is_whole(increment.state); });
}

/// With room for few states and for more the gradient has the bits of that with all; returns the run with few.
KeptRun expect_same_gradient(Scene scene, const Method& method, const RunOptions& options = {}) {
  scenes::ask_for_objectives(scene);
  const std::string what = scene.title + " " + std::string(name_of(method));
  const KeptRun all = run_keeping(scene, method, options, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(is_converged(all.trajectory.status)) << what << all.trajectory.message;
  EXPECT_GT(all.gradients.of_objectives.size(), 0) << what << all.gradients.message;
  EXPECT_EQ(all.gradients.repeated, 0) << what;
  const std::size_t count = all.trajectory.increments.size();
  EXPECT_EQ(whole_states(all.trajectory), count) << what;
  KeptRun few;
  for (const double room : {6.0, 1.0}) {
    few = run_keeping(scene, method, options, room);
    EXPECT_EQ(few.trajectory.increments.size(), count) << what;
    EXPECT_LT(whole_states(few.trajectory), count) << what;
    EXPECT_GT(few.gradients.repeated, 0) << what;
    EXPECT_EQ(few.trajectory.counters.newton, all.trajectory.counters.newton) << what;
    const Matrix<double>&one = few.gradients.of_objectives, &other = all.gradients.of_objectives;
    EXPECT_TRUE(one.size() == other.size() && one == other) << what << "\n" << one << "\n" << other;
  }
  return few;
}

TEST(Checkpoints, LeaveTheGradientOfElasticBodiesByEitherEngine) {
  for (const auto engine : {LinearAlgebra::Engine::condensed, LinearAlgebra::Engine::sparse})
    for (const Method& method : all_schemes()) {
      RunOptions options;
      options.linear_algebra.engine = engine;
      expect_same_gradient(scenes::two_boxes(6, 9), method, options);
    }
}

TEST(Checkpoints, LeaveTheGradientOfMetalThatFlows) {
  for (const bool finite : {false, true})
    for (const Method& method : all_schemes()) expect_same_gradient(scenes::pressed_metal(finite), method);
}

TEST(Checkpoints, LeaveTheGradientOfADieThatSlidesAlongASmoothSide) {
  for (const Scene& die : {scenes::sliding_die(), scenes::integrated_die()})
    for (const Method& method : all_schemes()) expect_same_gradient(die, method);
}

TEST(Checkpoints, LeaveTheGradientWhereTangentsAreCondensed) {
  RunOptions options;
  options.linear_algebra.engine = LinearAlgebra::Engine::condensed;
  for (const Scene& scene : {scenes::sliding_die(), scenes::pressed_metal(true)})
    for (const Method& method : scenes::all_methods()) expect_same_gradient(scene, method, options);
}

/// The branches at ties are searched for forward in time, over the same states.
TEST(Checkpoints, LeaveTheGradientAtTies) {
  for (const Method& method : all_schemes()) {
    const auto few = expect_same_gradient(scenes::pull_out(10, {0, 1, 0}, 6), method);
    EXPECT_GT(few.gradients.search.contact_evaluations, 0) << name_of(method);
  }
}

TEST(Checkpoints, LeaveTheGradientOfStepsThatAreCut) {
  MonolithicAL method;
  method.newton.max_iterations = 4;
  const auto few = expect_same_gradient(scenes::sliding_die(), method);
  EXPECT_GT(few.trajectory.counters.cutbacks, 0);
}

// --- memory ----------------------------------------------------------------------------------------------------------

/// Bytes that a process took beyond what it began with, at its most. `work` runs in a process of its own.
template <class Work>
double peak_of(Work&& work) {
  const auto most_of = [](auto&& f) {
    const pid_t child = fork();
    if (child == 0) {
      f();
      std::_Exit(0);
    }
    int status = 0;
    rusage usage{};
    EXPECT_EQ(wait4(child, &status, 0, &usage), child);
    EXPECT_EQ(status, 0);
    return 1024.0 * static_cast<double>(usage.ru_maxrss);
  };
  const double before = most_of([] {});
  return most_of(work) - before;
}

/// A thousand steps to and fro of a deep block over another: 4374 displacements, 13 contact points.
Scene long_run() {
  Scene scene = scenes::two_boxes(12, 13);
  for (auto& body : scene.bodies) std::get<BoxMesh>(body.mesh).cells[1] = 80;
  scene.legs = {{3, 1000}};
  scene.objectives = {{"sum of the shear", 1, {}}};
  return scene;
}

TEST(SlowCheckpoints, SpareTheMemoryOfAThousandSteps) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer's own memory is what would be measured";
#endif
  const Scene scene = long_run();
  const Model model = make_model(scene);
  const double steps = static_cast<double>(model.times.size()), all = steps * thinned_bytes(model);
  for (const Method& method : scenes::all_methods()) {
    const auto peak = [&](double states) {
      return peak_of([&] {
        const auto done = run_keeping(scene, method, {}, states);
        if (done.gradients.of_objectives.size() == 0) std::_Exit(1);
      });
    };
    const double kept = peak(steps), spared = peak(64);
    EXPECT_GT(kept, all) << name_of(method);
    // what 64 states and the contact of all leave of it: the rest of the run is there either way
    EXPECT_LT(spared, kept - 0.9 * all) << name_of(method);
    RecordProperty(std::string(name_of(method)) + "_mb",
                   std::to_string(kept / 1e6) + " " + std::to_string(spared / 1e6));
  }
  for (const Method& method : scenes::all_methods()) {
    const Matrix<double> all_kept = run_keeping(scene, method, {}, steps).gradients.of_objectives;
    const Gradients few = run_keeping(scene, method, {}, 64).gradients;
    EXPECT_TRUE(few.of_objectives == all_kept) << name_of(method);
    EXPECT_EQ(few.repeated, plan_checkpoints(model.times.size(), 64)->repeated()) << name_of(method);
  }
}

}  // namespace
}  // namespace stickslip::checkpoints_test
