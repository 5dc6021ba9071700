/// Local history: the only values of the last increment that the residual of the next one depends on, except for
/// tractions that a method carries on itself. (Start values do not change a residual.) Kernels read the history and
/// never the last displacements. So direct differentiation carries the derivative of the history from increment to
/// increment, an adjoint goes back through it, and the oracle computes it in its own scalar. The first history is a
/// function of the slots: initial_history().
#pragma once

#include <vector>

#include "core/algebra/scalar.hpp"

namespace stickslip {

/// Branches of the bodies' flows (flow_branch), laid out as History::bodies: at the first number of each point. Empty:
/// all by their values, as in a state that was solved for.
using FlowBranches = std::vector<int>;

template <class T>
struct History {
  Vector<T> placement;  ///< s, the slip since the start, at tangential_offset()
  Vector<T> foot;       ///< where geometry is the present one: places on what is faced, at ContactPoint::foot, as
                        ///< differences from the start (PlacedPoint::foot)
  Vector<T> work;       ///< frictional work since the start, per contact; empty without friction
  Vector<T> bodies;     ///< what materials remember, at BodyMesh::first_memory; empty where none does
  /// Of points that slide on surfaces: the patch that a foot is on, per point, and whether the point faced it. One
  /// that faced nothing has the patch that is nearest. Labels, which have no derivative.
  std::vector<int> patch = {};
  std::vector<char> faced = {};
};

/// Calls f(part...) with each part of histories that numbers make up, in turn.
template <class F, class... Histories>
void for_each_part(F&& f, Histories&&... of) {
  f(of.placement...);
  f(of.foot...);
  f(of.work...);
  f(of.bodies...);
}

}  // namespace stickslip
