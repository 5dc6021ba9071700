/// Convex quadrilateral, a bilinear image of a grid (core/mesh/structured.hpp): corner 0 to corner 1 is its bottom,
/// then right, top and left.
#pragma once

#include <array>
#include <string>
#include <tuple>

#include "core/algebra/described.hpp"
#include "core/mesh/structured.hpp"

namespace stickslip {

/// Sides and grading as a box.
struct QuadMesh {
  static constexpr const char *key = "quad", *about =
                                                 "a quadrilateral; sides bottom (from its first corner to the "
                                                 "second), right, top, left";
  static constexpr Filling filling = Filling::continuum;
  std::array<std::array<Number, 2>, 4> corners;
  std::array<int, 2> cells{1, 1};
  std::vector<Grading> grade;

  double cell_count() const { return product(cells); }
  static constexpr auto keys() {
    return std::tuple{
        Key{&QuadMesh::corners, "corners", "counter-clockwise (length)", Corners2D{{{{0, 0}, {4, 0}, {3, 2}, {1, 2}}}}},
        Key{&QuadMesh::cells, "cells", "along bottom and top, along left and right", Counts{{16, 8}}},
        Key{&QuadMesh::grade, "grade", "as of a box", Grade{grid_sides, 8}}};
  }
};

/// What is wrong with the description, or "".
std::string fault(const QuadMesh&, const std::string& element, int dimension);
Mesh topology(const QuadMesh&, const std::string& element, int dimension);

/// Coordinates, 2 x nodes.
template <class T>
Points<T> coordinates(const QuadMesh& quad, const Numbers<T>& numbers, int) {
  const T one(1.0);
  const auto fx = grid_fractions(quad.cells[0], quad.grade, numbers, "left", "right"),
             fy = grid_fractions(quad.cells[1], quad.grade, numbers, "bottom", "top");
  Points<T> points(2, fx.size() * fy.size());
  int node = 0;
  for (const T& y : fy)
    for (const T& x : fx) {
      for (int axis = 0; axis < 2; ++axis) {
        auto corner = [&](int k) { return numbers(quad.corners[k][axis]); };
        points(axis, node) =
            (one - y) * ((one - x) * corner(0) + x * corner(1)) + y * ((one - x) * corner(3) + x * corner(2));
      }
      ++node;
    }
  return points;
}

}  // namespace stickslip
