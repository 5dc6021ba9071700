/// Integrals over the sides of elements, edges in the plane and faces in space: consistent shares of areas and loads,
/// in any scalar.
#pragma once

#include <array>
#include <vector>

#include "core/algebra/scalar.hpp"
#include "core/mesh/mesh.hpp"
#include "core/mesh/shapes.hpp"

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

/// Shape functions of a face at one point of its quadrature, nodes counter-clockwise, corners first (sides_of of
/// core/mesh/mesh.hpp), and their derivatives along two directions.
struct FacePoint {
  double weight;
  std::array<double, 9> value, along, across;
};

/// What a plane shape has at a point of it.
template <int nodes>
FacePoint face_point(const ShapePoint<nodes>& at) {
  FacePoint point{at.weight, {}, {}, {}};
  for (int a = 0; a < nodes; ++a) {
    point.value[a] = at.value[a];
    point.along[a] = at.gradient(0, a);
    point.across[a] = at.gradient(1, a);
  }
  return point;
}

/// A face of nine nodes: that of a hexahedron of twenty-seven at z = -1, seen from above.
inline FacePoint point_of_nine_nodes(double x, double y, double weight) {
  static constexpr int node[9] = {0, 1, 2, 3, 8, 9, 10, 11, 24};
  FacePoint point{weight, {}, {}, {}};
  for (int a = 0; a < 9; ++a) {
    const auto& at = hexahedron[node[a]];
    point.value[a] = parabola(at[0], x) * parabola(at[1], y);
    point.along[a] = slope_of_parabola(at[0], x) * parabola(at[1], y);
    point.across[a] = parabola(at[0], x) * slope_of_parabola(at[1], y);
  }
  return point;
}

/// Six points of a triangle, exact for polynomials of degree 4 (D. A. Dunavant, Int. J. Numer. Meth. Engng. 21 (1985)
/// 1129; coordinates and weights in closed form).
inline std::vector<FacePoint> six_points() {
  std::vector<FacePoint> points;
  const double ten = std::sqrt(10.0);
  for (const int sign : {-1, 1}) {
    const double a = (8 - ten + sign * std::sqrt(38 - 44 * std::sqrt(0.4))) / 18, b = 1 - 2 * a;
    const double weight = (620 + sign * std::sqrt(213125 - 53320 * ten)) / 7440;
    for (const auto& [x, y] : {std::pair{a, a}, {b, a}, {a, b}}) points.push_back(face_point(Tri6::at(x, y, weight)));
  }
  return points;
}

/// As many points as make the shares of a flat parallelogram exact, and of a quadratic face, curved or not, the vector
/// of each node: degree 4 in a triangle, 5 along each side of a quadrilateral.
inline const std::vector<FacePoint>& face_quadrature(int nodes) {
  static const std::vector<FacePoint> triangle{{0.5, {1.0 / 3, 1.0 / 3, 1.0 / 3}, {-1, 1}, {-1, 0, 1}}},
      triangle6 = six_points();
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
  static const std::vector<FacePoint> quadrilateral8 = [] {
    std::vector<FacePoint> points;
    for (const auto& point : Quad8::quadrature()) points.push_back(face_point(point));
    return points;
  }();
  static const std::vector<FacePoint> quadrilateral9 = [] {
    std::vector<FacePoint> points;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        points.push_back(point_of_nine_nodes(gauss_at[i], gauss_at[j], gauss_weight[i] * gauss_weight[j]));
    return points;
  }();
  switch (nodes) {
    case 3:
      return triangle;
    case 6:
      return triangle6;
    case 8:
      return quadrilateral8;
    case 9:
      return quadrilateral9;
    default:
      return quadrilateral;
  }
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
/// and its middle where it is quadratic), in space a face (its corners counter-clockwise seen from outside, and its
/// middles where it is quadratic).
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

/// Consistent shares of the nodes of a side of an element in its area, one a node.
template <class T>
Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 9, 1> side_shares(const Points<T>& points, const std::vector<int>& side,
                                                         const Depth<T>& depth) {
  using Shares = Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 9, 1>;
  const auto count = static_cast<Eigen::Index>(side.size());
  Shares shares = Shares::Constant(count, T(0));
  for_each_side_point(points, side, depth, [&](const auto& values, const auto&, const T& area) {
    for (Eigen::Index a = 0; a < count; ++a) shares[a] += T(values[static_cast<std::size_t>(a)]) * area;
  });
  return shares;
}

}  // namespace stickslip
