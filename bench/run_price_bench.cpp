/// The price of whole runs in factorisations: CPU seconds over F, one numeric Cholesky factorisation of the bodies'
/// stiffness over all free dofs, in the same process. All by default options, on the GRECO plate; the argument is the
/// cells along a side.
///
///   run_price/METHOD/frictionless      one step; `run_over_factorisation`
///   run_price/METHOD/friction          ten steps; the same
///   derivative_price/METHOD/sparse     ten steps; one and eight derivatives of a step over a Newton iteration of the
///                                      run, mean of those that factorise and those that update, and over one that
///                                      factorises
///   derivative_price/METHOD/condensed  ten steps; `with_over_without` of eight derivatives, and what they add in F
///   adjoint_price/METHOD               ten steps; `gradient_over_run` of one objective by some thousand shape
///                                      parameters
#include <benchmark/benchmark.h>

#include <ctime>

#include "core/algebra/memory.hpp"
#include "core/engine/body_matrix.hpp"
#include "sensitivity/adjoint.hpp"
#include "sensitivity/differentiate.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::run_price_bench {
namespace {

using Kind = LinearAlgebra::Engine;

/// CPU seconds of a call.
template <class F>
double seconds_of(F&& call) {
  const std::clock_t start = std::clock();
  call();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// The plate with so many steps and parameters: pressed at once, pushed step by step and halfway back, so that each
/// step has branches to find. Parameters beyond those of the scene repeat them, which costs the same.
Scene plate(int cells, int steps, bool friction, std::size_t parameters) {
  auto scene = scenes::greco_plate(cells);
  scene.legs = {{1, steps}};
  if (steps > 1) scene.loads[0].history = scenes::table({{0, 0.0}, {0.7, 1.0}, {1, 0.5}});
  if (!friction) {
    scene.contacts[0].friction.reset();
    scene.supports = {scenes::support("plate.right", {{'x', scenes::table({{0, 0.0}})}})};
    scene.responses.clear();
  }
  const auto own = scene.parameters;
  scene.parameters.clear();
  for (std::size_t j = 0; j < parameters; ++j) scene.parameters.push_back(own[j % own.size()]);
  return scene;
}

struct Run {
  double seconds = 0;
  double derivatives = 0;  ///< wall clock, of these
  Seconds parts;
  Counters counters;
  /// Seconds of a Newton iteration, assembly, factorisation and solves: mean of all, and of one that factorises.
  double iteration() const { return (parts.assembly() + parts.factorization + parts.backsolve) / counters.newton; }
  double full_iteration() const {
    return (parts.assembly() + parts.backsolve) / counters.newton + parts.factorization / counters.factorizations;
  }
};

/// A run with its derivatives, from the scene on; an error of the benchmark where it does not converge.
Run run(benchmark::State& state, const Scene& scene, const Method& method, Kind engine) {
  Run result;
  result.seconds = seconds_of([&] {
    const Model model = make_model(scene);
    const auto slots = make_slots<double>(model, scene.as<double>());
    RunOptions options;
    options.linear_algebra.engine = engine;
    Workspace<double> workspace;
    Trajectory<double> trajectory;
    Derivatives derivatives(model, slots, method, workspace);
    options.on_step = [&] { derivatives.follow(trajectory); };
    solve(model, slots, method, options, workspace, trajectory);
    if (!is_converged(trajectory.status)) state.SkipWithError(trajectory.message.c_str());
    result.derivatives = derivatives.finish(trajectory).seconds;
    result.parts = trajectory.seconds;
    result.counters = trajectory.counters;
  });
  return result;
}

/// F of a scene, the quickest of three.
double factorisation_of(const Scene& scene) {
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  const RowLists lists = element_rows(model, model.free_index);
  const auto pattern = make_pattern(static_cast<int>(model.free_dofs.size()), lists);
  const auto values = assemble_bodies<double>(model, slots, lists, *pattern);
  LinearSolver<double> solver;
  solver.analyse(pattern, Symmetry::positive_definite);
  double least = seconds_of([&] { solver.factorise(values.data()); });
  for (int i = 0; i < 2; ++i) least = std::min(least, seconds_of([&] { solver.factorise(values.data()); }));
  return least;
}

void run_price(benchmark::State& state, const Method& method, int steps, bool friction) {
  const int cells = static_cast<int>(state.range(0));
  // (The supports of the run with friction hold the plate, so that its stiffness has a factor.)
  const double factorisation = factorisation_of(plate(cells, steps, true, 0));
  const auto scene = plate(cells, steps, friction, 0);
  double seconds = 0;
  long made = 0;
  for (auto _ : state) {
    const Run one = run(state, scene, method, Kind::automatic);
    seconds += one.seconds;
    made = one.counters.factorizations;
  }
  state.counters["s_factorisation"] = factorisation;
  state.counters["factorisations"] = static_cast<double>(made);
  state.counters["run_over_factorisation"] = seconds / static_cast<double>(state.iterations()) / factorisation;
}

void derivative_price(benchmark::State& state, const Method& method, Kind engine) {
  constexpr int steps = 10;
  const int cells = static_cast<int>(state.range(0));
  const double factorisation = factorisation_of(plate(cells, steps, true, 0));
  double one = 0, eight = 0, iteration = 0, full = 0, ratio = 0;
  for (auto _ : state) {
    const Run without = run(state, plate(cells, steps, true, 0), method, engine);
    const Run with_one = run(state, plate(cells, steps, true, 1), method, engine);
    const Run with_eight = run(state, plate(cells, steps, true, 8), method, engine);
    one += with_one.derivatives / steps;
    eight += with_eight.derivatives / steps;
    iteration += without.iteration();
    full += without.full_iteration();
    ratio += with_eight.seconds / without.seconds;
  }
  const auto runs = static_cast<double>(state.iterations());
  if (engine == Kind::sparse) {
    state.counters["one_over_iteration"] = one / iteration;
    state.counters["eight_over_iteration"] = eight / iteration;
    state.counters["one_over_full_iteration"] = one / full;
    state.counters["eight_over_full_iteration"] = eight / full;
  } else {
    state.counters["with_over_without"] = ratio / runs;
    state.counters["added_over_factorisation"] = steps * eight / runs / factorisation;
  }
}

/// The plate with the nodes of its free sides as shape parameters, along both axes, and the friction over all steps as
/// the objective.
Scene shaped_plate(int cells, int steps) {
  Scene scene = plate(cells, steps, true, 0);
  for (const char* side : {"plate.top", "plate.left", "plate.bottom"})
    for (int node = 1; node < cells; ++node)
      for (int axis = 0; axis < 2; ++axis)
        scenes::shape(scene, std::string(side).substr(6) + std::to_string(2 * node + axis),
                      {0, side, "", {1.0 - axis, 1.0 * axis}, node, 0});
  const auto is_friction = [](const Response& response) { return response.name == "friction"; };
  const auto& responses = scene.responses;
  const auto found = std::find_if(responses.begin(), responses.end(), is_friction);
  scene.objectives = {{"drag", static_cast<int>(found - responses.begin())}};
  scene.sensitivity_mode = SensitivityMode::adjoint;
  return scene;
}

void adjoint_price(benchmark::State& state, const Method& method) {
  const Scene scene = shaped_plate(static_cast<int>(state.range(0)), 10);
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  double forward = 0, backward = 0;
  long made = 0;
  for (auto _ : state) {
    Workspace<double> workspace;
    Trajectory<double> trajectory;
    forward += seconds_of([&] { trajectory = solve(model, slots, method, {}, workspace); });
    Gradients gradients;
    backward += seconds_of([&] { gradients = adjoint(model, slots, method, trajectory, workspace); });
    if (!is_converged(gradients.status)) state.SkipWithError(gradients.message.c_str());
    made = gradients.counters.sensitivity_factorizations;
  }
  const auto runs = static_cast<double>(state.iterations());
  state.counters["parameters"] = static_cast<double>(scene.parameters.size());
  state.counters["factorisations"] = static_cast<double>(made);
  state.counters["s_run"] = forward / runs;
  state.counters["s_gradient"] = backward / runs;
  state.counters["gradient_over_run"] = backward / forward;
}

void register_all() {
  const std::vector<std::pair<std::string, Method>> methods{
      {"penalty", Penalty{}}, {"uzawa", UzawaAL{}}, {"monolithic", MonolithicAL{}}};
  const auto add = [](const std::string& name, auto&& price, int cells) {
    benchmark::RegisterBenchmark(name.c_str(), price)->Unit(benchmark::kMillisecond)->Arg(cells);
  };
  for (const auto& [name, one] : methods) {
    const Method& method = one;
    add(
        "run_price/" + name + "/frictionless", [=](benchmark::State& s) { run_price(s, method, 1, false); }, 226);
    add(
        "run_price/" + name + "/friction", [=](benchmark::State& s) { run_price(s, method, 10, true); }, 100);
    add(
        "derivative_price/" + name + "/sparse", [=](benchmark::State& s) { derivative_price(s, method, Kind::sparse); },
        100);
    add(
        "derivative_price/" + name + "/condensed",
        [=](benchmark::State& s) { derivative_price(s, method, Kind::condensed); }, 100);
    add(
        "adjoint_price/" + name, [=](benchmark::State& s) { adjoint_price(s, method); }, 143);
  }
}

const bool registered  // before main, as the BENCHMARK macros do
    = (keep_freed_memory(), register_all(), true);

}  // namespace
}  // namespace stickslip::run_price_bench
