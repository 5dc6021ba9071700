/// Geometry of a slave node against facets and vertices, and the normal that two deformable sides share. `x`: position
/// of the slave node. The area is left to the caller.
#pragma once

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

/// Outward normal of the slave side at a node, length: sum over the node's facets (solid on their left) of unit normal
/// times facet length.
template <class T>
Vec<T, 2> slave_normal(const std::vector<std::pair<int, int>>& facets, const Points<T>& points) {
  Vec<T, 2> n = Vec<T, 2>::Constant(T(0));
  for (const auto& [a, b] : facets) {
    n[0] += points(1, b) - points(1, a);
    n[1] -= points(0, b) - points(0, a);
  }
  return n;
}

/// Sets the normal to the bisector of the master normal and the reversed slave normal, and the tangents to match.
/// `slave_normal`: outward, of any length. The gap is left to the caller: it is the distance between slave node and
/// master point along the new normal.
///
/// Why: geometry is fixed at the start, and the common tangent plane of the closed contact is known only up to the
/// angle between the two surfaces. The bisector is right to second order in that angle and treats both bodies alike.
/// The master normal alone would count part of the closing motion as slip. Example: two cylinders with the ratio of
/// contact width to radius b/R = 0.085, where that part is 3/4 of the slip.
template <class T>
void share_normal(PointGeometry<T>& geometry, const Vec<T, 2>& slave_normal) {
  const T length = norm(slave_normal);
  Vec<T, 2> mean(geometry.normal[0] - slave_normal[0] / length, geometry.normal[1] - slave_normal[1] / length);
  const T size = norm(mean);
  for (int i = 0; i < 2; ++i) mean[i] /= size;
  geometry.normal << mean[0], mean[1];
  geometry.tangents = detail::tangent_frame<T>(geometry.normal);
}

}  // namespace stickslip
