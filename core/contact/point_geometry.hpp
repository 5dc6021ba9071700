/// Geometry of one contact point: gap, unit normal out of the master, tangent frame, weights of displacements, area. It
/// is a closed form of coordinates, so dual, complex and reverse scalars differentiate it.
///
/// In 2D the tangent is e = (-n_y, n_x). A facet with the unit tangent tau and the solid on its left has the normal
/// n = (tau_y, -tau_x), so e = tau.
#pragma once

#include "core/algebra/scalar.hpp"

namespace stickslip {

template <class T>
struct PointGeometry {
  T gap{};  ///< normal gap with the offset of the contact, length; negative: penetration
  Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 3, 1> normal;                 ///< unit, out of the master
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 2> tangents;  ///< D x (D-1), orthonormal columns
  /// Weights of the nodal displacements in the relative displacement w. Those of slave nodes sum to 1, those of master
  /// nodes to -1.
  Eigen::Matrix<T, Eigen::Dynamic, 1> weights;
  T area{};  ///< tributary area of the slave node
};

namespace detail {

/// Orthonormal tangents, D x (D-1), of the plane whose unit normal is n.
template <class T, class Normal>
auto tangent_frame(const Normal& n) {
  decltype(PointGeometry<T>::tangents) frame(n.size(), n.size() - 1);
  if (n.size() == 2) {
    frame(0, 0) = -n[1];
    frame(1, 0) = n[0];
    return frame;
  }
  int smallest = 0;  // coordinate axis with the largest angle to n
  for (int i = 1; i < 3; ++i)
    if (std::abs(value(n[i])) < std::abs(value(n[smallest]))) smallest = i;
  Vec<T, 3> first;
  for (int i = 0; i < 3; ++i) first[i] = T(i == smallest ? 1 : 0) - n[smallest] * n[i];
  const T length = norm(first);
  for (int i = 0; i < 3; ++i) first[i] /= length;
  frame.col(0) = first;
  frame.col(1) = cross(Vec<T, 3>(n), first);
  return frame;
}

/// Geometry against a rigid surface: w is the displacement of the slave node alone. The area is left to the caller.
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

/// Geometry of a point that faces no master. Of the `count` slave nodes, w has the displacement of the first alone.
template <class T>
PointGeometry<T> alone(const T& gap, const Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 3, 1>& normal, int count) {
  PointGeometry<T> g = rigid(gap, normal);
  g.weights = decltype(g.weights)::Constant(count, T(0));
  g.weights[0] = T(1);
  return g;
}

}  // namespace detail

}  // namespace stickslip
