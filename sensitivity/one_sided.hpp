/// One-sided derivatives where the solution has a kink, and the derivative that stands for both.
///
/// Contact points at a tie take, for one parameter and one direction, the branches that their own derivatives confirm
/// (sensitivity/branches.hpp), found by flipping what is not confirmed. The history Dh then differs between the two
/// sides, so both are carried to the end of the run, where they may agree again. Uzawa's truncated scheme does so in
/// each augmentation. A projection onto a vertex of the master goes to another facet on each side
/// (sensitivity/sided_geometry.hpp). Material points that are about to flow take branches likewise
/// (sensitivity/flow_ties.hpp).
///
/// Branches that no direction confirms would give the derivative of nothing, and leave it in the history. So where
/// there are ties, all parameters are differentiated with the branches that hold along one direction, in which all of
/// them grow (consistent_at_ties). That is the derivative of a neighbouring smooth piece of the solution, for every
/// scheme and its adjoint. Once the kink has passed it is exact again.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "sensitivity/differentiate.hpp"
#include "sensitivity/whole_states.hpp"

namespace stickslip {

/// How far the nearest point is from a change of state; infinity where there is no such point.
///
///   open    between open and closed: pressure, or k g / A of an open point, over the largest of pressure and k / A
///           times motion
///   slip    between stick and slip, or pieces of the bound: distance to the cone, or k |dg_T| / A of a slipping point,
///           over the bound
///   yield   between elastic and plastic, of a point of a body (yield_margin)
///   vertex  from facet to facet of a master (vertex_margin)
struct Margins {
  double open, slip;
  double yield = std::numeric_limits<double>::infinity(), vertex = yield;
  /// The least of those at which a derivative is told to have two sides.
  double least() const { return std::min({open, slip, yield}); }
};

/// A point is weak where its distance from a change of state is no more than this.
inline constexpr double weak_margin = 1e-8;

/// Of one contact point.
Margins margins(const Model& model, const Slots<double>& slots, const State<double>& state, int point);
/// Of all: the least of each.
Margins margins(const Model& model, const Slots<double>& slots, const State<double>& state);

struct OneSided {
  /// Per increment: responses x parameters, from below and from above. NaN where a side has none: the response jumps,
  /// its slope is infinite (core/README.md), or no branches were confirmed.
  std::vector<Matrix<double>> backward, forward;
  Counters counters;
};

/// Both sides of all derivatives, if some increment has a weak point or the contact geometry a kink; none (and nothing
/// is computed) otherwise.
std::optional<OneSided> one_sided_derivatives(const Model& model, const Slots<double>& slots, const Method& method,
                                              const Trajectory<double>& trajectory, Workspace<double>& workspace);

/// Whether some point, of contact or of a body, is about to change its state in an increment. `previous`: that at its
/// start; `largest`: traction_scale of the run so far.
bool has_ties(const Model& model, const Slots<double>& slots, const Method& method, const State<double>& previous,
              const Increment<double>& increment, double largest);

/// An increment's contact and flow with the branches of its ties chosen, and those after each augmentation.
struct TakenBranches {
  ContactField<double> contact;
  FlowBranches flow;
  Vector<double> foot;  ///< of the history, and its labels: those of patches that were chosen at a vertex
  std::vector<int> patch;
  std::vector<std::pair<ContactField<double>, FlowBranches>> sweeps;
  void give(Increment<double>& increment) const;
};

/// The branches of all increments' ties chosen along one direction of all parameters; none where there are no ties.
/// `states`: of the trajectory. Adds what that took to `counters`.
std::optional<std::vector<TakenBranches>> consistent_at_ties(const Model& model, const Slots<double>& slots,
                                                             const Method& method, const Trajectory<double>& trajectory,
                                                             WholeStates& states, Workspace<double>& workspace,
                                                             Counters& counters);

}  // namespace stickslip
