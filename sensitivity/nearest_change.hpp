/// Distance of an increment from the nearest change of a branch, in units of each parameter, to first order.
///
/// A branch changes where a margin m is zero:
///
///   open    m = g                                    gap, length
///   closed  m = p                                    pressure
///   stick   m = bound - |t_T|, at both ends of the line on which t_T moves
///   slip    m = |dg_T|; of a penalty (|z_T| - bound) / rho_T, for its slip holds the spring's
///   corner  m = mu p - limit, while it slips
///   yield   m = q - bound(a'); at a corner c of the hardening table a - c, while it flows
///   vertex  m = (x - v).(t + t'), of a closed point on a curve at finite strain
///   facet   m = share of a master node in a closed point, at small strain
///
/// With the derivative Dm by a parameter the change is -m / Dm away. At a tie (sensitivity/one_sided.hpp) the distance
/// is zero on both sides. A derivative that is rounding changes nothing: such a point has no distance.
///
/// Not counted are ends of segments, vertices of obstacles at small strain, and open points that pass from one part of
/// their master to the next.
#pragma once

#include "sensitivity/differentiation.hpp"

namespace stickslip {

/// An increment with its derivatives, as nearest_change() reads it.
struct DifferentiatedIncrement {
  const State<double>& state;
  double time;
  double largest;                                           ///< traction_scale() of the run so far
  const ParameterBlock& block;                              ///< parameters and slots
  const State<Direction>& at;                               ///< the state with derivatives
  const Vector<Direction>& memory;                          ///< History::bodies at the start of the increment
  const RegularisationField<Direction>* springs = nullptr;  ///< rho of a penalty; nullptr: the slip is none of a spring
};

/// Distances per parameter of the scene: below and above its value, in its units.
using NearestChange = Matrix<double>;

/// No change for any parameter: infinity.
NearestChange no_change(const Model& model);

/// Lowers the distances by those of an increment, for the parameters of its block.
void lower_nearest_change(const Model& model, const Slots<double>& slots, const DifferentiatedIncrement& increment,
                          NearestChange& nearest);

}  // namespace stickslip
