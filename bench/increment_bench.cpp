/// One increment of the GRECO plate by each method, engine and backend: seconds per Newton iteration, of them the
/// numeric factorisation (`iteration_over_factorisation`: what an iteration costs beside the factor it cannot do
/// without); the same without friction, which must cost no more than the unknowns it has; and one sensitivity sweep by
/// each scheme (`parameter_over_iteration`: one parameter against one Newton iteration). The argument is the cells
/// along a side.
#include <benchmark/benchmark.h>

#include "sensitivity/differentiate.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::increment_bench {
namespace {

using Kind = LinearAlgebra::Engine;

struct Plate {
  Model model;
  Slots<double> slots;
  Plate(int cells, bool friction) {
    auto scene = scenes::greco_plate(cells);
    if (!friction) {
      scene.contacts[0].friction.reset();
      scene.supports = {scenes::support("plate.right", {{'x', scenes::table({{0, 0.0}})}})};
      scene.responses.clear();
      scene.parameters.clear();
    }
    model = make_model(scene);
    slots = make_slots<double>(model, scene.as<double>());
  }
};

/// What an iteration of some runs took, by part.
struct Iterations {
  Seconds seconds;
  Counters counters;
  void add(const Trajectory<double>& trajectory) {
    seconds.contact += trajectory.seconds.contact;
    seconds.bodies += trajectory.seconds.bodies;
    seconds.factorization += trajectory.seconds.factorization;
    seconds.backsolve += trajectory.seconds.backsolve;
    counters += trajectory.counters;
  }
  double factorisation() const { return seconds.factorization / counters.factorizations; }
  double one() const { return (seconds.assembly() + seconds.factorization + seconds.backsolve) / counters.newton; }
};

void increment(benchmark::State& state, const Method& method, Kind engine, Backend backend, bool friction = true) {
  if (!has_backend(backend)) {
    state.SkipWithError("this backend is not built in");
    return;
  }
  const Plate plate(static_cast<int>(state.range(0)), friction);
  RunOptions options;
  options.linear_algebra.engine = engine;
  options.backend = backend;
  Iterations iterations;
  long nonzeros = 0;
  for (auto _ : state) {
    Workspace<double> workspace;
    const auto trajectory = solve(plate.model, plate.slots, method, options, workspace);
    if (!is_converged(trajectory.status)) state.SkipWithError(trajectory.message.c_str());
    iterations.add(trajectory);
    nonzeros = workspace.engine->nonzeros();
  }
  state.counters["dofs"] = static_cast<double>(plate.model.free_dofs.size());
  state.counters["multipliers"] = plate.model.multiplier_count;
  state.counters["nonzeros"] = static_cast<double>(nonzeros);
  state.counters["newton"] = static_cast<double>(iterations.counters.newton) / state.iterations();
  state.counters["s_factorisation"] = iterations.factorisation();
  state.counters["s_iteration"] = iterations.one();
  state.counters["iteration_over_factorisation"] = iterations.one() / iterations.factorisation();
}

void sensitivity(benchmark::State& state, const Method& method, Kind engine) {
  const Plate plate(static_cast<int>(state.range(0)), true);
  RunOptions options;
  options.linear_algebra.engine = engine;
  Workspace<double> workspace;
  const auto trajectory = solve(plate.model, plate.slots, method, options, workspace);
  Iterations iterations;
  iterations.add(trajectory);
  double seconds = 0;
  for (auto _ : state) {
    const auto gradients = differentiate(plate.model, plate.slots, method, trajectory, workspace);
    seconds += gradients.seconds;
  }
  const auto parameters = static_cast<double>(plate.model.scene.parameters.size());
  state.counters["dofs"] = static_cast<double>(plate.model.free_dofs.size());
  state.counters["parameters"] = parameters;
  state.counters["s_solve"] = trajectory.seconds.total;
  state.counters["parameter_over_iteration"] = seconds / state.iterations() / parameters / iterations.one();
}

void register_all() {
  auto add = [](const std::string& name, auto&& run, std::vector<int> cells) {
    auto* one = benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMillisecond);
    for (int n : cells) one->Arg(n);
  };
  const std::vector<std::pair<const char*, Method>> methods{
      {"penalty", Penalty{}}, {"uzawa", UzawaAL{}}, {"monolithic", MonolithicAL{}}};
  for (const auto& [name, method] : methods) {
    auto by = [&add, name = name, method = method](const char* how, Kind kind, Backend backend, bool friction,
                                                   std::vector<int> cells) {
      add(
          std::string("increment/") + name + "/" + how,
          [=](benchmark::State& s) { increment(s, method, kind, backend, friction); }, cells);
    };
    by("sparse_mumps", Kind::sparse, Backend::mumps, true, {100, 224});
    by("condensed", Kind::condensed, Backend::automatic, true, {100, 224});
    by("sparse_frictionless", Kind::sparse, Backend::automatic, false, {100});
    by("condensed_frictionless", Kind::condensed, Backend::automatic, false, {100});
    for (const auto& [how, kind] : {std::pair{"sparse", Kind::sparse}, std::pair{"condensed", Kind::condensed}})
      add(std::string("sensitivity/") + name + "/" + how,
          [method = method, kind = kind](benchmark::State& s) { sensitivity(s, method, kind); }, {100});
  }
}

const bool registered  // before main, as the BENCHMARK macros do
    = (register_all(), true);

}  // namespace
}  // namespace stickslip::increment_bench
