/// Ties of points on curves: at the end of an increment they face the vertex where one patch ends and the next begins.
///
/// Two patches are separated by the line through their vertex v perpendicular to t + t', t and t' their unit tangents:
/// (x - v) . (t + t') = 0. The point faces the second patch iff s D((x - v) . (t + t')) > 0.
///
///   straight, or free   the patches join without a turn (facets in line; Catmull-Rom splines, whose curvature alone
///                       jumps), or the point carries no traction. Either patch has an equilibrium here, and each side
///                       has the derivative of its patch
///   pressed corner      the force jumps with the normal. On the side on which the point keeps its patch the derivative
///                       is that of its patch; on the other side there is none
///   smooth              splines whose curvature is continuous, such as B-splines: no tie
/// Source: core/README.md.
#pragma once

#include <functional>

#include "sensitivity/ties/choice.hpp"

namespace stickslip {

struct VertexTie {
  static constexpr bool holds = false;  // one patch as much as the other
  int point;
  int first, second;  ///< patches of its curve
  bool crosses;       ///< whether the point can change its patch without a jump

  /// The points that press or nearly touch; all, if a response asks for gaps.
  static void find(const SolvedState& of, std::vector<Tie>& ties);
  /// None where the point cannot cross.
  std::vector<Choice> choices(const Model& model) const;
  Choice now(const Model& model, const State<double>& at) const;
  /// Lets the point face the end of a patch.
  void set(const Model& model, const Choice& choice, State<double>& at) const;
  Verdict verdict(const SidedDerivative& derivative) const;
};

/// Calls f(way, length) for each end of the patch that a closed point faces, if another patch joins there with a kink:
/// its distance past the line that separates the two, with its derivative, over the length of the first. At small
/// strain surfaces are where they were at the start.
void for_each_vertex_way(const Model& model, const Slots<Direction>& slots, const Vector<Direction>& displacement,
                         const State<double>& state, double time,
                         const std::function<void(const Direction&, double)>& f);

}  // namespace stickslip
