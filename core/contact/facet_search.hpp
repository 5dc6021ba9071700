/// Search for the facets of a side that a slave facet or a point may face. The facets may come in any order. A slave
/// facet faces only what reaches into the strip perpendicular to it, so boxes outside of the strip are skipped. The
/// results equal those of a comparison with all facets, bit for bit.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "core/contact/box_tree.hpp"
#include "core/contact/segment.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Share of a facet's length within which a projection counts as lying at the facet's end.
inline constexpr double at_facet_end = 1e-9;

/// The place of a facet that is nearest to a point.
struct FacetPlace {
  double xi;        ///< coordinate of the projection, which may lie past the ends: 0 at the first, 1 at the second
  double distance;  ///< of the nearest place, length
};
/// `a`, `b`: ends of the facet.
FacetPlace nearest_of_facet(const Vec<double, 2>& a, const Vec<double, 2>& b, const Vec<double, 2>& x);

/// Closest point of a side. `second` < 0: inside facet `facet`, or at a free end that only this facet has. Otherwise at
/// a vertex: `facet` ends there and `second` starts there.
struct ClosestPoint {
  int facet = -1;
  int second = -1;
};

/// Closest point of the facets to x, by comparison with all; none where x projects past a free end of the side.
///
///   points  nodal positions, D x nodes, length
///   facets  the two nodes of each facet
///   among   numbers of the facets that are compared
///
/// Among equally close points the choice depends on geometry alone and not on numbering.
std::optional<ClosestPoint> closest_point(const Points<double>& points, const std::vector<std::vector<int>>& facets,
                                          const std::vector<int>& among, const Vec<double, 2>& x);

/// Search among the facets of one side at given nodal positions.
class FacetSearch {
 public:
  /// `points`: nodal positions, D x nodes; `facets`: two nodes each. Both must outlive the search. A facet with a
  /// position that is not finite is never found.
  FacetSearch(const Points<double>& points, const std::vector<std::vector<int>>& facets);

  /// Numbers, ascending, of the facets that reach into the strip perpendicular to a slave facet: all that it may face,
  /// and few others.
  std::vector<int> candidates(const std::array<int, 2>& slave) const;
  /// Segments of a slave facet, as facing_segments() finds them among all facets. `depth_of(facet)`: its `depths`, of a
  /// side in contact with itself.
  std::vector<Segment> facing(const std::array<int, 2>& slave, const std::vector<int>& ends = {},
                              const std::function<double(int)>& depth_of = nullptr) const;
  /// The facet nearest to x; -1 where there is none.
  struct Nearest {
    int facet = -1;
    double distance = std::numeric_limits<double>::infinity();  ///< length
  };
  Nearest nearest(const Vec<double, 2>& x) const;
  /// The nearest of those for which `counts(facet)` holds.
  Nearest nearest(const Vec<double, 2>& x, const std::function<bool(int)>& counts) const;
  /// The closest point of the side, as closest_point() finds it among all facets.
  std::optional<ClosestPoint> closest(const Vec<double, 2>& x) const;
  /// Whether x projects past an end of a facet, by more than a mesh file rounds.
  bool is_past_end(int facet, const Vec<double, 2>& x) const;

 private:
  Vec<double, 2> end_of(int facet, int end) const { return points_.col(facets_[facet][end]).head<2>(); }
  template <class Skips>
  std::vector<int> facets_but(Skips&& skips) const;

  const Points<double>& points_;
  const std::vector<std::vector<int>>& facets_;
  BoxTree<2> boxes_;
  double band_ = 0;  ///< length above the rounding of a distance
};

}  // namespace stickslip
