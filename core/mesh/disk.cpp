#include "core/mesh/disk.hpp"

namespace stickslip {

int DiskLayout::ring(int l, int j) const {
  l %= around();
  if (j > 0) return (core + 1) * (core + 1) + (j - 1) * around() + l;
  const int side = l / core, along = l % core;
  if (side == 0) return inside(core, along);
  if (side == 1) return inside(core - along, core);
  if (side == 2) return inside(0, core - along);
  return inside(along, 0);
}

Vec<double, 2> core_edge(const DiskLayout& layout, int l) {
  // of equal size: the radius left for the rings over the core's side, as rings over cells
  const double corner = 1 / (1 + std::sqrt(2.0) * layout.rings / layout.core);
  const double reach = std::min(0.8, std::max(0.3, corner));
  constexpr double bulge = 0.4;  // between a straight side (0) and an arc (1)
  const int side = l / layout.core;
  const double s = static_cast<double>(l % layout.core) / layout.core, angle = std::acos(0.0) * (s - 0.5);
  const double straight = std::sqrt(0.5);
  const Vec<double, 2> at((1 - bulge) * straight + bulge * std::cos(angle),
                          (1 - bulge) * straight * (2 * s - 1) + bulge * std::sin(angle));
  switch (side) {  // turned by a right angle a side
    case 0:
      return reach * at;
    case 1:
      return reach * Vec<double, 2>(-at[1], at[0]);
    case 2:
      return -reach * at;
    default:
      return reach * Vec<double, 2>(at[1], -at[0]);
  }
}

std::string fault(const DiskMesh& disk, const std::string& element, int dimension) {
  if (dimension != 2) return "a disk needs a plane space";
  if (const auto message = element_fault("a disk", element); !message.empty()) return message;
  if (disk.cells[0] < 1 || disk.cells[1] < 1) return "cells of a disk must be at least 1";
  if (!(disk.radius.value > 0)) return "radius must be greater than 0";
  if (!(disk.grade.value > 0)) return "grade must be greater than 0";
  return "";
}

Mesh topology(const DiskMesh& disk, const std::string& element, int) {
  const DiskLayout layout(disk);
  Mesh mesh;
  mesh.shape = structured_shape(element);
  mesh.node_count = layout.node_count();
  const int n = layout.core;
  for (int q = 0; q < n; ++q)
    for (int p = 0; p < n; ++p)
      append_cell(mesh,
                  {layout.inside(p, q), layout.inside(p + 1, q), layout.inside(p + 1, q + 1), layout.inside(p, q + 1)},
                  (p + q) % 2 == 0 ? Diagonal::first : Diagonal::second);
  for (int j = 0; j < layout.rings; ++j)
    for (int l = 0; l < layout.around(); ++l)
      append_cell(mesh, {layout.ring(l, j), layout.ring(l, j + 1), layout.ring(l + 1, j + 1), layout.ring(l + 1, j)},
                  (l + j) % 2 == 0 ? Diagonal::first : Diagonal::second);
  std::vector<int> arc;
  for (int l = 0; l < layout.around(); ++l) arc.push_back(layout.ring(l, layout.rings));
  mesh.sides = {{"arc", closed_side(arc)}};
  return mesh;
}

}  // namespace stickslip
