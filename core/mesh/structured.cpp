#include "core/mesh/structured.hpp"

#include <algorithm>

#include "core/mesh/sides.hpp"

namespace stickslip {

std::string grade_fault(const std::vector<Grading>& grade, const std::vector<std::array<const char*, 2>>& directions) {
  std::vector<std::string> sides;
  for (const auto& ends : directions) {
    const auto is_among = [&](const Grading& g) { return g.towards == ends[0] || g.towards == ends[1]; };
    if (std::count_if(grade.begin(), grade.end(), is_among) > 1)
      return std::string("grade is towards ") + ends[0] + " or " + ends[1] + ", not both";
    sides.insert(sides.end(), ends.begin(), ends.end());
  }
  for (const auto& [towards, ratio] : grade) {
    if (!(ratio.value > 0)) return "grade must be greater than 0";
    if (std::find(sides.begin(), sides.end(), towards) != sides.end()) continue;
    std::string all = sides[0];
    for (std::size_t i = 1; i < sides.size(); ++i) all += (i + 1 == sides.size() ? " or " : ", ") + sides[i];
    return "grade is towards " + all + ", not " + towards;
  }
  return "";
}

void append_block(Mesh& mesh, const std::array<int, 8>& n, const std::array<bool, 3>& mirrored) {
  if (mesh.shape == ElementShape::hex8) {
    mesh.connectivity.insert(mesh.connectivity.end(), n.begin(), n.end());
    return;
  }
  // corner by its place along the three directions: bit 0, 1, 2
  static constexpr std::array<int, 8> corner{0, 1, 3, 2, 4, 5, 7, 6};
  int flip = 0;
  for (int axis = 0; axis < 3; ++axis) flip |= mirrored[axis] ? 1 << axis : 0;
  const bool odd = (mirrored[0] + mirrored[1] + mirrored[2]) % 2 == 1;
  static constexpr std::array<std::array<int, 3>, 6> orders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (std::size_t o = 0; o < orders.size(); ++o) {
    int at = 0;
    std::array<int, 4> tet{n[corner[flip]]};
    for (int step = 0; step < 3; ++step) {
      at |= 1 << orders[o][step];
      tet[step + 1] = n[corner[at ^ flip]];
    }
    if ((o >= 3) != odd) std::swap(tet[1], tet[2]);
    mesh.connectivity.insert(mesh.connectivity.end(), tet.begin(), tet.end());
  }
}

Mesh grid(const std::array<int, 3>& cells, const std::string& element) {
  const auto [nx, ny, nz] = cells;
  const auto node = [&, nx = nx, ny = ny](int i, int j, int k) { return (k * (ny + 1) + j) * (nx + 1) + i; };
  Mesh mesh;
  mesh.dimension = 3;
  mesh.shape = structured_shape(element, 3);
  mesh.node_count = (nx + 1) * (ny + 1) * (nz + 1);
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        append_block(mesh,
                     {node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k), node(i, j, k + 1),
                      node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1), node(i, j + 1, k + 1)},
                     {i % 2 == 1, j % 2 == 1, k % 2 == 1});
  const Side all = boundary_of(mesh);
  const int row = nx + 1, layer = row * (ny + 1);
  mesh.sides = {{"left", part_of(all, [&](int n) { return n % row == 0; })},
                {"right", part_of(all, [&, nx = nx](int n) { return n % row == nx; })},
                {"front", part_of(all, [&](int n) { return n % layer / row == 0; })},
                {"back", part_of(all, [&, ny = ny](int n) { return n % layer / row == ny; })},
                {"bottom", part_of(all, [&](int n) { return n / layer == 0; })},
                {"top", part_of(all, [&, nz = nz](int n) { return n / layer == nz; })}};
  return mesh;
}

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
