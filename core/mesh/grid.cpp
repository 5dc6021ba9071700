#include "core/mesh/grid.hpp"

#include <algorithm>

namespace stickslip {

Mesh grid(const std::array<int, 2>& cells, const std::string& element) {
  const int nx = cells[0], ny = cells[1];
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
