#include "sensitivity/vertex_margin.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "core/contact/segments.hpp"
#include "core/model/loading.hpp"
#include "core/model/positions.hpp"
#include "sensitivity/ties/edge_tie.hpp"
#include "sensitivity/ties/scales.hpp"

namespace stickslip {
namespace {

using Place = Vec<double, 2>;

/// How a point that faces a facet stands to the vertices at its ends.
struct WayToVertex {
  double share = 0;   ///< distance from a vertex, over the length of the facet
  double length = 0;  ///< of the facet
  double turn = 0;    ///< sine of the angle between the facets there; positive: the vertex stands out of the solid
};

/// Calls f for each end of the facet `faced` behind which another one is. `place(vertex)`: from the point.
template <class Places, class F>
void for_each_vertex(const Surface<2>& patches, int faced, Places&& place, F&& f) {
  const auto along = [&](int patch) -> Place {
    return place(patches[patch].corner(1)) - place(patches[patch].corner(0));
  };
  const double length = along(faced).norm();
  for (const int side : {0, 1}) {
    const int other = patches[faced].across[side];
    if (other == no_patch) continue;
    const Place vertex = place(patches[faced].corner(side));
    const Place a = along(faced).normalized(), b = along(other).normalized(), half = (a + b).normalized();
    const double turn = a[0] * b[1] - a[1] * b[0];
    f(WayToVertex{std::abs(vertex.dot(half)) / length, length, side == 1 ? turn : -turn});
  }
}

/// Nodes at which the slave side of an integrated curve ends.
std::vector<int> ends_of_slave(const Model& model, int curve) {
  std::set<std::array<int, 2>> facets;
  for (const auto& point : model.points)
    if (point.surface == curve)
      for (const auto& facet : point.segments) facets.insert(facet.slave);
  std::map<int, int> count;
  for (const auto& facet : facets)
    for (int node : facet) ++count[node];
  std::vector<int> ends;
  for (const auto& [node, times] : count)
    if (times == 1) ends.push_back(node);
  return ends;
}

/// Whether an integrated curve turns at a node, or its two facets there are stretched differently. `present(node)`,
/// `of_start(node)`: present and initial position.
template <class At, class OfStart>
bool has_kink_at(const MasterSurface& curve, int node, At&& present, OfStart&& of_start) {
  const auto along = [&](int patch, const auto& where) -> Place {
    return where(curve.facets[patch][1]) - where(curve.facets[patch][0]);
  };
  for (std::size_t f = 0; f < curve.facets.size(); ++f) {
    const int next = curve.patches<2>()[f].across[1];
    if (curve.facets[f][1] != node || next == no_patch) continue;
    const Place a = along(static_cast<int>(f), present), b = along(next, present);
    const double stretch = a.norm() / along(static_cast<int>(f), of_start).norm(),
                 other = b.norm() / along(next, of_start).norm();
    return std::abs(a[0] * b[1] - a[1] * b[0]) > straight * a.norm() * b.norm() ||
           std::abs(stretch - other) > straight * stretch;
  }
  return false;
}

/// Calls f(point, way) for each point that is closed in `reached` and faces a facet there, and each vertex of that; at
/// the places of `at`, whose time is `time`.
template <class F>
void for_each_way(const Model& model, const Slots<double>& slots, const State<double>& at, const State<double>& reached,
                  double time, F&& f) {
  if (model.dimension == 3 || !slides_along_facets(model)) return;
  const Vector<double> compact = to_compact(model, at.displacement);
  const auto positions = detail::positions_at(model, slots, compact, time);
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    if (point.surface < 0 || reached.contact.state[p] == ContactState::open) continue;
    const auto& curve = model.surfaces[point.surface];
    if (curve.is_integrated()) continue;
    const int faced = reached.contact.facing[p].patch;
    if (faced == no_patch || curve.patches<2>()[faced].is_smooth()) continue;
    const Placed<double> x = positions.slave(point);
    for_each_vertex(
        curve.patches<2>(), faced, [&](int vertex) -> Place { return positions.vertex(curve, vertex) - x; },
        [&](const WayToVertex& way) { f(static_cast<int>(p), way); });
  }
}

}  // namespace

double integration_margin(const Model& model, const Slots<double>& slots, const State<double>& state, double time) {
  double least = std::numeric_limits<double>::infinity();
  const Vector<double> compact = to_compact(model, state.displacement);
  const auto positions = detail::positions_at(model, slots, compact, time);
  for (int c = 0; c < static_cast<int>(model.surfaces.size()); ++c) {
    const auto& curve = model.surfaces[c];
    if (!model.slides_on_surfaces() || !curve.is_integrated()) continue;
    const auto of_start = [&](int node) -> Place { return detail::start_of<2>(model, curve.obstacle, slots, node); };
    const auto present = [&](int node) -> Placed<double> {
      if (node >= model.node_count) return positions.vertex_of_obstacle(curve.obstacle, node - model.node_count);
      return {of_start(node), state.displacement.segment<2>(2 * static_cast<Eigen::Index>(node))};
    };
    const auto ends = ends_of_slave(model, c);
    const auto is_end = [](const std::vector<int>& of, int node) {
      return std::find(of.begin(), of.end(), node) != of.end();
    };
    for (std::size_t p = 0; p < model.points.size(); ++p) {
      if (model.points[p].surface != c || state.contact.state[p] == ContactState::open) continue;
      for (const auto& segment : state.contact.facing[p].pieces) {
        const auto bulge = detail::bulge_of<double, double>(segment.slave_edge, present);
        for (int side : {0, 1})
          for (int node : segment.master) {
            if (!is_end(ends, segment.slave[side]) || !has_kink_at(curve, node, present, of_start)) continue;
            const Placed<double> a = present(segment.slave[0]);
            const Place tau = present(segment.slave[1]) - a;
            least = std::min(least, std::abs(detail::end_coordinate<double>(node, present, a, tau, bulge) - side));
          }
      }
    }
  }
  return least;
}

bool slides_along_facets(const Model& model) {
  const auto has_facets = [](const MasterSurface& surface) { return surface.has_facets(); };
  return model.slides_on_surfaces() && std::any_of(model.surfaces.begin(), model.surfaces.end(), has_facets);
}

double vertex_margin(const Model& model, const Slots<double>& slots, const State<double>& state, double time) {
  double least = std::min(integration_margin(model, slots, state, time), edge_margin(model, state));
  for_each_way(model, slots, state, state, time,
               [&](int, const WayToVertex& way) { least = std::min(least, way.share); });
  return least;
}

std::vector<char> contacts_at_vertices(const Model& model, const Slots<double>& slots, const State<double>& left,
                                       double start, const State<double>& reached, double end,
                                       const std::vector<double>& compliance) {
  constexpr double rounding = 1e-9;  // of a facet: coordinates of places that meet differ by less
  constexpr double turned = 1e-5;    // forces along normals that are nearer to one another are alike
  std::vector<char> contacts;
  const auto mark = [&](int p, const WayToVertex& way) {
    if (std::abs(way.turn) < turned) return;
    const auto& point = model.points[p];
    const auto& traction = reached.contact.traction;
    double reach = 0;
    if (!compliance.empty()) reach = compliance[p] * traction.segment(point.multiplier + 1, point.tangents).norm();
    if (way.turn > 0) {
      const double force = std::abs(traction[point.multiplier]) * slots.geometry[p].area;
      reach = std::max(reach, force * way.turn / slots.stiffness[p]);
    }
    if (way.share > std::max(rounding, reach / way.length)) return;
    contacts.resize(model.scene.contacts.size());
    contacts[point.contact] = 1;
  };
  for_each_way(model, slots, left, reached, start, mark);
  for_each_way(model, slots, reached, reached, end, mark);
  return contacts;
}

}  // namespace stickslip
