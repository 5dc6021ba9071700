/// What the meshes of a rectangle of cells share (box, quad, ring), and those of a block: topology and grading.
///
/// cells[0] x cells[1] cells, node (i, j) has number j (cells[0] + 1) + i; sides `bottom right top left`, each from its
/// start to its end counter-clockwise.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "core/mesh/structured.hpp"

namespace stickslip {

/// The sides of a grid that cells may be graded towards.
inline constexpr std::array grid_sides{"left", "right", "bottom", "top"};

Mesh grid(const std::array<int, 2>& cells, const std::string& element);

/// A block of cells in space. Node (i, j, k) has number (k (cells[1] + 1) + j) (cells[0] + 1) + i. Sides: left right
/// along the first direction, front back along the second, bottom top along the third.
Mesh grid(const std::array<int, 3>& cells, const std::string& element);

/// Appends a cell of space, as one hexahedron, or as six tetrahedra around its diagonal from corner 0 to corner 6.
/// `mirrored`: along which directions the cell is turned over before. Neighbours are turned over in turn, so the
/// diagonals of a face that they share agree, and no direction is preferred.
void append_block(Mesh&, const std::array<int, 8>& nodes, const std::array<bool, 3>& mirrored);

/// The nodes of the boundary of a mesh in space that hold, and its faces all of whose nodes do.
template <class Holds>
Side part_of(const Side& boundary, const Holds& holds) {
  Side part;
  for (const int node : boundary.nodes)
    if (holds(node)) part.nodes.push_back(node);
  for (const auto& facet : boundary.facets)
    if (std::all_of(facet.begin(), facet.end(), holds)) part.facets.push_back(facet);
  return part;
}

/// Fractions along one axis; cells grow away from the side `low` or `high` if that is the one they are graded towards.
template <class T>
std::vector<T> grid_fractions(int cells, const std::string& towards, const T& ratio, const char* low,
                              const char* high) {
  const std::vector<T> f = graded_fractions(towards == low || towards == high ? ratio : T(1.0), cells);
  if (towards != high) return f;
  std::vector<T> mirrored;
  for (auto it = f.rbegin(); it != f.rend(); ++it) mirrored.push_back(T(1.0) - *it);
  return mirrored;
}

}  // namespace stickslip
