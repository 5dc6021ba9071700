/// A mortar segment: unit of the integration of segment-integrated contact (core/contact/segments.hpp). Vertex v of an
/// obstacle counts as the node Model::node_count + v.
#pragma once

#include <array>

namespace stickslip {

/// Part of a slave facet that faces one master facet, or an obstacle.
struct Segment {
  /// Values of first_end and last_end: the segment ends at the first (start) or second (end) node of the slave facet.
  static constexpr int start = -1, end = -2;
  static constexpr int none = -1;
  std::array<int, 2> slave{};               ///< nodes a -> b of the slave facet, solid on the left
  std::array<int, 2> master{{none, none}};  ///< nodes c -> d of the master facet; none: the master has no facets
  /// The sides of quadratic elements that the two facets are halves of: start, end, middle; none: of linear ones.
  std::array<int, 3> slave_edge{{none, none, none}}, master_edge = slave_edge;
  int facet = none;                       ///< number of the master facet on its side
  int first_end = start, last_end = end;  ///< start, end, or the master node that is projected there
  int carrier = 0;                        ///< 0 or 1: the slave node that carries the multiplier
  bool sole_carrier = false;              ///< the other slave node carries no multiplier, so psi = 1
  friend bool operator==(const Segment&, const Segment&) = default;
};

}  // namespace stickslip
