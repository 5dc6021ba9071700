/// Elements: tangents and forces of all elements of a mesh by type, as the engines ask for them (`s_element`: seconds
/// per element); forces that carry derivatives; and the assembly of the sparse engine, its pattern included.
#include <benchmark/benchmark.h>

#include "core/engine/engine.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::element_bench {
namespace {

template <class T>
struct Plate {
  Model model;
  Slots<T> slots;
  explicit Plate(int cells, const std::string& element) {
    auto scene = scenes::greco_plate(cells);
    scene.bodies[0].element = element;
    model = make_model(scene);
    slots = make_slots<T>(model, scene.as<T>());
  }
};

void per_element(benchmark::State& state, const Model& model) {
  state.counters["dofs"] = model.dof_count();
  state.counters["s_element"] =
      benchmark::Counter(static_cast<double>(model.bodies[0].mesh.element_count()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void tangents(benchmark::State& state, const std::string& element) {
  const Plate<double> plate(static_cast<int>(state.range(0)), element);
  for (auto _ : state) {
    double sum = 0;
    for_each_element_tangent(plate.model, plate.slots, 0, nullptr, [&](const auto&, const auto& K) { sum += K(0, 0); });
    benchmark::DoNotOptimize(sum);
  }
  per_element(state, plate.model);
}

/// T = double: the residual's part; T = Dual<4>: the pseudo-loads of four parameters at once.
template <class T>
void forces(benchmark::State& state, const std::string& element) {
  const Plate<T> plate(static_cast<int>(state.range(0)), element);
  const Vector<T> u = Vector<T>::Constant(plate.model.dof_count(), T(1e-3));
  for (auto _ : state) benchmark::DoNotOptimize(bulk_forces(plate.model, plate.slots, u, {}));
  per_element(state, plate.model);
}

constexpr auto plain_forces = forces<double>;
constexpr auto seeded_forces = forces<Dual<4>>;

/// Pattern, scatter map and values of the bodies: once a run where they are linear.
void assembly(benchmark::State& state, const std::string& element) {
  const Plate<double> plate(static_cast<int>(state.range(0)), element);
  long nonzeros = 0;
  for (auto _ : state) {
    const auto engine =
        sparse_engine(plate.model, plate.slots,
                      system_kind(plate.model, Multipliers::unknown, ConeRadius::augmented, Backend::eigen));
    nonzeros = engine.nonzeros();
  }
  per_element(state, plate.model);
  state.counters["nonzeros"] = static_cast<double>(nonzeros);
}

void on_every_type(benchmark::internal::Benchmark* one) { one->Arg(100)->Unit(benchmark::kMillisecond); }
BENCHMARK_CAPTURE(tangents, Q4, "Q4")->Apply(on_every_type);
BENCHMARK_CAPTURE(tangents, Q4_mean_dilatation, "Q4_mean_dilatation")->Apply(on_every_type);
BENCHMARK_CAPTURE(tangents, Q8, "Q8")->Apply(on_every_type);
BENCHMARK_CAPTURE(tangents, T3, "T3")->Apply(on_every_type);
BENCHMARK_CAPTURE(tangents, T6, "T6")->Apply(on_every_type);
BENCHMARK_CAPTURE(plain_forces, Q4, "Q4")->Apply(on_every_type);
BENCHMARK_CAPTURE(plain_forces, Q8, "Q8")->Apply(on_every_type);
BENCHMARK_CAPTURE(seeded_forces, Q4, "Q4")->Apply(on_every_type);
BENCHMARK_CAPTURE(assembly, Q4, "Q4")->Apply(on_every_type);
BENCHMARK_CAPTURE(assembly, Q8, "Q8")->Apply(on_every_type);

}  // namespace
}  // namespace stickslip::element_bench
