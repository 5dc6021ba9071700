#include "core/mesh/ball.hpp"

#include "core/mesh/sides.hpp"
#include "core/mesh/structured.hpp"

namespace stickslip {
namespace {

using Place = BallLayout::Place;

/// Appends the cells. Which of them are turned over is told by the parity of their indices, so the diagonals of faces
/// agree between the core and the layers, and across the edges of the cube.
void append_cells(const BallLayout& of, Mesh& mesh) {
  const int n = of.core;
  const auto append = [&](const std::array<Place, 4>& low, const std::array<Place, 4>& high, int j_low, int j_high,
                          const std::array<bool, 3>& mirrored) {
    std::array<int, 8> nodes{};
    for (int k = 0; k < 4; ++k) {
      nodes[k] = of.node(low[k], j_low);
      nodes[k + 4] = of.node(high[k], j_high);
    }
    append_block(mesh, nodes, mirrored);
  };
  for (int k = 0; k < n && !of.hollow; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        append({{{i, j, k}, {i + 1, j, k}, {i + 1, j + 1, k}, {i, j + 1, k}}},
               {{{i, j, k + 1}, {i + 1, j, k + 1}, {i + 1, j + 1, k + 1}, {i, j + 1, k + 1}}}, 0, 0,
               {is_odd(i), is_odd(j), is_odd(k)});
  for (int axis = 0; axis < 3; ++axis)
    for (const bool far : {false, true}) {
      // along u and v, counter-clockwise seen from outside
      const int u = (axis + (far ? 1 : 2)) % 3, v = (axis + (far ? 2 : 1)) % 3;
      const auto at = [&](int p, int q) {
        Place place{};
        place[axis] = far ? n : 0;
        place[u] = p;
        place[v] = q;
        return place;
      };
      for (int q = 0; q < n; ++q)
        for (int p = 0; p < n; ++p) {
          const std::array<Place, 4> square{at(p, q), at(p + 1, q), at(p + 1, q + 1), at(p, q + 1)};
          for (int j = 0; j < of.layers; ++j) append(square, square, j, j + 1, {is_odd(p), is_odd(q), is_odd(j)});
        }
    }
}

}  // namespace

double BallMesh::cell_count() const {
  const double n = cells[0];
  return (inner.value > 0 ? 0 : n * n * n) + 6 * n * n * cells[1];
}

BallLayout::BallLayout(const BallMesh& ball)
    : core(ball.cells[0]), layers(ball.cells[1]), hollow(ball.inner.value > 0) {}

int BallLayout::node(const Place& at, int j) const {
  if (hollow) return j * on_surface() + surface_index(at);
  return j == 0 ? grid_index(at) : grid_index({core, core, core}) + 1 + (j - 1) * on_surface() + surface_index(at);
}

int BallLayout::surface_index(const Place& at) const {
  const int row = core + 1, full = row * row, rim = 4 * core;  // nodes of the first and last layer of the grid; between
  if (at[2] == 0) return at[1] * row + at[0];
  if (at[2] == core) return full + (core - 1) * rim + at[1] * row + at[0];
  const int around = at[1] == 0      ? at[0]
                     : at[1] == core ? row + 2 * (core - 1) + at[0]
                                     : row + 2 * (at[1] - 1) + (at[0] == core);
  return full + (at[2] - 1) * rim + around;
}

std::string fault(const BallMesh& ball, const std::string& element, int dimension) {
  if (dimension != 3) return "a ball needs the space solid";
  if (const auto message = element_fault("a ball", element, 3); !message.empty()) return message;
  if (ball.center.size() != 3) return "center of a ball has three coordinates";
  if (ball.cells[0] < 1 || ball.cells[1] < 1) return "cells of a ball must be at least 1";
  if (!(ball.radius.value > 0)) return "radius must be greater than 0";
  if (!(ball.inner.value >= 0 && ball.inner.value < ball.radius.value))
    return "inner of a ball must be at least 0 and less than radius";
  if (!(ball.grade.value > 0)) return "grade must be greater than 0";
  return "";
}

Mesh topology(const BallMesh& ball, const std::string& element, int) {
  const BallLayout layout(ball);
  Mesh mesh;
  mesh.dimension = 3;
  mesh.shape = structured_shape(element, 3);
  mesh.node_count = layout.node_count();
  append_cells(layout, mesh);
  const int outermost = mesh.node_count - layout.on_surface(), innermost = layout.on_surface();
  const Side boundary = boundary_of(mesh);
  mesh.sides = {{"surface", part_of(boundary, [&](int node) { return node >= outermost; })}};
  if (layout.hollow) mesh.sides["inner"] = part_of(boundary, [&](int node) { return node < innermost; });
  return mesh;
}

}  // namespace stickslip
