/// One-sided derivatives at kinks of the solution, and one derivative that stands for both sides.
///
/// For one parameter and one side, what is at a tie takes the choice that its own derivative confirms
/// (sensitivity/ties/tie.hpp). A projection onto a vertex of the master passes to another facet on each side
/// (sensitivity/sided_geometry.hpp). The derivative of the history then differs between the two sides. So both are
/// carried to the end of the run, where they may agree again. Uzawa's truncated scheme does this in each augmentation.
///
/// Branches that no direction confirms would give a derivative of nothing, and leave it in the history. So at ties all
/// parameters are differentiated with the branches of one direction, in which all parameters grow (consistent_at_ties).
/// The result is the derivative of a neighbouring smooth piece of the solution, for every scheme and its adjoint. It is
/// exact again once the kink has passed.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "sensitivity/differentiate.hpp"
#include "sensitivity/ties/scales.hpp"

namespace stickslip {

class WholeStates;  // sensitivity/whole_states.hpp

/// Distance of the nearest point from a change of state, dimensionless; infinity if there is no point.
///
///   open    between open and closed: pressure, or k g / A of an open point, over the largest of pressure and
///           k / A times motion
///   slip    between stick and slip, or between pieces of the bound, over the bound: distance to the cone, or
///           k |dg_T| / A of a slipping point
///   yield   between elastic and plastic, of a material point (yield_margin)
///   vertex  between two facets of a master (vertex_margin)
struct Margins {
  double open, slip;
  double yield = std::numeric_limits<double>::infinity(), vertex = yield;
  /// The least of the margins at which a derivative is reported to have two sides.
  double least() const { return std::min({open, slip, yield}); }
};

/// Margins of one contact point.
Margins margins(const Model& model, const Slots<double>& slots, const State<double>& state, int point);
/// The least of each margin over all points.
Margins margins(const Model& model, const Slots<double>& slots, const State<double>& state);

/// Largest number of parameters whose two sides are computed for an adjoint run. Each side takes a factorisation and a
/// solve an increment, as direct differentiation alone would: of 50 parameters, at 4 iterations an increment, the time
/// of some 25 runs. An adjoint is for many more.
inline constexpr int most_sided_parameters = 50;

struct OneSided {
  /// Per increment: responses x parameters, from below and from above. NaN if a side has no derivative: the response
  /// jumps, its slope is infinite (core/README.md), or no branches were confirmed. Empty if an adjoint run has more
  /// than most_sided_parameters.
  std::vector<Matrix<double>> backward, forward;
  std::size_t first = 0;  ///< the first increment with ties
  Counters counters;
  long repeated = 0;  ///< number of increments solved again (sensitivity/whole_states.hpp)
};

/// Both sides of all derivatives, in either mode. None, without any computation, unless an increment has a tie or the
/// contact geometry a kink; of an adjoint run also unless values of a response tie, whose sides direct differentiation
/// has already.
std::optional<OneSided> one_sided_derivatives(const Model& model, const Slots<double>& slots, const Method& method,
                                              const Trajectory<double>& trajectory, Workspace<double>& workspace);

/// Whether anything is at a tie in an increment. `previous`: state at its start; `largest`:
/// traction_scale() of the run so far.
bool has_ties(const Model& model, const Slots<double>& slots, const Method& method, const State<double>& previous,
              const Increment<double>& increment, double largest);

/// The branches that an increment takes with the choices at its ties.
struct TakenBranches {
  struct OfState {
    ContactField<double> contact;
    FlowBranches flow;
  };
  OfState end;
  Vector<double> foot;  ///< History::foot and History::patch, with the patches that were chosen at vertices
  std::vector<int> patch;
  std::vector<OfState> sweeps;  ///< after each augmentation

  explicit TakenBranches(Increment<double> of);
  void give(Increment<double>& increment) const;
};

/// Branches of the increments, up to the first that has no derivative, chosen at ties along one direction of all
/// parameters; empty if there are no ties. `states`: of the trajectory. The work is added to `counters`.
std::vector<TakenBranches> consistent_at_ties(const Model& model, const Slots<double>& slots, const Method& method,
                                              const Trajectory<double>& trajectory, WholeStates& states,
                                              Workspace<double>& workspace, Counters& counters);

}  // namespace stickslip
