#include "core/model/faced_pieces.hpp"

#include <map>

#include "core/contact/facet_search.hpp"
#include "core/contact/segments.hpp"

namespace stickslip {
namespace {

/// Share of its area below which a point faces nothing: its traction would be its force over next to no area.
constexpr double least_share = 0.01;

auto place_in(const Points<double>& points) {
  return [&points](int node) -> Vec<double, 2> { return points.col(node).head<2>(); };
}

/// Share of a point's area that pieces are.
double share_of(const std::vector<Piece>& pieces, const ContactPoint& point, const Points<double>& points,
                const Points<double>& places) {
  const auto nodes = nodes_of_pieces(point.nodes[0], point.pieces, pieces);
  const auto unread = [](const Vec<double, 2>& x) { return detail::Foot<double>{x, x, {}}; };
  const double area = integrate_pieces<double>(pieces, nodes, place_in(places), place_in(points), Depth<double>{},
                                               unread, [](auto&&...) {})
                          .area;
  return area / area_of_facets<double>(point.pieces, place_in(points), Depth<double>{});
}

}  // namespace

void find_pieces(const Model& model, int curve, const Points<double>& points, const Points<double>& places,
                 std::vector<Facing>& found) {
  const auto& master = model.curves[curve];
  const FacetSearch search(places, master.facets);
  std::map<std::array<int, 2>, std::vector<Piece>> of_facet;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    if (point.curve != curve) continue;
    Facing facing;
    for (const Piece& facet : point.pieces) {
      const auto [entry, is_new] = of_facet.try_emplace(facet.slave);
      if (is_new) entry->second = search.facing(facet.slave, master.ends);
      for (Piece piece : entry->second) {
        piece.carrier = facet.carrier;
        piece.whole = facet.whole;
        facing.pieces.push_back(piece);
      }
    }
    if (!facing.pieces.empty() && !(share_of(facing.pieces, point, points, places) >= least_share))
      facing.pieces.clear();
    if (facing.pieces.empty())
      facing.distance = search.distance(places.col(point.nodes[0]).head<2>());
    else
      facing.patch = facing.pieces.front().facet;
    facing.nodes = nodes_of_pieces(point.nodes[0], point.pieces, facing.pieces);
    found[p] = std::move(facing);
  }
}

}  // namespace stickslip
