/// Segment-wise integrated (mortar) contact: gap and slip of the multiplier of one slave node, as integrals over mortar
/// segments. A segment is the part of a slave facet that faces one master facet. The shape function psi_j of slave node
/// j weighs the integrals, which are exact:
///
///   A_j = int psi_j dA      w_j = (1/A_j) int psi_j (u_s - u_m) dA      g_j = n_j . (1/A_j) int psi_j (x_s - y) dA
///   n_j parallel to int psi_j (n_m - n_s) dA
///
///   psi_j   linear on the slave facets of node j; 1 on a facet whose other node carries no multiplier
///   x_s, y  point of the slave facet, and its foot on the master along the normal of the slave facet
///
/// Where the two facets are steep to one another, dA is weighed (weight_of_angle()).
///
/// The traction field is sum psi_j t_j, and its work is sum A_j t_j . w_j. So a uniform pressure passes between any two
/// meshes. The result is a PointGeometry, as in node-to-segment contact, with more nodes and other weights. The kernel,
/// the methods and their derivatives do not distinguish the two.
///
/// At finite strain x, y, the normals and the segments are present ones: they are found anew at each iterate. dA is the
/// initial one, so tractions are nominal. Per initial length S of the master, y has the mean tangent m_j, and n_j is
/// perpendicular to m_j. Z_j is the mean of the foot's initial arc length S(y) along the master; S_s is the signed
/// initial length along the slave from node j. The slip is |m_j| times the change of Z_j since the last increment:
///
///   m_j = (1/A_j) int psi_j dy/dS dA      Z_j = (1/A_j) int psi_j (S(y) + S_s) dA      dg_T = |m_j| (Z_j - last Z_j)
///
/// To first order n_j then does no work as points slide, and dg_T is the tangential part of the change of w_j. A rigid
/// motion of both bodies causes no slip. Source: [PL04]; theory: core/README.md.
///
/// So that small displacements keep their digits, feet are measured from those of the start: a point X of the slave
/// facet has the initial distance G from the line of the master facet, along its normal N, at the coordinate E. With u
/// the displacement of the point relative to that place,
///
///   off = G N + u         eta = E + off . tau / (tau_m . tau)         x - y = off - (eta - E) tau_m
///
/// tau and tau_m run along the two facets as they are now. G and E are linear along the slave facet.
///
/// Relief, at finite strain: if less than s_0 = 0.1 of the whole area of a node faces the master, its gap is
///
///   g_j + h(s)      h(s) = 0.01 l (s_0 / s - 1)^2      s = A_j / (whole area)      l = int psi_j dS over whole facets
///
/// Why: g_j does not fade as s does. A node that an end of the master leaves would bear its force to the last, and lose
/// it at once. Then the end is beside it again, so that neither is an equilibrium. h rounds the end off, as the end
/// relief of a roller does (core/README.md, Past a free end).
///
/// A side of a quadratic element is two facets, each from one of its nodes to the next. The element moves along
///
///   x(s) = (1 - s) x_a + s x_b + s (1 - s) d      d = x_middle - (x_start + x_end) / 2
///
/// on either, so a place has the facet's weights, and in addition s (1 - s) times those of d. Facets decide what faces
/// what; gap, foot, normal and weights are those of the curve. psi_j is linear on the facets, so A_j > 0 for all nodes.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "core/contact/contact_integrals.hpp"
#include "core/contact/placed.hpp"
#include "core/contact/segment.hpp"
#include "core/contact/segment_facets.hpp"
#include "core/mesh/mesh.hpp"
#include "core/solids/edges.hpp"

namespace stickslip {

/// Share of its area below which a point faces nothing. Why: a traction is force over area, and would grow without
/// bound.
inline constexpr double least_share = 0.01;

/// The segments of a slave facet, in order along it. Where the slave facet faces several master facets, the nearest
/// counts. Parts that face no master facet have no segment. The caller sets `carrier` and `sole_carrier`.
///
///   points   nodal positions, 2 x nodes, length
///   slave    the two nodes of the slave facet
///   masters  the two nodes of each master facet
///   ends     nodes at which the master ends. Such a node counts as projected to an end of the slave facet where it is
///            within 1e-6 of the facet's length of it
///   depths   of a side in contact with itself: per master facet, how deep inside of it the slave facet may be, length;
///            negative: it faces it nowhere. Such facets face each other only if their normals make more than 120
///            degrees. Empty: the slave facet is of another side
std::vector<Segment> facing_segments(const Points<double>& points, const std::array<int, 2>& slave,
                                     const std::vector<std::vector<int>>& masters, const std::vector<int>& ends = {},
                                     const std::vector<double>& depths = {});

/// A Gauss point of a segment.
template <class T>
struct IntegrationPoint {
  T xi{};            ///< coordinate along the slave facet: 0 at its first node, 1 at its second
  T slave_length{};  ///< initial length of the slave facet
  T area{};          ///< psi dA times the Gauss weight and weight_of_angle()
  detail::Foot<T> foot;
};

/// Integrals over segments.
///
///   nodes             nodes of the contact point, in the order of the weights that are returned
///   position(node)    Placed<T, S>
///   depth             of the slave body
///   rigid_foot(X, u)  Foot on the obstacle of the place X displaced by u; called for segments that have no master
///   facet
///
/// A master whose nodes are not among `nodes` is rigid: it has no weights, and the normal is its own.
///   visit(segment, facets, IntegrationPoint)  called at each Gauss point. facets: optional FacingFacets
template <class T, class S, class Position, class RigidFoot, class Visit>
ContactIntegrals<T, 2> integrate_segments(const std::vector<Segment>& segments, const std::vector<int>& nodes,
                                          Position&& position, const Depth<T>& depth, RigidFoot&& rigid_foot,
                                          Visit&& visit) {
  static constexpr double gauss[3] = {-0.7745966692414834, 0, 0.7745966692414834};  // exact to degree 5; 3 is needed
  static constexpr double weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  ContactIntegrals<T, 2> sums;
  sums.weights = decltype(sums.weights)::Constant(static_cast<Eigen::Index>(nodes.size()), T(0));
  const auto place = [&](int node) { return std::find(nodes.begin(), nodes.end(), node) - nodes.begin(); };
  const auto share = [&](int node, const T& w) { sums.weights[place(node)] += w; };
  // w times the shape functions of a facet, at its coordinate s
  const auto share_along = [&](const std::array<int, 2>& facet, const std::array<int, 3>& edge, bool is_curved,
                               const T& s, const T& w) {
    share(facet[0], w * (T(1) - s));
    share(facet[1], w * s);
    if (!is_curved) return;
    const T bend = w * s * (T(1) - s);
    share(edge[2], bend);
    for (int k = 0; k < 2; ++k) share(edge[k], T(-0.5) * bend);
  };
  for (const auto& segment : segments) {
    const detail::SlaveFacet<T, S> slave(segment, position);
    std::optional<detail::FacingFacets<T, S>> facets;
    if (segment.master[0] != Segment::none)
      facets.emplace(slave, position(segment.master[0]), position(segment.master[1]),
                     detail::bulge_of<T, S>(segment.master_edge, position));
    const auto end = [&](int of) {
      return detail::end_coordinate<T>(of, position, slave.a, slave.along(), slave.bulge);
    };
    const T from = end(segment.first_end), to = end(segment.last_end);
    const bool rigid = place(segment.master[0]) == static_cast<std::ptrdiff_t>(nodes.size());
    IntegrationPoint<T> point;
    point.slave_length = T(slave.length());
    for (int q = 0; q < 3; ++q) {
      const T s = point.xi = from + (to - from) * T(0.5 * (1 + gauss[q]));
      const auto at = slave.at(s);
      const detail::Foot<T>& foot = point.foot =
          facets ? detail::foot_on_facet<T, S>(*facets, s, at.moved, slave.bulge.is_curved)
                 : rigid_foot(at.start, Vec<T, 2>(slave.a.moved + at.moved));
      const T psi = segment.sole_carrier ? T(1) : segment.carrier == 0 ? T(1) - s : s;
      const T angle = facets ? weight_of_angle<2, T>(at.normal, foot.normal) : T(1);
      const T dA = point.area = psi * (to - from) * at.stretch * T(weight[q]) * depth.at(at.start[0]) * angle;
      sums.area += dA;
      share_along(segment.slave, segment.slave_edge, slave.bulge.is_curved, s, dA);
      if (!rigid) share_along(segment.master, segment.master_edge, facets->bulge.is_curved, foot.eta, -dA);
      for (int i = 0; i < 2; ++i) {
        sums.gap[i] += dA * foot.off[i];
        sums.normal[i] += dA * (foot.normal[i] - (rigid ? T(0) : at.normal[i]));
      }
      visit(segment, facets, point);
    }
  }
  return sums;
}

/// Nodes of a contact point, each once, in this order: `own`, the other slave nodes of `facets`, the master nodes of
/// `segments`; of all only those below `node_count`, which are no vertices of an obstacle.
std::vector<int> nodes_of_segments(int own, const std::vector<Segment>& facets, const std::vector<Segment>& segments,
                                   int node_count);

/// Geometry of a contact point that moves, and the foot from which the next increment measures slip.
template <class T>
struct SegmentKinematics {
  PointGeometry<T> geometry;
  /// On an obstacle: the mean foot, from the mean place of the slave points at the start. On facets: (Z_j, 0), Z_j the
  /// mean initial arc length along the master. Each Gauss point contributes its foot's arc length plus S_s, its own
  /// distance from the slave node. So Z_j does not depend on which part of the slave facets faces the master.
  Vec<T, 2> foot = Vec<T, 2>::Constant(T(0));
  Vec<T, 2> tangent = foot;  ///< m_j: mean tangent of the master facets, per initial length; 0 on an obstacle
};

/// Kinematics of a contact point. Arguments as in integrate_segments(), and
///
///   arc_length(facet)  initial arc length along the master at which a master facet begins, in S
///   bisects            true: the normal is that of the mean bisector; false: it is perpendicular to the mean tangent
template <class T, class S, class Position, class RigidFoot, class ArcLength>
SegmentKinematics<T> segment_kinematics(const std::vector<Segment>& segments, const std::vector<int>& nodes,
                                        Position&& position, const Depth<T>& depth, RigidFoot&& rigid_foot,
                                        ArcLength&& arc_length, bool bisects) {
  SegmentKinematics<T> kinematics;
  const auto accumulate = [&](const Segment& segment, const auto& facets, const IntegrationPoint<T>& point) {
    if (!facets) {
      for (int i = 0; i < 2; ++i) kinematics.foot[i] += point.area * point.foot.moved[i];
      return;
    }
    // S(y) + S_s at a, what it grows by along the slave facet (nothing where this lay on the master), and the rest
    const S& length = facets->length;
    const T start = T(arc_length(segment.facet) + facets->first * length) -
                    (segment.carrier == 0 ? T(0) : point.slave_length),
            growth = T(facets->along * length) + point.slave_length;
    kinematics.foot[0] += point.area * (start + point.xi * growth + point.foot.shift * length);
    if (segment.slave_edge[2] != Segment::none)
      kinematics.foot[0] += point.area * (point.xi * (T(1) - point.xi) * facets->bulge_along * length);
    for (int i = 0; i < 2; ++i) kinematics.tangent[i] += point.area * point.foot.tangent[i] / T(length);
  };
  const auto sums = integrate_segments<T, S>(segments, nodes, position, depth, rigid_foot, accumulate);
  for (int i = 0; i < 2; ++i) {
    kinematics.foot[i] /= sums.area;
    kinematics.tangent[i] /= sums.area;
  }
  kinematics.geometry = sums.geometry(bisects ? sums.normal : Vec<T, 2>(kinematics.tangent[1], -kinematics.tangent[0]));
  return kinematics;
}

/// Initial area A_j of a multiplier over whole slave facets, whether they face a master or not.
template <class T, class InitialPosition>
T area_of_facets(const std::vector<Segment>& facets, InitialPosition&& initial_position, const Depth<T>& depth) {
  std::vector<int> nodes;
  for (const auto& facet : facets) {
    nodes.insert(nodes.end(), facet.slave.begin(), facet.slave.end());
    nodes.insert(nodes.end(), facet.slave_edge.begin(), facet.slave_edge.end());
  }
  const auto position = [&](int node) { return at_start<T>(initial_position(node)); };
  const auto here = [](const auto&...) { return detail::Foot<T>{Vec<T, 2>(T(0), T(0)), Vec<T, 2>(T(0), T(1))}; };
  return integrate_segments<T, T>(facets, nodes, position, depth, here, [](auto&&...) {}).area;
}

/// s_0 of the relief (above), which is end_relief() of s_0 / s.
inline constexpr double relieved_share = 0.1;

/// Distance of a slave node from a free end of the master, initial length, positive outside, at which 2 least_share of
/// the area of its point faces the master: where a point that comes on begins to slide. Twice, because a point that
/// sticks there must face its master, whatever the two sides are stretched.
///
///   facets   whole slave facets of the point
///   leading  Segment::carrier of the facet that comes to face the master first; a point may have none
///   depth    is taken as uniform
template <class T, class InitialPosition>
T way_outside_of_end(const std::vector<Segment>& facets, int leading, InitialPosition&& initial_position) {
  const auto length = [&](const Segment& facet) {
    return norm(Vec<T, 2>(initial_position(facet.slave[1]) - initial_position(facet.slave[0])));
  };
  const auto area = [&](const Segment& facet) { return T(facet.sole_carrier ? 1.0 : 0.5) * length(facet); };
  T faces(0);
  for (const auto& facet : facets) faces += T(2 * least_share) * area(facet);
  for (const auto& facet : facets) {
    if (facet.carrier != leading) continue;
    if (value(faces) <= value(area(facet)))
      return length(facet) - (facet.sole_carrier ? faces : T(sqrt(T(2) * length(facet) * faces)));
    faces -= area(facet);
  }
  for (const auto& facet : facets)
    if (facet.carrier != leading) {
      const T c = length(facet);
      return facet.sole_carrier ? T(-faces) : T(sqrt(c * c - T(2) * c * faces) - c);
    }
  return T(0);
}

}  // namespace stickslip
