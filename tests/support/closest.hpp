/// The closest point of a faceted curve by comparison with all facets.
#pragma once

#include <numeric>

#include "core/contact/facet_search.hpp"

namespace stickslip {

inline std::optional<ClosestPoint> closest_of_all(const Points<double>& points,
                                                  const std::vector<std::vector<int>>& facets,
                                                  const Vec<double, 2>& x) {
  std::vector<int> all(facets.size());
  std::iota(all.begin(), all.end(), 0);
  return closest_point(points, facets, all, x);
}

}  // namespace stickslip
