#include "core/mesh/middles.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace stickslip {
namespace {

/// Corners that a node lies between, ascending; behind them no more.
using Corners = std::array<int, 8>;
constexpr int no_more = -1;

/// Those of an element or a side, as they are listed in it.
Corners corners_among(const int* nodes, const std::vector<int>& listed) {
  Corners of;
  of.fill(no_more);
  for (std::size_t k = 0; k < listed.size(); ++k) of[k] = nodes[listed[k]];
  std::sort(of.begin(), of.begin() + static_cast<std::ptrdiff_t>(listed.size()));
  return of;
}

Corners ends_of_edge(int a, int b) {
  const auto [first, second] = std::minmax(a, b);
  return {first, second, no_more, no_more, no_more, no_more, no_more, no_more};
}

using Between = std::map<Corners, int>;

/// The side with each facet cut at its middle. Facets of a generated side of the plane follow each other.
Side halved(const Side& side, const Between& middle_of) {
  if (side.facets.empty()) return side;
  Side out;
  out.nodes = {side.facets.front()[0]};
  for (const auto& facet : side.facets) {
    const int a = facet[0], b = facet[1], middle = middle_of.at(ends_of_edge(a, b));
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
      whole.push_back(between.at(ends_of_edge(face[k], face[(k + 1) % face.size()])));
    const auto centre = face.size() == 4 ? between.find(corners_among(face.data(), {0, 1, 2, 3})) : between.end();
    if (centre != between.end()) whole.push_back(centre->second);
    for (auto& facet : facets_of_side(whole, 3)) out.facets.push_back(std::move(facet));
    nodes.insert(whole.begin(), whole.end());
  }
  out.nodes.assign(nodes.begin(), nodes.end());
  return out;
}

/// The corners of a face or an element, and then the middles of its edges. `listed`: its corners in the element.
std::vector<int> nodes_around(const int* nodes, const std::vector<int>& listed, ElementShape shape,
                              const Between& between) {
  std::vector<int> all;
  for (const int corner : listed) all.push_back(nodes[corner]);
  const auto is_listed = [&](int corner) { return std::find(listed.begin(), listed.end(), corner) != listed.end(); };
  for (const auto& around : corners_around(shape))
    if (around.size() == 2 && is_listed(around[0]) && is_listed(around[1]))
      all.push_back(between.at(corners_among(nodes, around)));
  return all;
}

}  // namespace

Mesh with_middles(const Mesh& linear, ElementShape shape) {
  Mesh mesh = linear;
  mesh.shape = shape;
  mesh.connectivity.clear();
  mesh.connectivity.reserve(static_cast<std::size_t>(linear.element_count()) * nodes_of(shape));
  const auto count = static_cast<std::size_t>(nodes_of(linear.shape));
  const auto& around = corners_around(shape);
  Between between;
  const auto add = [&](const int* nodes, std::size_t a) {
    const bool is_new = between.emplace(corners_among(nodes, around[a]), mesh.node_count).second;
    mesh.node_count += is_new;
    return is_new;
  };
  const auto element = [&](int e) { return linear.connectivity.data() + static_cast<std::size_t>(e) * count; };
  for (int e = 0; e < linear.element_count(); ++e)
    for (std::size_t a = count; a < around.size(); ++a)
      if (around[a].size() == 2 && add(element(e), a))
        mesh.middles.push_back({element(e)[around[a][0]], element(e)[around[a][1]]});
  for (int e = 0; e < linear.element_count(); ++e)
    for (std::size_t a = count; a < around.size(); ++a)
      if (around[a].size() > 2 && add(element(e), a))
        mesh.centres.push_back(nodes_around(element(e), around[a], shape, between));
  for (int e = 0; e < linear.element_count(); ++e)
    for (std::size_t a = 0; a < around.size(); ++a)
      mesh.connectivity.push_back(a < count ? element(e)[a] : between.at(corners_among(element(e), around[a])));
  for (auto& [name, side] : mesh.sides) side = mesh.dimension == 3 ? cut(side, between) : halved(side, between);
  return mesh;
}

}  // namespace stickslip
