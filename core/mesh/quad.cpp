#include "core/mesh/quad.hpp"

namespace stickslip {

std::string fault(const QuadMesh& quad, const std::string& element, int dimension) {
  if (dimension != 2) return "a quad needs a plane space";
  if (const auto message = element_fault("a quad", element); !message.empty()) return message;
  if (quad.cells[0] < 1 || quad.cells[1] < 1) return "cells of a quad must be at least 1";
  for (int k = 0; k < 4; ++k) {
    const auto &here = quad.corners[k], &next = quad.corners[(k + 1) % 4], &last = quad.corners[(k + 3) % 4];
    const double turn = (next[0].value - here[0].value) * (last[1].value - here[1].value) -
                        (next[1].value - here[1].value) * (last[0].value - here[0].value);
    if (!(turn > 0)) return "corners of a quad must run counter-clockwise, and none may be flat or turn inwards";
  }
  return grade_fault(quad.grade, {{"left", "right"}, {"bottom", "top"}});
}

Mesh topology(const QuadMesh& quad, const std::string& element, int) { return grid(quad.cells, element); }

}  // namespace stickslip
