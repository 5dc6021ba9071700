/// Axis-parallel block of cells[0] x cells[1] cells; node (i, j) has number j (cells[0] + 1) + i.
/// Sides `bottom right top left`, each from its start to its end counter-clockwise.
#pragma once

#include <string>

#include "core/mesh/structured.hpp"
#include "core/model/scene.hpp"

namespace stickslip {

/// What is wrong with the description, or "".
std::string fault(const BoxMesh&, const std::string& element, int dimension);
Mesh topology(const BoxMesh&, const std::string& element, int dimension);

/// Coordinates, 2 x nodes.
template <class T>
Points<T> coordinates(const BoxMesh& box, const Numbers<T>& numbers, int) {
  // Fractions along one axis; cells grow away from the side `low` or `high`, or not at all.
  auto fractions = [&](int axis, const char* low, const char* high) {
    const bool graded = box.grade_towards == low || box.grade_towards == high;
    std::vector<T> f = graded_fractions(graded ? numbers(box.grade) : T(1.0), box.cells[axis]);
    if (box.grade_towards != high) return f;
    std::vector<T> mirrored;
    for (auto it = f.rbegin(); it != f.rend(); ++it) mirrored.push_back(T(1.0) - *it);
    return mirrored;
  };
  const auto fx = fractions(0, "left", "right"), fy = fractions(1, "bottom", "top");
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
