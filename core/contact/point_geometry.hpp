/// Geometry of one contact point: gap, unit normal out of the master, frame, weights of displacements, area. Closed
/// forms of coordinates give it, so any scalar differentiates it.
///
/// In 2D the frame is e = (-n_y, n_x): a facet directed a -> b with the solid on its left has n = (tau_y, -tau_x) and
/// e = tau.
#pragma once

#include "core/algebra/scalar.hpp"

namespace stickslip {

template <class T>
struct PointGeometry {
  T gap{};                                                             ///< normal gap, with the offset of the contact
  Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 3, 1> normal;                 ///< unit, out of the master
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 2> tangents;  ///< orthonormal frame, one column each
  Eigen::Matrix<T, Eigen::Dynamic, 1>
      weights;  ///< of the nodes' displacements in w: slave nodes sum to 1, master to -1
  T area{};     ///< tributary area of the slave node
};

namespace detail {

/// Orthonormal frame of the plane normal to n (unit), D x (D-1).
template <class T, class Normal>
auto tangent_frame(const Normal& n) {
  decltype(PointGeometry<T>::tangents) frame(n.size(), n.size() - 1);
  if (n.size() == 2) {
    frame(0, 0) = -n[1];
    frame(1, 0) = n[0];
    return frame;
  }
  int smallest = 0;  // the axis furthest from n
  for (int i = 1; i < 3; ++i)
    if (std::abs(value(n[i])) < std::abs(value(n[smallest]))) smallest = i;
  Vec<T, 3> first;
  for (int i = 0; i < 3; ++i) first[i] = T(i == smallest ? 1 : 0) - n[smallest] * n[i];
  const T length = norm(first);
  for (int i = 0; i < 3; ++i) first[i] /= length;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    frame(i, 0) = first[i];
    frame(i, 1) = n[j] * first[k] - n[k] * first[j];
  }
  return frame;
}

/// Against a place that is rigid: nothing but the slave node moves in w.
template <class T>
PointGeometry<T> rigid(const T& gap, const Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 3, 1>& normal) {
  PointGeometry<T> g;
  g.gap = gap;
  g.normal = normal;
  g.tangents = tangent_frame<T>(normal);
  g.weights.resize(1);
  g.weights[0] = T(1);
  return g;
}

/// Of a point that faces nothing: of its slave's nodes, `count`, its own alone moves in w.
template <class T>
PointGeometry<T> alone(const T& gap, const Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 3, 1>& normal, int count) {
  PointGeometry<T> g = rigid(gap, normal);
  g.weights = decltype(g.weights)::Constant(count, T(0));
  g.weights[0] = T(1);
  return g;
}

}  // namespace detail

}  // namespace stickslip
