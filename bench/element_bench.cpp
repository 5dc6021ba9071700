/// Elements: nanoseconds for the tangent and the forces of one element, and for all elements of a mesh as the engines
/// ask for them (`s_element`: seconds per element).
#include <benchmark/benchmark.h>

#include "core/model/slots.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip {
namespace {

void mesh_tangents(benchmark::State& state) {
  const auto scene = scenes::greco_plate(static_cast<int>(state.range(0)));
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  for (auto _ : state) {
    double sum = 0;
    for_each_element_tangent(model, slots, 0, nullptr, [&](const auto&, const auto& K) { sum += K(0, 0); });
    benchmark::DoNotOptimize(sum);
  }
  state.counters["s_element"] =
      benchmark::Counter(static_cast<double>(model.bodies[0].mesh.element_count()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void mesh_forces(benchmark::State& state) {
  const auto scene = scenes::greco_plate(static_cast<int>(state.range(0)));
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  const Vector<double> u = Vector<double>::LinSpaced(model.dof_count(), 0, 1e-3);
  for (auto _ : state) benchmark::DoNotOptimize(bulk_forces(model, slots, u));
  state.counters["s_element"] =
      benchmark::Counter(static_cast<double>(model.bodies[0].mesh.element_count()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void seeded_forces(benchmark::State& state) {
  using D = Dual<4>;
  const auto scene = scenes::greco_plate(static_cast<int>(state.range(0)));
  const Model model = make_model(scene);
  const auto slots = make_slots<D>(model, scene.as<D>());
  const Vector<D> u = Vector<D>::Constant(model.dof_count(), D(1e-3));
  for (auto _ : state) benchmark::DoNotOptimize(bulk_forces(model, slots, u));
  state.counters["s_element"] =
      benchmark::Counter(static_cast<double>(model.bodies[0].mesh.element_count()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(mesh_tangents)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK(mesh_forces)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK(seeded_forces)->Arg(100)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stickslip
