#include "core/contact/rigid_facets.hpp"

#include <map>
#include <stdexcept>
#include <utility>

#include "core/mesh/sides.hpp"

namespace stickslip {

MeshSide::MeshSide(MeshDescription of, Mesh made, const std::string& side)
    : description(std::move(of)), mesh(std::move(made)), facets(evaluate_side(mesh, side).facets) {
  if (facets.empty()) throw std::invalid_argument("the side \"" + side + "\" has no facets");
  std::map<int, int> number;
  for (auto& facet : facets)
    for (int& node : facet) {
      const auto [found, is_new] = number.emplace(node, static_cast<int>(number.size()));
      if (is_new) nodes.push_back(node);
      node = found->second;
    }
}

std::vector<std::vector<int>> facets_of(const Polyline& polyline) {
  const int count = static_cast<int>(polyline.points.size());
  std::vector<std::vector<int>> facets;
  for (int v = 0; v + 1 < count + polyline.closed; ++v) facets.push_back({(v + 1) % count, v});
  return facets;
}

}  // namespace stickslip
