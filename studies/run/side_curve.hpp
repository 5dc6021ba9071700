/// Sides and obstacles of facets as curves of their own, for searches of what a contact does not look for itself; and
/// where obstacles are.
#pragma once

#include <vector>

#include "core/contact/foot_in_plane.hpp"
#include "core/contact/surface_search.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

using PlanePlace = Vec<double, 2>;

/// A side, or an obstacle, as a curve at some positions: a copy, for searches of what it does not look for itself.
struct SideCurve {
  std::vector<int> nodes;  ///< per vertex; empty of an obstacle
  Eigen::Matrix2Xd places;
  Surface<2> patches;

  auto position() const {
    return [this](int vertex) -> PlanePlace { return places.col(vertex); };
  }
  /// Gap of x to the place that it faces.
  double gap(const Facing& facing, const PlanePlace& x) const {
    return foot_on_patch<double>(patches[facing.patch], facing.at, x, position()).gap;
  }
};

SideCurve curve_of_side(const SideSet& side, const Points<double>& points, const Contact& contact, bool smooth);

/// pre: the obstacle has facets, and the space is plane
SideCurve curve_of_obstacle(const Problem& problem, const Obstacle& obstacle, const Contact& contact, double time);

/// Displacement, length, of the place x of an obstacle of the plane at a time.
PlanePlace obstacle_displacement(const Problem& problem, const Obstacle& obstacle, const PlanePlace& x, double time);

/// The master of Scene::contacts[c], if it is an obstacle; else nullptr.
const Obstacle* obstacle_of(const Model& model, int c);

}  // namespace stickslip
