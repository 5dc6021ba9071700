#include "studies/run/side_curve.hpp"

#include <map>

#include "core/model/master_surface.hpp"
#include "core/model/pairing.hpp"
#include "core/model/supports.hpp"

namespace stickslip {

PlanePlace obstacle_displacement(const Problem& problem, const Obstacle& obstacle, const PlanePlace& x, double time) {
  const auto& numbers = problem.slots.numbers;
  PlanePlace u = PlanePlace::Zero();
  for (const auto& [axis, table] : obstacle.move)
    if (axis < 'z') u[axis - 'x'] = evaluate(table, time, numbers);
  if (obstacle.rotate)
    u += rotated<double>(*obstacle.rotate, x, evaluate(obstacle.rotate->angle, time, numbers),
                         strains_of(problem.model.scene.finite_strain), numbers);
  return u;
}

SideCurve curve_of_side(const SideSet& side, const Points<double>& points, const Contact& contact, bool smooth) {
  SideCurve curve;
  std::map<int, int> number;
  auto facets = side.facets;
  for (auto& facet : facets)
    for (int& node : facet) {
      const auto [found, is_new] = number.emplace(node, static_cast<int>(number.size()));
      if (is_new) curve.nodes.push_back(node);
      node = found->second;
    }
  curve.places.resize(2, static_cast<Eigen::Index>(curve.nodes.size()));
  for (std::size_t v = 0; v < curve.nodes.size(); ++v)
    curve.places.col(static_cast<Eigen::Index>(v)) = points.col(curve.nodes[v]).head<2>();
  curve.patches = make_surface<2>(facets, smooth ? contact.smoothing : Smoothing::none, contact.corner, curve.places);
  return curve;
}

SideCurve curve_of_obstacle(const Problem& problem, const Obstacle& obstacle, const Contact& contact, double time) {
  SideCurve curve;
  curve.places = vertices_of(obstacle.shape, problem.slots.numbers);
  for (auto x : curve.places.colwise()) x += obstacle_displacement(problem, obstacle, x, time);
  curve.patches = make_surface<2>(facets_of(obstacle.shape), contact.smoothing, contact.corner, curve.places);
  return curve;
}

const Obstacle* obstacle_of(const Model& model, int c) {
  const int obstacle = model.contact_sides[c].obstacle;
  return obstacle < 0 ? nullptr : &model.scene.obstacles[obstacle];
}

}  // namespace stickslip
