#include "core/model/segment_search.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "core/contact/facet_search.hpp"
#include "core/contact/segments.hpp"

namespace stickslip {
namespace {

/// How deep a slave facet of a side in contact with itself may be inside of its other facets.
class OwnDepths {
 public:
  /// `last`: of find_segments().
  OwnDepths(const Model& model, int curve, const std::vector<int>& last) : curve_(model.surfaces[curve]) {
    for (std::size_t p = 0; p < model.points.size(); ++p)
      if (model.points[p].surface == curve && last[p] != no_patch)
        for (const Segment& facet : model.points[p].segments) last_[facet.slave[0]].push_back(last[p]);
  }
  /// The depth, length; negative: the slave facet faces this one nowhere.
  double operator()(const std::array<int, 2>& slave, int facet) const {
    double depth = std::numeric_limits<double>::infinity();
    for (int node : slave) {
      const OwnVertex& own = curve_.own.at(node);
      if (!own.may_face(curve_.patches<2>(), facet)) return -1;
      depth = std::min(depth, depth_of(own, slave[0], facet));
    }
    return depth;
  }

 private:
  double depth_of(const OwnVertex& own, int slave, int facet) const {
    double depth = own.depth_in(facet, no_patch);
    if (const auto faced = last_.find(slave); faced != last_.end())
      for (int last : faced->second) depth = std::max(depth, own.depth_in(facet, last));
    return depth;
  }

  const MasterSurface& curve_;
  std::map<int, std::vector<int>> last_;  ///< per first node of a slave facet: the patches that its points faced
};

/// The nearest facet that a node of a side in contact with itself may touch: its normal is against that of the node,
/// which is outside of it or beside it.
FacetSearch::Nearest nearest_of_itself(const FacetSearch& search, const MasterSurface& master,
                                       const Points<double>& positions, const ContactPoint& point) {
  const auto right_of = [](const Vec<double, 2>& along) { return Vec<double, 2>(along[1], -along[0]); };
  const auto along = [&](int from, int to) -> Vec<double, 2> {
    return (positions.col(to) - positions.col(from)).head<2>();
  };
  Vec<double, 2> outward = Vec<double, 2>::Zero();
  for (const Segment& facet : point.segments) outward += right_of(along(facet.slave[0], facet.slave[1]));
  const int node = point.nodes[0];
  const OwnVertex& own = master.own.at(node);
  return search.nearest(positions.col(node).head<2>(), [&](int facet) {
    const int first = master.facets[facet][0];
    const Vec<double, 2> tau = along(first, master.facets[facet][1]), normal = right_of(tau), off = along(first, node);
    return own.may_touch(master.patches<2>(), facet) &&
           normal.dot(outward) <= -least_against * normal.norm() * outward.norm() &&
           (normal.dot(off) >= 0 || is_beside_facet(off.dot(tau) / tau.squaredNorm()));
  });
}

}  // namespace

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

void find_segments(const Model& model, int curve, const Points<double>& start, const Points<double>& moved,
                   const std::vector<int>& last, std::vector<Facing>& found) {
  const auto& master = model.surfaces[curve];
  // (places from a node of the master at the start, so that what lies far from the origin is found as near it)
  const Points<double> positions = (start.colwise() - start.col(master.facets[0][0])) + moved;
  const FacetSearch search(positions, master.facets);
  const bool of_itself = !master.own.empty();
  std::optional<OwnDepths> depths;
  if (of_itself) depths.emplace(model, curve, last);
  std::map<std::array<int, 2>, std::vector<Segment>> of_facet;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    if (point.surface != curve) continue;
    Facing facing;
    for (const Segment& facet : point.segments) {
      const auto [entry, is_new] = of_facet.try_emplace(facet.slave);
      const auto depth_of = [&](int of) { return (*depths)(facet.slave, of); };
      if (is_new)
        entry->second =
            of_itself ? search.facing(facet.slave, master.ends, depth_of) : search.facing(facet.slave, master.ends);
      for (Segment segment : entry->second) {
        segment.slave_edge = facet.slave_edge;
        segment.master_edge = master.edges[segment.facet];
        segment.carrier = facet.carrier;
        segment.sole_carrier = facet.sole_carrier;
        facing.pieces.push_back(segment);
      }
    }
    if (!facing.pieces.empty() && !(area_share(facing.pieces, point, start, moved, model.node_count) >= least_share))
      facing.pieces.clear();
    if (facing.pieces.empty()) {
      const auto nearest = of_itself ? nearest_of_itself(search, master, positions, point)
                                     : search.nearest(positions.col(point.nodes[0]).head<2>());
      const bool is_any = nearest.facet >= 0;  // (else a side that may touch itself nowhere near)
      facing.distance =
          is_any ? nearest.distance : (positions.rowwise().maxCoeff() - positions.rowwise().minCoeff()).norm();
      facing.nearest = nearest.facet;
    } else {
      facing.patch = facing.pieces.front().facet;
    }
    facing.nodes = nodes_of_segments(point.nodes[0], point.segments, facing.pieces, model.node_count);
    found[p] = std::move(facing);
  }
}

}  // namespace stickslip
