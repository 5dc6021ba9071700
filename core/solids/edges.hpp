/// Integrals over the sides of elements, edges in the plane and faces in space: consistent shares of areas and loads,
/// in any scalar.
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

namespace detail {

/// Shape functions of a face at one point of its quadrature, nodes counter-clockwise, and their derivatives along two
/// directions.
struct FacePoint {
  double weight;
  std::array<double, 4> value, along, across;
};

/// As many points as make the shares of a flat parallelogram exact.
inline const std::vector<FacePoint>& face_quadrature(int nodes) {
  static const std::vector<FacePoint> triangle{{0.5, {1.0 / 3, 1.0 / 3, 1.0 / 3, 0}, {-1, 1, 0, 0}, {-1, 0, 1, 0}}};
  static const std::vector<FacePoint> quadrilateral = [] {
    static constexpr double sx[4] = {-1, 1, 1, -1}, sy[4] = {-1, -1, 1, 1};
    std::vector<FacePoint> points;
    for (int q = 0; q < 4; ++q) {
      const double x = sx[q] / std::sqrt(3.0), y = sy[q] / std::sqrt(3.0);
      FacePoint point{1, {}, {}, {}};
      for (int a = 0; a < 4; ++a) {
        point.value[a] = 0.25 * (1 + sx[a] * x) * (1 + sy[a] * y);
        point.along[a] = 0.25 * sx[a] * (1 + sy[a] * y);
        point.across[a] = 0.25 * sy[a] * (1 + sx[a] * x);
      }
      points.push_back(point);
    }
    return points;
  }();
  return nodes == 3 ? triangle : quadrilateral;
}

template <class T>
using AreaVector = Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 3, 1>;

template <class T, class F>
void for_each_edge_point(const Points<T>& points, const std::vector<int>& edge, const Depth<T>& depth, F&& f) {
  const int nodes = static_cast<int>(edge.size());
  for (const auto& point : detail::edge_quadrature(nodes, depth.of_revolution)) {
    AreaVector<T> tau(points.rows());
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
    AreaVector<T> outward = tau;  // (of an edge in space, a bar, it has no meaning)
    if (points.rows() == 2) outward << tau[1], -tau[0];
    f(point.value, outward, area);
  }
}

template <class T, class F>
void for_each_face_point(const Points<T>& points, const std::vector<int>& face, F&& f) {
  const int nodes = static_cast<int>(face.size());
  for (const auto& point : face_quadrature(nodes)) {
    Vec<T, 3> along = Vec<T, 3>::Constant(T(0)), across = along;
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < 3; ++i) {
        along[i] += points(i, face[a]) * T(point.along[a]);
        across[i] += points(i, face[a]) * T(point.across[a]);
      }
    AreaVector<T> outward = cross(along, across);
    for (int i = 0; i < 3; ++i) outward[i] *= T(point.weight);
    const T area = norm(outward);
    f(point.value, outward, area);
  }
}

}  // namespace detail

/// Calls f(values, outward, area) at each quadrature point of a side of an element: in the plane an edge (its two ends,
/// and its middle where it is quadratic), in space a face (its corners counter-clockwise seen from outside).
///
///   values   of the shape functions N_a
///   outward  the vector area of the point, out of the element
///   area     its length, whose derivative exists on the axis of revolution too, where it is zero
///
/// So N_a area sums up to the tributary area of node a. `depth`: unread of a face.
template <class T, class F>
void for_each_side_point(const Points<T>& points, const std::vector<int>& side, const Depth<T>& depth, F&& f) {
  if (points.rows() == 3 && side.size() > 2)
    detail::for_each_face_point(points, side, f);
  else
    detail::for_each_edge_point(points, side, depth, f);
}

/// Tributary areas of the nodes of a side of an element.
template <class T>
std::array<T, 4> side_shares(const Points<T>& points, const std::vector<int>& side, const Depth<T>& depth) {
  std::array<T, 4> shares{T(0), T(0), T(0), T(0)};
  for_each_side_point(points, side, depth, [&](const auto& values, const auto&, const T& area) {
    for (std::size_t a = 0; a < side.size(); ++a) shares[a] += T(values[a]) * area;
  });
  return shares;
}

}  // namespace stickslip
