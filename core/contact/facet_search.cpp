#include "core/contact/facet_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/segments.hpp"

namespace stickslip {

FacetSearch::FacetSearch(const Points<double>& points, const std::vector<std::vector<int>>& facets)
    : points_(points), facets_(facets) {
  std::vector<int> numbers;
  for (int f = 0; f < static_cast<int>(facets.size()); ++f) {
    const Vec<double, 2> a = end_of(f, 0), b = end_of(f, 1);
    if (!a.allFinite() || !b.allFinite()) continue;  // Newton tried an iterate that overflows
    numbers.push_back(f);
    band_ = std::max(band_, at_facet_end * (b - a).norm());
  }
  boxes_.reserve(2 * numbers.size());
  if (!numbers.empty()) add_boxes(numbers, 0, static_cast<int>(numbers.size()));
}

/// Adds the box of the facets numbers[first] to numbers[last - 1], then the boxes of its two halves. The box is halved
/// along its longer side.
void FacetSearch::add_boxes(std::vector<int>& numbers, int first, int last) {
  Box box{end_of(numbers[first], 0), end_of(numbers[first], 0)};
  for (int n = first; n < last; ++n)
    for (int end = 0; end < 2; ++end) {
      box.low = box.low.cwiseMin(end_of(numbers[n], end));
      box.high = box.high.cwiseMax(end_of(numbers[n], end));
    }
  const std::size_t at = boxes_.size();
  boxes_.push_back(box);
  if (last - first == 1) {
    boxes_[at].facet = numbers[first];
    return;
  }
  const int longer = box.high[0] - box.low[0] >= box.high[1] - box.low[1] ? 0 : 1, middle = (first + last) / 2;
  const auto comes_first = [&](int f, int g) {
    const double x = end_of(f, 0)[longer] + end_of(f, 1)[longer], y = end_of(g, 0)[longer] + end_of(g, 1)[longer];
    return x != y ? x < y : f < g;
  };
  std::nth_element(numbers.begin() + first, numbers.begin() + middle, numbers.begin() + last, comes_first);
  add_boxes(numbers, first, middle);
  boxes_[at].right = static_cast<int>(boxes_.size());
  add_boxes(numbers, middle, last);
}

/// Numbers, ascending, of the facets in no box that is outside.
template <class Outside>
std::vector<int> FacetSearch::facets_but(Outside&& is_outside) const {
  std::vector<int> found;
  const auto visit = [&](const auto& self, int at) -> void {
    const Box& box = boxes_[at];
    if (is_outside(box)) return;
    if (box.facet >= 0) {
      found.push_back(box.facet);
      return;
    }
    self(self, at + 1);
    self(self, box.right);
  };
  if (!boxes_.empty()) visit(visit, 0);
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<int> FacetSearch::candidates(const std::array<int, 2>& slave) const {
  // Share of the slave facet by which the strip is widened, far above rounding. A facet that is found only because of
  // it gives no segment in facing_segments().
  constexpr double margin = 1e-6;
  const Vec<double, 2> a = points_.col(slave[0]).head<2>(), tau = points_.col(slave[1]).head<2>() - a;
  const auto is_outside = [&](const Box& box) {
    const double middle = ((box.low + box.high) / 2 - a).dot(tau) / tau.squaredNorm();
    const double half = ((box.high - box.low) / 2).dot(tau.cwiseAbs()) / tau.squaredNorm();
    return middle + half < -margin || middle - half > 1 + margin;
  };
  return facets_but(is_outside);
}

std::vector<Segment> FacetSearch::facing(const std::array<int, 2>& slave, const std::vector<int>& ends) const {
  const auto numbers = candidates(slave);
  std::vector<std::vector<int>> facets;
  facets.reserve(numbers.size());
  for (int f : numbers) facets.push_back(facets_[f]);
  auto segments = facing_segments(points_, slave, facets, ends);
  for (Segment& segment : segments) segment.facet = numbers[segment.facet];
  return segments;
}

double FacetSearch::facet_distance(int facet, const Vec<double, 2>& x) const {
  const Vec<double, 2> c = end_of(facet, 0), tau = end_of(facet, 1) - c;
  const double eta = (x - c).dot(tau) / tau.squaredNorm();
  return (x - c - std::clamp(eta, 0.0, 1.0) * tau).norm();
}

FacetSearch::Nearest FacetSearch::nearest(const Vec<double, 2>& x) const {
  Nearest best;
  const auto from = [&](int at) { return box_distance(boxes_[at], x); };
  const auto visit = [&](const auto& self, int at) -> void {
    const Box& box = boxes_[at];
    if (from(at) > best.distance + band_) return;
    if (box.facet >= 0) {
      const double distance = facet_distance(box.facet, x);
      if (distance < best.distance) best = {box.facet, distance};
      return;
    }
    const bool left_first = from(at + 1) <= from(box.right);
    self(self, left_first ? at + 1 : box.right);
    self(self, left_first ? box.right : at + 1);
  };
  if (!boxes_.empty()) visit(visit, 0);
  return best;
}

std::optional<ClosestPoint> FacetSearch::closest(const Vec<double, 2>& x) const {
  // Facets farther away than some ties of the nearest decide nothing; those that share its vertex are no farther.
  constexpr double ties = 8;
  const double near = nearest(x).distance + ties * band_;
  const auto numbers = facets_but([&](const Box& box) { return box_distance(box, x) > near; });
  std::vector<std::vector<int>> facets;
  facets.reserve(numbers.size());
  for (int f : numbers) facets.push_back(facets_[f]);
  auto found = closest_point(points_, facets, x);
  if (!found) return found;
  for (int* facet : {&found->facet, &found->second})
    if (*facet >= 0) *facet = numbers[*facet];
  return found;
}

}  // namespace stickslip
