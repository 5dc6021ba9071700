/// Search, by a tree of bounding boxes, for the facets of a side that a slave facet or a point may face.
///
/// A slave facet faces only what reaches into the strip perpendicular to it. The search skips each box outside of this
/// strip, so it visits about log n boxes of n facets. The tree splits by position, so facets may come in any order. The
/// results equal those of a comparison with all facets, bit for bit.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "core/contact/search.hpp"
#include "core/contact/segment.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Search among the facets of one side at given nodal positions.
class FacetSearch {
 public:
  /// `points`: nodal positions, D x nodes; `facets`: two nodes each. Both must outlive the search. A facet with a
  /// position that is not finite is never found.
  FacetSearch(const Points<double>& points, const std::vector<std::vector<int>>& facets);

  /// Numbers, ascending, of the facets that reach into the strip perpendicular to a slave facet: all that it may face,
  /// and few others.
  std::vector<int> candidates(const std::array<int, 2>& slave) const;
  /// Segments of a slave facet, as facing_segments() finds them among all facets.
  std::vector<Segment> facing(const std::array<int, 2>& slave, const std::vector<int>& ends = {}) const;
  /// The facet nearest to x; -1 where there is none.
  struct Nearest {
    int facet = -1;
    double distance = std::numeric_limits<double>::infinity();  ///< length
  };
  Nearest nearest(const Vec<double, 2>& x) const;
  /// The closest point of the side, as closest_point() finds it among all facets.
  std::optional<ClosestPoint> closest(const Vec<double, 2>& x) const;

 private:
  /// The left child of boxes_[k] is boxes_[k + 1]. `right`: index of the right child. `facet`: number of the facet of
  /// a leaf; -1: the box has children.
  struct Box {
    Vec<double, 2> low, high;
    int right = 0, facet = -1;
  };
  Vec<double, 2> end_of(int facet, int end) const { return points_.col(facets_[facet][end]).head<2>(); }
  void add_boxes(std::vector<int>& numbers, int first, int last);
  double facet_distance(int facet, const Vec<double, 2>& x) const;
  double box_distance(const Box& box, const Vec<double, 2>& x) const {
    return (box.low - x).cwiseMax(x - box.high).cwiseMax(0.0).norm();
  }
  template <class Outside>
  std::vector<int> facets_but(Outside&& is_outside) const;

  const Points<double>& points_;
  const std::vector<std::vector<int>>& facets_;
  std::vector<Box> boxes_;  ///< boxes_[0]: the whole side
  double band_ = 0;         ///< length above the rounding of a distance
};

}  // namespace stickslip
