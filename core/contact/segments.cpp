#include "core/contact/segments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/own_vertex.hpp"
#include "core/contact/surfaces.hpp"

namespace stickslip {
namespace {

/// Share of the slave facet's length below which two breakpoints are one. Also the least cosine at which a master facet
/// looks the way of the slave facet.
constexpr double band = 1e-9;

/// Share of the slave facet's length within which an end of the master is an end of the slave facet. Why: sides that
/// end together do so only to the tolerance of an equilibrium, and the weights of a point must have no kink there.
constexpr double same_end = 1e-6;

/// End of a shadow, or of the slave facet itself.
struct Break {
  double xi;  ///< coordinate along the slave facet: 0 at its first node, 1 at its second
  int end;    ///< as Segment::first_end
};

/// Projection of a master facet onto the slave facet.
struct Shadow {
  std::array<int, 2> nodes;  ///< of the master facet
  int facet;                 ///< its number
  Break low, high;           ///< ends of the projection, low.xi < high.xi
  bool covers(double xi) const { return low.xi <= xi && xi <= high.xi; }
};
/// Those of the facets that are opposite to the slave facet, and of those that look the same way.
struct Shadows {
  std::vector<Shadow> opposite, alike;
};

/// The breakpoint of a node that projects to the coordinate xi.
Break break_at(double xi, int node, const std::vector<int>& ends) {
  if (std::find(ends.begin(), ends.end(), node) == ends.end()) return {xi, node};
  if (std::abs(xi) <= same_end) return {0, Segment::start};
  if (std::abs(xi - 1) <= same_end) return {1, Segment::end};
  return {xi, node};
}

/// The way from the line through c and d to x along the direction nu.
Vec<double, 2> way_along(const Vec<double, 2>& x, const Vec<double, 2>& nu, const Vec<double, 2>& c,
                         const Vec<double, 2>& d) {
  const Vec<double, 2> tau = d - c, from = x - c;
  const double eta = (from[0] * nu[1] - from[1] * nu[0]) / (tau[0] * nu[1] - tau[1] * nu[0]);
  return from - eta * tau;
}

/// The projections of the master facets onto the slave facet a + xi tau, 0 <= xi <= 1. `depths`: of facing_segments().
Shadows shadows(const Points<double>& points, const Vec<double, 2>& a, const Vec<double, 2>& tau,
                const std::vector<std::vector<int>>& masters, const std::vector<int>& ends,
                const std::vector<double>& depths) {
  Shadows out;
  const Vec<double, 2> nu(tau[1], -tau[0]);
  const double least = (depths.empty() ? least_against_a_side : least_against) * nu.norm();
  for (std::size_t f = 0; f < masters.size(); ++f) {
    const auto& facet = masters[f];
    const Vec<double, 2> c = points.col(facet[0]), d = points.col(facet[1]), along = d - c;
    const double turn = nu.dot(Vec<double, 2>(along[1], -along[0]));
    const bool is_opposite = turn < -least * along.norm() && (depths.empty() || depths[f] >= 0);
    if (!is_opposite && turn <= band * nu.norm() * along.norm()) continue;
    Break high = break_at((c - a).dot(tau) / tau.squaredNorm(), facet[0], ends),
          low = break_at((d - a).dot(tau) / tau.squaredNorm(), facet[1], ends);
    if (turn > 0) std::swap(high, low);  // a facet opposite to the slave runs from high to low
    if (high.xi > band && low.xi < 1 - band && high.xi - low.xi > band)
      (is_opposite ? out.opposite : out.alike).push_back({{facet[0], facet[1]}, static_cast<int>(f), low, high});
  }
  return out;
}

/// Breakpoints of the slave facet in ascending order, its own ends included. Of several within `band` one is kept.
std::vector<Break> breakpoints(const std::vector<Shadow>& all) {
  std::vector<Break> breaks;
  for (const auto& shadow : all)
    for (const Break& b : {shadow.low, shadow.high})
      if (b.xi > band && b.xi < 1 - band) breaks.push_back(b);
  std::stable_sort(breaks.begin(), breaks.end(), [](const Break& x, const Break& y) { return x.xi < y.xi; });
  std::vector<Break> merged{{0, Segment::start}};
  for (const Break& b : breaks)
    if (b.xi - merged.back().xi > band) merged.push_back(b);
  merged.push_back({1, Segment::end});
  return merged;
}

}  // namespace

std::vector<Segment> facing_segments(const Points<double>& points, const std::array<int, 2>& slave,
                                     const std::vector<std::vector<int>>& masters, const std::vector<int>& ends,
                                     const std::vector<double>& depths) {
  const Vec<double, 2> a = points.col(slave[0]), tau = points.col(slave[1]).head<2>() - points.col(slave[0]).head<2>();
  const Vec<double, 2> nu = Vec<double, 2>(tau[1], -tau[0]) / tau.norm();
  const auto candidates = shadows(points, a, tau, masters, ends, depths);
  const auto breaks = breakpoints(candidates.opposite);
  std::vector<Segment> segments;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    const double middle = (breaks[k].xi + breaks[k + 1].xi) / 2;
    const Vec<double, 2> x = a + middle * tau;
    const auto way = [&](const Shadow& shadow) {
      return way_along(x, nu, points.col(shadow.nodes[0]), points.col(shadow.nodes[1]));
    };
    const Shadow* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& shadow : candidates.opposite) {
      if (!shadow.covers(middle)) continue;
      const Vec<double, 2> off = way(shadow);
      const double distance = off.norm();
      const bool is_too_deep = !depths.empty() && off.dot(nu) > depths[shadow.facet];
      if (distance < least && !is_too_deep) {
        least = distance;
        nearest = &shadow;
      }
    }
    // Beyond the other face of the solid x is outside, and penetrates no face on its far side.
    const auto is_between = [&](const Shadow& shadow) {
      const bool is_itself = shadow.nodes == slave;
      const double from = !is_itself && shadow.covers(middle) ? way(shadow).dot(nu) : 0;
      return from > 0 && from < least;
    };
    if (!nearest ||
        (way(*nearest).dot(nu) > 0 && std::any_of(candidates.alike.begin(), candidates.alike.end(), is_between)))
      continue;
    if (!segments.empty() && segments.back().master == nearest->nodes && segments.back().last_end == breaks[k].end) {
      segments.back().last_end = breaks[k + 1].end;  // the shadow that begins or ends there is not the nearest
      continue;
    }
    Segment segment;
    segment.slave = slave;
    segment.master = nearest->nodes;
    segment.facet = nearest->facet;
    segment.first_end = breaks[k].end;
    segment.last_end = breaks[k + 1].end;
    segments.push_back(segment);
  }
  return segments;
}

std::vector<int> nodes_of_segments(int own, const std::vector<Segment>& facets, const std::vector<Segment>& segments,
                                   int node_count) {
  std::vector<int> nodes{own};
  const auto add = [&](int node) {
    if (node >= 0 && node < node_count && std::find(nodes.begin(), nodes.end(), node) == nodes.end())
      nodes.push_back(node);
  };
  for (const auto& facet : facets) {
    std::for_each(facet.slave.begin(), facet.slave.end(), add);
    std::for_each(facet.slave_edge.begin(), facet.slave_edge.end(), add);
  }
  for (const auto& segment : segments) {
    std::for_each(segment.master.begin(), segment.master.end(), add);
    std::for_each(segment.master_edge.begin(), segment.master_edge.end(), add);
  }
  return nodes;
}

}  // namespace stickslip
