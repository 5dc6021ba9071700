#include "core/contact/overlaps.hpp"

#include <cmath>

namespace stickslip {

Vec<double, 2> side_node(int corners, int number) {
  if (number < corners) return face_corner(corners, number);
  if (number == 2 * corners) return {0.5, 0.5};
  return (face_corner(corners, number - corners) + face_corner(corners, number - corners + 1)) / 2;
}

namespace detail {

const GaussRule& rule_of(const Overlap& overlap) {
  static const double root = 2.0 / 7 * std::sqrt(1.2), weigh = std::sqrt(30.0) / 72;
  static const double two = std::sqrt(1.0 / 12), near = std::sqrt(3.0 / 7 - root) / 2,
                      far = std::sqrt(3.0 / 7 + root) / 2;
  static const GaussRule of_two{2, {0.5 - two, 0.5 + two}, {0.5, 0.5}},
      of_four{
          4, {0.5 - far, 0.5 - near, 0.5 + near, 0.5 + far}, {0.25 - weigh, 0.25 + weigh, 0.25 + weigh, 0.25 - weigh}};
  const auto is_linear = [](const SideFacet& facet) { return facet.side.empty() && facet.corners != 4; };
  return is_linear(overlap.slave) && is_linear(overlap.master) ? of_two : of_four;
}

}  // namespace detail

std::vector<int> nodes_of_overlaps(int own, const std::vector<Overlap>& overlaps, int node_count, int& slave_nodes) {
  std::vector<int> nodes{own};
  const auto add = [&](int node) {
    if (node < node_count && std::find(nodes.begin(), nodes.end(), node) == nodes.end()) nodes.push_back(node);
  };
  const auto add_all = [&](const SideFacet& facet) {
    for (int k = 0; k < facet.corners && facet.side.empty(); ++k) add(facet.nodes[k]);
    for (int node : facet.side) add(node);
  };
  for (const auto& overlap : overlaps) add_all(overlap.slave);
  slave_nodes = static_cast<int>(nodes.size());
  for (const auto& overlap : overlaps) add_all(overlap.master);
  return nodes;
}

}  // namespace stickslip
