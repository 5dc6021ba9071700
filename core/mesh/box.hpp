/// Block along the axes, in the plane or in space, numbered as a grid (core/mesh/structured.hpp).
#pragma once

#include <array>
#include <string>
#include <tuple>

#include "core/algebra/described.hpp"
#include "core/mesh/structured.hpp"

namespace stickslip {

/// Sides left right bottom top; in space left right along x, front back along y, bottom top along z. Along each axis
/// cells may be graded towards one of the two sides.
struct BoxMesh {
  static constexpr const char *key = "box", *about =
                                                "a rectangle; sides left, right, bottom, top; in space a block, with "
                                                "front and back too";
  static constexpr Filling filling = Filling::continuum;
  static constexpr bool fills_space = true;
  static constexpr std::array sides{"left", "right", "bottom", "top", "front", "back"};
  std::vector<Number> min = std::vector<Number>(2), max = min;  ///< as many coordinates as axes
  std::vector<int> cells{1, 1};                                 ///< likewise
  std::vector<Grading> grade;

  double cell_count() const { return product(cells); }
  static constexpr auto keys() {
    return std::tuple{
        Key{&BoxMesh::min, "min", "lower left (front) corner (length)", Place2D{{0, 0}}},
        Key{&BoxMesh::max, "max", "upper right (back) corner (length)", Place2D{{4, 2}}},
        Key{&BoxMesh::cells, "cells", "along x, along y, in space along z", Counts{{16, 8}}},
        Key{&BoxMesh::grade, "grade",
            "largest cell over smallest, smallest at the side that is named; one side along each axis (left out: "
            "all alike)",
            Grade{sides, 8}}};
  }
};

/// What is wrong with the description, or "".
std::string fault(const BoxMesh&, const std::string& element, int dimension);
Mesh topology(const BoxMesh&, const std::string& element, int dimension);

/// Names of the sides at the low and at the high end of an axis.
inline std::array<const char*, 2> box_sides(int axis, int dimension) {
  if (axis == 0) return {"left", "right"};
  if (axis == dimension - 1) return {"bottom", "top"};
  return {"front", "back"};
}

/// Coordinates, dimension x nodes.
template <class T>
Points<T> coordinates(const BoxMesh& box, const Numbers<T>& numbers, int dimension) {
  std::vector<std::vector<T>> fractions;
  Eigen::Index count = 1;
  for (int axis = 0; axis < dimension; ++axis) {
    const auto [low, high] = box_sides(axis, dimension);
    fractions.push_back(grid_fractions(box.cells[axis], box.grade, numbers, low, high));
    count *= static_cast<Eigen::Index>(fractions.back().size());
  }
  // both ends weighted, so that each is met exactly
  auto between = [&](int axis, const T& f) {
    return (T(1.0) - f) * numbers(box.min[axis]) + f * numbers(box.max[axis]);
  };
  Points<T> points(dimension, count);
  for (Eigen::Index node = 0; node < count; ++node) {
    Eigen::Index rest = node;
    for (int axis = 0; axis < dimension; ++axis) {
      const auto along = static_cast<Eigen::Index>(fractions[axis].size());
      points(axis, node) = between(axis, fractions[axis][rest % along]);
      rest /= along;
    }
  }
  return points;
}

}  // namespace stickslip
