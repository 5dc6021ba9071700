/// What segments in the plane and overlaps in space integrate for the multiplier of a slave node, and the geometry of
/// its contact point.
#pragma once

#include "core/contact/point_geometry.hpp"
#include "core/contact/surfaces.hpp"

namespace stickslip {

/// Weight of what faces a slave facet, by the cosine c with which their normals oppose one another: 0 at
/// least_against_a_side, 1 from twice that on, s^2 (3 - 2 s) between them, s from 0 to 1. Why: beyond the corner of a
/// block a slave facet that dips below its sole sees the wall, far away. This would lift the mean gap, so that the node
/// lost its force; and if the wall counted at once, the gap would jump as the facet turns.
template <int D, class T>
T weight_of_angle(const Vec<T, D>& slave_normal, const Vec<T, D>& master_normal) {
  const T s = (-dot(slave_normal, master_normal) - T(least_against_a_side)) / T(least_against_a_side);
  return value(s) <= 0 ? T(0) : value(s) >= 1 ? T(1) : T(s * s * (T(3) - T(2) * s));
}

/// Integrals over what one contact point faces.
template <class T, int D>
struct ContactIntegrals {
  T area{};                                                 ///< A_j = int psi dA
  decltype(PointGeometry<T>::weights) weights;              ///< A_j times the weights of w_j
  Vec<T, D> gap = Vec<T, D>::Constant(T(0)), normal = gap;  ///< int psi (x - y) dA, and int psi (n_m - n_s) dA

  /// Geometry of the contact point with the normal n / |n|.
  PointGeometry<T> geometry(const Vec<T, D>& n) const {
    PointGeometry<T> g;
    g.area = area;
    g.weights = weights;
    for (auto& w : g.weights) w /= area;
    const T length = norm(n);
    g.normal.resize(D);
    g.gap = T(0);
    for (int i = 0; i < D; ++i) {
      g.normal[i] = n[i] / length;
      g.gap += gap[i] * g.normal[i];
    }
    g.gap /= area;
    g.tangents = detail::tangent_frame<T>(g.normal);
    return g;
  }
};

}  // namespace stickslip
