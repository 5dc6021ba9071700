/// Search for the overlaps of the facets of two sides in space.
#pragma once

#include <vector>

#include "core/algebra/scalar.hpp"
#include "core/contact/box_tree.hpp"
#include "core/contact/overlap.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

/// A whole slave facet, against an obstacle that has no facets.
Overlap whole_facet(const SideFacet& slave);

/// The facets of a master side at given positions.
class OverlapSearch {
 public:
  /// `points`: positions of the nodes, 3 x nodes, length; then those of the vertices of an obstacle.
  OverlapSearch(Points<double> points, std::vector<SideFacet> master);

  /// The overlaps of a slave facet with the master facets that oppose it, seen along the normal of the slave facet.
  /// Where it faces several, one behind the other, the nearest counts. Beyond another face of the master's solid
  /// nothing is inside of it. Parts that face nothing are in no overlap. The caller sets `psi`.
  ///
  /// A vertex within 1e-6 of the facet's width of an edge is on it: the rounding of coordinates in files. So sides that
  /// end together have no slivers, and a parameter that moves them apart meets no kink there.
  std::vector<Overlap> facing(const SideFacet& slave) const;
  /// Whether the master has no facets.
  bool empty() const { return master_.empty(); }
  Vec<double, 3> place(int node) const { return points_.col(node); }

 private:
  Vec<double, 3> across(const SideFacet& facet) const;  ///< its area vector
  std::vector<int> near(const SideFacet& slave, const Vec<double, 3>& normal) const;

  Points<double> points_;
  std::vector<SideFacet> master_;
  BoxTree<3> boxes_;
};

}  // namespace stickslip
