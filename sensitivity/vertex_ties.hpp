/// Ties of points on curves: at the end of an increment they face the vertex where one patch ends and the next begins.
///
/// Two patches are separated by the line through their vertex v perpendicular to t + t', t and t' their unit tangents:
/// (x - v) . (t + t') = 0. Take one side of a parameter, dphi = s d with s = +-1. The point faces the second patch iff
/// s D((x - v) . (t + t')) > 0.
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

#include "sensitivity/branches.hpp"

namespace stickslip {

/// A contact point at the vertex of two patches.
struct VertexTie {
  int point;
  int first, second;  ///< patches of its curve
  bool crosses;       ///< whether the point can change its patch without a jump
};

/// The points of a state at a tie: those that press or nearly touch; all, if a response asks for gaps. `largest`:
/// traction_scale() of the run so far.
std::vector<VertexTie> vertex_ties(const Model& model, const Slots<double>& slots, const State<double>& state,
                                   double time, double largest);

/// Calls f(way, length) for each end of the patch that a closed point faces, if another patch joins there with a kink:
/// its distance past the line that separates the two, with its derivative, over the length of the first.
void for_each_vertex_way(const Model& model, const Slots<Direction>& slots, const Vector<Direction>& displacement,
                         const State<double>& state, double time,
                         const std::function<void(const Direction&, double)>& f);

/// Lets the point of a tie face the end of one of its patches.
void set_patch(const Model& model, const VertexTie& tie, int patch, State<double>& at);

/// Whether a derivative that was found with the patch of a tie confirms this patch.
struct VertexVerdict {
  std::optional<int> contradicts;  ///< none: confirmed; else the patch that the derivative points to
  double severity = 0;             ///< size of the contradiction, in units of what is negligible
};
/// Verdict on a tie. `block`: the derivative, in its first direction, found with the patches of `at`.
VertexVerdict vertex_verdict(const Model& model, const ParameterBlock& block, const VertexTie& tie,
                             const State<double>& at, double time, const SideDirection& along);

}  // namespace stickslip
