/// Search for what contact points face of their curves, where displacements have moved them.
#pragma once

#include "core/contact/curve_search.hpp"
#include "core/model/contact_geometry.hpp"
#include "core/model/segment_search.hpp"
#include "core/model/state.hpp"

namespace stickslip {

/// Regularisation of all points, force per length cubed.
template <class T>
using RegularisationField = std::vector<PointRegularisation<T>>;

/// What a contact evaluation reads beside displacement and multiplier.
template <class T>
struct ContactInput {
  const Model& model;
  const Slots<T>& slots;
  const RegularisationField<T>& rho;
  const History<T>& previous;  ///< of the last converged increment
  ConeRadius cone = ConeRadius::augmented;
  double time = 0;
  const std::vector<Facing>* facing = nullptr;  ///< per point, on its curve; nullptr: search for it

  /// Positions at compact displacements, which must outlive them.
  auto positions(const Vector<T>& compact) const { return detail::positions_at(model, slots, compact, time); }
};

namespace detail {

/// The patch that point p faced in the last increment, or Patch::none.
template <class T>
int last_faced(const ContactInput<T>& input, int p) {
  return input.previous.faces[p] ? input.previous.patch[p] : Patch::none;
}

/// A curve where displacements have moved it, and the search along it. Places are from the first vertex at the start,
/// so that what lies far from the origin is found as near it. Not to be copied.
template <class T>
struct MovedCurve {
  const ContactInput<T>& input;
  const Vector<T>& compact;  ///< displacements of the contact nodes
  Vec<double, 2> origin;
  Eigen::Matrix2Xd places;  ///< of the vertices
  CurveSearch search;

  /// All arguments must outlive this.
  MovedCurve(const ContactInput<T>& input, const MasterCurve& curve, const Vector<T>& compact)
      : input(input),
        compact(compact),
        origin(values(input.positions(compact).vertex(curve, 0).start)),
        places(places_of(curve)),
        search(curve.patches, places) {}
  MovedCurve(const MovedCurve&) = delete;

  /// Place of the slave node of a point.
  Vec<double, 2> slave(const ContactPoint& point) const { return place(input.positions(compact).slave(point)); }
  /// Outward normal of the slave side at a point, by the lengths of its facets; zero where it has none.
  Vec<double, 2> outward(const ContactPoint& point) const {
    const auto displacement = nodal_displacement(compact);
    const auto node = [&](int number, int at) {
      return place(Placed<T>{point2(input.slots.points, number), displacement(at)});
    };
    Vec<double, 2> normal = Vec<double, 2>::Zero();
    for (std::size_t f = 0; f < point.facet_places.size(); ++f) {
      const auto &facet = point.area_facets[f], &places = point.facet_places[f];
      const Vec<double, 2> along = node(facet[1], places[1]) - node(facet[0], places[0]);
      normal += Vec<double, 2>(along[1], -along[0]);
    }
    return normal;
  }

 private:
  Vec<double, 2> place(const Placed<T>& at) const { return values(at.start) - origin + values(at.moved); }
  Eigen::Matrix2Xd places_of(const MasterCurve& curve) const {
    Eigen::Matrix2Xd at(2, curve.vertex_count);
    for (int v = 0; v < curve.vertex_count; ++v) at.col(v) = place(input.positions(compact).vertex(curve, v));
    return at;
  }
};

/// Sets what the points of an integrated curve face.
template <class T>
void find_moved_segments(const ContactInput<T>& input, int curve, const Vector<T>& compact,
                         std::vector<Facing>& found) {
  const Model& model = input.model;
  const auto& master = model.curves[curve];
  Points<double> start = values(input.slots.points);
  if (master.obstacle >= 0) start.conservativeResize(Eigen::NoChange, model.node_count + master.vertex_count);
  Points<double> moved = Points<double>::Zero(start.rows(), start.cols());
  const auto displacement = nodal_displacement(compact);
  for (int n = 0; n < static_cast<int>(model.contact_nodes.size()); ++n)
    moved.col(model.contact_nodes[n]).template head<2>() = values(displacement(n));
  for (int v = 0; master.obstacle >= 0 && v < master.vertex_count; ++v) {
    const auto vertex = input.positions(compact).vertex(master, v);
    start.col(model.node_count + v) = values(vertex.start);
    moved.col(model.node_count + v) = values(vertex.moved);
  }
  std::vector<int> last;
  for (int p = 0; !master.own.empty() && p < static_cast<int>(found.size()); ++p)
    last.push_back(model.points[p].curve == curve ? last_faced(input, p) : Patch::none);
  find_segments(model, curve, start, moved, last, found);
}

/// What each contact point faces of its curve. `compact`: displacements of the contact nodes; `kept`: per point, the
/// patch on which its foot is to be found, or Patch::none to search the curve; empty: search for all points.
template <class T>
std::vector<Facing> facings(const ContactInput<T>& input, const Vector<T>& compact, const std::vector<int>& kept = {}) {
  const Model& model = input.model;
  std::vector<Facing> found(model.points.size());
  for (int c = 0; c < static_cast<int>(model.curves.size()); ++c) {
    if (model.curves[c].is_integrated()) {
      find_moved_segments(input, c, compact, found);
      continue;
    }
    const MovedCurve<T> now(input, model.curves[c], compact);
    for (int p = 0; p < static_cast<int>(found.size()); ++p) {
      const auto& point = model.points[p];
      if (point.curve != c) continue;
      const Vec<double, 2> x = now.slave(point);
      if (!kept.empty() && kept[p] != Patch::none)
        found[p] = now.search.foot_on(kept[p], x);
      else if (point.own.vertex == Patch::none)
        found[p] = now.search.facing(x, now.outward(point));
      else
        found[p] = now.search.facing_itself(x, now.outward(point), point.own, last_faced(input, p));
    }
  }
  return found;
}

/// Places the vertices of curves in contact with themselves that face nothing beside their nearest patches, from which
/// they slide if they come onto one. An equilibrium needs it, and no iterate on the way: the search looks far.
template <class T>
void place_open_vertices(const ContactInput<T>& input, const Vector<T>& compact, ContactField<T>& field) {
  std::optional<MovedCurve<T>> now;
  for (int p = 0, of = -1; p < static_cast<int>(field.facing.size()); ++p) {
    const auto& point = input.model.points[p];
    auto& facing = field.facing[p];
    if (point.own.vertex == Patch::none || point.foot < 0 || facing.patch != Patch::none) continue;
    if (of != point.curve) now.emplace(input, input.model.curves[point.curve], compact);
    of = point.curve;
    facing.nearest =
        now->search.nearest_of_itself(now->slave(point), now->outward(point), point.own, last_faced(input, p));
    const bool is_near = facing.nearest != Patch::none;
    field.foot[point.foot] = is_near ? place_beside(input.positions(compact), point, facing.nearest) : T(0);
  }
}

}  // namespace detail

}  // namespace stickslip
