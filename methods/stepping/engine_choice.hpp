/// Which engine solves a run, by predicted prices, and the engine itself.
#pragma once

#include "core/engine/condensed_tangent.hpp"
#include "core/engine/engine_price.hpp"
#include "core/engine/sparse_system.hpp"
#include "methods/stepping/run_options.hpp"

namespace stickslip {

/// Predicted price of a run by each engine. `factor`: of the bodies (bodies_factor).
EnginePrice predict_price(const Model& model, const Method& method, const FactorSize& factor);

/// Whether a run condenses the bodies, or the condensable ones of a mixed scene: if it is asked to, or if that is
/// cheaper. `factor`: of the bodies; if it is not given, they are analysed when it is needed.
bool condenses(const Model& model, const Method& method, LinearAlgebra::Engine engine,
               const std::optional<FactorSize>& factor = std::nullopt);

/// What condenses the tangents of a run, analysed; nothing where they are not condensed. `bodies` must outlive it.
template <class T>
std::unique_ptr<CondensedTangent<T>> make_condensed_tangent(const Model& model, const Slots<T>& slots,
                                                            const SystemKind& kind, LinearAlgebra::Engine engine,
                                                            FullBodies<T>& bodies) {
  if (!can_condense_tangents(model) || engine == LinearAlgebra::Engine::sparse) return nullptr;
  auto tangent = std::make_unique<CondensedTangent<T>>(model, slots, kind, bodies);
  if (engine == LinearAlgebra::Engine::automatic &&
      !prefers_condensed_tangents(tangent->factor_size(), tangent->dense_rows(), kind.symmetry))
    tangent.reset();
  return tangent;
}

/// The engine of bodies none of which is condensed: each tangent is, or it is sparse.
template <class T>
Engine<T> engine_of_full_bodies(const Model& model, const Slots<T>& slots, const SystemKind& kind,
                                LinearAlgebra::Engine engine) {
  if constexpr (std::is_same_v<T, double>) {
    auto bodies = std::make_unique<FullBodies<T>>(model, slots);
    if (auto tangent = make_condensed_tangent(model, slots, kind, engine, *bodies)) {
      auto instead = std::make_unique<SparseSystem<T>>(model, slots, kind, *bodies);
      return {model, slots, std::move(bodies), std::move(tangent), std::move(instead)};
    }
  }
  return sparse_engine(model, slots, kind);
}

/// Makes the engine of a run: dense on the contact dofs if all bodies are condensed, otherwise sparse. If the workspace
/// has condensed bodies already, they are used: the price of condensing is then not counted again.
template <class T>
void make_engine(const Model& model, const Slots<T>& slots, const Method& method, const RunOptions& options,
                 Workspace<T>& workspace) {
  const auto kind = system_kind(model, multipliers_of(method), cone_radius_of(method), options.backend);
  const auto engine = options.linear_algebra.engine;
  if (can_condense(model) && engine != LinearAlgebra::Engine::sparse) {
    auto bodies = workspace.condensation;
    const bool shared = bodies != nullptr;
    if (!bodies) bodies = std::make_shared<Condensation<T>>(model, options.backend);
    if (shared || condenses(model, method, engine, bodies->factor_size())) {
      if (!std::exchange(workspace.condensation, bodies)) bodies->factorise(slots);
      if (bodies->valid()) {
        workspace.engine = std::make_shared<Engine<T>>(condensed_engine(model, slots, kind, std::move(bodies)));
        return;
      }
    }
  }
  workspace.engine = std::make_shared<Engine<T>>(engine_of_full_bodies(model, slots, kind, engine));
}

extern template std::unique_ptr<CondensedTangent<double>> make_condensed_tangent(const Model&, const Slots<double>&,
                                                                                 const SystemKind&,
                                                                                 LinearAlgebra::Engine,
                                                                                 FullBodies<double>&);
extern template void make_engine(const Model&, const Slots<double>&, const Method&, const RunOptions&,
                                 Workspace<double>&);

}  // namespace stickslip
