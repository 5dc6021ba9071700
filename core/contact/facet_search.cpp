#include "core/contact/facet_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/segments.hpp"

namespace stickslip {
namespace {

/// The nearest place of a facet, and its position.
struct Foot : FacetPlace {
  Vec<double, 2> position;
};

/// Whether foot a precedes foot b at the same distance. The order depends on geometry alone: a projection inside its
/// facet precedes one at an end; then the lesser x, then the lesser y, precedes.
bool precedes(const Foot& a, const Foot& b) {
  const bool a_inside = a.xi >= 0 && a.xi <= 1, b_inside = b.xi >= 0 && b.xi <= 1;
  if (a_inside != b_inside) return a_inside;
  return a.position[0] < b.position[0] || (a.position[0] == b.position[0] && a.position[1] < b.position[1]);
}

bool is_past_end(const FacetPlace& place) {
  return place.xi < -mesh_file_rounding || place.xi > 1 + mesh_file_rounding;
}

}  // namespace

FacetPlace nearest_of_facet(const Vec<double, 2>& a, const Vec<double, 2>& b, const Vec<double, 2>& x) {
  const Vec<double, 2> tau = b - a;
  const double xi = (x - a).dot(tau) / tau.squaredNorm();
  return {xi, (x - a - std::clamp(xi, 0.0, 1.0) * tau).norm()};
}

std::optional<ClosestPoint> closest_point(const Points<double>& points, const std::vector<std::vector<int>>& facets,
                                          const std::vector<int>& among, const Vec<double, 2>& x) {
  int best = -1;
  Foot foot{{0, std::numeric_limits<double>::infinity()}, {0, 0}};
  for (int f : among) {
    const Vec<double, 2> a = points.col(facets[f][0]).head<2>(), b = points.col(facets[f][1]).head<2>();
    const FacetPlace place = nearest_of_facet(a, b, x);
    const Foot candidate{place, a + std::clamp(place.xi, 0.0, 1.0) * (b - a)};
    const double band = at_facet_end * (b - a).norm();
    const bool tie = best >= 0 && std::abs(candidate.distance - foot.distance) <= band;
    if (tie ? precedes(candidate, foot) : candidate.distance < foot.distance) {
      foot = candidate;
      best = f;
    }
  }
  if (best < 0) return std::nullopt;
  const bool start = foot.xi<at_facet_end, end = foot.xi> 1 - at_facet_end;
  if (!start && !end) return ClosestPoint{best, -1};
  const int vertex = facets[best][end ? 1 : 0];
  for (int f : among)
    if (facets[f][end ? 0 : 1] == vertex) return end ? ClosestPoint{best, f} : ClosestPoint{f, best};
  return is_past_end(foot) ? std::nullopt : std::optional<ClosestPoint>(ClosestPoint{best, -1});
}

FacetSearch::FacetSearch(const Points<double>& points, const std::vector<std::vector<int>>& facets)
    : points_(points), facets_(facets) {
  std::vector<int> numbers;
  for (int f = 0; f < static_cast<int>(facets.size()); ++f) {
    const Vec<double, 2> a = end_of(f, 0), b = end_of(f, 1);
    if (!a.allFinite() || !b.allFinite()) continue;  // Newton tried an iterate that overflows
    numbers.push_back(f);
    band_ = std::max(band_, at_facet_end * (b - a).norm());
  }
  boxes_ = BoxTree<2>(std::move(numbers), [this](int f) {
    return Bounds<2>{end_of(f, 0).cwiseMin(end_of(f, 1)), end_of(f, 0).cwiseMax(end_of(f, 1))};
  });
}

/// Numbers, ascending, of the facets in no box that is skipped.
template <class Skips>
std::vector<int> FacetSearch::facets_but(Skips&& skips) const {
  std::vector<int> found;
  boxes_.visit(Vec<double, 2>::Zero(), skips, [&](int facet) { found.push_back(facet); });
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<int> FacetSearch::candidates(const std::array<int, 2>& slave) const {
  // Share of the slave facet by which the strip is widened, far above rounding. A facet that is found only because of
  // it gives no segment in facing_segments().
  constexpr double margin = 1e-6;
  const Vec<double, 2> a = points_.col(slave[0]).head<2>(), tau = points_.col(slave[1]).head<2>() - a;
  return facets_but([&](const Bounds<2>& box) {
    const double middle = ((box.low + box.high) / 2 - a).dot(tau) / tau.squaredNorm();
    const double half = ((box.high - box.low) / 2).dot(tau.cwiseAbs()) / tau.squaredNorm();
    return middle + half < -margin || middle - half > 1 + margin;
  });
}

std::vector<Segment> FacetSearch::facing(const std::array<int, 2>& slave, const std::vector<int>& ends,
                                         const std::function<double(int)>& depth_of) const {
  const auto numbers = candidates(slave);
  std::vector<std::vector<int>> facets;
  std::vector<double> depths;
  facets.reserve(numbers.size());
  for (int f : numbers) {
    facets.push_back(facets_[f]);
    if (depth_of) depths.push_back(depth_of(f));
  }
  auto segments = facing_segments(points_, slave, facets, ends, depths);
  for (Segment& segment : segments) segment.facet = numbers[segment.facet];
  return segments;
}

FacetSearch::Nearest FacetSearch::nearest(const Vec<double, 2>& x) const {
  return nearest(x, [](int) { return true; });
}

FacetSearch::Nearest FacetSearch::nearest(const Vec<double, 2>& x, const std::function<bool(int)>& counts) const {
  Nearest best;
  const auto skips = [&](const Bounds<2>& box) { return box.distance(x) > best.distance + band_; };
  boxes_.visit(x, skips, [&](int facet) {
    if (!counts(facet)) return;
    const double distance = nearest_of_facet(end_of(facet, 0), end_of(facet, 1), x).distance;
    if (distance < best.distance) best = {facet, distance};
  });
  return best;
}

std::optional<ClosestPoint> FacetSearch::closest(const Vec<double, 2>& x) const {
  // Facets farther away than some ties of the nearest decide nothing; those that share its vertex are no farther.
  constexpr double ties = 8;
  const double near = nearest(x).distance + ties * band_;
  const auto among = facets_but([&](const Bounds<2>& box) { return box.distance(x) > near; });
  return closest_point(points_, facets_, among, x);
}

bool FacetSearch::is_past_end(int facet, const Vec<double, 2>& x) const {
  return stickslip::is_past_end(nearest_of_facet(end_of(facet, 0), end_of(facet, 1), x));
}

}  // namespace stickslip
