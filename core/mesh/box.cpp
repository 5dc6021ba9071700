#include "core/mesh/box.hpp"

namespace stickslip {

std::string fault(const BoxMesh& box, const std::string& element, int dimension) {
  const auto axes = static_cast<std::size_t>(dimension);
  if (box.min.size() != axes || box.max.size() != axes || box.cells.size() != axes)
    return "min, max and cells of a box have one number an axis, " + std::to_string(dimension) + " in this space";
  if (const auto message = element_fault("a box", element, dimension); !message.empty()) return message;
  std::vector<std::array<const char*, 2>> directions;
  for (int axis = 0; axis < dimension; ++axis) {
    if (box.cells[axis] < 1) return "cells of a box must be at least 1";
    if (!(box.max[axis].value > box.min[axis].value)) return "max of a box must be greater than min";
    directions.push_back(box_sides(axis, dimension));
  }
  return grade_fault(box.grade, directions);
}

Mesh topology(const BoxMesh& box, const std::string& element, int dimension) {
  if (dimension == 3) return grid(std::array{box.cells[0], box.cells[1], box.cells[2]}, element);
  return grid(std::array{box.cells[0], box.cells[1]}, element);
}

}  // namespace stickslip
