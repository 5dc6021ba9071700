/// Which engine solves a run, by predicted prices, and the engine itself.
#pragma once

#include "core/model/engine_price.hpp"
#include "methods/run.hpp"

namespace stickslip {

/// Whether the tangent has the multipliers among its unknowns.
bool has_unknown_multipliers(const Method& method);

ConeRadius cone_radius(const Method& method);

/// Price of a run by each engine.
EnginePrice predict_price(const Model& model, const Method& method);

/// Whether a run condenses the bodies: where it is asked to, else where that is cheaper.
bool condenses(const Model& model, const Method& method, LinearAlgebra::Engine engine);

/// Builds the engine a run asks for.
template <class T>
void make_engine(const Model& model, const Slots<T>& slots, const Method& method, const RunOptions& options,
                 Workspace<T>& workspace) {
  const bool unknown_multipliers = has_unknown_multipliers(method);
  const ConeRadius cone = cone_radius(method);
  auto& condensation = workspace.condensation;
  if (condenses(model, method, options.linear_algebra.engine)) {
    if (!condensation) condensation = std::make_shared<Condensation<T>>(model, slots, options.backend);
    if (condensation->valid()) {
      workspace.engine.emplace(std::in_place_type<CondensedEngine<T>>, model, slots, unknown_multipliers, cone,
                               condensation);
      return;
    }
  }
  workspace.engine.emplace(std::in_place_type<SparseEngine<T>>, model, slots, unknown_multipliers, cone,
                           options.backend);
}

}  // namespace stickslip
