/// Disk: a square core of cells[0] x cells[0] cells, and around it cells[1] rings of 4 cells[0] cells each, out to the
/// arc. So cells = [along a quarter of the arc, rings].
///
/// The core's corners lie on the diagonals, where its cells and those of the rings are about as large; its sides bulge,
/// so that no corner of a cell is flatter than 150 degrees. grade is the size of the innermost ring over that of the
/// outermost. Side `arc`, closed, counter-clockwise from the angle -45 degrees.
#pragma once

#include <array>
#include <string>
#include <tuple>

#include "core/algebra/described.hpp"
#include "core/mesh/circle.hpp"
#include "core/mesh/structured.hpp"

namespace stickslip {

struct DiskMesh {
  static constexpr const char *key = "disk", *about = "rings around a square core; side arc";
  static constexpr Filling filling = Filling::continuum;
  std::array<Number, 2> center;
  Number radius;
  std::array<int, 2> cells{4, 2};
  Number grade = 1.0;

  double cell_count() const { return std::pow(cells[0], 2) + 4 * product(cells); }
  static constexpr auto keys() {
    return std::tuple{
        Key{&DiskMesh::center, "center", "of the circle (length)", Place2D{{0, 0}}},
        Key{&DiskMesh::radius, "radius", "of the circle (length)", InRange{Range::positive, 1}},
        Key{&DiskMesh::cells, "cells", "along a quarter of the arc, rings around the core", Counts{{8, 6}}},
        Key{&DiskMesh::grade, "grade", "innermost ring over outermost", IfGiven{Range::positive, 4}}};
  }
};

/// What is wrong with the description, or "".
std::string fault(const DiskMesh&, const std::string& element, int dimension);
Mesh topology(const DiskMesh&, const std::string& element, int dimension);

/// Numbering of the nodes: the core row by row, then ring by ring.
struct DiskLayout {
  int core, rings;
  explicit DiskLayout(const DiskMesh& disk) : core(disk.cells[0]), rings(disk.cells[1]) {}
  int around() const { return 4 * core; }
  int node_count() const { return (core + 1) * (core + 1) + rings * around(); }
  int inside(int p, int q) const { return q * (core + 1) + p; }
  /// Node l = 0 .. around() - 1, counter-clockwise from the core's corner at -45 degrees, on ring j = 0 .. rings; ring
  /// 0 is the core's edge.
  int ring(int l, int j) const;
};

/// Position on the edge of the core of a unit disk, l as in DiskLayout::ring.
Vec<double, 2> core_edge(const DiskLayout& layout, int l);

/// Coordinates, 2 x nodes.
template <class T>
Points<T> coordinates(const DiskMesh& disk, const Numbers<T>& numbers, int) {
  const DiskLayout layout(disk);
  const int n = layout.core;
  Points<T> points(2, layout.node_count());
  const T radius = numbers(disk.radius);
  auto place = [&](int node, const Vec<T, 2>& at) {
    for (int axis = 0; axis < 2; ++axis) points(axis, node) = numbers(disk.center[axis]) + radius * at[axis];
  };
  auto edge = [&](int l) { return core_edge(layout, l % layout.around()); };
  for (int q = 0; q <= n; ++q)
    for (int p = 0; p <= n; ++p) {  // blended between the four edges
      const double x = static_cast<double>(p) / n, y = static_cast<double>(q) / n;
      const Vec<double, 2> at = (1 - x) * edge(3 * n - q) + x * edge(q) + (1 - y) * edge(3 * n + p) +
                                y * edge(2 * n - p) - (1 - x) * (1 - y) * edge(3 * n) - x * (1 - y) * edge(0) -
                                x * y * edge(n) - (1 - x) * y * edge(2 * n);
      place(layout.inside(p, q), Vec<T, 2>(T(at[0]), T(at[1])));
    }
  const std::vector<T> fractions = graded_fractions(T(T(1.0) / numbers(disk.grade)), layout.rings);
  for (int l = 0; l < layout.around(); ++l) {
    const double angle = std::acos(0.0) * (static_cast<double>(l) / n - 0.5);
    const Vec<double, 2> from = edge(l), to(std::cos(angle), std::sin(angle));
    for (int j = 1; j <= layout.rings; ++j) {
      const T f = fractions[j];
      place(layout.ring(l, j),
            Vec<T, 2>((T(1.0) - f) * T(from[0]) + f * T(to[0]), (T(1.0) - f) * T(from[1]) + f * T(to[1])));
    }
  }
  return points;
}

/// Puts the middles of the arc's edges on the circle.
template <class T>
void bend(const DiskMesh& disk, const Mesh& mesh, const Numbers<T>& numbers, Points<T>& points) {
  bend_side(mesh.sides.at("arc"), disk.center, disk.radius, numbers, points);
}

}  // namespace stickslip
