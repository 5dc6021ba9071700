#include "core/mesh/middles.hpp"

#include <algorithm>
#include <map>

namespace stickslip {
namespace {

/// The side with each facet cut in two at its middle. Facets of a generated side follow each other.
Side halved(const Side& side, const std::map<std::pair<int, int>, int>& middle_of) {
  if (side.facets.empty()) return side;
  Side out;
  out.nodes = {side.facets.front()[0]};
  for (const auto& facet : side.facets) {
    const int a = facet[0], b = facet[1], middle = middle_of.at(std::minmax(a, b));
    out.facets.push_back({a, middle});
    out.facets.push_back({middle, b});
    out.quadratic.push_back({a, b, middle});
    out.nodes.push_back(middle);
    if (b != out.nodes.front()) out.nodes.push_back(b);
  }
  return out;
}

}  // namespace

Mesh with_middles(const Mesh& linear) {
  Mesh mesh = linear;
  mesh.shape = linear.shape == ElementShape::tri3 ? ElementShape::tri6 : ElementShape::quad8;
  mesh.connectivity.clear();
  const int count = nodes_of(linear.shape);
  std::map<std::pair<int, int>, int> middle_of;
  for (int e = 0; e < linear.element_count(); ++e) {
    const int* corner = linear.connectivity.data() + e * count;
    mesh.connectivity.insert(mesh.connectivity.end(), corner, corner + count);
    for (int k = 0; k < count; ++k) {
      const int a = corner[k], b = corner[(k + 1) % count];
      const auto [found, is_new] = middle_of.emplace(std::minmax(a, b), mesh.node_count);
      if (is_new) {
        ++mesh.node_count;
        mesh.middles.push_back({a, b});
      }
      mesh.connectivity.push_back(found->second);
    }
  }
  for (auto& [name, side] : mesh.sides) side = halved(side, middle_of);
  return mesh;
}

}  // namespace stickslip
