/// Ties of points on surfaces in space: at the end of an increment they face an edge or a corner at which patches meet.
///
/// With the derivatives of its coordinates (s, t) on the patch that it faces, the foot of a point leaves this patch
/// over an edge k that it is on iff s D(beyond_edge k) > 0. Then it faces the patch behind that edge.
///
///   smooth   the normal goes on, and the curvature jumps (Catmull-Rom), or on facets the way in which weights change;
///            or the point carries no traction: each side has the derivative of its patch
///   turned   the force jumps with the normal. On a side on which the point keeps its patch the derivative is that of
///            its patch; on the other side there is none
///   alike    on a smooth surface the curvature goes on too: no tie
/// In the plane: sensitivity/ties/vertex_tie.hpp.
#pragma once

#include <functional>

#include "sensitivity/ties/choice.hpp"

namespace stickslip {

struct EdgeTie {
  static constexpr bool holds = false;  // one patch as much as the other
  /// The place on a patch, and the tangents there in terms of the slopes, as History::foot stores them.
  struct Place {
    Facing facing;
    Vec<double, 4> tangents;
  };
  int point;
  std::vector<Place> places;  ///< on each patch that has it
  bool crosses;               ///< whether the point can change its patch without a jump

  /// The points that press or nearly touch; all, if a response asks for gaps.
  static void find(const SolvedState& of, std::vector<Tie>& ties);
  /// None where the point cannot cross.
  std::vector<Choice> choices(const Model& model) const;
  Choice now(const Model& model, const State<double>& at) const;
  /// Lets the point face its place on a patch.
  void set(const Model& model, const Choice& choice, State<double>& at) const;
  Verdict verdict(const SidedDerivative& derivative) const;
};

/// Calls f(way, length) for each edge of the patch that a closed point faces behind which another patch joins with a
/// kink: how far its foot is beyond the edge, with its derivative, and the size of the patch. At small strain surfaces
/// are where they were at the start.
void for_each_edge_way(const Model& model, const Slots<Direction>& slots, const Vector<Direction>& displacement,
                       const State<double>& state, double time, const std::function<void(const Direction&, double)>& f);

/// Least distance of the foot of a closed point from an edge of facets that other facets join, in coordinates of its
/// patch; infinite where no point slides on facets.
double edge_margin(const Model& model, const State<double>& state);

}  // namespace stickslip
