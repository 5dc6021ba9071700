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
///
/// At finite strain x, y, the normals and the pieces are those of the present, found anew wherever the points move, and
/// dA stays that of the start, so that tractions are nominal. What a node faces has the mean tangent m_j, per length of
/// the start, and n_j is across it; slip is |m_j| times the change of the mean place Z_j along the master in that
/// length (S, and S_s along the slave from the node):
///
///   m_j = (1/A_j) int psi_j dy/dS dA      Z_j = (1/A_j) int psi_j (S(y) + S_s) dA      dg_T = |m_j| (Z_j - last Z_j)
///
/// so that to first order n_j does no work as points slide, and slip is that of w_j; it turns with no rigid motion.
/// [PL04]; core/README.md.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "core/contact/piece.hpp"
#include "core/contact/surfaces.hpp"
#include "core/mesh/mesh.hpp"
#include "core/solids/edges.hpp"

namespace stickslip {

/// The pieces of a slave facet (node pair), in order along it: on each the nearest of the master facets that it faces.
/// Parts that face none are left out. `carrier` and `whole` are left to the caller. `ends`: nodes at which the master
/// ends; one that is next to an end of the slave facet is at it.
std::vector<Piece> facing_pieces(const Points<double>& points, const std::array<int, 2>& slave,
                                 const std::vector<std::vector<int>>& masters, const std::vector<int>& ends = {});

namespace detail {

/// Place along the slave facet (0 at a, 1 at b) of an end of a piece. `at(node)`: where a node is.
template <class T, class At>
T place_along(int piece_end, At&& at, const Vec<T, 2>& a, const Vec<T, 2>& tau) {
  if (piece_end == Piece::start) return T(0);
  if (piece_end == Piece::end) return T(1);
  const Vec<T, 2> m = at(piece_end);
  return dot((m - a).eval(), tau) / dot(tau, tau);
}

/// Foot of a point on a master: position, unit normal out of the master, and its weights on the piece's master nodes.
template <class T>
struct Foot {
  Vec<T, 2> place, normal;
  std::array<T, 2> weights{};
};

/// On the line through the master facet c -> d along the direction nu.
template <class T>
Foot<T> foot_on_facet(const Vec<T, 2>& x, const Vec<T, 2>& nu, const Vec<T, 2>& c, const Vec<T, 2>& d) {
  const Vec<T, 2> tau = d - c;
  const T length = norm(tau);
  const T eta = ((x[0] - c[0]) * nu[1] - (x[1] - c[1]) * nu[0]) / (tau[0] * nu[1] - tau[1] * nu[0]);
  Foot<T> foot;
  for (int i = 0; i < 2; ++i) foot.place[i] = c[i] + eta * tau[i];
  foot.normal = Vec<T, 2>(tau[1] / length, -tau[0] / length);
  foot.weights = {T(1) - eta, eta};
  return foot;
}

}  // namespace detail

/// A place of integration.
template <class T>
struct PiecePlace {
  T along{};         ///< place along the slave facet: 0 at its first node, 1 at its second
  T slave_length{};  ///< of the slave facet at the start
  T area{};          ///< psi dA
  detail::Foot<T> foot;
};

/// Integrals over the pieces of a point.
template <class T>
struct PieceSums {
  T area{};
  decltype(PointGeometry<T>::weights) weights;
  Vec<T, 2> gap = Vec<T, 2>::Constant(T(0)), normal = gap;  ///< of x - y, and of the bisectors

  /// The geometry with a normal, of any length.
  PointGeometry<T> across(const Vec<T, 2>& n) const {
    PointGeometry<T> g;
    g.area = area;
    g.weights = weights;
    for (auto& w : g.weights) w /= area;
    const T length = norm(n);
    g.normal.resize(2);
    g.normal << n[0] / length, n[1] / length;
    g.gap = (gap[0] * g.normal[0] + gap[1] * g.normal[1]) / area;
    g.tangents = detail::tangent_frame<T>(g.normal);
    return g;
  }
};

/// Integrals over the pieces that are given, on a slave body of this depth. `at(node)`: where a node is;
/// `of_start(node)`: where it was, for the areas; `nodes`: its nodes, in the order of the weights wanted; `rigid_foot`:
/// x -> Foot on the obstacle, called for pieces that have no master facet; `visit(piece, PiecePlace)`: called at each
/// place of integration.
template <class T, class At, class OfStart, class RigidFoot, class Visit>
PieceSums<T> integrate_pieces(const std::vector<Piece>& pieces, const std::vector<int>& nodes, At&& at,
                              OfStart&& of_start, const Depth<T>& depth, RigidFoot&& rigid_foot, Visit&& visit) {
  static constexpr double gauss[3] = {-0.7745966692414834, 0, 0.7745966692414834};  // exact to degree 5; 3 is needed
  static constexpr double weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  PieceSums<T> sums;
  sums.weights = decltype(sums.weights)::Constant(static_cast<Eigen::Index>(nodes.size()), T(0));
  auto share = [&](int node, const T& w) {
    sums.weights[std::find(nodes.begin(), nodes.end(), node) - nodes.begin()] += w;
  };
  for (const auto& piece : pieces) {
    const Vec<T, 2> a = at(piece.slave[0]), tau = at(piece.slave[1]) - a;
    const Vec<T, 2> A = of_start(piece.slave[0]), Tau = of_start(piece.slave[1]) - A;
    const T length = norm(tau);
    const Vec<T, 2> nu(tau[1] / length, -tau[0] / length);
    const T from = detail::place_along<T>(piece.first_end, at, a, tau),
            to = detail::place_along<T>(piece.last_end, at, a, tau);
    PiecePlace<T> place;
    place.slave_length = norm(Tau);
    for (int q = 0; q < 3; ++q) {
      const T s = place.along = from + (to - from) * T(0.5 * (1 + gauss[q]));
      const Vec<T, 2> x(a[0] + s * tau[0], a[1] + s * tau[1]);
      const bool rigid = piece.master[0] == Piece::none;
      const detail::Foot<T>& foot = place.foot =
          rigid ? rigid_foot(x) : detail::foot_on_facet<T>(x, nu, at(piece.master[0]), at(piece.master[1]));
      const T psi = piece.whole ? T(1) : piece.carrier == 0 ? T(1) - s : s;
      const T dA = place.area = psi * (to - from) * place.slave_length * T(weight[q]) * depth.at(T(A[0] + s * Tau[0]));
      sums.area += dA;
      share(piece.slave[0], dA * (T(1) - s));
      share(piece.slave[1], dA * s);
      if (!rigid)
        for (int m = 0; m < 2; ++m) share(piece.master[m], -dA * foot.weights[m]);
      for (int i = 0; i < 2; ++i) {
        sums.gap[i] += dA * (x[i] - foot.place[i]);
        sums.normal[i] += dA * (foot.normal[i] - (rigid ? T(0) : nu[i]));
      }
      visit(piece, place);
    }
  }
  return sums;
}

/// Nodes of a point: its own, the other slave nodes of its whole facets, then the masters' of its pieces.
std::vector<int> nodes_of_pieces(int own, const std::vector<Piece>& facets, const std::vector<Piece>& pieces);

/// What a point that moves faces: its geometry, and what friction remembers of it.
template <class T>
struct FacedPieces {
  PointGeometry<T> geometry;
  /// Mean foot on an obstacle; on facets the mean place along them, length of the start, and 0. A place that the slave
  /// node does not face itself is taken back to it along the slave, so that what of its facets faces the master does
  /// not count as slip.
  Vec<T, 2> foot = Vec<T, 2>::Constant(T(0));
  Vec<T, 2> tangent = foot;  ///< mean of that of the facets, per length of the start; 0 on an obstacle
};

/// Arguments as of integrate_pieces(); `begin(facet)`: place along the master at which a facet begins, length.
/// `bisects`: the normal is the mean bisector of both sides, in place of that of the mean tangent.
template <class T, class At, class OfStart, class RigidFoot, class Begin>
FacedPieces<T> face_pieces(const std::vector<Piece>& pieces, const std::vector<int>& nodes, At&& at, OfStart&& of_start,
                           const Depth<T>& depth, RigidFoot&& rigid_foot, Begin&& begin, bool bisects) {
  FacedPieces<T> faced;
  const auto remember = [&](const Piece& piece, const PiecePlace<T>& place) {
    if (piece.master[0] == Piece::none) {
      for (int i = 0; i < 2; ++i) faced.foot[i] += place.area * place.foot.place[i];
      return;
    }
    const auto along = [&](auto&& where) { return Vec<T, 2>(where(piece.master[1]) - where(piece.master[0])); };
    const T of_facet = norm(along(of_start)), back = piece.carrier == 0 ? place.along : T(place.along - T(1));
    faced.foot[0] += place.area * (begin(piece.facet) + place.foot.weights[1] * of_facet + back * place.slave_length);
    const Vec<T, 2> tau = along(at);
    for (int i = 0; i < 2; ++i) faced.tangent[i] += place.area * tau[i] / of_facet;
  };
  const auto sums = integrate_pieces<T>(pieces, nodes, at, of_start, depth, rigid_foot, remember);
  for (int i = 0; i < 2; ++i) {
    faced.foot[i] /= sums.area;
    faced.tangent[i] /= sums.area;
  }
  faced.geometry = sums.across(bisects ? sums.normal : Vec<T, 2>(faced.tangent[1], -faced.tangent[0]));
  return faced;
}

/// Area that whole facets have for a multiplier, whatever they face.
template <class T, class OfStart>
T area_of_facets(const std::vector<Piece>& facets, OfStart&& of_start, const Depth<T>& depth) {
  std::vector<int> nodes;
  for (const auto& facet : facets) nodes.insert(nodes.end(), facet.slave.begin(), facet.slave.end());
  const auto here = [](const Vec<T, 2>& x) { return detail::Foot<T>{x, Vec<T, 2>(T(0), T(1)), {}}; };
  return integrate_pieces<T>(facets, nodes, of_start, of_start, depth, here, [](auto&&...) {}).area;
}

}  // namespace stickslip
