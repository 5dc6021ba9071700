#include "core/model/slave_point.hpp"

#include <algorithm>
#include <utility>

#include "core/model/placed_point.hpp"

namespace stickslip {
namespace {

/// Whether all nodes of the sides of an element have a positive share of them. Of faces of six nodes corners have none,
/// of eight a negative one.
bool has_positive_shares(ElementShape shape) { return shape != ElementShape::tet10 && shape != ElementShape::hex20; }

}  // namespace

ContactPoint slave_point(const Model& model, const Points<double>& points, const Pairing& pairing, int node) {
  const auto shape = model.bodies[pairing.slave.body].mesh.shape;
  ContactPoint point;
  point.contact = pairing.index;
  point.obstacle = pairing.obstacle;
  point.nodes = {node};
  point.slave_body = pairing.slave.body;
  for (const auto& facet : pairing.slave.facets)
    if (std::find(facet.begin(), facet.end(), node) != facet.end()) point.area_facets.push_back(facet);
  for (const auto& edge : has_positive_shares(shape) ? pairing.slave.edges : pairing.slave.facets)
    if (std::find(edge.begin(), edge.end(), node) != edge.end()) point.area_edges.push_back(edge);
  point.area_of_bar = shape == ElementShape::bar2 && pairing.slave.nodes.size() == 1 && point.area_facets.empty();
  point.mesh_size = detail::mean_edge_length<double>(point.area_facets, points);
  point.tie_length = 8 * unit_roundoff * (point.mesh_size + points.col(node).cwiseAbs().maxCoeff());
  // a node on the axis of revolution cannot slide
  const bool slides = model.scene.contacts[pairing.index].friction && !model.is_on_axis(points, node);
  point.tangents = slides ? model.dimension - 1 : 0;
  return point;
}

void add_point(Model& model, ContactPoint point) {
  model.effects.contact = true;
  model.effects.friction |= point.tangents > 0;
  model.effects.coupled_friction |= point.tangents > 0 && model.scene.contacts[point.contact].friction->couples();
  model.effects.deformable_master |= point.obstacle < 0;
  point.multiplier = model.multiplier_count;
  model.multiplier_count += point.components();
  model.points.push_back(std::move(point));
}

}  // namespace stickslip
