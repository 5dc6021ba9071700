#include "core/contact/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stickslip {
namespace {

/// Closest point of one facet. `xi`: unclamped coordinate of the projection; `position`: of the closest point.
struct Foot {
  double xi, distance;
  Vec<double, 2> position;
};

/// Whether foot a precedes foot b at the same distance. The order depends on geometry alone: a projection inside its
/// facet precedes one at an end; then the lesser x, then the lesser y, precedes.
bool precedes(const Foot& a, const Foot& b) {
  const bool a_inside = a.xi >= 0 && a.xi <= 1, b_inside = b.xi >= 0 && b.xi <= 1;
  if (a_inside != b_inside) return a_inside;
  return a.position[0] < b.position[0] || (a.position[0] == b.position[0] && a.position[1] < b.position[1]);
}

Foot project(const Points<double>& points, const std::vector<int>& facet, const Vec<double, 2>& x) {
  const Vec<double, 2> a = points.col(facet[0]).head<2>(), tau = points.col(facet[1]).head<2>() - a;
  const double xi = (x - a).dot(tau) / tau.squaredNorm();
  const Vec<double, 2> closest = a + std::clamp(xi, 0.0, 1.0) * tau;
  return {xi, (x - closest).norm(), closest};
}

}  // namespace

std::optional<ClosestPoint> closest_point(const Points<double>& points, const std::vector<std::vector<int>>& facets,
                                          const Vec<double, 2>& x) {
  int best = -1;
  Foot foot{0, std::numeric_limits<double>::infinity(), {0, 0}};
  for (std::size_t f = 0; f < facets.size(); ++f) {
    const Foot candidate = project(points, facets[f], x);
    const double band = at_facet_end * (points.col(facets[f][1]) - points.col(facets[f][0])).norm();
    const bool tie = best >= 0 && std::abs(candidate.distance - foot.distance) <= band;
    if (tie ? precedes(candidate, foot) : candidate.distance < foot.distance) {
      foot = candidate;
      best = static_cast<int>(f);
    }
  }
  if (best < 0) return std::nullopt;
  const bool start = foot.xi<at_facet_end, end = foot.xi> 1 - at_facet_end;
  if (!start && !end) return ClosestPoint{best, -1};
  const int vertex = facets[best][end ? 1 : 0];
  for (std::size_t f = 0; f < facets.size(); ++f)
    if (facets[f][end ? 0 : 1] == vertex)
      return end ? ClosestPoint{best, static_cast<int>(f)} : ClosestPoint{static_cast<int>(f), best};
  const bool past_the_end = foot.xi < -past_free_end || foot.xi > 1 + past_free_end;
  return past_the_end ? std::nullopt : std::optional<ClosestPoint>(ClosestPoint{best, -1});
}

}  // namespace stickslip
