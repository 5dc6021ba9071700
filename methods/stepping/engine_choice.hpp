/// Which engine solves a run, by predicted prices, and the engine itself.
#pragma once

#include "core/engine/condensed_engine.hpp"
#include "core/engine/engine_price.hpp"
#include "core/engine/sparse_engine.hpp"
#include "methods/stepping/run.hpp"

namespace stickslip {

/// Predicted price of a run by each engine. `factor`: of the bodies (bodies_factor).
EnginePrice predict_price(const Model& model, const Method& method, const FactorSize& factor);

/// Whether a run condenses the bodies, or the condensable ones of a mixed scene: if it is asked to, or if that is
/// cheaper. `factor`: of the bodies; if it is not given, they are analysed when it is needed.
bool condenses(const Model& model, const Method& method, LinearAlgebra::Engine engine,
               const std::optional<FactorSize>& factor = std::nullopt);

/// What condenses the tangents of a run, analysed; nothing where they are not condensed.
template <class T>
std::shared_ptr<CondensedTangent<T>> make_condensed_tangent(const Model& model, const Slots<T>& slots,
                                                            const Method& method, const LinearAlgebra::Engine engine,
                                                            Backend backend) {
  if (!can_condense_tangents(model) || engine == LinearAlgebra::Engine::sparse) return nullptr;
  const bool unknown = has_unknown_multipliers(method);
  const auto symmetry = detail::symmetry_of(model, unknown, cone_radius_of(method));
  auto tangent = std::make_shared<CondensedTangent<T>>(model, slots, unknown, symmetry, backend);
  if (engine == LinearAlgebra::Engine::automatic &&
      !prefers_condensed_tangents(tangent->factor_size(), tangent->dense_rows(), symmetry))
    tangent.reset();
  return tangent;
}

/// Makes the engine of a run: dense on the contact dofs if all bodies are condensed, otherwise sparse. If the workspace
/// has condensed bodies already, they are used: the price of condensing is then not counted again.
template <class T>
void make_engine(const Model& model, const Slots<T>& slots, const Method& method, const RunOptions& options,
                 Workspace<T>& workspace) {
  const bool unknown_multipliers = has_unknown_multipliers(method);
  const ConeRadius cone = cone_radius_of(method);
  const auto engine = options.linear_algebra.engine;
  std::shared_ptr<Condensation<T>> condensed;  // the condensable bodies of a mixed scene
  if (can_condense(model) && engine != LinearAlgebra::Engine::sparse) {
    auto bodies = workspace.condensation;
    const bool shared = bodies != nullptr;
    if (!bodies) bodies = std::make_shared<Condensation<T>>(model, options.backend);
    if (shared || condenses(model, method, engine, bodies->factor_size())) {
      if (!std::exchange(workspace.condensation, bodies)) bodies->factorise(slots);
      if (bodies->valid() && !model.effects.linear_bulk) condensed = bodies;
      if (bodies->valid() && model.effects.linear_bulk) {
        workspace.engine = std::make_shared<CondensedEngine<T>>(model, slots, unknown_multipliers, cone, bodies);
        return;
      }
    }
  }
  std::shared_ptr<CondensedTangent<T>> tangent;
  if constexpr (std::is_same_v<T, double>)
    if (!condensed) tangent = make_condensed_tangent(model, slots, method, engine, options.backend);
  workspace.engine = std::make_shared<SparseEngine<T>>(model, slots, unknown_multipliers, cone, options.backend,
                                                       std::move(condensed), std::move(tangent));
}

}  // namespace stickslip
