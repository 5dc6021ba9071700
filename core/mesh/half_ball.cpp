#include "core/mesh/half_ball.hpp"

#include <algorithm>
#include <cmath>

#include "core/mesh/sides.hpp"
#include "core/mesh/structured.hpp"

namespace stickslip {
namespace {

/// Appends the cells of a half ball. Which of them are turned over is told by the parity of their indices, so the
/// diagonals of faces agree between the block and the shells, and are symmetric about the axis.
class HalfBallCells {
 public:
  HalfBallCells(const HalfBallLayout& layout, bool up, Mesh& mesh) : of_(layout), up_(up), mesh_(mesh) {}

  void append_all() {
    const int w = of_.width;
    for (int p = -w; p < w; ++p)
      for (int r = -w; r < w; ++r) {
        const std::array<std::array<int, 2>, 4> square{{{p, r}, {p + 1, r}, {p + 1, r + 1}, {p, r + 1}}};
        for (int q = 0; q < of_.height; ++q) append(square, q, 0, q + 1, 0, {is_odd(p), is_odd(r), is_odd(q)});
        for (int j = 0; j < of_.shells; ++j)
          append(square, of_.height, j, of_.height, j + 1, {is_odd(p), is_odd(r), is_odd(j)});
      }
    for (int k = -w; k < w; ++k) {  // beside the block, counter-clockwise seen from the centre of the flat side
      append_beside({w, k}, {w, k + 1}, k);
      append_beside({k + 1, w}, {k, w}, k + 1);
      append_beside({-w, k + 1}, {-w, k}, k + 1);
      append_beside({k, -w}, {k + 1, -w}, k);
    }
  }

 private:
  /// Of nodes p across the axis, between layer q of shell j and another.
  void append(const std::array<std::array<int, 2>, 4>& p, int q, int j, int q_above, int j_above,
              const std::array<bool, 3>& mirrored) {
    std::array<int, 8> nodes{};
    for (int k = 0; k < 4; ++k) {
      nodes[k] = of_.node(p[k], q, j);
      nodes[k + 4] = of_.node(p[k], q_above, j_above);
    }
    append(nodes, mirrored);
  }

  /// The cells of all shells on a strip of a side of the block, between columns a and b. `k`: index of a.
  void append_beside(const std::array<int, 2>& a, const std::array<int, 2>& b, int k) {
    for (int q = 0; q < of_.height; ++q)
      for (int j = 0; j < of_.shells; ++j)
        append({of_.node(a, q, j), of_.node(a, q, j + 1), of_.node(b, q, j + 1), of_.node(b, q, j),
                of_.node(a, q + 1, j), of_.node(a, q + 1, j + 1), of_.node(b, q + 1, j + 1), of_.node(b, q + 1, j)},
               {is_odd(j), is_odd(k), is_odd(q)});
  }

  /// Of a half ball that faces down; the mirror image turns cells over.
  void append(std::array<int, 8> nodes, std::array<bool, 3> mirrored) {
    if (up_) {
      std::swap_ranges(nodes.begin(), nodes.begin() + 4, nodes.begin() + 4);
      mirrored[2] = !mirrored[2];
    }
    append_block(mesh_, nodes, mirrored);
  }

  const HalfBallLayout& of_;
  bool up_;
  Mesh& mesh_;
};

}  // namespace

double HalfBallMesh::cell_count() const {
  const double shells = std::floor((std::min(cells[0], cells[1]) + 1.0) / 2), width = cells[0] - shells,
               height = cells[1] - shells;
  return 4 * width * width * (height + shells) + 8 * width * height * shells;
}

// (half the cells, rounded up: a wider block would leave no room for shells beside its corners)
HalfBallLayout::HalfBallLayout(const HalfBallMesh& ball) : shells((std::min(ball.cells[0], ball.cells[1]) + 1) / 2) {
  width = ball.cells[0] - shells;
  height = ball.cells[1] - shells;
}

int HalfBallLayout::node(const std::array<int, 2>& p, int q, int j) const {
  const int layer = row() * row(), in_layer = (p[1] + width) * row() + p[0] + width;
  if (j == 0) return q * layer + in_layer;
  const int shell = (height + 1) * layer + (j - 1) * (height * around() + layer);
  if (q == height) return shell + height * around() + in_layer;
  const int w = width;
  const int at = p[0] == w && p[1] < w     ? p[1] + w
                 : p[1] == w && p[0] > -w  ? 3 * w - p[0]
                 : p[0] == -w && p[1] > -w ? 5 * w - p[1]
                                           : 7 * w + p[0];
  return shell + q * around() + at;
}

std::string fault(const HalfBallMesh& ball, const std::string& element, int dimension) {
  if (dimension != 3) return "a half ball needs the space solid";
  if (const auto message = element_fault("a half ball", element, 3); !message.empty()) return message;
  if (ball.center.size() != 3) return "center of a half ball has three coordinates";
  const auto [few, many] = std::minmax(ball.cells[0], ball.cells[1]);
  if (few < 2) return "cells of a half ball must be at least 2";
  if (2 * static_cast<long long>(many) > 3 * static_cast<long long>(few))
    return "cells of a half ball must not differ by more than a factor 1.5, or its elements would be flat";
  if (!(ball.radius.value > 0)) return "radius must be greater than 0";
  if (!(ball.grade.value > 0)) return "grade must be greater than 0";
  return "";
}

Mesh topology(const HalfBallMesh& ball, const std::string& element, int) {
  const HalfBallLayout layout(ball);
  Mesh mesh;
  mesh.dimension = 3;
  mesh.shape = structured_shape(element, 3);
  mesh.node_count = layout.node_count();
  HalfBallCells(layout, ball.facing == HalfBallMesh::Facing::up, mesh).append_all();
  std::vector<bool> on_sphere(mesh.node_count), on_flat(mesh.node_count);
  layout.for_each_node([&](const std::array<int, 2>& p, int q, int j) {
    on_sphere[layout.node(p, q, j)] = q == 0;
    on_flat[layout.node(p, q, j)] = j == layout.shells;
  });
  const Side boundary = boundary_of(mesh);
  mesh.sides = {{"surface", part_of(boundary, [&](int node) { return on_sphere[node]; })},
                {"flat", part_of(boundary, [&](int node) { return on_flat[node]; })}};
  return mesh;
}

}  // namespace stickslip
