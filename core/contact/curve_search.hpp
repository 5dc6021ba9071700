/// Which place of a master curve a point faces: the nearest, found by a tree of boxes over the curve.
///
/// A box holds a stretch of the curve and bounds of the normals of its facets. A box that is too far away, or looks the
/// wrong way, is passed over as a whole. The search takes about log n facets, also on a side that may touch itself,
/// where the nearest n facets are the point's own.
///
/// At a corner the curve consists of two straight lines that end in their bisector. So the gap is continuous there, and
/// the corner has no states of its own: beyond a convex corner a point has the gap of the line on its side of the
/// bisector.
#pragma once

#include "core/contact/curve.hpp"

namespace stickslip {

/// Search along one curve, where its vertices are now.
class CurveSearch {
 public:
  /// Both must outlive it. `places`: of the vertices, by number.
  CurveSearch(const std::vector<Patch>& patches, const Eigen::Matrix2Xd& places);

  /// The place that x faces; none where it lies past a free end, or at the centre of a bend. Only patches count whose
  /// normal is against `outward`, the normal of the side that x is on; where that is zero, all count. A point that is
  /// outside of the solid by the nearest patch of all is not inside of it by another. Where two patches meet, the place
  /// is on the second. Where places are not finite, as in a trial that is rejected, nothing is faced and the distance
  /// is infinite.
  Facing facing(const Vec<double, 2>& x, const Vec<double, 2>& outward) const;
  /// The same for a vertex of this very curve. Patches count whose normal makes more than 120 degrees with `outward`.
  /// The vertex can be inside of a patch that it is beside of, no deeper than its reach; where the patch is not next to
  /// `last`, no deeper than a quarter of that. `last`: the patch that it faced in the last state. Where it faces
  /// nothing, the distance is the size of the curve.
  Facing facing_itself(const Vec<double, 2>& x, const Vec<double, 2>& outward, const OwnVertex& own, int last) const;
  /// The foot of x on one patch, beyond its ends too.
  Facing stay(int patch, const Vec<double, 2>& x) const;

 private:
  struct Nearest {
    int patch = Patch::none;
    double xi = 0, distance = std::numeric_limits<double>::infinity();
  };
  /// What is sought: the place nearest to x among patches that look against `outward`. `own`: where given, the patches
  /// that it may face alone.
  struct Sought {
    Vec<double, 2> x, outward;
    const OwnVertex* own = nullptr;
    int last = Patch::none;
  };
  /// Patches first to last - 1, with bounds of their ends and of their unit normals. The left child, if there is one,
  /// is the next box. `right`: index of the other child; 0: none.
  struct Box {
    Vec<double, 2> low, high, normal_low, normal_high;
    int first, last, right = 0;
  };
  Vec<double, 2> vertex(int patch, int end) const { return places_.col(patches_[patch].vertices[1 + end]); }
  void add_boxes(int first, int last);
  void bound(Box& box) const;
  double distance(const Box& box, const Vec<double, 2>& x) const;
  bool may_count(const Box& box, const Sought& sought) const;
  double reach(int first, int last, const Sought& sought) const;
  Nearest nearest_facet(const Sought& sought) const;
  bool counts(int patch, const Sought& sought) const;
  void try_facet(int patch, const Vec<double, 2>& x, Nearest& best) const;
  Facing slide(Facing from, const Vec<double, 2>& x, int hops) const;
  Vec<double, 2> tangent_at_end(int patch, int end) const;
  Facing at_end(Facing at, const Sought& sought) const;
  Facing faced(const Sought& sought) const;
  Facing in_second_patch(Facing at, const Sought& sought) const;

  const std::vector<Patch>& patches_;
  const Eigen::Matrix2Xd& places_;
  std::vector<Box> boxes_;  ///< the whole curve first; none where places are not finite
  double band_ = 0;         ///< length within which two facets are as near as one another
  double size_ = std::numeric_limits<double>::infinity();  ///< of the whole curve
};

}  // namespace stickslip
