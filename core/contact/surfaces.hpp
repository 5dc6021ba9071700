/// Geometry of a slave node against facets, vertices and faces, and the normal that two deformable sides share. `x`:
/// position of the slave node. The area is left to the caller.
#pragma once

#include <algorithm>

#include "core/contact/face.hpp"
#include "core/contact/point_geometry.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Geometry against the facet a -> b with the solid on its left. pre: x projects onto the facet.
template <class T>
PointGeometry<T> against_facet(const Vec<T, 2>& x, const Vec<T, 2>& a, const Vec<T, 2>& b) {
  const Vec<T, 2> tau = b - a;
  const T length = norm(tau);
  const T xi = dot((x - a).eval(), tau) / (length * length);
  PointGeometry<T> g;
  g.normal.resize(2);
  g.normal << tau[1] / length, -tau[0] / length;
  g.gap = dot((x - a).eval(), g.normal);
  g.tangents = detail::tangent_frame<T>(g.normal);
  g.weights.resize(3);
  g.weights << T(1), xi - T(1), -xi;
  return g;
}

/// The same geometry against a rigid facet or vertex: w is the displacement of the slave node alone.
template <class T>
PointGeometry<T> fixed(PointGeometry<T> geometry) {
  geometry.weights.conservativeResize(1);
  return geometry;
}

/// Geometry against the vertex v between the facets before -> v and v -> after. before = v, or after = v: there is no
/// such facet. The normal bisects the normals of both facets. It does not depend on the order of the facets.
template <class T>
PointGeometry<T> against_vertex(const Vec<T, 2>& x, const Vec<T, 2>& before, const Vec<T, 2>& v,
                                const Vec<T, 2>& after) {
  auto unit = [](const Vec<T, 2>& t) {
    const T length = norm(t);
    return Vec<T, 2>(t[0] / length, t[1] / length);
  };
  Vec<T, 2> tau = Vec<T, 2>::Constant(T(0));
  if (values(before) != values(v)) tau += unit(v - before);
  if (values(after) != values(v)) tau += unit(after - v);
  tau = unit(tau);
  PointGeometry<T> g;
  g.normal.resize(2);
  g.normal << tau[1], -tau[0];
  g.gap = dot((x - v).eval(), g.normal);
  g.tangents = detail::tangent_frame<T>(g.normal);
  g.weights.resize(2);
  g.weights << T(1), T(-1);
  return g;
}

/// Adds to the geometry against vertex v half the weights by which the projection of x slides along the facet v ->
/// `to`. Why: x projects to the end v of that facet. If x moves to one side of v, its projection slides along the
/// facet; if it moves to the other, the projection stays at v or slides along the next facet. Half the weights give the
/// mean of both derivatives.
template <class T>
void slide_off(PointGeometry<T>& geometry, const Vec<T, 2>& x, const Vec<T, 2>& v, const Vec<T, 2>& to) {
  const Vec<T, 2> tau = to - v;
  const T half = T(0.5) * dot((x - v).eval(), tau) / dot(tau, tau);
  decltype(geometry.weights) weights(geometry.weights.size() + 1);
  weights << geometry.weights, -half;
  weights[1] += half;
  geometry.weights = std::move(weights);
}

/// Geometry against the place that is closest to x, on each face that has it: the mean over these faces, of which an
/// edge has two and a corner several. Each has the same weights there, but other derivatives, as on the two sides of a
/// vertex in the plane. The normal is the mean of theirs.
///
///   nodes     slave node, then the nodes of all faces, in the order of the weights
///   position  node -> position
template <class T, class Position>
PointGeometry<T> against_faces(const Vec<T, 3>& x, const std::vector<FacePlace>& faces, const std::vector<int>& nodes,
                               const Position& position) {
  PointGeometry<T> g;
  g.weights = decltype(g.weights)::Constant(static_cast<Eigen::Index>(nodes.size()), T(0));
  g.weights[0] = T(1);
  const T share(1.0 / static_cast<double>(faces.size()));
  Vec<T, 3> normal = Vec<T, 3>::Constant(T(0)), foot = normal;
  for (const auto& face : faces) {
    const auto at = face_foot<T>(face, x, corners_of<T>(face, position));
    normal += at.normal;
    foot += at.y * share;
    for (int k = 0; k < face.corners; ++k)
      g.weights[std::find(nodes.begin(), nodes.end(), face.nodes[k]) - nodes.begin()] -= share * at.weights[k];
  }
  const T length = norm(normal);
  g.normal.resize(3);
  for (int i = 0; i < 3; ++i) g.normal[i] = normal[i] / length;
  g.gap = dot((x - foot).eval(), g.normal);
  g.tangents = detail::tangent_frame<T>(g.normal);
  return g;
}

/// Outward normal of the slave side at a node: sum over the node's facets of unit normal times length, in space times
/// area. In the plane the solid is on the left of a facet; in space its nodes are counter-clockwise seen from outside.
template <int D, class T>
Vec<T, D> slave_normal(const std::vector<std::vector<int>>& facets, const Points<T>& points) {
  Vec<T, D> n = Vec<T, D>::Constant(T(0));
  for (const auto& facet : facets) {
    const auto corner = [&](int k) -> Vec<T, D> { return points.col(facet[k]); };
    if constexpr (D == 2) {
      const Vec<T, 2> tau = corner(1) - corner(0);
      n[0] += tau[1];
      n[1] -= tau[0];
    } else {
      n += area_vector<T>(static_cast<int>(facet.size()), corner);
    }
  }
  return n;
}

/// Cosine by which a master's normal must oppose that of a slave side: the two make more than 104 degrees. Why: the
/// wall of a block is at a right angle to the floor that the block stands on, but for rounding, and deformation tilts
/// it. If it opposed the floor, it would take nodes and parts of facets from the sole. At the corner of a block the
/// mean normal of the side still opposes what each of its three faces touches, by 1 / sqrt(3).
inline constexpr double least_against_a_side = 0.25;

/// Whether a master of normal `across` opposes a slave side. Lengths are any.
template <int D>
bool opposes(const Vec<double, D>& across, const Vec<double, D>& outward) {
  return across.dot(outward) < -least_against_a_side * across.norm() * outward.norm();
}

/// Sets the normal to the bisector of the master normal and the reversed slave normal, and the tangents to match.
/// `slave_normal`: outward, of any length. The gap is left to the caller: it is the distance between slave node and
/// master point along the new normal.
///
/// Why: geometry is fixed at the start, and the common tangent plane of the closed contact is known only up to the
/// angle between the two surfaces. The bisector is right to second order in that angle and treats both bodies alike.
/// The master normal alone would count part of the closing motion as slip. Example: two cylinders with the ratio of
/// contact width to radius b/R = 0.085, where that part is 3/4 of the slip.
template <int D, class T>
void share_normal(PointGeometry<T>& geometry, const Vec<T, D>& slave_normal) {
  const T length = norm(slave_normal);
  Vec<T, D> mean;
  for (int i = 0; i < D; ++i) mean[i] = geometry.normal[i] - slave_normal[i] / length;
  const T size = norm(mean);
  for (int i = 0; i < D; ++i) geometry.normal[i] = mean[i] / size;
  geometry.tangents = detail::tangent_frame<T>(geometry.normal);
}

}  // namespace stickslip
