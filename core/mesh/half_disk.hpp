/// Half disk, all quadrilaterals, fine at the pole of its arc and coarse at its diameter.
///
/// A block sits on the arc around the pole, and rings of cells grow from it to the diameter:
///
///     flat  +-----+----+----+-----+        along the arc, pole to end:    block_width + rings = cells[0]
///            \  \  \   |   /  /  /         along the axis, pole to centre: block_height + rings = cells[1]
///             \   ------------  /
///               \ |  block  | /            (shown facing down)
///                  ----+----
///                    pole
///
/// The rays between block and diameter spread about as fast as the rings thicken, so a strong grading makes no flat
/// cells. Over all grades from 1 to 100 the corners of all cells keep a sine above 0.6 with as many cells along the arc
/// as along the axis, and above 0.3 with up to twice as many (0.08 where the lesser count is 2).
/// Sides `arc` and `flat`, counter-clockwise; a half disk facing up is the mirror image of one facing down, node by
/// node.
#pragma once

#include <array>
#include <string>
#include <tuple>
#include <vector>

#include "core/algebra/described.hpp"
#include "core/mesh/circle.hpp"
#include "core/mesh/structured.hpp"

namespace stickslip {

/// The arc points where it faces. Graded towards the pole of the arc.
struct HalfDiskMesh {
  static constexpr const char *key = "half_disk", *about = "fine at the pole of its arc; sides arc, flat",
                              *example = R"({"center": [0, 1], "radius": 1, "cells": [20, 20], "grade": 10})";
  static constexpr Filling filling = Filling::continuum;
  enum class Facing { down, up };
  std::array<Number, 2> center;
  Number radius;
  std::array<int, 2> cells{8, 8};
  Number grade = 1.0;
  Facing facing = Facing::down;

  double cell_count() const { return std::pow(cells[0], 2) / 2 + 2 * product(cells); }
  static constexpr auto keys() {
    return std::tuple{
        Key{&HalfDiskMesh::center, "center", "middle of the flat side (length)", Place2D{{0, 1}}},
        Key{&HalfDiskMesh::radius, "radius", "of the circle (length)", InRange{Range::positive, 1}},
        Key{&HalfDiskMesh::cells, "cells", "along a quarter of the arc, from the arc to the centre", Counts{{20, 20}}},
        Key{&HalfDiskMesh::grade, "grade", "largest cell over smallest along the arc, smallest at the pole",
            IfGiven{Range::positive, 10}},
        Key{&HalfDiskMesh::facing, "facing", "where the arc points to", std::array{"down", "up"}}};
  }
};

/// What is wrong with the description, or "".
std::string fault(const HalfDiskMesh&, const std::string& element, int dimension);
Mesh topology(const HalfDiskMesh&, const std::string& element, int dimension);

/// Numbering of the nodes: block rows from the arc inwards, then ring by ring.
struct HalfDiskLayout {
  int width, height, rings;  ///< cells: half width and height of the block, number of rings
  explicit HalfDiskLayout(const HalfDiskMesh&);
  int quarter() const { return width + height; }  ///< cells of a ring from the arc to the axis
  int node_count() const { return (2 * width + 1) * (height + 1) + rings * (2 * quarter() + 1); }
  /// Node p = -width .. width along the arc, q = 0 .. height inwards.
  int block(int p, int q) const { return q * (2 * width + 1) + p + width; }
  /// Node l = 0 .. 2 quarter() around the block, counter-clockwise, on ring j = 0 .. rings; ring 0 is the block's edge.
  int ring(int l, int j) const;
};

/// The block's inner corner, across the axis and along it from the pole, of unit radius. `on_arc`: where its edge
/// begins, at the angle `opening` from the pole; `height`: of the block along the axis.
template <class T>
Vec<T, 2> inner_corner(const Vec<T, 2>& on_arc, const T& opening, const T& height) {
  using std::cos, std::pow, std::sin;
  // A little less than its height away from the arc, leaning to the axis. The numbers 0.2, 0.8, 1.1, 0.4 are those that
  // keep the worst corner of all cells best over grades 1 to 100 and counts 1:2 to 2:1.
  const T lean = T(0.2) + opening * T(0.8), reach = height * (T(1.1) - opening * T(0.4));
  // a block much higher than wide leans no further than its width allows: a smooth minimum
  const T wanted = reach * sin(lean), inwards = wanted / pow(T(1.0) + pow(wanted / (on_arc[0] * T(0.6)), 8.0), 0.125);
  return on_arc + Vec<T, 2>(-inwards, reach * cos(lean));
}

/// Coordinates, 2 x nodes.
template <class T>
Points<T> coordinates(const HalfDiskMesh& disk, const Numbers<T>& numbers, int) {
  using std::sin;
  using Position = Vec<T, 2>;  // across the axis, and along it from the pole to the centre; unit radius
  const HalfDiskLayout layout(disk);
  const int width = layout.width, height = layout.height, quarter = layout.quarter();
  const T grade = numbers(disk.grade), right_angle(std::acos(0.0));
  const std::vector<T> along = graded_fractions(grade, disk.cells[0]), axis = graded_fractions(grade, disk.cells[1]);
  auto arc = [&](int i) {
    const T half = right_angle * along[i] * T(0.5);
    return Position(sin(half * T(2.0)), sin(half) * sin(half) * T(2.0));  // 1 - cos without cancellation
  };

  const Position on_arc = arc(width), on_axis(T(0.0), axis[height]), end(T(1.0), T(1.0));
  const Position corner = inner_corner<T>(on_arc, right_angle * along[width], axis[height]);

  Points<T> points(2, layout.node_count());
  const T radius = numbers(disk.radius), up(disk.facing == HalfDiskMesh::Facing::up ? -1.0 : 1.0);
  auto place = [&](int node, const Position& at, double side) {
    points(0, node) = numbers(disk.center[0]) + radius * at[0] * T(side);
    points(1, node) = numbers(disk.center[1]) + radius * (at[1] - T(1.0)) * up;
  };

  // Block, right half: blended between arc, axis, the edge from arc to corner, and a parabola (level at the axis).
  std::vector<std::vector<Position>> block(width + 1, std::vector<Position>(height + 1));
  for (int p = 0; p <= width; ++p)
    for (int q = 0; q <= height; ++q) {
      const T x = along[p] / along[width], y = axis[q] / axis[height], x0 = T(1.0) - x, y0 = T(1.0) - y;
      const Position inner(corner[0] * x, on_axis[1] + (corner[1] - on_axis[1]) * x * x);
      const Position edge = on_arc + (corner - on_arc) * y;
      block[p][q] = arc(p) * y0 + inner * y + on_axis * (y * x0) + edge * x -
                    (on_axis * (x0 * y) + on_arc * (x * y0) + corner * (x * y));
      for (double side : {1.0, -1.0}) place(layout.block(side > 0 ? p : -p, q), block[p][q], side);
    }

  // Rings, right half: straight rays to equal steps on the diameter, bent near the arc to follow it.
  for (int l = 0; l <= quarter; ++l) {
    const T s(static_cast<double>(l) / quarter), s0 = T(1.0) - s;
    const Position from = l <= height ? block[width][l] : block[quarter - l][height], to(s0, T(1.0));
    for (int j = 1; j <= layout.rings; ++j) {
      const T at_arc = (along[width + j] - along[width]) / (T(1.0) - along[width]);
      const T at_axis = (axis[height + j] - axis[height]) / (T(1.0) - axis[height]);
      const Position bulge = arc(width + j) - (on_arc + (end - on_arc) * at_arc);
      const Position at = from + (to - from) * T(s0 * at_arc + s * at_axis) + bulge * T(s0 * s0);
      for (double side : {1.0, -1.0}) place(layout.ring(side > 0 ? l : 2 * quarter - l, j), at, side);
    }
  }
  return points;
}

/// Puts the middles of the arc's edges on the circle.
template <class T>
void bend(const HalfDiskMesh& disk, const Mesh& mesh, const Numbers<T>& numbers, Points<T>& points) {
  bend_side(mesh.sides.at("arc"), disk.center, disk.radius, numbers, points);
}

}  // namespace stickslip
