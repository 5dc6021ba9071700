#include "core/model/segment_search.hpp"

#include <map>

#include "core/contact/facet_search.hpp"
#include "core/contact/segments.hpp"

namespace stickslip {
namespace {

/// Area of segments as a share of the area of the whole slave facets of their point.
double area_share(const std::vector<Segment>& segments, const ContactPoint& point, const Points<double>& start,
                  const Points<double>& moved, int node_count) {
  const auto nodes = nodes_of_segments(point.nodes[0], point.segments, segments, node_count);
  const auto initial = [&](int node) -> Vec<double, 2> { return start.col(node).head<2>(); };
  const auto placed = [&](int node) -> Placed<double> { return {initial(node), moved.col(node).head<2>()}; };
  const auto not_read = [](const Vec<double, 2>& X, const Vec<double, 2>&) { return detail::Foot<double>{X, X}; };
  const double area =
      integrate_segments<double, double>(segments, nodes, placed, Depth<double>{}, not_read, [](auto&&...) {}).area;
  return area / area_of_facets<double>(point.segments, initial, Depth<double>{});
}

}  // namespace

void find_segments(const Model& model, int curve, const Points<double>& start, const Points<double>& moved,
                   std::vector<Facing>& found) {
  const auto& master = model.curves[curve];
  // (places from a node of the master at the start, so that what lies far from the origin is found as near it)
  const Points<double> positions = (start.colwise() - start.col(master.facets[0][0])) + moved;
  const FacetSearch search(positions, master.facets);
  std::map<std::array<int, 2>, std::vector<Segment>> of_facet;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    if (point.curve != curve) continue;
    Facing facing;
    for (const Segment& facet : point.segments) {
      const auto [entry, is_new] = of_facet.try_emplace(facet.slave);
      if (is_new) entry->second = search.facing(facet.slave, master.ends);
      for (Segment segment : entry->second) {
        segment.carrier = facet.carrier;
        segment.sole_carrier = facet.sole_carrier;
        facing.pieces.push_back(segment);
      }
    }
    if (!facing.pieces.empty() && !(area_share(facing.pieces, point, start, moved, model.node_count) >= least_share))
      facing.pieces.clear();
    if (facing.pieces.empty()) {
      const auto nearest = search.nearest(positions.col(point.nodes[0]).head<2>());
      facing.distance = nearest.distance;
      facing.nearest = nearest.facet;
    } else {
      facing.patch = facing.pieces.front().facet;
    }
    facing.nodes = nodes_of_segments(point.nodes[0], point.segments, facing.pieces, model.node_count);
    found[p] = std::move(facing);
  }
}

}  // namespace stickslip
