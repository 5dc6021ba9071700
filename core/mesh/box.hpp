/// Axis-parallel block of cells[0] x cells[1] cells, numbered as a grid (core/mesh/grid.hpp).
#pragma once

#include <string>

#include "core/mesh/descriptions.hpp"
#include "core/mesh/grid.hpp"

namespace stickslip {

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
