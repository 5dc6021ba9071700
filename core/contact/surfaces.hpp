/// Geometry of a slave point against facets and vertices, and the normal that two deformable sides share.
#pragma once

#include "core/contact/point_geometry.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Against the facet a -> b (solid on its left); the projection lies on the facet.
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

/// The geometry of a facet or vertex that is rigid: nothing but the slave node moves in w.
template <class T>
PointGeometry<T> fixed(PointGeometry<T> geometry) {
  geometry.weights.conservativeResize(1);
  return geometry;
}

/// Against the vertex v between the facets before -> v and v -> after: the normal is the bisector of the two, so that
/// it depends neither on the numbering nor on the order of the facets.
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

/// Gives a projection that lies just at the end v of the facet v -> `to` half the slope of one that slides along it. On
/// one side of v it does slide along the facet; on the other it rests, or slides along another facet. Half the slope is
/// the mean of both derivatives.
template <class T>
void slide_off(PointGeometry<T>& geometry, const Vec<T, 2>& x, const Vec<T, 2>& v, const Vec<T, 2>& to) {
  const Vec<T, 2> tau = to - v;
  const T half = T(0.5) * dot((x - v).eval(), tau) / dot(tau, tau);
  geometry.weights.conservativeResize(geometry.weights.size() + 1);
  geometry.weights[1] += half;
  geometry.weights[geometry.weights.size() - 1] = -half;
}

/// Outward normal of the slave side at its node: sum over its facets (solid on their left), weighted by length.
template <class T>
Vec<T, 2> slave_normal(const std::vector<std::pair<int, int>>& facets, const Points<T>& points) {
  Vec<T, 2> n = Vec<T, 2>::Constant(T(0));
  for (const auto& [a, b] : facets) {
    n[0] += points(1, b) - points(1, a);
    n[1] -= points(0, b) - points(0, a);
  }
  return n;
}

/// Turns the frame of a point half-way to its slave side: n becomes the bisector of the master normal and the reversed
/// slave normal. `outward`: the slave normal, of any length. Why: with contact geometry fixed at the start, the tangent
/// plane that the two surfaces are about to share is known only up to the angle between them. The bisector is right to
/// second order in that angle and treats both bodies alike. The master normal of a curved pair would turn part of the
/// closing motion into slip: of two cylinders at b/R = 0.085, 3/4 of the slip that friction is to see. The gap is left
/// to the caller: it is that of slave and master place along the new normal.
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
