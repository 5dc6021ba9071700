/// Convex quadrilateral, a bilinear image of a grid (core/mesh/grid.hpp): corner 0 to corner 1 is its bottom, then
/// right, top and left.
#pragma once

#include <string>

#include "core/mesh/descriptions.hpp"
#include "core/mesh/grid.hpp"

namespace stickslip {

/// What is wrong with the description, or "".
std::string fault(const QuadMesh&, const std::string& element, int dimension);
Mesh topology(const QuadMesh&, const std::string& element, int dimension);

/// Coordinates, 2 x nodes.
template <class T>
Points<T> coordinates(const QuadMesh& quad, const Numbers<T>& numbers, int) {
  const T ratio = numbers(quad.grade), one(1.0);
  const auto fx = grid_fractions(quad.cells[0], quad.grade_towards, ratio, "left", "right"),
             fy = grid_fractions(quad.cells[1], quad.grade_towards, ratio, "bottom", "top");
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
