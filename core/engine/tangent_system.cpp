#include "core/engine/tangent_system.hpp"

#include <algorithm>

namespace stickslip {
namespace {

bool integrates(const Model& model) {
  return std::any_of(model.points.begin(), model.points.end(), [](const auto& point) { return point.is_integrated(); });
}

/// Slip couples the normal into the tangential rows, and not the other way round: the tangent is unsymmetric. It is
/// symmetric if nothing couples them: if the radius of the cone is fixed while the system is solved (that of given
/// multipliers), or if the bound does not depend on the pressure. If frames turn, friction follows them and has no
/// potential, whatever its law.
Symmetry symmetry_of(const Model& model, Multipliers multipliers, ConeRadius cone) {
  const bool fixed_radius = cone == ConeRadius::multiplier && multipliers == Multipliers::given;
  if (!model.followers.empty()) return Symmetry::general;  // of a pressure that follows a side with ends
  if (model.effects.friction && model.effects.current_geometry) return Symmetry::general;
  if (model.effects.current_geometry && integrates(model)) return Symmetry::general;  // its forces have no potential
  if (model.effects.coupled_friction && !fixed_radius) return Symmetry::general;
  return multipliers == Multipliers::unknown ? Symmetry::indefinite : Symmetry::positive_definite;
}

}  // namespace

SystemKind system_kind(const Model& model, Multipliers multipliers, ConeRadius cone, Backend backend) {
  return {multipliers, symmetry_of(model, multipliers, cone), backend};
}

}  // namespace stickslip
