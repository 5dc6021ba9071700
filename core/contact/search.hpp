/// Which part of a master surface a slave node faces: the closest point of a faceted curve.
#pragma once

#include <optional>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Relative distance (of a facet's length) within which a projection counts as lying at the facet's end.
inline constexpr double at_facet_end = 1e-9;

/// The same past the free end of a curve: what a mesh file rounds off its coordinates must not decide whether a node at
/// the end of its master has one.
inline constexpr double past_free_end = 1e-6;

/// Closest point of the curve: inside facet `facet` (second < 0), or at the vertex shared by facets `facet` and
/// `second` (the one that ends there, the one that starts there). A vertex that only one facet has (the end of the
/// curve) counts as that facet's.
struct ClosestPoint {
  int facet = -1;
  int second = -1;
};

/// Closest point of the facets (node pairs) to x; none where x lies past a free end of the curve. Among equals the
/// choice depends on geometry alone, not on numbering: two facets that meet in the closest point are named together.
std::optional<ClosestPoint> closest_point(const Points<double>& points, const std::vector<std::vector<int>>& facets,
                                          const Vec<double, 2>& x);

}  // namespace stickslip
