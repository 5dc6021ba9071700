#include "core/mesh/box.hpp"

namespace stickslip {

std::string fault(const BoxMesh& box, const std::string& element, int dimension) {
  if (dimension != 2) return "a box of two corners with 2 coordinates each needs a plane space";
  if (const auto message = element_fault("a box", element); !message.empty()) return message;
  if (box.cells[0] < 1 || box.cells[1] < 1) return "cells of a box must be at least 1";
  for (int axis = 0; axis < 2; ++axis)
    if (!(box.max[axis].value > box.min[axis].value)) return "max of a box must be greater than min";
  return grade_fault(box.grade_towards, box.grade.value, {"left", "right", "bottom", "top"});
}

Mesh topology(const BoxMesh& box, const std::string& element, int) { return grid(box.cells, element); }

}  // namespace stickslip
