#include "core/contact/overlap_search.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/contact/face.hpp"
#include "core/contact/surfaces.hpp"

namespace stickslip {
namespace {

/// A vertex of a convex polygon, and the edge on which the polygon goes on from it.
struct PolygonCorner {
  OverlapVertex of;
  Vec<double, 3> at;
  std::array<int, 2> edge;
};
using Polygon = std::vector<PolygonCorner>;

/// Polygons in the plane across `normal`, unit. Places count as they are seen along it.
class PolygonView {
 public:
  PolygonView(const Points<double>& points, const Vec<double, 3>& normal, double on_edge)
      : points_(points), normal_(normal), on_edge_(on_edge) {}

  /// The facet itself; `turned`: in the opposite direction.
  Polygon polygon(const SideFacet& facet, bool turned) const {
    Polygon polygon;
    for (int k = 0; k < facet.corners; ++k) {
      const int from = turned ? facet.corners - k : k, to = turned ? from - 1 : k + 1;
      const int node = facet.nodes[from % facet.corners], next = facet.nodes[to % facet.corners];
      polygon.push_back({{{node, node}, {node, node}}, place(node), {node, next}});
    }
    return polygon;
  }

  /// Distance of x from the line of an edge, positive on the left of it, length.
  double left_of(const std::array<int, 2>& edge, const Vec<double, 3>& x) const {
    const Vec<double, 3> tau = place(edge[1]) - place(edge[0]), along = tau - tau.dot(normal_) * normal_;
    return normal_.dot(cross<double>(along, x - place(edge[0]))) / along.norm();
  }

  /// What of the polygon is on the left of an edge, and what is on its right.
  std::pair<Polygon, Polygon> cut(const Polygon& polygon, const std::array<int, 2>& edge) const {
    std::pair<Polygon, Polygon> sides;
    const std::array<int, 2> back{edge[1], edge[0]};
    std::vector<int> side;  // 1: left, -1: right, 0: on it
    std::vector<double> distance;
    for (const auto& corner : polygon) {
      distance.push_back(left_of(edge, corner.at));
      side.push_back(distance.back() > on_edge_ ? 1 : distance.back() < -on_edge_ ? -1 : 0);
    }
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const std::size_t next = (k + 1) % polygon.size();
      const PolygonCorner& corner = polygon[k];
      if (side[k] >= 0) sides.first.push_back(corner);
      if (side[k] <= 0) sides.second.push_back(corner);
      if (side[k] == 0) {  // one of the two goes on along the edge here, where the polygon leaves it
        if (side[next] < 0) sides.first.back().edge = edge;
        if (side[next] > 0) sides.second.back().edge = back;
      }
      if (side[k] * side[next] >= 0) continue;
      const double share = distance[k] / (distance[k] - distance[next]);
      const PolygonCorner crossing{
          {corner.edge, edge}, corner.at + share * (polygon[next].at - corner.at), corner.edge};
      sides.first.push_back(crossing);
      sides.second.push_back(crossing);
      if (side[k] > 0)
        sides.first.back().edge = edge;
      else
        sides.second.back().edge = back;
    }
    return sides;
  }

  /// Whether one lies beyond an edge of the other.
  bool are_apart(const Polygon& a, const Polygon& b) const {
    const auto parts = [this](const Polygon& one, const Polygon& other) {
      return std::any_of(one.begin(), one.end(), [&](const PolygonCorner& from) {
        return std::all_of(other.begin(), other.end(),
                           [&](const PolygonCorner& corner) { return left_of(from.edge, corner.at) <= on_edge_; });
      });
    };
    return parts(a, b) || parts(b, a);
  }

  double area(const Polygon& polygon) const {
    double twice = 0;
    for (std::size_t k = 2; k < polygon.size(); ++k)
      twice += normal_.dot(cross<double>(polygon[k - 1].at - polygon[0].at, polygon[k].at - polygon[0].at));
    return twice / 2;
  }

  Vec<double, 3> place(int node) const { return points_.col(node); }

 private:
  const Points<double>& points_;
  Vec<double, 3> normal_;
  double on_edge_;  ///< length
};

/// A part of the slave facet with a master facet that is before or behind it, and its depth behind that facet, length;
/// negative: the facet is before it.
struct FacingPart {
  int master;
  double depth;
  Polygon polygon;
};

/// What of convex polygons another one does not cover, as convex polygons.
std::vector<Polygon> uncovered(const PolygonView& view, std::vector<Polygon> polygons, const Polygon& by) {
  std::vector<Polygon> beside;
  for (auto& polygon : polygons) {
    if (view.are_apart(polygon, by)) {
      beside.push_back(std::move(polygon));
      continue;
    }
    for (const auto& from : by) {
      auto [inside, outside] = view.cut(polygon, from.edge);
      if (outside.size() > 2) beside.push_back(std::move(outside));
      polygon = std::move(inside);
    }
  }
  return beside;
}

/// Leaves of each part what no nearer one covers, and of a part that is inside of the solid what is not outside again,
/// beyond another face of it: of `alike`, which look the way of the slave facet. There it penetrates no face on the far
/// side. Pieces of no more than `least_area` go.
std::vector<FacingPart> nearest_of(const PolygonView& view, std::vector<FacingPart> parts,
                                   const std::vector<FacingPart>& alike, double least_area) {
  const auto is_nearer = [](const auto& a, const auto& b) { return std::abs(a.depth) < std::abs(b.depth); };
  std::stable_sort(parts.begin(), parts.end(), is_nearer);
  std::vector<FacingPart> nearest, kept;
  for (auto& part : parts) {
    std::vector<Polygon> left{std::move(part.polygon)};
    for (const auto& nearer : nearest) left = uncovered(view, std::move(left), nearer.polygon);
    for (auto& polygon : left)
      if (view.area(polygon) > least_area) nearest.push_back({part.master, part.depth, std::move(polygon)});
  }
  for (auto& part : nearest) {
    std::vector<Polygon> left{std::move(part.polygon)};
    for (const auto& face : alike)
      if (face.depth > 0 && face.depth < part.depth) left = uncovered(view, std::move(left), face.polygon);
    for (auto& polygon : left)
      if (view.area(polygon) > least_area) kept.push_back({part.master, part.depth, std::move(polygon)});
  }
  return kept;
}

}  // namespace

Overlap whole_facet(const SideFacet& slave) {
  Overlap overlap{slave};
  for (int k = 0; k < slave.corners; ++k) {
    const int node = slave.nodes[k];
    overlap.vertices.push_back({{node, node}, {node, node}});
  }
  return overlap;
}

OverlapSearch::OverlapSearch(Points<double> points, std::vector<SideFacet> master)
    : points_(std::move(points)), master_(std::move(master)) {
  std::vector<int> all(master_.size());
  std::iota(all.begin(), all.end(), 0);
  boxes_ = BoxTree<3>(std::move(all), [this](int f) {
    Bounds<3> box{points_.col(master_[f].nodes[0]), points_.col(master_[f].nodes[0])};
    for (int k = 1; k < master_[f].corners; ++k) {
      box.low = box.low.cwiseMin(Vec<double, 3>(points_.col(master_[f].nodes[k])));
      box.high = box.high.cwiseMax(Vec<double, 3>(points_.col(master_[f].nodes[k])));
    }
    return box;
  });
}

Vec<double, 3> OverlapSearch::across(const SideFacet& facet) const {
  return area_vector<double>(facet.corners, [&](int k) -> Vec<double, 3> { return points_.col(facet.nodes[k]); });
}

/// Numbers, ascending, of the facets whose boxes a line along the normal of a slave facet may pass.
std::vector<int> OverlapSearch::near(const SideFacet& slave, const Vec<double, 3>& normal) const {
  Vec<double, 3> middle = Vec<double, 3>::Zero();
  double reach = 0;
  for (int k = 0; k < slave.corners; ++k) middle += place(slave.nodes[k]) / slave.corners;
  for (int k = 0; k < slave.corners; ++k) reach = std::max(reach, (place(slave.nodes[k]) - middle).norm());
  std::vector<int> near;
  const auto skips = [&](const Bounds<3>& box) {
    const Vec<double, 3> off = (box.low + box.high) / 2 - middle;
    return (off - off.dot(normal) * normal).norm() > reach + (box.high - box.low).norm() / 2;
  };
  boxes_.visit(middle, skips, [&](int f) { near.push_back(f); });
  std::sort(near.begin(), near.end());
  return near;
}

std::vector<Overlap> OverlapSearch::facing(const SideFacet& slave) const {
  constexpr double least_share = 1e-12;  // of the area of the facet
  const Vec<double, 3> whole = across(slave), normal = whole.normalized();
  const double area = whole.norm();
  double longest = 0;
  for (int k = 0; k < slave.corners; ++k)
    longest = std::max(longest, (place(slave.nodes[(k + 1) % slave.corners]) - place(slave.nodes[k])).norm());
  const PolygonView view(points_, normal, mesh_file_rounding * area / longest);
  const Polygon own = view.polygon(slave, false);
  std::vector<FacingPart> opposite, alike;
  for (int f : near(slave, normal)) {
    const Vec<double, 3> outward = across(master_[f]);
    const bool is_opposite = opposes<3>(outward, whole);
    if (!is_opposite && normal.dot(outward) <= at_face_edge * outward.norm()) continue;
    if (master_[f] == slave) continue;
    const Polygon other = view.polygon(master_[f], is_opposite);
    if (view.are_apart(own, other)) continue;
    Polygon part = own;
    for (const auto& from : other) part = view.cut(part, from.edge).first;
    if (view.area(part) <= least_share * area) continue;
    Vec<double, 3> middle = Vec<double, 3>::Zero();
    for (const auto& vertex : part) middle += vertex.at / static_cast<double>(part.size());
    const double depth = (middle - place(master_[f].nodes[0])).dot(outward) / normal.dot(outward);
    (is_opposite ? opposite : alike).push_back({f, depth, std::move(part)});
  }
  std::vector<Overlap> overlaps;
  for (const auto& part : nearest_of(view, std::move(opposite), alike, least_share * area)) {
    Overlap overlap{slave, master_[part.master]};
    for (const auto& vertex : part.polygon) overlap.vertices.push_back(vertex.of);
    overlaps.push_back(std::move(overlap));
  }
  return overlaps;
}

}  // namespace stickslip
