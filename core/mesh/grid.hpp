/// What the meshes of a rectangle of cells share (box, quad, ring), and those of a block: topology and grading.
///
/// cells[0] x cells[1] cells, node (i, j) has number j (cells[0] + 1) + i; sides `bottom right top left`, each from its
/// start to its end counter-clockwise.
#pragma once

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
