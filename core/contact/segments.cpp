#include "core/contact/segments.hpp"

#include <algorithm>
#include <limits>

namespace stickslip {
namespace {

/// Breakpoints closer than this part of the slave facet are one; a facet steeper than this faces nothing.
constexpr double band = 1e-9;

struct Break {
  double place;
  int end;  ///< as Piece::from
};

/// A master facet that the slave facet faces, its shadow on it, and where its ends are.
struct Shadow {
  std::array<int, 2> nodes;
  Break low, high;
};

std::vector<Shadow> shadows(const Points<double>& points, const Vec<double, 2>& a, const Vec<double, 2>& tau,
                            const std::vector<std::vector<int>>& masters) {
  std::vector<Shadow> out;
  const Vec<double, 2> nu(tau[1], -tau[0]);
  for (const auto& facet : masters) {
    const Vec<double, 2> c = points.col(facet[0]), d = points.col(facet[1]), along = d - c;
    if (nu.dot(Vec<double, 2>(along[1], -along[0])) >= -band * nu.norm() * along.norm()) continue;
    const double at_c = (c - a).dot(tau) / tau.squaredNorm(), at_d = (d - a).dot(tau) / tau.squaredNorm();
    if (at_c > band && at_d < 1 - band && at_c - at_d > band)  // the master runs the other way: d comes first
      out.push_back({{facet[0], facet[1]}, {at_d, facet[1]}, {at_c, facet[0]}});
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

std::vector<Piece> facing_pieces(const Points<double>& points, const std::vector<int>& slave,
                                 const std::vector<std::vector<int>>& masters) {
  const Vec<double, 2> a = points.col(slave[0]), tau = points.col(slave[1]).head<2>() - points.col(slave[0]).head<2>();
  const Vec<double, 2> nu = Vec<double, 2>(tau[1], -tau[0]) / tau.norm();
  const auto candidates = shadows(points, a, tau, masters);
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
      const double distance = (x - foot.at).norm();
      if (distance < least) {
        least = distance;
        nearest = &shadow;
      }
    }
    if (!nearest) continue;
    if (!pieces.empty() && pieces.back().master == nearest->nodes && pieces.back().to == breaks[k].end) {
      pieces.back().to = breaks[k + 1].end;  // another facet's shadow began there, but this one is nearer
      continue;
    }
    Piece piece;
    piece.slave = {slave[0], slave[1]};
    piece.master = nearest->nodes;
    piece.from = breaks[k].end;
    piece.to = breaks[k + 1].end;
    pieces.push_back(piece);
  }
  return pieces;
}

}  // namespace stickslip
