#include "studies/run/turned_surfaces.hpp"

#include <fmt/core.h>

#include <limits>

#include "core/contact/surface_search.hpp"
#include "core/model/pairing.hpp"
#include "studies/run/facing_sides.hpp"
#include "studies/run/side_curve.hpp"

namespace stickslip {
namespace {

/// Cosine of two normals that count as alike, or as opposed: a side that is steeper may come to touch with its end.
constexpr double alike_from = 0.5;

/// An obstacle where it is at the start.
class StartingObstacle {
 public:
  StartingObstacle(const Problem& problem, const Contact& contact, const Obstacle& obstacle)
      : numbers_(problem.slots.numbers), shape_(obstacle.shape) {
    if (!has_facets(shape_)) return;
    if (problem.model.dimension == 3) {
      faces_.emplace(vertices_of(shape_, numbers_), facets_of(shape_));
      return;
    }
    curve_ = curve_of_obstacle(problem, obstacle, contact, 0);
    search_.emplace(curve_.patches, curve_.places);
  }

  struct Seen {
    Vector<double> normal;  ///< outward, of the nearest place of the obstacle
    double gap = 0;
    bool is_inside = false;  ///< of its solid, by more than rounding
  };
  /// From a place x; none past free ends, and where all places are equally near.
  std::optional<Seen> from(const Vector<double>& x) const {
    std::optional<Seen> seen;
    if (search_) {
      const PlanePlace place = x.head<2>();
      const Facing facing = search_->facing({place, PlanePlace::Zero()});
      if (facing.patch == no_patch) return std::nullopt;
      const auto foot = foot_on_patch<double>(curve_.patches[facing.patch], facing.at, place, curve_.position());
      seen = {foot.normal, foot.gap};
    } else if (faces_) {
      const Vec<double, 3> place = x;
      const auto near = faces_->closest(place, Vec<double, 3>::Zero());
      if (near.empty()) return std::nullopt;
      std::vector<int> nodes{no_vertex};  // x, then those of the faces
      for (const auto& face : near) nodes.insert(nodes.end(), face.nodes.begin(), face.nodes.begin() + face.corners);
      const auto position = [&](int vertex) { return faces_->position(vertex); };
      const auto at = against_faces<double>(place, near, nodes, position);
      seen = {at.normal, at.gap};
    } else {
      if (ambiguity(x, shape_, numbers_)) return std::nullopt;
      const auto at = against_rigid<double>(x, shape_, numbers_);
      seen = {at.normal, at.gap};
    }
    seen->is_inside = seen->gap < -8 * unit_roundoff * (x.norm() + std::abs(seen->gap));
    return seen;
  }

 private:
  const Numbers<double>& numbers_;
  const RigidSurface& shape_;
  SideCurve curve_;
  std::optional<SurfaceSearch<2>> search_;  ///< of facets in the plane
  std::optional<FaceSearch> faces_;         ///< of facets in space
};

/// How the nodes of a side stand to an obstacle: the side's outward normal to the obstacle's.
struct Stance {
  int alike = 0, opposed = 0, inside = 0, all = 0;
  double gap = std::numeric_limits<double>::infinity();  ///< least of the nodes that look at the obstacle
};

Stance stance_of(const Problem& problem, const StartingObstacle& obstacle, const SideSet& side) {
  constexpr double against = 1e-9;  // cosine: less is a side along the obstacle's normal, to rounding
  Stance stance;
  for (const auto& [node, outward] : outward_normals(problem.slots.points, side)) {
    const auto seen = obstacle.from(problem.slots.points.col(node));
    if (!seen) continue;
    const double cosine = seen->normal.dot(outward.normalized());
    ++stance.all;
    stance.alike += cosine > alike_from;
    stance.opposed += cosine < -against;
    stance.inside += seen->is_inside;
    if (cosine < -alike_from) stance.gap = std::min(stance.gap, seen->gap);
  }
  return stance;
}

/// The side of a body that looks at an obstacle and is nearest to it: "body.side"; empty: none does.
std::string nearest_side(const Problem& problem, const StartingObstacle& obstacle, int body) {
  const Model& model = problem.model;
  std::string name;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& candidate : names_of_sides(model, body)) {
    const Stance stance = stance_of(problem, obstacle, surface_of(model, problem.slots.points, model.side(candidate)));
    if (stance.alike > 0 || !(stance.gap < least)) continue;
    least = stance.gap;
    name = candidate;
  }
  return name;
}

/// The slave is on the far side of its body, which is as a whole where it may be: the obstacle is right.
Warning far_side_warning(const Problem& problem, const StartingObstacle& obstacle, int c, int nodes) {
  const auto& contact = problem.model.scene.contacts[c];
  const std::string side = nearest_side(problem, obstacle, problem.model.contact_sides[c].slave.body);
  return {WarningCode::turned_surface, contact.name, static_cast<double>(nodes),
          side.empty() ? fmt::format("take the side of this body that faces {} as the slave", contact.master)
                       : fmt::format("take {} as the slave, which faces {}", side, contact.master),
          fmt::format("{0}: {1} faces away from {2}, and its body is outside of {2}: it is the far side of the body",
                      contact.name, contact.slave, contact.master)};
}
}  // namespace

std::optional<Warning> turned_surface(const Problem& problem, int c) {
  const Model& model = problem.model;
  const auto& points = problem.slots.points;
  const auto& contact = model.scene.contacts[c];
  const Obstacle* const shape = obstacle_of(model, c);
  if (!shape) return std::nullopt;
  const SideSet side = surface_of(model, points, model.contact_sides[c].slave);
  const auto& body = model.bodies[side.body];
  if (!is_continuum(body.mesh.shape)) return std::nullopt;  // points and bars have no inside
  const StartingObstacle obstacle(problem, contact, *shape);
  const auto warning = [&](const std::string& words, int faulty) {
    return Warning{WarningCode::turned_surface, contact.name, static_cast<double>(faulty), if_turned(shape->shape),
                   contact.name + ": " + words};
  };
  const Stance stance = stance_of(problem, obstacle, side);
  if (stance.alike > 0 && stance.opposed == 0) {
    int within = 0;
    for (int node = 0; node < body.mesh.node_count; ++node) {
      const auto seen = obstacle.from(points.col(body.first_node + node));
      within += seen && seen->is_inside;
    }
    if (within == 0) return far_side_warning(problem, obstacle, c, stance.alike);
    return warning(fmt::format("the solid of {} is on the side of {}, whose outward normals point the same way as its "
                               "own",
                               contact.master, contact.slave),
                   stance.alike);
  }
  if (stance.alike > 0 && 2 * stance.inside > stance.all && stance.inside + 1 >= stance.all)
    return warning(fmt::format("{} starts inside of the solid of {}", contact.slave, contact.master),
                   stance.inside);  // a closed side: one node may be on it
  return std::nullopt;
}

}  // namespace stickslip
