/// One increment of the GRECO plate by each method, engine and backend: seconds per Newton iteration, of them the
/// numeric factorisation; and one sensitivity sweep. `iteration_over_factorisation` is what an iteration costs beside
/// the factor it cannot do without.
#include <benchmark/benchmark.h>

#include "sensitivity/differentiate.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip {
namespace {

void increment(benchmark::State& state, const Method& method, LinearAlgebra::Engine engine, Backend backend) {
  if (!has_backend(backend)) {
    state.SkipWithError("this backend is not built in");
    return;
  }
  const auto scene = scenes::greco_plate(static_cast<int>(state.range(0)));
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  RunOptions options;
  options.linear_algebra.engine = engine;
  options.backend = backend;
  Seconds seconds;
  long iterations = 0, factorizations = 0;
  for (auto _ : state) {
    Workspace<double> workspace;
    const auto trajectory = solve(model, slots, method, options, workspace);
    seconds.assembly += trajectory.seconds.assembly;
    seconds.factorization += trajectory.seconds.factorization;
    seconds.backsolve += trajectory.seconds.backsolve;
    iterations += trajectory.counters.newton;
    factorizations += trajectory.counters.factorizations;
  }
  const double factor = seconds.factorization / factorizations;
  const double iteration = (seconds.assembly + seconds.factorization + seconds.backsolve) / iterations;
  state.counters["dofs"] = static_cast<double>(model.free_dofs.size());
  state.counters["newton"] = static_cast<double>(iterations) / state.iterations();
  state.counters["s_factorisation"] = factor;
  state.counters["s_iteration"] = iteration;
  state.counters["iteration_over_factorisation"] = iteration / factor;
}

void sensitivity(benchmark::State& state, const Method& method) {
  const auto scene = scenes::greco_plate(static_cast<int>(state.range(0)));
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  Workspace<double> workspace;
  const auto trajectory = solve(model, slots, method, {}, workspace);
  for (auto _ : state) benchmark::DoNotOptimize(differentiate(model, slots, method, trajectory, workspace));
  state.counters["parameters"] = static_cast<double>(scene.parameters.size());
  state.counters["s_solve"] = trajectory.seconds.total;
}

using Engine = LinearAlgebra::Engine;
BENCHMARK_CAPTURE(increment, monolithic_sparse_mumps, MonolithicAL{}, Engine::sparse, Backend::mumps)
    ->Arg(100)
    ->Arg(224)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(increment, monolithic_sparse_umfpack, MonolithicAL{}, Engine::sparse, Backend::umfpack)
    ->Arg(100)
    ->Arg(224)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(increment, monolithic_condensed, MonolithicAL{}, Engine::condensed, Backend::automatic)
    ->Arg(100)
    ->Arg(224)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(increment, penalty_sparse_mumps, Penalty{}, Engine::sparse, Backend::mumps)
    ->Arg(100)
    ->Arg(224)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(increment, uzawa_condensed, UzawaAL{}, Engine::condensed, Backend::automatic)
    ->Arg(100)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(sensitivity, penalty, Penalty{})->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(sensitivity, uzawa, UzawaAL{})->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(sensitivity, monolithic, MonolithicAL{})->Arg(100)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stickslip
