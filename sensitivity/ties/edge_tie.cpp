#include "sensitivity/ties/edge_tie.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "core/contact/surface_search.hpp"
#include "core/model/loading.hpp"
#include "core/model/master_geometry.hpp"
#include "sensitivity/ties/tie.hpp"

namespace stickslip {
namespace {

/// The normal of a patch at a place, and how it turns along each direction of its tangent plane.
struct Shape {
  Eigen::Matrix<double, 3, 2> slopes;
  Vec<double, 3> normal;
  Eigen::Matrix3d turn;  ///< dn = turn dx, 1 / length
  double size;           ///< of the patch, length
};

/// `vertex(v)`: where vertex v of the surface is.
template <class Vertex>
Shape shape_at(const Patch<3>& patch, const Vec<double, 2>& at, Vertex&& vertex) {
  Eigen::Matrix3Xd arms(3, static_cast<Eigen::Index>(patch.vertices.size()));
  const Placed<double, double, 3> origin = vertex(patch.vertices[0]);
  for (std::size_t i = 0; i < patch.vertices.size(); ++i)
    arms.col(static_cast<Eigen::Index>(i)) = vertex(patch.vertices[i]) - origin;
  const Eigen::Matrix<double, 3, 5> y = arms * curved_weights(patch, at).middleCols<5>(1);
  const Eigen::Matrix<double, 3, 2> slopes = y.leftCols<2>();
  const Vec<double, 3> across = cross<double>(y.col(0), y.col(1));
  const double area = across.norm();
  Shape shape{slopes, across / area, Eigen::Matrix3d::Zero(), std::sqrt(area)};
  Eigen::Matrix<double, 3, 2> turns;
  for (int i = 0; i < 2; ++i) {
    const Vec<double, 3> rate = (cross<double>(y.col(2 + i), y.col(1)) + cross<double>(y.col(0), y.col(3 + i))) / area;
    turns.col(i) = rate - rate.dot(shape.normal) * shape.normal;
  }
  shape.turn = turns * (slopes.transpose() * slopes).inverse() * slopes.transpose();
  return shape;
}

/// What jumps between two patches at one place.
struct Jump {
  double turn;  ///< sine of the angle between the normals
  double bend;  ///< of the curvature, times the size
  bool is_kink() const { return turn > straight || bend > straight; }
};
Jump jump_between(const Shape& a, const Shape& b) {
  return {cross<double>(a.normal, b.normal).norm(), (a.turn - b.turn).norm() * a.size};
}

bool is_along_surface(const Model& model, const State<double>& state, int p) {
  const auto& point = model.points[p];
  return model.dimension == 3 && point.surface >= 0 && faced_at(model, state, p).patch != no_patch;
}

/// The foot of a point on the patch that it faces, in a scalar. `positions`: detail::Positions.
template <class T, class At>
SurfacePlace<T, 3> foot_of(const At& positions, int p, const Facing& facing) {
  const Model& model = positions.model;
  const auto& point = model.points[p];
  const auto& surface = model.surfaces[point.surface];
  const auto vertex = [&](int v) { return positions.template vertex<3>(surface, v); };
  return foot_on_patch<T, T>(surface.patches<3>()[facing.patch], detail::foot_reference<3>(model, point, facing.patch),
                             facing.at, positions.template slave<3>(point), vertex)
      .place;
}

/// beyond_edge() of a foot with its derivatives.
Direction beyond(const SurfacePlace<Direction, 3>& foot, int edge) {
  Direction way(beyond_edge(*foot.patch, edge, foot.at));
  const Vec<double, 2> origin = Vec<double, 2>::Zero();
  for (int i = 0; i < 2; ++i) {
    Vec<double, 2> along = origin;
    along[i] = 1;
    way += foot.rest[i] * (beyond_edge(*foot.patch, edge, along) - beyond_edge(*foot.patch, edge, origin));
  }
  return way;
}

}  // namespace

void EdgeTie::find(const SolvedState& of, std::vector<Tie>& ties) {
  const auto& [model, slots, state, memory, rho, cone, time, largest] = of;
  if (model.dimension != 3 || !model.slides_on_surfaces()) return;
  const Vector<double> compact = to_compact(model, state.displacement);
  const auto positions = detail::positions_at<3>(model, slots, compact, time);
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    if (!is_along_surface(model, state, p) || !has_a_say(of, p)) continue;
    const auto& point = model.points[p];
    const auto& surface = model.surfaces[point.surface];
    const auto on_patches = patches_at(surface.patches<3>(), state.contact.facing[p], weak_margin);
    if (on_patches.size() < 2) continue;
    const auto vertex = [&](int v) { return positions.template vertex<3>(surface, v); };
    const auto shape = [&](const Facing& at) { return shape_at(surface.patches<3>()[at.patch], at.at, vertex); };
    const Shape first = shape(on_patches[0]);
    Eigen::Matrix<double, 3, 2> tangents = Eigen::Matrix<double, 3, 2>::Zero();
    for (int a = 0; a < 2 && point.foot >= 0; ++a)
      tangents.col(a) = first.slopes * state.history.foot.template segment<2>(point.foot + 2 + 2 * a);
    double turn = 0;
    bool is_kink = !surface.patches<3>()[on_patches[0].patch].is_smooth();
    std::vector<Place> places;
    for (const Facing& facing : on_patches) {
      const Shape here = shape(facing);
      const Jump jump = jump_between(first, here);
      turn = std::max(turn, jump.turn);
      is_kink |= jump.is_kink();
      const Mat<double, 2> metric = here.slopes.transpose() * here.slopes;
      const Mat<double, 2> terms = metric.inverse() * here.slopes.transpose() * tangents;
      places.push_back({facing, {terms(0, 0), terms(1, 0), terms(0, 1), terms(1, 1)}});
    }
    if (is_kink) ties.emplace_back(EdgeTie{p, std::move(places), !bears(of, p) || turn <= straight});
  }
}

std::vector<Choice> EdgeTie::choices(const Model&) const {
  std::vector<Choice> all;
  if (crosses)
    for (const Place& place : places) all.push_back({place.facing.patch});
  return all;
}

Choice EdgeTie::now(const Model&, const State<double>& at) const { return {at.contact.facing[point].patch}; }

void EdgeTie::set(const Model& model, const Choice& choice, State<double>& at) const {
  const auto& [facing, tangents] = *std::find_if(
      places.begin(), places.end(), [&](const Place& place) { return place.facing.patch == choice.branch; });
  at.contact.facing[point] = facing;
  at.history.patch[point] = choice.branch;
  const auto& of = model.points[point];
  if (of.foot < 0) return;
  at.history.foot.segment<2>(of.foot) = facing.at - detail::foot_reference<3>(model, of, choice.branch).at;
  at.history.foot.segment<4>(of.foot + 2) = tangents;
}

Verdict EdgeTie::verdict(const SidedDerivative& derivative) const {
  const auto& [of, block, rho, side, scales, flows] = derivative;
  const Facing facing = of.at.contact.facing[point];
  const Vector<Direction> now = to_compact(of.model, block.current.displacement);
  const auto foot = foot_of<Direction>(detail::positions_at<3>(of.model, block.slots, now, of.time), point, facing);
  const auto& patch = *foot.patch;
  const Vector<double> compact = to_compact(of.model, of.at.displacement);
  const auto positions = detail::positions_at<3>(of.model, of.slots, compact, of.time);
  const auto& surface = of.model.surfaces[of.model.points[point].surface];
  const double size = shape_at(patch, facing.at, [&](int v) { return positions.vertex<3>(surface, v); }).size;
  const double negligible = scales.negligible(scales.of_mesh / size)[0];
  Verdict verdict;
  for (int k = 0; k < patch.corners; ++k) {
    const Direction way = beyond(foot, k);
    if (patch.across[k] == no_patch || std::abs(way.v) > weak_margin) continue;
    const double by = derivative.rate(way) / negligible;
    if (by > std::max(1.0, verdict.severity)) verdict = {crosses, Choice{patch.across[k]}, by};
  }
  return verdict;
}

void for_each_edge_way(const Model& model, const Slots<Direction>& slots, const Vector<Direction>& displacement,
                       const State<double>& state, double time,
                       const std::function<void(const Direction&, double)>& f) {
  const auto visit = [&](const auto& positions) {
    for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
      if (state.contact.state[p] == ContactState::open || !is_along_surface(model, state, p)) continue;
      const auto& surface = model.surfaces[model.points[p].surface];
      const auto vertex = [&](int v) -> Placed<double, double, 3> {
        const auto at = positions.template vertex<3>(surface, v);
        return {values(at.start), values(at.moved)};
      };
      const Facing facing = faced_at(model, state, p);
      const auto foot = foot_of<Direction>(positions, p, facing);
      for (int k = 0; k < foot.patch->corners; ++k) {
        if (foot.patch->across[k] == no_patch) continue;
        const auto [here, there] = places_on_edge(surface.patches<3>(), facing, k);
        const Shape a = shape_at(*foot.patch, here.at, vertex),
                    b = shape_at(surface.patches<3>()[there.patch], there.at, vertex);
        if (!foot.patch->is_smooth() || jump_between(a, b).is_kink()) f(beyond(foot, k), a.size);
      }
    }
  };
  if (!model.slides_on_surfaces()) return visit(detail::positions_of_start(model, slots));
  const Vector<Direction> compact = to_compact(model, displacement);
  visit(detail::positions_at<3>(model, slots, compact, time));
}

double edge_margin(const Model& model, const State<double>& state) {
  double least = std::numeric_limits<double>::infinity();
  if (!model.slides_on_surfaces()) return least;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    if (state.contact.state[p] == ContactState::open || !is_along_surface(model, state, p)) continue;
    const Facing& facing = state.contact.facing[p];
    const Patch<3>& patch = model.surfaces[model.points[p].surface].patches<3>()[facing.patch];
    for (int k = 0; k < patch.corners && !patch.is_smooth(); ++k)
      if (patch.across[k] != no_patch) least = std::min(least, std::abs(beyond_edge(patch, k, facing.at)));
  }
  return least;
}

}  // namespace stickslip
