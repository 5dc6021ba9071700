/// Which facets of a side a slave facet, or a point, may face: by a tree of boxes over the side.
///
/// A slave facet faces what lies in the strip across it. A box that does not reach into the strip is passed over as a
/// whole, so that a search takes about log n boxes. The tree is split by place: facets may come in any order. What is
/// found is what a comparison with all facets finds, to the last bit.
#pragma once

#include <array>
#include <vector>

#include "core/contact/piece.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Search among the facets (node pairs) of one side, where its nodes are now.
class FacetSearch {
 public:
  /// Both must outlive it. A facet whose ends are not finite is never found.
  FacetSearch(const Points<double>& points, const std::vector<std::vector<int>>& facets);

  /// The facets that reach into the strip across a slave facet, by number: all that it may face, and few others.
  std::vector<int> across(const std::array<int, 2>& slave) const;
  /// facing_pieces() of all facets.
  std::vector<Piece> facing(const std::array<int, 2>& slave, const std::vector<int>& ends = {}) const;
  /// Distance from the nearest facet; infinity where there is none.
  double distance(const Vec<double, 2>& x) const;

 private:
  /// The left child is the next box. `right`: index of the other child. `facet`: of a box without children.
  struct Box {
    Vec<double, 2> low, high;
    int right = 0, facet = -1;
  };
  Vec<double, 2> end_of(int facet, int end) const { return points_.col(facets_[facet][end]).head<2>(); }
  void add_boxes(std::vector<int>& numbers, int first, int last);
  double distance_of(int facet, const Vec<double, 2>& x) const;

  const Points<double>& points_;
  const std::vector<std::vector<int>>& facets_;
  std::vector<Box> boxes_;  ///< the whole side first
  double band_ = 0;         ///< above what rounding makes of distances
};

}  // namespace stickslip
