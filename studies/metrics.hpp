/// One measure of error for every method, computed from states alone by code that does not know which method ran.
///
/// With l the largest relative displacement or A|t|/k of the run, p the largest traction and f the largest nodal force:
///   equilibrium      largest nodal imbalance at free nodes / f
///   gap              largest penetration / l
///   complementarity  largest |min(g_N k / A, -t_N)| / p
///   cone             largest (|t_T| + mu t_N)^+ / p
///   stick            largest slip, summed over increments, of a point that stayed inside its cone, / l: what a
///                    regularisation lets creep
///   slip_direction   largest 1 - cos(slip, t_T) among points on the cone that slip
/// All are 0 for an exact solution of the discrete problem. Dimensionless, hence the same in any units.
#pragma once

#include <vector>

#include "methods/method.hpp"

namespace stickslip {

struct KktError {
  double equilibrium = 0, gap = 0, complementarity = 0, cone = 0, stick = 0, slip_direction = 0;
  double largest() const;
};

struct ContactSummary {
  int open = 0, stick = 0, slip = 0;
  double penetration = 0;                ///< largest, length
  double normal_force = 0;               ///< sum, positive in compression
  std::vector<double> tangential_force;  ///< on the slave, by axis
};

/// Measures of the increments of a trajectory, in order (the creep of sticking points is summed along the way).
std::vector<KktError> kkt_errors(const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory);
std::vector<ContactSummary> summarise(const Model& model, const Slots<double>& slots, const State<double>& state);

}  // namespace stickslip
