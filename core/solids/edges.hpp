/// Integrals along the sides of elements: consistent shares of areas and loads, in any scalar.
#pragma once

#include <array>
#include <vector>

#include "core/algebra/scalar.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

/// What a length in the plane stands for: area per length is the thickness, or the circumference 2 pi r, r = x.
template <class T>
struct Depth {
  bool of_revolution = false;
  T thickness{1};
  T at(const T& x) const { return of_revolution ? T(2 * std::acos(-1.0)) * x : thickness; }
};

namespace detail {

/// Shape functions of an edge at one point of its quadrature, nodes start, end, middle.
struct EdgePoint {
  double weight;
  std::array<double, 3> value, gradient;
};

inline EdgePoint edge_point(int nodes, double s, double weight) {
  if (nodes == 2) return {weight, {1 - s, s, 0}, {-1, 1, 0}};
  return {weight, {(1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s)}, {4 * s - 3, 4 * s - 1, 4 - 8 * s}};
}

/// Gauss points on [0, 1], as many as make the shares of a straight edge exact.
inline const std::vector<EdgePoint>& edge_quadrature(int nodes, bool of_revolution) {
  static const double two = std::sqrt(1.0 / 12), three = std::sqrt(0.15);
  static const std::vector<EdgePoint> plane{edge_point(2, 0.5, 1)},
      revolved{edge_point(2, 0.5 - two, 0.5), edge_point(2, 0.5 + two, 0.5)},
      quadratic{edge_point(3, 0.5 - three, 5.0 / 18), edge_point(3, 0.5, 8.0 / 18),
                edge_point(3, 0.5 + three, 5.0 / 18)};
  return nodes == 3 ? quadratic : of_revolution ? revolved : plane;
}

}  // namespace detail

/// Calls f(values, tau, area) at each quadrature point of an edge (its two ends, and its middle where it is quadratic):
/// the values N_a of its shape functions, tau, the vector along the edge whose length is the area of the point, and
/// that area, whose derivative exists on the axis of revolution too, where it is zero. So N_a area sums up to the
/// tributary area of node a, and N_a times tau turned right to its share of the vector area (solid on the left of the
/// edge).
template <class T, class F>
void for_each_edge_point(const Points<T>& points, const std::vector<int>& edge, const Depth<T>& depth, F&& f) {
  const int nodes = static_cast<int>(edge.size());
  for (const auto& point : detail::edge_quadrature(nodes, depth.of_revolution)) {
    Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 3, 1> tau(points.rows());
    for (int i = 0; i < points.rows(); ++i) {
      tau[i] = T(0);
      for (int a = 0; a < nodes; ++a) tau[i] += points(i, edge[a]) * T(point.gradient[a]);
    }
    T width = T(point.weight) * depth.thickness;
    if (depth.of_revolution) {
      width = T(0);
      for (int a = 0; a < nodes; ++a)
        width += points(0, edge[a]) * T(2 * std::acos(-1.0) * point.weight * point.value[a]);
    }
    const T area = norm(tau) * width;
    for (int i = 0; i < points.rows(); ++i) tau[i] *= width;
    f(point.value, tau, area);
  }
}

/// Tributary areas of the nodes of an edge.
template <class T>
std::array<T, 3> edge_shares(const Points<T>& points, const std::vector<int>& edge, const Depth<T>& depth) {
  std::array<T, 3> shares{T(0), T(0), T(0)};
  for_each_edge_point(points, edge, depth, [&](const auto& values, const auto&, const T& area) {
    for (std::size_t a = 0; a < edge.size(); ++a) shares[a] += T(values[a]) * area;
  });
  return shares;
}

}  // namespace stickslip
