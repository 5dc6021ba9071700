#include "core/model/overlap_pairing.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "core/contact/overlap_search.hpp"
#include "core/contact/overlaps.hpp"
#include "core/model/master_surface.hpp"

namespace stickslip {
namespace {

/// The facets of a side in space, with the sides of quadratic elements that they are parts of.
std::vector<SideFacet> side_facets(const SideSet& side) {
  std::map<std::vector<int>, std::vector<int>> of_quadratic;
  for (const auto& whole : side.edges)
    if (whole.size() > 4)
      for (auto& facet : facets_of_side(whole, 3)) of_quadratic.emplace(std::move(facet), whole);
  std::vector<SideFacet> facets;
  for (const auto& nodes : side.facets) {
    SideFacet facet;
    facet.corners = static_cast<int>(nodes.size());
    std::copy(nodes.begin(), nodes.end(), facet.nodes.begin());
    if (const auto whole = of_quadratic.find(nodes); whole != of_quadratic.end()) facet.side = whole->second;
    facets.push_back(std::move(facet));
  }
  return facets;
}

/// The facets of a slave facet's master, and where all nodes are: those of the model and then the obstacle's vertices.
OverlapSearch overlap_search(const Model& model, const Points<double>& points, const Pairing& pairing) {
  if (pairing.obstacle < 0) return {points, side_facets(pairing.master)};
  const Obstacle& obstacle = model.scene.obstacles[pairing.obstacle];
  if (!has_facets(obstacle.shape)) return {points, {}};
  const auto vertices = vertices_of(obstacle.shape, model.scene.as<double>());
  Points<double> all(3, points.cols() + vertices.cols());
  all << points, vertices;
  SideSet facets;
  facets.facets = facets_of(obstacle.shape);
  for (auto& facet : facets.facets)
    for (int& vertex : facet) vertex += model.node_count;
  return {std::move(all), side_facets(facets)};
}

/// Whether the overlaps of a point weigh nothing, as those of curved sides may that are steep to
/// one another (weight_of_angle()).
bool weigh_nothing(const ContactPoint& point, const OverlapSearch& search) {
  constexpr double nothing = 1e-12;
  const auto place = [&](int node) -> Vec<double, 3> { return search.place(node); };
  const auto not_read = [](const Vec<double, 3>&) { return PointGeometry<double>{}; };
  const double area = integrate_overlaps<double>(point.overlaps, point.nodes, place, not_read).area;
  return !(area > nothing * point.mesh_size * point.mesh_size);
}

}  // namespace

void pair_overlaps(Model& model, const Points<double>& points, const Pairing& pairing) {
  const OverlapSearch search = overlap_search(model, points, pairing);
  const std::set<int> carriers(pairing.slave.nodes.begin(), pairing.slave.nodes.end());
  std::map<int, std::vector<Overlap>> of_node;
  for (const auto& facet : side_facets(pairing.slave)) {
    const auto carries = [&](int k) { return carriers.count(facet.nodes[k]) > 0; };
    int carrying = 0;
    for (int k = 0; k < facet.corners; ++k) carrying += carries(k);
    for (Overlap& overlap : search.empty() ? std::vector<Overlap>{whole_facet(facet)} : search.facing(facet))
      for (int carrier = 0; carrier < facet.corners; ++carrier) {
        if (!carries(carrier)) continue;
        overlap.psi = {};
        for (int k = 0; k < facet.corners; ++k) overlap.psi[k] = k == carrier ? 1.0 : carries(k) ? 0.0 : 1.0 / carrying;
        of_node[facet.nodes[carrier]].push_back(overlap);
      }
  }
  for (int node : pairing.slave.nodes) {
    if (of_node[node].empty()) continue;
    ContactPoint point = slave_point(model, points, pairing, node);
    point.master = ContactPoint::Master::segments;
    point.overlaps = std::move(of_node[node]);
    point.nodes = nodes_of_overlaps(node, point.overlaps, model.node_count, point.slave_nodes);
    if (!search.empty() && weigh_nothing(point, search)) continue;
    add_point(model, std::move(point));
  }
}

}  // namespace stickslip
