#include "core/mesh/middles.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace stickslip {
namespace {

using Between = std::map<std::vector<int>, int>;  ///< nodes by the corners around them, ascending

std::vector<int> ascending(std::vector<int> nodes) {
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

/// The side with each facet cut at its middle. Facets of a generated side of the plane follow each other.
Side halved(const Side& side, const Between& middle_of) {
  if (side.facets.empty()) return side;
  Side out;
  out.nodes = {side.facets.front()[0]};
  for (const auto& facet : side.facets) {
    const int a = facet[0], b = facet[1], middle = middle_of.at(ascending({a, b}));
    out.facets.push_back({a, middle});
    out.facets.push_back({middle, b});
    out.quadratic.push_back({a, b, middle});
    out.nodes.push_back(middle);
    if (b != out.nodes.front()) out.nodes.push_back(b);
  }
  return out;
}

/// The side of a mesh in space with the middles of its faces, and these cut there.
Side cut(const Side& side, const Between& between) {
  Side out;
  std::set<int> nodes(side.nodes.begin(), side.nodes.end());
  for (const auto& face : side.facets) {
    auto& whole = out.quadratic.emplace_back(face);
    for (std::size_t k = 0; k < face.size(); ++k)
      whole.push_back(between.at(ascending({face[k], face[(k + 1) % face.size()]})));
    if (const auto centre = between.find(ascending(face)); centre != between.end()) whole.push_back(centre->second);
    for (auto& facet : facets_of_side(whole, 3)) out.facets.push_back(std::move(facet));
    nodes.insert(whole.begin(), whole.end());
  }
  out.nodes.assign(nodes.begin(), nodes.end());
  return out;
}

}  // namespace

Mesh with_middles(const Mesh& linear, ElementShape shape) {
  Mesh mesh = linear;
  mesh.shape = shape;
  const int count = nodes_of(linear.shape);
  const auto& around = corners_around(shape);
  Between between;
  const auto corners = [&](int e, std::size_t a) {
    std::vector<int> nodes;
    for (const int corner : around[a])
      nodes.push_back(linear.connectivity[static_cast<std::size_t>(e) * count + corner]);
    return nodes;
  };
  const auto add = [&](const std::vector<int>& of) {
    const auto [found, is_new] = between.emplace(ascending(of), mesh.node_count);
    if (is_new) ++mesh.node_count;
    return is_new;
  };
  for (int e = 0; e < linear.element_count(); ++e)
    for (std::size_t a = count; a < around.size(); ++a)
      if (const auto ends = corners(e, a); ends.size() == 2 && add(ends)) mesh.middles.push_back({ends[0], ends[1]});
  for (int e = 0; e < linear.element_count(); ++e)
    for (std::size_t a = count; a < around.size(); ++a) {
      auto of = corners(e, a);
      if (of.size() == 2 || !add(of)) continue;
      const std::set<int> within(of.begin(), of.end());
      for (std::size_t b = count; b < around.size(); ++b)
        if (const auto ends = corners(e, b); ends.size() == 2 && within.count(ends[0]) + within.count(ends[1]) == 2)
          of.push_back(between.at(ascending(ends)));
      mesh.centres.push_back(std::move(of));
    }
  mesh.connectivity.clear();
  for (int e = 0; e < linear.element_count(); ++e)
    for (std::size_t a = 0; a < around.size(); ++a) {
      const auto of = corners(e, a);
      mesh.connectivity.push_back(of.size() == 1 ? of[0] : between.at(ascending(of)));
    }
  for (auto& [name, side] : mesh.sides) side = mesh.dimension == 3 ? cut(side, between) : halved(side, between);
  return mesh;
}

}  // namespace stickslip
