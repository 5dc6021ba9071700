/// Shape functions and quadrature of the continuum elements: one small struct an element. In the plane nodes are
/// numbered counter-clockwise, corners first, then the middles of the sides in turn (0-1, 1-2, ...). In space they are
/// numbered as in VTK: nodes 0, 1, 2 of a tetrahedron are counter-clockwise seen from node 3; of a hexahedron
/// come first the nodes at z = -1, counter-clockwise seen from above, then those at z = 1. Then come the middles of
/// edges, of faces and of the element (corners_around of core/mesh/mesh.hpp).
///
/// Rules: all stiffness rows that are no rigid motion have rank (tests: continuum_test). Three-node triangles have one
/// point in the plane and three where the circumference turns with r (one would leave a rotation about its point free);
/// eight-node quadrilaterals have 3 x 3: with 2 x 2 a single one has a mode of zero energy. Hexahedra with middles have
/// 3 x 3 x 3: with 2 x 2 x 2, 48 strains, the 54 motions of one of twenty nodes that are not rigid cannot all have
/// energy.
#pragma once

#include <array>

#include "core/algebra/scalar.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Shape functions at a natural coordinate: their weight in the quadrature, gradients with respect to the natural
/// coordinates (one column a node) and values.
template <int n, int D = 2>
struct ShapePoint {
  double weight = 0;
  Mat<double, D, n> gradient;
  Vec<double, n> value;
};

namespace detail {

/// A rule of natural coordinates and weights, evaluated for a shape.
template <class Shape, std::size_t points>
std::array<ShapePoint<Shape::nodes>, points> evaluated(const std::array<std::array<double, 3>, points>& rule) {
  std::array<ShapePoint<Shape::nodes>, points> all;
  for (std::size_t i = 0; i < points; ++i) all[i] = Shape::at(rule[i][0], rule[i][1], rule[i][2]);
  return all;
}

/// Three points of Gauss on [-1, 1], and their weights.
inline const double gauss_at[3] = {-std::sqrt(0.6), 0, std::sqrt(0.6)};
inline constexpr double gauss_weight[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};

/// 3 x 3 x 3 points for a shape.
template <class Shape>
std::array<typename Shape::Point, 27> evaluated_in_hexahedron() {
  std::array<typename Shape::Point, 27> all;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k)
        all[9 * i + 3 * j + k] =
            Shape::at(gauss_at[i], gauss_at[j], gauss_at[k], gauss_weight[i] * gauss_weight[j] * gauss_weight[k]);
  return all;
}

/// Natural coordinates of the nodes of a hexahedron: corners, edges, faces, the middle.
inline constexpr int hexahedron[27][3] = {
    {-1, -1, -1}, {1, -1, -1}, {1, 1, -1},  {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1},  {-1, 1, 1},  {0, -1, -1},
    {1, 0, -1},   {0, 1, -1},  {-1, 0, -1}, {0, -1, 1},  {1, 0, 1},   {0, 1, 1},  {-1, 0, 1}, {-1, -1, 0}, {1, -1, 0},
    {1, 1, 0},    {-1, 1, 0},  {-1, 0, 0},  {1, 0, 0},   {0, -1, 0},  {0, 1, 0},  {0, 0, -1}, {0, 0, 1},   {0, 0, 0}};

/// The parabola that is 1 at a node -1, 0 or 1 and 0 at the two others, and its slope.
constexpr double parabola(int node, double x) { return node == 0 ? 1 - x * x : 0.5 * x * (x + node); }
constexpr double slope_of_parabola(int node, double x) { return node == 0 ? -2 * x : x + 0.5 * node; }

/// Three inner points, exact for polynomials of degree 2.
inline std::array<std::array<double, 3>, 3> three_points() {
  constexpr double a = 1.0 / 6, b = 2.0 / 3;
  return {{{a, a, a}, {b, a, a}, {a, b, a}}};
}

}  // namespace detail

/// Three-node triangle, one point (exact for a constant strain).
struct Tri3 {
  static constexpr int nodes = 3, corners = 3, dimension = 2;
  static constexpr bool is_simplex = true;
  using Point = ShapePoint<nodes>;
  static Point at(double x, double y, double weight) {
    Point p;
    p.weight = weight;
    p.gradient << -1, 1, 0, -1, 0, 1;
    p.value << 1 - x - y, x, y;
    return p;
  }
  static std::array<Point, 1> quadrature() { return {at(1.0 / 3, 1.0 / 3, 0.5)}; }
  static std::array<Point, 3> quadrature_of_revolution() { return detail::evaluated<Tri3>(detail::three_points()); }
};

/// Four-node quadrilateral, 2 x 2 points.
struct Quad4 {
  static constexpr int nodes = 4, corners = 4, dimension = 2;
  static constexpr bool is_simplex = false;
  using Point = ShapePoint<nodes>;
  static Point at(double x, double y, double weight) {
    static constexpr double sx[4] = {-1, 1, 1, -1}, sy[4] = {-1, -1, 1, 1};
    Point p;
    p.weight = weight;
    for (int a = 0; a < 4; ++a) {
      p.gradient(0, a) = 0.25 * sx[a] * (1 + sy[a] * y);
      p.gradient(1, a) = 0.25 * sy[a] * (1 + sx[a] * x);
      p.value[a] = 0.25 * (1 + sx[a] * x) * (1 + sy[a] * y);
    }
    return p;
  }
  static std::array<Point, 4> quadrature() {
    const double g = 1 / std::sqrt(3.0);
    return {{at(-g, -g, 1), at(g, -g, 1), at(g, g, 1), at(-g, g, 1)}};
  }
  static std::array<Point, 4> quadrature_of_revolution() { return quadrature(); }
};

/// Six-node triangle, three points.
struct Tri6 {
  static constexpr int nodes = 6, corners = 3, dimension = 2;
  static constexpr bool is_simplex = true;
  using Point = ShapePoint<nodes>;
  static Point at(double x, double y, double weight) {
    const double l[3] = {1 - x - y, x, y}, dx[3] = {-1, 1, 0}, dy[3] = {-1, 0, 1};
    Point p;
    p.weight = weight;
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3;
      p.value[a] = l[a] * (2 * l[a] - 1);
      p.gradient(0, a) = (4 * l[a] - 1) * dx[a];
      p.gradient(1, a) = (4 * l[a] - 1) * dy[a];
      p.value[3 + a] = 4 * l[a] * l[b];
      p.gradient(0, 3 + a) = 4 * (l[a] * dx[b] + l[b] * dx[a]);
      p.gradient(1, 3 + a) = 4 * (l[a] * dy[b] + l[b] * dy[a]);
    }
    return p;
  }
  static std::array<Point, 3> quadrature() { return detail::evaluated<Tri6>(detail::three_points()); }
  static std::array<Point, 3> quadrature_of_revolution() { return quadrature(); }
};

/// Eight-node quadrilateral (serendipity), 3 x 3 points.
struct Quad8 {
  static constexpr int nodes = 8, corners = 4, dimension = 2;
  static constexpr bool is_simplex = false;
  using Point = ShapePoint<nodes>;
  static Point at(double x, double y, double weight) {
    static constexpr double sx[4] = {-1, 1, 1, -1}, sy[4] = {-1, -1, 1, 1};
    Point p;
    p.weight = weight;
    for (int a = 0; a < 4; ++a) {
      const double u = 1 + sx[a] * x, v = 1 + sy[a] * y;
      p.value[a] = 0.25 * u * v * (u + v - 3);
      p.gradient(0, a) = 0.25 * sx[a] * v * (2 * u + v - 3);
      p.gradient(1, a) = 0.25 * sy[a] * u * (u + 2 * v - 3);
      const bool along_x = a % 2 == 0;  // sides 0 and 2 run along x, at y = sy
      const double side = along_x ? sy[a] : sx[(a + 1) % 4], s = along_x ? x : y, t = along_x ? y : x;
      p.value[4 + a] = 0.5 * (1 - s * s) * (1 + side * t);
      p.gradient(along_x ? 0 : 1, 4 + a) = -s * (1 + side * t);
      p.gradient(along_x ? 1 : 0, 4 + a) = 0.5 * side * (1 - s * s);
    }
    return p;
  }
  static std::array<Point, 9> quadrature() {
    const double at[3] = {-std::sqrt(0.6), 0, std::sqrt(0.6)}, weight[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
    std::array<std::array<double, 3>, 9> rule;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) rule[3 * i + j] = {at[i], at[j], weight[i] * weight[j]};
    return detail::evaluated<Quad8>(rule);
  }
  static std::array<Point, 9> quadrature_of_revolution() { return quadrature(); }
};

/// Four-node tetrahedron, one point (exact for a constant strain).
struct Tet4 {
  static constexpr int nodes = 4, corners = 4, dimension = 3;
  static constexpr bool is_simplex = true;
  using Point = ShapePoint<nodes, dimension>;
  static Point at(double x, double y, double z, double weight) {
    Point p;
    p.weight = weight;
    p.gradient << -1, 1, 0, 0, -1, 0, 1, 0, -1, 0, 0, 1;
    p.value << 1 - x - y - z, x, y, z;
    return p;
  }
  static std::array<Point, 1> quadrature() { return {at(0.25, 0.25, 0.25, 1.0 / 6)}; }
};

/// Eight-node hexahedron, 2 x 2 x 2 points.
struct Hex8 {
  static constexpr int nodes = 8, corners = 8, dimension = 3;
  static constexpr bool is_simplex = false;
  using Point = ShapePoint<nodes, dimension>;
  static Point at(double x, double y, double z, double weight) {
    static constexpr double sx[8] = {-1, 1, 1, -1, -1, 1, 1, -1}, sy[8] = {-1, -1, 1, 1, -1, -1, 1, 1},
                            sz[8] = {-1, -1, -1, -1, 1, 1, 1, 1};
    Point p;
    p.weight = weight;
    for (int a = 0; a < nodes; ++a) {
      const double u = 1 + sx[a] * x, v = 1 + sy[a] * y, w = 1 + sz[a] * z;
      p.gradient(0, a) = 0.125 * sx[a] * v * w;
      p.gradient(1, a) = 0.125 * sy[a] * u * w;
      p.gradient(2, a) = 0.125 * sz[a] * u * v;
      p.value[a] = 0.125 * u * v * w;
    }
    return p;
  }
  static std::array<Point, 8> quadrature() {
    const double g = 1 / std::sqrt(3.0);
    std::array<Point, 8> points;
    for (int q = 0; q < 8; ++q) points[q] = at(q & 1 ? g : -g, q & 2 ? g : -g, q & 4 ? g : -g, 1);
    return points;
  }
};

/// Ten-node tetrahedron, four points (exact for polynomials of degree 2).
struct Tet10 {
  static constexpr int nodes = 10, corners = 4, dimension = 3;
  static constexpr bool is_simplex = true;
  using Point = ShapePoint<nodes, dimension>;
  static Point at(double x, double y, double z, double weight) {
    static constexpr int ends[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
    static constexpr double slope[4][3] = {{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const double l[4] = {1 - x - y - z, x, y, z};
    Point p;
    p.weight = weight;
    for (int a = 0; a < corners; ++a) {
      p.value[a] = l[a] * (2 * l[a] - 1);
      for (int i = 0; i < 3; ++i) p.gradient(i, a) = (4 * l[a] - 1) * slope[a][i];
    }
    for (int k = 0; k < 6; ++k) {
      const auto [a, b] = ends[k];
      p.value[4 + k] = 4 * l[a] * l[b];
      for (int i = 0; i < 3; ++i) p.gradient(i, 4 + k) = 4 * (l[a] * slope[b][i] + l[b] * slope[a][i]);
    }
    return p;
  }
  static std::array<Point, 4> quadrature() {
    const double b = (5 - std::sqrt(5.0)) / 20, a = 1 - 3 * b, weight = 1.0 / 24;
    return {at(b, b, b, weight), at(a, b, b, weight), at(b, a, b, weight), at(b, b, a, weight)};
  }
};

/// Twenty-node hexahedron (serendipity), 3 x 3 x 3 points.
struct Hex20 {
  static constexpr int nodes = 20, corners = 8, dimension = 3;
  static constexpr bool is_simplex = false;
  using Point = ShapePoint<nodes, dimension>;
  static Point at(double x, double y, double z, double weight) {
    const double place[3] = {x, y, z};
    Point p;
    p.weight = weight;
    for (int a = 0; a < nodes; ++a) {
      double f[3], df[3], sum = -2;  // factors, and of a corner what is left
      for (int i = 0; i < 3; ++i) {
        const int s = detail::hexahedron[a][i];
        f[i] = s == 0 ? 1 - place[i] * place[i] : 0.5 * (1 + s * place[i]);
        df[i] = s == 0 ? -2 * place[i] : 0.5 * s;
        sum += s * place[i];
      }
      const bool is_corner = a < corners;
      p.value[a] = f[0] * f[1] * f[2] * (is_corner ? sum : 1);
      for (int i = 0; i < 3; ++i) {
        const double others = f[(i + 1) % 3] * f[(i + 2) % 3];
        p.gradient(i, a) = others * (is_corner ? df[i] * sum + f[i] * detail::hexahedron[a][i] : df[i]);
      }
    }
    return p;
  }
  static std::array<Point, 27> quadrature() { return detail::evaluated_in_hexahedron<Hex20>(); }
};

/// Twenty-seven-node hexahedron, 3 x 3 x 3 points.
struct Hex27 {
  static constexpr int nodes = 27, corners = 8, dimension = 3;
  static constexpr bool is_simplex = false;
  using Point = ShapePoint<nodes, dimension>;
  static Point at(double x, double y, double z, double weight) {
    const double place[3] = {x, y, z};
    Point p;
    p.weight = weight;
    for (int a = 0; a < nodes; ++a) {
      double f[3], df[3];
      for (int i = 0; i < 3; ++i) {
        f[i] = detail::parabola(detail::hexahedron[a][i], place[i]);
        df[i] = detail::slope_of_parabola(detail::hexahedron[a][i], place[i]);
      }
      p.value[a] = f[0] * f[1] * f[2];
      for (int i = 0; i < 3; ++i) p.gradient(i, a) = df[i] * f[(i + 1) % 3] * f[(i + 2) % 3];
    }
    return p;
  }
  static std::array<Point, 27> quadrature() { return detail::evaluated_in_hexahedron<Hex27>(); }
};

/// Natural coordinates of node a of an element of space.
template <class Shape>
Vec<double, 3> natural_node(int a) {
  if constexpr (!Shape::is_simplex) {
    return {double(detail::hexahedron[a][0]), double(detail::hexahedron[a][1]), double(detail::hexahedron[a][2])};
  } else {
    const auto corner = [](int k) { return Vec<double, 3>(k == 1, k == 2, k == 3); };
    constexpr int ends[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
    return a < 4 ? corner(a) : Vec<double, 3>((corner(ends[a - 4][0]) + corner(ends[a - 4][1])) / 2);
  }
}

/// Values at the nodes of an element, one column a node.
template <class T, class Shape>
using Nodal = Mat<T, Shape::dimension, Shape::nodes>;

/// Natural coordinates of a corner of a plane element, counted on beyond the last from the first.
template <class Shape>
Vec<double, 2> natural_corner(int corner) {
  const int k = corner % Shape::corners;
  if (Shape::corners == 3) return {k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
  return {k == 1 || k == 2 ? 1.0 : -1.0, k >= 2 ? 1.0 : -1.0};
}

/// Calls f(Shape{}) with the continuum shape of a mesh; not at all for points and bars.
template <class F>
void with_shape(ElementShape shape, F&& f) {
  switch (shape) {
    case ElementShape::point:
    case ElementShape::bar2:
      return;
    case ElementShape::tri3:
      return f(Tri3{});
    case ElementShape::quad4:
      return f(Quad4{});
    case ElementShape::tri6:
      return f(Tri6{});
    case ElementShape::quad8:
      return f(Quad8{});
    case ElementShape::tet4:
      return f(Tet4{});
    case ElementShape::hex8:
      return f(Hex8{});
    case ElementShape::tet10:
      return f(Tet10{});
    case ElementShape::hex20:
      return f(Hex20{});
    case ElementShape::hex27:
      return f(Hex27{});
  }
}

}  // namespace stickslip
