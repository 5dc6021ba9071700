/// Points that slide along curves and are, at the end of an increment, just where one patch ends and the next begins.
///
/// Two patches part at the line through their vertex v that halves their tangents t, t':  (x - v) . (t + t') = 0. Along
/// one direction of the parameters, dphi = s d with s = +-1, such a point faces the second iff s D((x - v) . (t + t'))
/// > 0.
///
///   straight, or free   the patches go on straight (facets in line; Catmull-Rom splines, whose curvature alone jumps),
///                       or the point bears nothing. Either patch has an equilibrium here, with its side's derivative
///   pressed corner      the force jumps with the normal. On the side on which the point stays the derivative is
///                       that of its patch; on the other there is none
///   smooth              splines whose curvature goes on, B-splines among them: no tie
/// Source: core/README.md.
#pragma once

#include "sensitivity/branches.hpp"

namespace stickslip {

struct VertexTie {
  int point;
  int first, second;  ///< patches of its curve
  bool crosses;       ///< from one to the other without a jump
};

/// The points of a state that are at a tie: those that press or are about to, and all where a response asks for gaps.
/// `largest`: traction_scale of the run so far.
std::vector<VertexTie> vertex_ties(const Model& model, const Slots<double>& slots, const State<double>& state,
                                   double time, double largest);

/// Sets what a point faces to the end of a patch of a tie.
void take_patch(const Model& model, const VertexTie& tie, int patch, State<double>& at);

/// What a derivative found with the patches of a state says of a tie.
struct VertexVerdict {
  std::optional<int> contradicts;  ///< the patch that it points to, where it contradicts the one it was found with
  double severity = 0;             ///< how much, in units of what is negligible
};
VertexVerdict judge(const Model& model, const ParameterBlock& block, const VertexTie& tie, const State<double>& at,
                    double time, const SideDirection& along);

}  // namespace stickslip
