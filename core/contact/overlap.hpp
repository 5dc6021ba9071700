/// Unit of the integration of segment-integrated contact in space: the polygon in which a facet of the slave side and
/// one of the master side overlap, seen along the normal of the slave facet. Vertex v of a triangulated obstacle counts
/// as the node Model::node_count + v.
#pragma once

#include <array>
#include <vector>

namespace stickslip {

/// A facet of a side in space, or of a triangulated obstacle.
struct SideFacet {
  std::array<int, 4> nodes{};  ///< counter-clockwise seen from outside; of a triangle the last stands for nothing
  int corners = 0;             ///< 3 or 4; 0: none
  /// The side of a quadratic element that it is a part of (facets_of_side()): its nodes in the order of sides_of();
  /// empty: of a linear element, whose side it is.
  std::vector<int> side = {};
  friend bool operator==(const SideFacet&, const SideFacet&) = default;
};

/// A vertex of an overlap: a node, or the place where two edges cross as they are seen along the normal.
struct OverlapVertex {
  std::array<int, 2> first{}, second{};  ///< the two nodes of each edge; a node: all four are it
  bool is_node() const { return first[0] == first[1]; }
  friend bool operator==(const OverlapVertex&, const OverlapVertex&) = default;
};

struct Overlap {
  SideFacet slave, master = {};              ///< master: none if it is an obstacle that has no facets
  std::vector<OverlapVertex> vertices = {};  ///< of a convex polygon, in the direction of the slave's corners
  /// What the multiplier's psi is of the weights of the slave's corners: 1 of the corner that carries it, and an equal
  /// share of those that carry none.
  std::array<double, 4> psi{};
  friend bool operator==(const Overlap&, const Overlap&) = default;
};

}  // namespace stickslip
