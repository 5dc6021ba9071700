#include "methods/stepping/engine_choice.hpp"

namespace stickslip {

EnginePrice predict_price(const Model& model, const Method& method, const FactorSize& factor) {
  const Multipliers multipliers = multipliers_of(method);
  const auto kind = system_kind(model, multipliers, cone_radius_of(method), Backend::automatic);
  return predict_price(model, multipliers, kind.symmetry, factor);
}

bool condenses(const Model& model, const Method& method, LinearAlgebra::Engine engine,
               const std::optional<FactorSize>& factor) {
  if (!can_condense(model)) return false;
  if (engine != LinearAlgebra::Engine::automatic) return engine == LinearAlgebra::Engine::condensed;
  return prefers_condensed(model, predict_price(model, method, factor ? *factor : bodies_factor(model)));
}

template std::unique_ptr<CondensedTangent<double>> make_condensed_tangent(const Model&, const Slots<double>&,
                                                                          const SystemKind&, LinearAlgebra::Engine,
                                                                          FullBodies<double>&);
template void make_engine(const Model&, const Slots<double>&, const Method&, const RunOptions&, Workspace<double>&);

}  // namespace stickslip
