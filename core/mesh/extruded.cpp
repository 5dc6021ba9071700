#include "core/mesh/extruded.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "core/mesh/sides.hpp"

namespace stickslip {
namespace {

/// The element of the plane mesh that an element of space is made of.
std::string plane_element(const std::string& element) {
  return structured_shape(element, 3) == ElementShape::tet4 ? "T3" : "Q4";
}

/// The three tetrahedra of the prism on a triangle, corners counter-clockwise. The nodes above have numbers that are
/// greater by `layer`.
void append_prism(Mesh& mesh, std::array<int, 3> at, int layer) {
  bool odd = false;
  for (const auto& [i, j] : {std::pair{0, 1}, {1, 2}, {0, 1}})
    if (at[i] > at[j]) {
      std::swap(at[i], at[j]);
      odd = !odd;
    }
  const auto [a, b, c] = at;
  const auto append = [&](std::array<int, 4> nodes, bool turned) {
    if (turned) std::swap(nodes[0], nodes[1]);
    mesh.connectivity.insert(mesh.connectivity.end(), nodes.begin(), nodes.end());
  };
  append({a, b, c, c + layer}, odd);
  append({a, b, b + layer, c + layer}, !odd);
  append({a, a + layer, b + layer, c + layer}, odd);
}

/// Drawn out: the nodes of a side, and those facets of the boundary that lie on its facets.
Side drawn_out(const Side& plane, int layer, int layers, const Side& boundary) {
  Side side;
  for (int k = 0; k <= layers; ++k)
    for (const int n : plane.nodes) side.nodes.push_back(k * layer + n);
  std::set<std::set<int>> facets;
  for (const auto& facet : plane.facets) facets.insert({facet.begin(), facet.end()});
  for (const auto& face : boundary.facets) {
    std::set<int> below;
    for (const int n : face) below.insert(n % layer);
    if (facets.count(below) > 0) side.facets.push_back(face);
  }
  return side;
}

/// The face of the boundary at a layer.
Side at_layer(int k, int layer, const Side& boundary) {
  Side side;
  const auto holds = [&](int n) { return n / layer == k; };
  for (int n = 0; n < layer; ++n) side.nodes.push_back(k * layer + n);
  for (const auto& face : boundary.facets)
    if (std::all_of(face.begin(), face.end(), holds)) side.facets.push_back(face);
  return side;
}

}  // namespace

std::string fault(const ExtrudedMesh& extruded, const std::string& element, int dimension) {
  if (dimension != 3) return "an extruded mesh needs the space solid";
  if (const auto message = element_fault("an extruded mesh", element, 3); !message.empty()) return message;
  if (extruded.cells < 1) return "cells of an extruded mesh must be at least 1";
  if (!(extruded.to.value > extruded.from.value)) return "to of an extruded mesh must be greater than from";
  return std::visit([&](const auto& mesh) { return fault(mesh, plane_element(element), 2); }, extruded.mesh);
}

Mesh plane_with_middles(const ExtrudedMesh& extruded, ElementShape shape) {
  const bool triangles = linear_shape(shape) == ElementShape::tet4;
  return with_middles(
      std::visit([&](const auto& mesh) { return topology(mesh, triangles ? "T3" : "Q4", 2); }, extruded.mesh),
      triangles ? ElementShape::tri6 : ElementShape::quad8);
}

Mesh topology(const ExtrudedMesh& extruded, const std::string& element, int) {
  const Mesh plane =
      std::visit([&](const auto& mesh) { return topology(mesh, plane_element(element), 2); }, extruded.mesh);
  const int layer = plane.node_count, count = nodes_of(plane.shape);
  Mesh mesh;
  mesh.dimension = 3;
  mesh.shape = structured_shape(element, 3);
  mesh.node_count = layer * (extruded.cells + 1);
  for (int k = 0; k < extruded.cells; ++k)
    for (int e = 0; e < plane.element_count(); ++e) {
      const auto node = [&](int a) { return k * layer + plane.connectivity[e * count + a]; };
      if (mesh.shape == ElementShape::tet4) {
        append_prism(mesh, {node(0), node(1), node(2)}, layer);
        continue;
      }
      for (const int up : {0, layer})
        for (int a = 0; a < 4; ++a) mesh.connectivity.push_back(node(a) + up);
    }
  const Side boundary = boundary_of(mesh);
  for (const auto& [name, side] : plane.sides) mesh.sides[name] = drawn_out(side, layer, extruded.cells, boundary);
  mesh.sides["front"] = at_layer(0, layer, boundary);
  mesh.sides["back"] = at_layer(extruded.cells, layer, boundary);
  return mesh;
}

}  // namespace stickslip
