/// The price of a run by each engine as it is predicted (core/engine/engine_price.hpp), held against what came: seconds
/// of both on the GRECO plate, with and without friction and derivatives. `predicted` and `measured` are sparse over
/// condensed; `lost` is what the chosen engine took beyond the faster one, as a share. The argument is the cells along
/// a side.
#include <benchmark/benchmark.h>

#include <algorithm>

#include "methods/stepping/engine_choice.hpp"
#include "sensitivity/differentiate.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::engine_price_bench {
namespace {

using Kind = LinearAlgebra::Engine;

double seconds_by(const Model& model, const Slots<double>& slots, const Method& method, Kind engine) {
  RunOptions options;
  options.linear_algebra.engine = engine;
  Workspace<double> workspace;
  Trajectory<double> trajectory;
  Derivatives derivatives(model, slots, method, workspace);
  options.on_step = [&] { derivatives.follow(trajectory); };
  solve(model, slots, method, options, workspace, trajectory);
  return trajectory.seconds.total + derivatives.finish(trajectory).seconds;
}

void engine_price(benchmark::State& state, const Method& method, bool friction, bool derivatives) {
  auto scene = scenes::greco_plate(static_cast<int>(state.range(0)));
  if (!friction) {
    scene.contacts[0].friction.reset();
    scene.supports = {scenes::support("plate.right", {{'x', scenes::table({{0, 0.0}})}})};
    scene.responses.clear();
  }
  if (!friction || !derivatives) scene.parameters.clear();
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  const EnginePrice price = predict_price(model, method, bodies_factor(model));
  double sparse = 0, condensed = 0;
  for (auto _ : state) {
    sparse += seconds_by(model, slots, method, Kind::sparse);
    condensed += seconds_by(model, slots, method, Kind::condensed);
  }
  const double chosen = condenses(model, method, Kind::automatic) ? condensed : sparse;
  state.counters["dofs"] = static_cast<double>(model.free_dofs.size());
  state.counters["contact_points"] = static_cast<double>(model.points.size());
  state.counters["predicted"] = price.sparse / price.condensed;
  state.counters["measured"] = sparse / condensed;
  state.counters["lost"] = chosen / std::min(sparse, condensed) - 1;
}

void register_all() {
  const std::vector<std::pair<const char*, Method>> methods{{"penalty", Penalty{}}, {"monolithic", MonolithicAL{}}};
  for (const auto& [name, method] : methods)
    for (const auto& [what, friction, derivatives] :
         {std::tuple{"friction", true, false}, std::tuple{"derivatives", true, true},
          std::tuple{"frictionless", false, false}})
      for (const int cells : {10, 40, 100, 160})
        benchmark::RegisterBenchmark((std::string("engine_price/") + name + "/" + what).c_str(),
                                     [method = method, friction = friction, derivatives = derivatives](
                                         benchmark::State& s) { engine_price(s, method, friction, derivatives); })
            ->Unit(benchmark::kMillisecond)
            ->Arg(cells);
}

const bool registered  // before main, as the BENCHMARK macros do
    = (register_all(), true);

}  // namespace
}  // namespace stickslip::engine_price_bench
