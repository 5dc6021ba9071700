/// Contact points: nanoseconds for one, by the value alone (`evaluate_point`, every Newton iteration and line search)
/// and by the tangent (`point_tangent`, every iteration), in each branch and with one or two tangents; and for all
/// points of a mesh together with their forces. The friction-free point is the first of each group: what friction costs
/// is the rest. (The methods share this kernel; that they supply lambda differently costs nothing here.)
#include <benchmark/benchmark.h>

#include "core/contact/contact_point.hpp"
#include "core/model/contact_assembly.hpp"
#include "core/model/point_tangent.hpp"
#include "methods/newton/regularisation.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::contact_bench {
namespace {

/// A trial in the branch: closed by a pressure of 2, pulled by 1 (stick) or 5 (slip) at a friction of 0.6.
template <int Tangents>
Traction<double, Tangents> trial(ContactState state) {
  Traction<double, Tangents> lambda;
  lambda.normal = state == ContactState::open ? 2 : -2;
  for (int a = 0; a < Tangents; ++a) lambda.tangential[a] = state == ContactState::slip ? 5 : 0.5;
  return lambda;
}

template <int D, int Tangents>
void one_value(benchmark::State& state, ContactState branch) {
  PointGeometry<double> geometry;
  geometry.normal = Vec<double, D>::Unit(D - 1);
  geometry.tangents = Mat<double, D>::Identity().leftCols(D - 1);
  geometry.weights = Vector<double>::Ones(1);
  geometry.area = 0.5;
  Vec<double, D> w = Vec<double, D>::Constant(1e-3);
  const auto lambda = trial<Tangents>(branch);
  for (auto _ : state) {
    benchmark::DoNotOptimize(w);
    const auto point = evaluate_point<double, D, Tangents>(geometry, w, lambda, Vec<double, Tangents>::Zero().eval(),
                                                           {1.0, 1.0}, 0.6, ConeRadius::augmented, 0, nullptr);
    if (Tangents > 0 && point.state != branch) state.SkipWithError("not the branch that was meant");
    benchmark::DoNotOptimize(point_force<double, D, Tangents>(geometry, point.traction));
  }
}

/// The plate with its contact, at u = 0 and a multiplier that puts every point in one branch.
struct Plate {
  Model model;
  Slots<double> slots;
  std::vector<PointRegularisation<double>> rho;
  Vector<double> compact, multiplier;
  History<double> previous;
  std::vector<ContactState> states;
  Plate(int cells, ContactState branch, bool friction) {
    auto scene = scenes::greco_plate(cells);
    if (!friction) {
      scene.contacts[0].friction.reset();
      scene.responses.clear();
    }
    model = make_model(scene);
    slots = make_slots<double>(model, scene.as<double>());
    rho = initial_regularisation(slots, MonolithicAL{});
    compact = Vector<double>::Zero(static_cast<Eigen::Index>(model.contact_nodes.size()) * model.dimension);
    multiplier.resize(model.multiplier_count);
    const auto normal = friction ? trial<1>(branch) : Traction<double, 1>{trial<0>(branch).normal};
    for (const auto& point : model.points) {
      multiplier[point.multiplier] = normal.normal;
      for (int a = 0; a < point.tangents; ++a) multiplier[point.multiplier + 1 + a] = normal.tangential[a];
    }
    previous = initial_history(model, slots);
    states.assign(model.points.size(), branch);
  }
  ContactInput<double> input() const { return {model, slots, rho, previous, ConeRadius::augmented, 1}; }
};

void per_point(benchmark::State& state, const Model& model) {
  state.counters["points"] = static_cast<double>(model.points.size());
  state.counters["s_point"] =
      benchmark::Counter(static_cast<double>(model.points.size()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void all_values(benchmark::State& state, bool friction) {
  const Plate plate(static_cast<int>(state.range(0)), ContactState::slip, friction);
  for (auto _ : state) {
    const auto field = evaluate_contact(plate.input(), plate.compact, plate.multiplier, nullptr);
    benchmark::DoNotOptimize(contact_forces(plate.model, plate.slots, field));
  }
  per_point(state, plate.model);
}

void all_tangents(benchmark::State& state, ContactState branch, bool friction) {
  const Plate plate(static_cast<int>(state.range(0)), branch, friction);
  for (auto _ : state)
    for (int p = 0; p < static_cast<int>(plate.model.points.size()); ++p)
      benchmark::DoNotOptimize(point_tangent(plate.input(), p, plate.compact, plate.multiplier, plate.states[p]));
  per_point(state, plate.model);
}

constexpr auto open = ContactState::open, stick = ContactState::stick, slip = ContactState::slip;
constexpr auto frictionless_plane = one_value<2, 0>, plane = one_value<2, 1>, frictionless_space = one_value<3, 0>,
               space = one_value<3, 2>;
BENCHMARK_CAPTURE(frictionless_plane, closed, slip);
BENCHMARK_CAPTURE(plane, open, open);
BENCHMARK_CAPTURE(plane, stick, stick);
BENCHMARK_CAPTURE(plane, slip, slip);
BENCHMARK_CAPTURE(frictionless_space, closed, slip);
BENCHMARK_CAPTURE(space, stick, stick);
BENCHMARK_CAPTURE(space, slip, slip);
BENCHMARK_CAPTURE(all_values, frictionless, false)->Arg(100);
BENCHMARK_CAPTURE(all_values, friction, true)->Arg(100);
BENCHMARK_CAPTURE(all_tangents, frictionless, slip, false)->Arg(100);
BENCHMARK_CAPTURE(all_tangents, open, open, true)->Arg(100);
BENCHMARK_CAPTURE(all_tangents, stick, stick, true)->Arg(100);
BENCHMARK_CAPTURE(all_tangents, slip, slip, true)->Arg(100);

}  // namespace
}  // namespace stickslip::contact_bench
