#include "core/contact/segments.hpp"

#include <algorithm>
#include <limits>

namespace stickslip {
namespace {

/// Breakpoints closer than this part of the slave facet are one; a facet steeper than this faces nothing.
constexpr double band = 1e-9;

/// Sides that end together do so only as well as an equilibrium was solved for: within this part of the slave facet
/// they end together, so that what a point weighs has no kink there.
constexpr double same_end = 1e-6;

struct Break {
  double place;
  int end;  ///< as Piece::from
};

/// A master facet that the slave facet faces, its shadow on it, and where its ends are.
struct Shadow {
  std::array<int, 2> nodes;
  int facet;
  Break low, high;
};

/// The place of a node on the slave facet as a breakpoint.
Break break_at(double place, int node, const std::vector<int>& ends) {
  if (std::find(ends.begin(), ends.end(), node) == ends.end()) return {place, node};
  if (std::abs(place) <= same_end) return {0, Piece::start};
  if (std::abs(place - 1) <= same_end) return {1, Piece::end};
  return {place, node};
}

std::vector<Shadow> shadows(const Points<double>& points, const Vec<double, 2>& a, const Vec<double, 2>& tau,
                            const std::vector<std::vector<int>>& masters, const std::vector<int>& ends) {
  std::vector<Shadow> out;
  const Vec<double, 2> nu(tau[1], -tau[0]);
  for (std::size_t f = 0; f < masters.size(); ++f) {
    const auto& facet = masters[f];
    const Vec<double, 2> c = points.col(facet[0]), d = points.col(facet[1]), along = d - c;
    if (nu.dot(Vec<double, 2>(along[1], -along[0])) >= -band * nu.norm() * along.norm()) continue;
    const Break high = break_at((c - a).dot(tau) / tau.squaredNorm(), facet[0], ends),
                low = break_at((d - a).dot(tau) / tau.squaredNorm(), facet[1], ends);
    if (high.place > band && low.place < 1 - band && high.place - low.place > band)  // it runs the other way
      out.push_back({{facet[0], facet[1]}, static_cast<int>(f), low, high});
  }
  return out;
}

/// Ends of all shadows on the facet, each place once: ends of the facet itself first.
std::vector<Break> breakpoints(const std::vector<Shadow>& all) {
  std::vector<Break> breaks;
  for (const auto& shadow : all)
    for (const Break& b : {shadow.low, shadow.high})
      if (b.place > band && b.place < 1 - band) breaks.push_back(b);
  std::stable_sort(breaks.begin(), breaks.end(), [](const Break& x, const Break& y) { return x.place < y.place; });
  std::vector<Break> merged{{0, Piece::start}};
  for (const Break& b : breaks)
    if (b.place - merged.back().place > band) merged.push_back(b);
  merged.push_back({1, Piece::end});
  return merged;
}

}  // namespace

std::vector<Piece> facing_pieces(const Points<double>& points, const std::array<int, 2>& slave,
                                 const std::vector<std::vector<int>>& masters, const std::vector<int>& ends) {
  const Vec<double, 2> a = points.col(slave[0]), tau = points.col(slave[1]).head<2>() - points.col(slave[0]).head<2>();
  const Vec<double, 2> nu = Vec<double, 2>(tau[1], -tau[0]) / tau.norm();
  const auto candidates = shadows(points, a, tau, masters, ends);
  const auto breaks = breakpoints(candidates);
  std::vector<Piece> pieces;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    const double middle = (breaks[k].place + breaks[k + 1].place) / 2;
    const Vec<double, 2> x = a + middle * tau;
    const Shadow* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& shadow : candidates) {
      if (shadow.low.place > middle || shadow.high.place < middle) continue;
      const auto foot = detail::foot_on_facet<double>(x, nu, points.col(shadow.nodes[0]), points.col(shadow.nodes[1]));
      const double distance = (x - foot.place).norm();
      if (distance < least) {
        least = distance;
        nearest = &shadow;
      }
    }
    if (!nearest) continue;
    if (!pieces.empty() && pieces.back().master == nearest->nodes && pieces.back().last_end == breaks[k].end) {
      pieces.back().last_end = breaks[k + 1].end;  // another facet's shadow began there, but this one is nearer
      continue;
    }
    Piece piece;
    piece.slave = slave;
    piece.master = nearest->nodes;
    piece.facet = nearest->facet;
    piece.first_end = breaks[k].end;
    piece.last_end = breaks[k + 1].end;
    pieces.push_back(piece);
  }
  return pieces;
}

std::vector<int> nodes_of_pieces(int own, const std::vector<Piece>& facets, const std::vector<Piece>& pieces) {
  std::vector<int> nodes{own};
  const auto add = [&](int node) {
    if (node >= 0 && std::find(nodes.begin(), nodes.end(), node) == nodes.end()) nodes.push_back(node);
  };
  for (const auto& facet : facets) std::for_each(facet.slave.begin(), facet.slave.end(), add);
  for (const auto& piece : pieces) std::for_each(piece.master.begin(), piece.master.end(), add);
  return nodes;
}

}  // namespace stickslip
