/// Segment-wise integrated contact (mortar): gap and slip of the multiplier of a slave node, weighted by its shape
/// function and integrated exactly over the pieces of the slave facets that face one master facet each.
///
///   A_j = int psi_j dA      w_j = (1/A_j) int psi_j (u_s - u_m) dA      g_j = n_j . (1/A_j) int psi_j (x_s - y) dA
///   n_j parallel to int psi_j (n_m - n_s) dA
///
/// y is the foot of x_s on the master along the normal of the slave facet, psi_j the linear shape function of the node
/// on the slave side (1 on a facet whose other node carries no multiplier), so that sum A_j t_j . w_j is the work of
/// the traction field sum psi_j t_j: a uniform pressure passes between any two meshes. What comes out is a
/// PointGeometry like that of node-to-segment contact, with more nodes and other weights; nothing else knows.
/// [PL04]; core/README.md.
#pragma once

#include <array>
#include <vector>

#include "core/contact/surfaces.hpp"
#include "core/mesh/mesh.hpp"
#include "core/solids/edges.hpp"

namespace stickslip {

/// Part of a slave facet that faces one master facet, or an obstacle.
struct Piece {
  static constexpr int start = -1, end = -2;  ///< ends of the slave facet
  static constexpr int none = -1;
  std::array<int, 2> slave{};               ///< nodes a -> b, solid on the left
  std::array<int, 2> master{{none, none}};  ///< nodes c -> d; none: the obstacle of the contact
  int from = start, to = end;               ///< ends of the piece: of the facet, or the master node projected there
  int carrier = 0;                          ///< which of the two slave nodes carries the multiplier
  bool whole = false;                       ///< psi = 1: the other node carries none
};

/// The pieces of a slave facet (node pair), in order along it: on each the nearest of the master facets that it faces.
/// Parts that face none are left out. `carrier` and `whole` are left to the caller.
std::vector<Piece> facing_pieces(const Points<double>& points, const std::vector<int>& slave,
                                 const std::vector<std::vector<int>>& masters);

namespace detail {

/// Place along the slave facet (0 at a, 1 at b) of an end of a piece.
template <class T>
T place_along(int piece_end, const Points<T>& points, const Vec<T, 2>& a, const Vec<T, 2>& tau) {
  if (piece_end == Piece::start) return T(0);
  if (piece_end == Piece::end) return T(1);
  const Vec<T, 2> m(points(0, piece_end), points(1, piece_end));
  return dot((m - a).eval(), tau) / dot(tau, tau);
}

/// Foot of a point on a master: position, unit normal out of the master, and its weights on the piece's master nodes.
template <class T>
struct Foot {
  Vec<T, 2> at, normal;
  std::array<T, 2> weights{};
};

/// On the line through the master facet c -> d along the direction nu.
template <class T>
Foot<T> foot_on_facet(const Vec<T, 2>& x, const Vec<T, 2>& nu, const Vec<T, 2>& c, const Vec<T, 2>& d) {
  const Vec<T, 2> tau = d - c;
  const T length = norm(tau);
  const T eta = ((x[0] - c[0]) * nu[1] - (x[1] - c[1]) * nu[0]) / (tau[0] * nu[1] - tau[1] * nu[0]);
  Foot<T> foot;
  for (int i = 0; i < 2; ++i) foot.at[i] = c[i] + eta * tau[i];
  foot.normal = Vec<T, 2>(tau[1] / length, -tau[0] / length);
  foot.weights = {T(1) - eta, eta};
  return foot;
}

}  // namespace detail

/// Geometry of the point whose pieces are given, on a slave body of this depth. `nodes`: its nodes, in the order of the
/// weights wanted; `rigid_foot`: x -> Foot on the obstacle, called for pieces that have no master facet. The result
/// carries its area.
template <class T, class RigidFoot>
PointGeometry<T> against_pieces(const Points<T>& points, const std::vector<Piece>& pieces,
                                const std::vector<int>& nodes, RigidFoot&& rigid_foot, const Depth<T>& depth = {}) {
  static constexpr double gauss[3] = {-0.7745966692414834, 0, 0.7745966692414834};  // exact to degree 5; 2 is needed
  static constexpr double weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  auto at = [&](int node) { return Vec<T, 2>(points(0, node), points(1, node)); };
  PointGeometry<T> g;
  g.weights = decltype(g.weights)::Constant(static_cast<Eigen::Index>(nodes.size()), T(0));
  auto share = [&](int node, const T& w) {
    g.weights[std::find(nodes.begin(), nodes.end(), node) - nodes.begin()] += w;
  };
  Vec<T, 2> gap = Vec<T, 2>::Constant(T(0)), normal = gap;
  for (const auto& piece : pieces) {
    const Vec<T, 2> a = at(piece.slave[0]), tau = at(piece.slave[1]) - a;
    const T length = norm(tau);
    const Vec<T, 2> nu(tau[1] / length, -tau[0] / length);
    const T from = detail::place_along(piece.from, points, a, tau), to = detail::place_along(piece.to, points, a, tau);
    for (int q = 0; q < 3; ++q) {
      const T s = from + (to - from) * T(0.5 * (1 + gauss[q]));
      const Vec<T, 2> x(a[0] + s * tau[0], a[1] + s * tau[1]);
      const bool rigid = piece.master[0] == Piece::none;
      const detail::Foot<T> foot =
          rigid ? rigid_foot(x) : detail::foot_on_facet<T>(x, nu, at(piece.master[0]), at(piece.master[1]));
      const T psi = piece.whole ? T(1) : piece.carrier == 0 ? T(1) - s : s;
      const T dA = psi * (to - from) * length * T(weight[q]) * depth.at(x[0]);
      g.area += dA;
      share(piece.slave[0], dA * (T(1) - s));
      share(piece.slave[1], dA * s);
      if (!rigid)
        for (int m = 0; m < 2; ++m) share(piece.master[m], -dA * foot.weights[m]);
      for (int i = 0; i < 2; ++i) {
        gap[i] += dA * (x[i] - foot.at[i]);
        normal[i] += dA * (foot.normal[i] - (rigid ? T(0) : nu[i]));
      }
    }
  }
  for (auto& w : g.weights) w /= g.area;
  const T length = norm(normal);
  g.normal.resize(2);
  g.normal << normal[0] / length, normal[1] / length;
  g.gap = (gap[0] * g.normal[0] + gap[1] * g.normal[1]) / g.area;
  g.tangents = detail::tangent_frame<T>(g.normal);
  return g;
}

}  // namespace stickslip
