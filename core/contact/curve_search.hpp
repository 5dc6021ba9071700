/// Search for the closest place of a master curve. It skips each box of facets that is too far away or whose normals do
/// not oppose the slave side. So it visits few facets, also on a side in contact with itself, where the nearest facets
/// belong to the point's own neighbourhood.
///
/// At a corner the curve continues as two straight lines that end in their bisector. So the gap is continuous there,
/// and a corner has no contact state of its own: beyond a convex corner a point has the gap to the line on its side of
/// the bisector.
#pragma once

#include "core/contact/box_tree.hpp"
#include "core/contact/curve.hpp"

namespace stickslip {

/// Search along one curve at given positions of its vertices.
class CurveSearch {
 public:
  /// `positions`: of the vertices, 2 x vertices, length. Both arguments must outlive the search.
  CurveSearch(const std::vector<Patch>& patches, const Eigen::Matrix2Xd& positions);

  /// The place of the curve that x faces; patch = none where x lies past a free end, or beyond the centre of curvature.
  ///
  ///   outward  outward normal of the slave side at x, any length. Only patches whose normal opposes it are eligible;
  ///            if it is zero, all patches are
  ///
  /// If the nearest of all patches has x outside of the solid, x is not inside of the solid by a farther patch. If x
  /// faces the vertex between two patches, the result is the second patch. If a position is not finite, as in an
  /// iterate that Newton rejects, nothing is faced and the distance is infinite.
  Facing facing(const Vec<double, 2>& x, const Vec<double, 2>& outward) const;
  /// The same for a vertex of this curve, which is in contact with itself. A patch is eligible if its normal makes more
  /// than 120 degrees with `outward`, and if `own` allows it. The vertex may penetrate a patch up to own.max_depth if
  /// the patch is within 8 patches of `last`, the patch that it faced in the last state; otherwise up to a quarter of
  /// that. If it faces nothing, the distance is the size of the curve, and the nearest patch is not looked for.
  Facing facing_itself(const Vec<double, 2>& x, const Vec<double, 2>& outward, const OwnVertex& own, int last) const;
  /// The patch nearest to such a vertex: the nearest eligible one; if there is none, the nearest that `own` allows.
  int nearest_of_itself(const Vec<double, 2>& x, const Vec<double, 2>& outward, const OwnVertex& own, int last) const;
  /// The foot of x on one patch, which is extended past both ends.
  Facing foot_on(int patch, const Vec<double, 2>& x) const;

 private:
  struct Nearest {
    int patch = Patch::none;
    double xi = 0, distance = std::numeric_limits<double>::infinity();
  };
  /// The search's question: which place is nearest to x among the patches that oppose `outward`? `own`: set for contact
  /// of the curve with itself.
  struct Query {
    Vec<double, 2> x, outward;
    const OwnVertex* own = nullptr;
    int last = Patch::none;
  };
  Vec<double, 2> vertex(int patch, int end) const { return positions_.col(patches_[patch].vertices[1 + end]); }
  Bounds<2> bounds(int patch) const;
  bool may_be_eligible(const Bounds<2>& box, const Query& query) const;
  Nearest nearest_facet(const Query& query) const;
  bool is_eligible(int patch, const Query& query) const;
  void compare_facet(int patch, const Vec<double, 2>& x, Nearest& best) const;
  Facing newton_foot(Facing from, const Vec<double, 2>& x, int hops) const;
  Vec<double, 2> tangent_at_end(int patch, int end) const;
  Facing end_facing(Facing foot, const Query& query) const;
  Facing nearest_facing(const Query& query) const;
  Facing second_patch_facing(Facing foot, const Query& query) const;

  const std::vector<Patch>& patches_;
  const Eigen::Matrix2Xd& positions_;
  BoxTree<2> facets_;  ///< from the start to the end of each patch; empty if a position is not finite
  double band_ = 0;    ///< length within which two distances are equal
  double size_ = std::numeric_limits<double>::infinity();  ///< diagonal of the box of the whole curve, length
};

}  // namespace stickslip
