#include "core/mesh/ring.hpp"

#include <cmath>

namespace stickslip {
namespace {

/// Makes the last row of nodes of the grid its first.
void close(Mesh& mesh, int count) {
  mesh.node_count = count;
  for (int& node : mesh.connectivity) node %= count;
  for (auto& [name, side] : mesh.sides) {
    // the first node is the last again: once is enough, the facet between stays
    const bool starts_there = side.nodes.front() >= count;
    side.nodes.erase(starts_there ? side.nodes.begin() : side.nodes.end() - 1);
    for (auto& facet : side.facets)
      for (int& node : facet) node %= count;
  }
}

}  // namespace

bool is_full_turn(double from_angle, double to_angle) { return std::abs(to_angle - from_angle - 360) <= 360 * 1e-12; }

std::string fault(const RingMesh& ring, const std::string& element, int dimension) {
  if (dimension != 2) return "a ring needs a plane space";
  if (const auto message = element_fault("a ring", element); !message.empty()) return message;
  if (ring.cells[0] < 1 || ring.cells[1] < 1) return "cells of a ring must be at least 1";
  if (!(ring.inner.value > 0)) return "inner must be greater than 0 (a disk has no hole)";
  if (!(ring.outer.value > ring.inner.value)) return "outer must be greater than inner";
  const double span = ring.to_angle.value - ring.from_angle.value;
  const bool closed = is_full_turn(ring.from_angle.value, ring.to_angle.value);
  if (!(span > 0) || (!closed && span > 360)) return "to_angle must exceed from_angle, by 360 degrees at most";
  if (span / ring.cells[1] >= 180) return "a cell of a ring must span less than 180 degrees";
  return grade_fault(ring.grade, {{"inner", "outer"}});
}

Mesh topology(const RingMesh& ring, const std::string& element, int) {
  Mesh mesh = grid(ring.cells, element);
  auto rename = [&](const char* grid_name, const char* name) {
    auto side = mesh.sides.extract(grid_name);
    side.key() = name;
    mesh.sides.insert(std::move(side));
  };
  rename("left", "inner");
  rename("right", "outer");
  if (is_full_turn(ring.from_angle.value, ring.to_angle.value)) {
    mesh.sides.erase("bottom");
    mesh.sides.erase("top");
    close(mesh, (ring.cells[0] + 1) * ring.cells[1]);
  } else {
    rename("bottom", "start");
    rename("top", "end");
  }
  return mesh;
}

}  // namespace stickslip
