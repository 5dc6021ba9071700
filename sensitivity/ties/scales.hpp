/// What counts as a tie, and what counts as rounding, for all that asks whether a derivative holds.
#pragma once

#include "core/model/state.hpp"
#include "sensitivity/direction.hpp"

namespace stickslip {

struct ParameterBlock;

/// Largest margin, dimensionless, at which a state counts as being at a tie. The methods leave errors of up to 1e-10.
inline constexpr double weak_margin = 1e-8;

/// Share of the size of its terms up to which a derivative is rounding.
inline constexpr double rounding_share = 1e-10;

/// Sine of an angle, or share of a length, up to which what meets at a vertex is alike: a curve does not turn there.
inline constexpr double straight = 1e-6;

/// Scale of the tractions of a state, force per area: the larger of the largest pressure and of k / A times the largest
/// motion of a point. The second counts where contact has only just begun.
double traction_scale(const Model& model, const Slots<double>& slots, const State<double>& state);

/// Traction per displacement of the node of point p: k / A.
double elastic_traction(const Slots<double>& slots, int p);

/// Sizes that derivatives are compared with, per direction of a block. A derivative that is smaller than
/// rounding_share of these is rounding.
struct RateScales {
  using ByDirection = Direction::Gradient;

  ByDirection per_parameter;  ///< 1 over the size of each parameter; 0: not known
  ByDirection of_bodies;      ///< length: what a motion leaves of strains, 1e-3 of its largest derivative
  ByDirection of_mesh;        ///< the same of displacements and of places of nodes
  /// Force per area: the largest of the derivatives of all tractions, of all motions and of `of_bodies` times k / A,
  /// and of the largest traction of the run over the size of the parameter.
  ByDirection of_tractions;

  /// `at`: the state with its derivatives; `largest`: traction_scale() of the run so far.
  RateScales(const Model& model, const Slots<double>& slots, const ParameterBlock& block, const State<Direction>& at,
             const ByDirection& per_size, double largest);

  /// Derivatives of a dimensionless margin up to this are rounding. `size`: of the terms of the derivative.
  ByDirection negligible(const ByDirection& size) const { return rounding_share * size.max(per_parameter); }
};

}  // namespace stickslip
