/// Ball: a core of cells[0]^3 cells that bulges, and around it cells[1] layers of 6 cells[0]^2 cells each, out to the
/// sphere. So cells = [along a quarter of a great circle, layers]. A hollow ball has the layers alone.
///
/// The cells are those of a cube drawn on the sphere, at equal angles along its middle planes. Over all numbers of
/// cells and all grades the corners of the hexahedra keep a volume above 0.55: that of the parallelepiped of unit
/// vectors along the edges, 1 at a right angle. Sides `surface`, and of a hollow ball `inner`.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <tuple>
#include <vector>

#include "core/algebra/described.hpp"
#include "core/mesh/circle.hpp"
#include "core/mesh/structured.hpp"

namespace stickslip {

struct BallMesh {
  static constexpr const char *key = "ball",
                              *about = "in space alone; layers around a core, or a hollow; sides surface, inner",
                              *example = R"({"center": [0, 0, 0], "radius": 1, "cells": [4, 3]})";
  static constexpr Filling filling = Filling::continuum;
  static constexpr bool fills_space = true;
  std::vector<Number> center = std::vector<Number>(3);
  Number radius, inner = 0.0;
  std::array<int, 2> cells{4, 3};
  Number grade = 1.0;

  double cell_count() const;
  static constexpr auto keys() {
    return std::tuple{
        Key{&BallMesh::center, "center", "of the sphere (length)", Place3D{{0, 0, 0}}},
        Key{&BallMesh::radius, "radius", "of the sphere (length)", InRange{Range::positive, 1}},
        Key{&BallMesh::cells, "cells", "along a quarter of a great circle, layers around the core", Counts{{4, 3}}},
        Key{&BallMesh::inner, "inner", "radius of the hollow, less than radius; 0: it is solid (length)",
            IfGiven{Range::not_negative, 0.5}},
        Key{&BallMesh::grade, "grade", "innermost layer over outermost", IfGiven{Range::positive, 4}}};
  }
};

/// What is wrong with the description, or "".
std::string fault(const BallMesh&, const std::string& element, int dimension);
Mesh topology(const BallMesh&, const std::string& element, int dimension);

/// Numbering of the nodes: the core as a grid, then layer by layer those on the surface of the grid, in its order.
struct BallLayout {
  int core, layers;
  bool hollow;
  explicit BallLayout(const BallMesh& ball);
  using Place = std::array<int, 3>;  ///< in the grid, each 0 .. core
  int on_surface() const { return 6 * core * core + 2; }
  int node_count() const {
    return (hollow ? on_surface() : grid_index({core, core, core}) + 1) + layers * on_surface();
  }
  /// Whether a place is on the surface of the grid.
  bool is_outside(const Place& at) const {
    return std::any_of(at.begin(), at.end(), [&](int i) { return i == 0 || i == core; });
  }
  /// Node at a place of the surface of the grid on layer j = 0 .. layers: 0 is the core, or the hollow. Inside of the
  /// grid j is 0, of a solid ball.
  int node(const Place& at, int j) const;

 private:
  int grid_index(const Place& at) const { return (at[2] * (core + 1) + at[1]) * (core + 1) + at[0]; }
  int surface_index(const Place& at) const;
};

namespace detail {

/// Place on the unit sphere of a place on the surface of the cube [-1, 1]^3.
inline Vec<double, 3> on_unit_sphere(const Vec<double, 3>& cube) {
  constexpr double right_angle_over_two = 0.78539816339744830962;
  return (right_angle_over_two * cube.array()).tan().matrix().normalized();
}

/// Place in the core whose middle lines have the half length 1, of a place in the cube [-1, 1]^3. Its edges and corners
/// are drawn in halfway to the sphere, so that cells around them have room.
inline Vec<double, 3> in_core(const Vec<double, 3>& cube) {
  constexpr double drawn_in = 0.5;
  const double size = cube.cwiseAbs().maxCoeff();
  if (size == 0) return cube;
  const double share = drawn_in * size * size;
  return (1 - share) * cube + share * size * on_unit_sphere(cube / size);
}

}  // namespace detail

/// Coordinates, 3 x nodes.
template <class T>
Points<T> coordinates(const BallMesh& ball, const Numbers<T>& numbers, int) {
  const BallLayout layout(ball);
  const int n = layout.core;
  Points<T> points(3, layout.node_count());
  const T radius = numbers(ball.radius), inner = numbers(ball.inner);
  // Half the length of the core's middle lines over the radius: cells of the core and of the layers are about as large,
  // but a core beyond 0.73 would reach through the sphere.
  const double core = std::min(static_cast<double>(n) / (n + 2 * layout.layers), 0.6);
  const std::vector<T> fractions = graded_fractions(T(T(1.0) / numbers(ball.grade)), layout.layers);
  const auto place = [&](int node, const Vec<double, 3>& at, const T& size) {
    for (int axis = 0; axis < 3; ++axis) points(axis, node) = numbers(ball.center[axis]) + size * T(at[axis]);
  };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const BallLayout::Place at{i, j, k};
        const Vec<double, 3> cube(2.0 * i / n - 1, 2.0 * j / n - 1, 2.0 * k / n - 1), from = detail::in_core(cube);
        if (!layout.hollow) place(layout.node(at, 0), core * from, radius);
        if (!layout.is_outside(at)) continue;
        const Vec<double, 3> to = detail::on_unit_sphere(cube);
        if (layout.hollow) place(layout.node(at, 0), to, inner);
        for (int layer = 1; layer <= layout.layers; ++layer) {
          const T f = fractions[layer];
          if (layout.hollow)
            place(layout.node(at, layer), to, (T(1.0) - f) * inner + f * radius);
          else
            for (int axis = 0; axis < 3; ++axis)
              points(axis, layout.node(at, layer)) =
                  numbers(ball.center[axis]) + radius * ((T(1.0) - f) * T(core * from[axis]) + f * T(to[axis]));
        }
      }
  return points;
}

/// Puts the middles of the sides' faces on their spheres, and of a hollow ball those of edges along the layers.
template <class T>
void bend(const BallMesh& ball, const Mesh& mesh, const Numbers<T>& numbers, Points<T>& points) {
  const BallLayout layout(ball);
  const Vec<T, 3> center(numbers(ball.center[0]), numbers(ball.center[1]), numbers(ball.center[2]));
  if (layout.hollow) {
    const auto layer_of = [&](int node) { return node / layout.on_surface(); };
    for (std::size_t k = 0; k < mesh.middles.size(); ++k) {
      const auto& [a, b] = mesh.middles[k];
      if (layer_of(a) == layer_of(b))
        onto_sphere(center, T(norm(Vec<T, 3>(points.col(a)) - center)), layout.node_count() + static_cast<int>(k),
                    points);
    }
    bend_side(mesh.sides.at("inner"), center, numbers(ball.inner), points);
  }
  bend_side(mesh.sides.at("surface"), center, numbers(ball.radius), points);
}

}  // namespace stickslip
