#include "studies/run/turned_surfaces.hpp"

#include <fmt/core.h>

#include <map>

#include "core/contact/surface_search.hpp"
#include "core/model/pairing.hpp"
#include "studies/run/side_curve.hpp"

namespace stickslip {
namespace {

/// Geometry of the nearest place of an obstacle at the start: outward normal and gap; none past its free ends.
std::optional<std::pair<PlanePlace, double>> start_against(const Problem& problem, const Obstacle& obstacle,
                                                           const SideCurve& polyline, const SurfaceSearch<2>* search,
                                                           const PlanePlace& x) {
  if (!search) {
    if (ambiguity(x, obstacle.shape, problem.slots.numbers)) return std::nullopt;
    const auto at = against_rigid<double>(x, obstacle.shape, problem.slots.numbers);
    return std::pair{PlanePlace(at.normal[0], at.normal[1]), at.gap};
  }
  const Facing facing = search->facing(x, PlanePlace::Zero());
  if (facing.patch == no_patch) return std::nullopt;
  const auto foot = foot_on_patch<double>(polyline.patches[facing.patch], facing.at, x, polyline.position());
  return std::pair{foot.normal, foot.gap};
}

/// The slave is on the far side of its body, which is as a whole where it may be: the obstacle is right.
Warning far_side_warning(const Problem& problem, int c, int nodes) {
  const auto& contact = problem.model.scene.contacts[c];
  return {WarningCode::turned_surface, contact.name, static_cast<double>(nodes),
          fmt::format("take the side of this body that faces {} as the slave", contact.master),
          fmt::format("{0}: {1} faces away from {2}, and its body is outside of {2}: it is the far side of the body",
                      contact.name, contact.slave, contact.master)};
}

Warning turned_warning(const Problem& problem, int c, const std::string& words, int faulty) {
  const auto& contact = problem.model.scene.contacts[c];
  const Obstacle& obstacle = *obstacle_of(problem.model, c);
  return {WarningCode::turned_surface, contact.name, static_cast<double>(faulty), if_turned(obstacle.shape),
          contact.name + ": " + words};
}
}  // namespace

std::optional<Warning> turned_surface(const Problem& problem, int c) {
  // Cosine of the two normals: a side that is steeper may come to touch with its end.
  constexpr double alike_from = 0.5;
  constexpr double against = 1e-9;  // cosine: less is a side along the obstacle's normal, to rounding
  const Model& model = problem.model;
  const auto& slots = problem.slots;
  const auto& contact = model.scene.contacts[c];
  const Obstacle* const obstacle = obstacle_of(model, c);
  if (!obstacle || model.dimension != 2) return std::nullopt;
  const SideSet side = surface_of(model, slots.points, model.contact_sides[c].slave);
  if (!is_continuum(model.bodies[side.body].mesh.shape)) return std::nullopt;  // points and bars have no inside
  std::map<int, PlanePlace> outward;
  for (const auto& facet : side.facets) {
    const PlanePlace along = slots.points.col(facet[1]).head<2>() - slots.points.col(facet[0]).head<2>();
    for (int node : facet)
      outward.try_emplace(node, PlanePlace::Zero()).first->second += PlanePlace(along[1], -along[0]);
  }
  if (outward.empty()) return std::nullopt;
  const bool is_polyline = std::holds_alternative<Polyline>(obstacle->shape);
  const SideCurve polyline = is_polyline ? curve_of_polyline(problem, *obstacle, contact, 0) : SideCurve{};
  std::optional<SurfaceSearch<2>> search;
  if (is_polyline) search.emplace(polyline.patches, polyline.places);
  int alike = 0, opposed = 0, inside = 0, all = 0;
  for (int node : side.nodes) {
    const PlanePlace x = slots.points.col(node).head<2>();
    const auto found = outward.find(node);
    const auto at = start_against(problem, *obstacle, polyline, search ? &*search : nullptr, x);
    if (!at || found == outward.end()) continue;
    const double cosine = at->first.dot(found->second.normalized());
    const double rounding = 8 * unit_roundoff * (x.norm() + std::abs(at->second));
    ++all;
    alike += cosine > alike_from;
    opposed += cosine < -against;
    inside += at->second < -rounding;
  }
  const auto& body = model.bodies[side.body];
  const auto is_inside = [&](int node) {
    const PlanePlace x = slots.points.col(node).head<2>();
    const auto at = start_against(problem, *obstacle, polyline, search ? &*search : nullptr, x);
    return at && at->second < -8 * unit_roundoff * (x.norm() + std::abs(at->second));
  };
  if (alike > 0 && opposed == 0) {
    int within = 0;
    for (int node = 0; node < body.mesh.node_count; ++node) within += is_inside(body.first_node + node);
    if (within == 0) return far_side_warning(problem, c, alike);
    const auto words =
        fmt::format("the solid of {} is on the side of {}, whose outward normals point the same way as its own",
                    contact.master, contact.slave);
    return turned_warning(problem, c, words, alike);
  }
  if (alike > 0 && opposed > 0 && 2 * inside > all && inside + 1 >= all) {  // a closed side: one node may be on it
    return turned_warning(problem, c, fmt::format("{} starts inside of the solid of {}", contact.slave, contact.master),
                          inside);
  }
  return std::nullopt;
}

}  // namespace stickslip
