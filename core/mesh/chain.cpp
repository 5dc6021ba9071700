#include "core/mesh/chain.hpp"

#include <cmath>

#include "core/mesh/structured.hpp"

namespace stickslip {
namespace {

/// Fault of what lines and arcs have in common, or "".
std::string chain_fault(int cells, const std::string& element, int dimension) {
  if (dimension != 2 && dimension != 3) return "a chain of bars needs a space of 2 or 3 dimensions";
  if (!element.empty() && element != "bar") return "a chain has elements bar, not " + element;
  if (cells < 1) return "cells of a chain must be at least 1";
  return "";
}

std::string size_fault(const char* what, const std::vector<Number>& coordinates, int dimension) {
  if (static_cast<int>(coordinates.size()) == dimension) return "";
  return std::string(what) + " has " + std::to_string(coordinates.size()) + " coordinates, the space has " +
         std::to_string(dimension);
}

Mesh chain(int cells, int dimension) {
  Mesh mesh;
  mesh.dimension = dimension;
  mesh.shape = ElementShape::bar2;
  mesh.node_count = cells + 1;
  std::vector<int> all;
  for (int node = 0; node <= cells; ++node) all.push_back(node);
  for (int cell = 0; cell < cells; ++cell) mesh.connectivity.insert(mesh.connectivity.end(), {cell, cell + 1});
  Side interior = side_along(all);
  interior.nodes = {all.begin() + 1, all.end() - 1};
  if (interior.nodes.empty()) interior.facets.clear();
  mesh.sides = {{"start", {{0}, {}}}, {"end", {{cells}, {}}}, {"nodes", side_along(all)}, {"interior", interior}};
  return mesh;
}

}  // namespace

std::string fault(const PointMesh& point, const std::string& element, int dimension) {
  if (!element.empty() && element != "point") return "a point has the element point, not " + element;
  return size_fault("at", point.at, dimension);
}

std::string fault(const LineMesh& line, const std::string& element, int dimension) {
  for (const std::string& message : {chain_fault(line.cells, element, dimension),
                                     size_fault("from", line.from, dimension), size_fault("to", line.to, dimension)})
    if (!message.empty()) return message;
  for (int axis = 0; axis < dimension; ++axis)
    if (line.from[axis].value != line.to[axis].value) return "";
  return "from and to are the same point";
}

std::string fault(const ArcMesh& arc, const std::string& element, int dimension) {
  if (std::string message = chain_fault(arc.cells, element, dimension); !message.empty()) return message;
  if (!(arc.radius.value > 0)) return "radius must be greater than 0";
  const double turn = std::abs(arc.to_angle.value - arc.from_angle.value);
  if (!(turn > 0 && turn < 360)) return "from_angle and to_angle must differ, by less than 360 degrees";
  return "";
}

Mesh topology(const PointMesh&, const std::string&, int dimension) {
  Mesh mesh;
  mesh.dimension = dimension;
  mesh.shape = ElementShape::point;
  mesh.node_count = 2;
  mesh.connectivity = {0, 1};
  mesh.sides = {{"node", {{0}, {}}}, {"anchor", {{1}, {}}}};
  return mesh;
}

Mesh topology(const LineMesh& line, const std::string&, int dimension) { return chain(line.cells, dimension); }
Mesh topology(const ArcMesh& arc, const std::string&, int dimension) { return chain(arc.cells, dimension); }

}  // namespace stickslip
