/// Axis-parallel block of cells[0] x cells[1] cells, numbered as a grid (core/mesh/grid.hpp).
#pragma once

#include <array>
#include <string>
#include <tuple>

#include "core/algebra/described.hpp"
#include "core/mesh/grid.hpp"

namespace stickslip {

/// Sides left right bottom top. `grade` > 1 makes cells grow away from the side named in `grade_towards` by that total
/// ratio (largest cell / smallest cell).
struct BoxMesh {
  static constexpr const char *key = "box", *about = "a rectangle; sides left, right, bottom, top";
  static constexpr Filling filling = Filling::continuum;
  std::array<Number, 2> min, max;
  std::array<int, 2> cells{1, 1};
  std::string grade_towards;  ///< empty: uniform
  Number grade = 1.0;

  double cell_count() const { return product(cells); }
  static constexpr auto keys() {
    return std::tuple{Key{&BoxMesh::min, "min", "lower left corner (length)", Place2D{{0, 0}}},
                      Key{&BoxMesh::max, "max", "upper right corner (length)", Place2D{{4, 2}}},
                      Key{&BoxMesh::cells, "cells", "along x, along y", Counts{{16, 8}}},
                      Key{&BoxMesh::grade, "grade",
                          "largest cell over smallest, smallest at the side that is named (left out: all alike)",
                          Grade{&BoxMesh::grade_towards, grid_sides, 8}}};
  }
};

/// What is wrong with the description, or "".
std::string fault(const BoxMesh&, const std::string& element, int dimension);
Mesh topology(const BoxMesh&, const std::string& element, int dimension);

/// Coordinates, 2 x nodes.
template <class T>
Points<T> coordinates(const BoxMesh& box, const Numbers<T>& numbers, int) {
  const T ratio = numbers(box.grade);
  const auto fx = grid_fractions(box.cells[0], box.grade_towards, ratio, "left", "right"),
             fy = grid_fractions(box.cells[1], box.grade_towards, ratio, "bottom", "top");
  // both ends weighted, so that each is met exactly
  auto between = [&](int axis, const T& f) {
    return (T(1.0) - f) * numbers(box.min[axis]) + f * numbers(box.max[axis]);
  };
  Points<T> points(2, fx.size() * fy.size());
  int node = 0;
  for (const T& y : fy)
    for (const T& x : fx) {
      points(0, node) = between(0, x);
      points(1, node++) = between(1, y);
    }
  return points;
}

}  // namespace stickslip
