#include "core/mesh/box.hpp"

#include <algorithm>

namespace stickslip {

std::string fault(const BoxMesh& box, const std::string& element, int dimension) {
  if (dimension != 2) return "a box of two corners with 2 coordinates each needs a plane space";
  if (!element.empty() && element != "T3" && element != "Q4") return "a box has elements T3 or Q4, not " + element;
  if (box.cells[0] < 1 || box.cells[1] < 1) return "cells of a box must be at least 1";
  for (int axis = 0; axis < 2; ++axis)
    if (!(box.max[axis].value > box.min[axis].value)) return "max of a box must be greater than min";
  if (!(box.grade.value > 0)) return "grade must be greater than 0";
  const std::string& side = box.grade_towards;
  if (!side.empty() && side != "left" && side != "right" && side != "bottom" && side != "top")
    return "grade_towards is left, right, bottom or top, not " + side;
  return "";
}

Mesh topology(const BoxMesh& box, const std::string& element, int) {
  const int nx = box.cells[0], ny = box.cells[1];
  auto node = [&](int i, int j) { return j * (nx + 1) + i; };
  Mesh mesh;
  mesh.shape = structured_shape(element);
  mesh.node_count = (nx + 1) * (ny + 1);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      // Alternating diagonals have no preferred direction. Counted from the nearest corner, the pattern is symmetric
      // and a diagonal starts in every corner: no triangle there has two edges on supported sides.
      const bool left = 2 * i < nx, low = 2 * j < ny;
      const bool even = (std::min(i, nx - 1 - i) + std::min(j, ny - 1 - j)) % 2 == 0;
      append_cell(mesh, {node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)},
                  even == (left == low) ? Diagonal::first : Diagonal::second);
    }
  std::vector<int> bottom, right, top, left;
  for (int i = 0; i <= nx; ++i) bottom.push_back(node(i, 0)), top.push_back(node(nx - i, ny));
  for (int j = 0; j <= ny; ++j) right.push_back(node(nx, j)), left.push_back(node(0, ny - j));
  mesh.sides = {{"bottom", side_along(bottom)},
                {"right", side_along(right)},
                {"top", side_along(top)},
                {"left", side_along(left)}};
  return mesh;
}

}  // namespace stickslip
