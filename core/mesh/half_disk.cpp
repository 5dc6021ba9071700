#include "core/mesh/half_disk.hpp"

#include <algorithm>

namespace stickslip {

HalfDiskLayout::HalfDiskLayout(const HalfDiskMesh& disk) : rings(std::min(disk.cells[0], disk.cells[1]) / 2) {
  width = disk.cells[0] - rings;
  height = disk.cells[1] - rings;
}

int HalfDiskLayout::ring(int l, int j) const {
  if (j > 0) return (2 * width + 1) * (height + 1) + (j - 1) * (2 * quarter() + 1) + l;
  if (l <= height) return block(width, l);
  if (l <= height + 2 * width) return block(quarter() - l, height);
  return block(-width, 2 * quarter() - l);
}

std::string fault(const HalfDiskMesh& disk, const std::string& element, int dimension) {
  if (dimension != 2) return "a half disk needs a plane space";
  if (const auto message = element_fault("a half disk", element); !message.empty()) return message;
  const auto [few, many] = std::minmax(disk.cells[0], disk.cells[1]);
  if (few < 2) return "cells of a half disk must be at least 2";
  if (many > 2 * few) return "cells of a half disk must not differ by more than a factor 2, or its elements would fold";
  if (!(disk.radius.value > 0)) return "radius must be greater than 0";
  if (!(disk.grade.value > 0)) return "grade must be greater than 0";
  return "";
}

Mesh topology(const HalfDiskMesh& disk, const std::string& element, int) {
  const HalfDiskLayout layout(disk);
  const bool up = disk.facing == HalfDiskMesh::Facing::up;
  Mesh mesh;
  mesh.shape = structured_shape(element);
  mesh.node_count = layout.node_count();
  // Cells of the half disk facing down; the mirror image turns them round. Diagonals are symmetric about the axis.
  auto append = [&](int a, int b, int c, int d, Diagonal diagonal) {
    append_cell(mesh, up ? std::array{a, d, c, b} : std::array{a, b, c, d}, diagonal);
  };
  for (int q = 0; q < layout.height; ++q)
    for (int p = -layout.width; p < layout.width; ++p) {
      const bool right = p >= 0, even = (q + (right ? p : -1 - p)) % 2 == 0;
      append(layout.block(p, q), layout.block(p + 1, q), layout.block(p + 1, q + 1), layout.block(p, q + 1),
             even == right ? Diagonal::first : Diagonal::second);
    }
  const int around = 2 * layout.quarter();
  for (int j = 0; j < layout.rings; ++j)
    for (int l = 0; l < around; ++l) {
      // a diagonal ends in each corner of the half disk: no triangle there has both its edges on the boundary
      const bool right = 2 * l < around, even = (layout.rings - 1 - j + (right ? l : around - 1 - l)) % 2 == 0;
      append(layout.ring(l, j), layout.ring(l, j + 1), layout.ring(l + 1, j + 1), layout.ring(l + 1, j),
             even == right ? Diagonal::second : Diagonal::first);
    }
  std::vector<int> arc, flat;
  for (int j = layout.rings; j > 0; --j) arc.push_back(layout.ring(around, j));
  for (int p = -layout.width; p <= layout.width; ++p) arc.push_back(layout.block(p, 0));
  for (int j = 1; j <= layout.rings; ++j) arc.push_back(layout.ring(0, j));
  for (int l = 0; l <= around; ++l) flat.push_back(layout.ring(l, layout.rings));
  if (up) {
    std::reverse(arc.begin(), arc.end());
    std::reverse(flat.begin(), flat.end());
  }
  mesh.sides = {{"arc", side_along(arc)}, {"flat", side_along(flat)}};
  return mesh;
}

}  // namespace stickslip
