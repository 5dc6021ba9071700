/// Search for the facet or vertex of a master side that is closest to a slave node.
#pragma once

#include <optional>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Share of a facet's length within which a projection counts as lying at the facet's end.
inline constexpr double at_facet_end = 1e-9;

/// Share of a facet's length by which a projection may lie past the free end of the side. Why: coordinates of a mesh
/// file are rounded, and that rounding must not decide whether a node at the end of its master faces it.
inline constexpr double past_free_end = 1e-6;

/// Closest point of a side. `second` < 0: inside facet `facet`, or at a free end that only this facet has. Otherwise at
/// a vertex: `facet` ends there and `second` starts there.
struct ClosestPoint {
  int facet = -1;
  int second = -1;
};

/// Closest point of the facets to x; none where x projects past a free end of the side.
///
///   points  nodal positions, D x nodes, length
///   facets  the two nodes of each facet
///
/// Among equally close points the choice depends on geometry alone and not on numbering.
std::optional<ClosestPoint> closest_point(const Points<double>& points, const std::vector<std::vector<int>>& facets,
                                          const Vec<double, 2>& x);

}  // namespace stickslip
