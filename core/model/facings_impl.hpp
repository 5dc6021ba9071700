/// Definitions of the templates in facings.hpp.
#pragma once

#include <memory>
#include <optional>

#include "core/contact/surface_search.hpp"
#include "core/model/contact_geometry.hpp"
#include "core/model/facings.hpp"
#include "core/model/segment_search.hpp"

namespace stickslip {

namespace detail {

/// The patch that point p faced in the last increment, or no_patch.
template <class T>
int last_faced(const ContactInput<T>& input, int p) {
  return input.previous.faced[p] ? input.previous.patch[p] : no_patch;
}

/// The question what a point faces of a surface. `x`, `outward`: place of its slave node, and normal of the slave side
/// there; `last`: as last_faced(). The point and the surface must outlive it.
template <int D>
SurfaceQuery<D> query_of(const ContactPoint& point, const MasterSurface& surface, const Vec<double, D>& x,
                         const Vec<double, D>& outward, int last) {
  const bool rounds_ends = D == 3 && surface.is_rigid();
  SurfaceQuery<D> query{x, outward, rounds_ends ? point.mesh_size : 0};
  if (point.own.vertex == no_vertex) return query;
  query.own = &point.own;
  query.last = last;
  if constexpr (D == 3) query.start = &surface.start;
  return query;
}

/// A surface where displacements have moved it, and the search along it. Places are from the first vertex at the start,
/// so that what lies far from the origin is found as near it. An obstacle stays where it was at the start, and all else
/// is seen from it. Not to be copied.
template <class T, int D>
struct MovedSurface {
  using Place = Vec<double, D>;
  const ContactInput<T>& input;
  const MasterSurface& surface;
  const Vector<T>& compact;  ///< displacements of the contact nodes
  Place origin;
  Frame<T, D> frame;  ///< that places are seen from

  /// All arguments must outlive this.
  MovedSurface(const ContactInput<T>& input, const MasterSurface& surface, const Vector<T>& compact)
      : input(input),
        surface(surface),
        compact(compact),
        origin(values(positions().template vertex<D>(surface, 0).start)),
        frame(surface.is_rigid() ? positions().template frame<D>(surface.obstacle) : Frame<T, D>{}),
        places_(places_of(surface)) {
    if (const auto* still = std::get_if<std::shared_ptr<const StillSurface<D>>>(&surface.still)) still_ = *still;
    if (!still_ || still_->places != places_) own_.emplace(surface.patches<D>(), places_);
  }
  MovedSurface(const MovedSurface&) = delete;

  const SurfaceSearch<D>& search() const { return own_ ? *own_ : still_->search; }

  /// The question what point p faces.
  SurfaceQuery<D> query(int p) const {
    const auto& point = input.model.points[p];
    return query_of<D>(point, surface, place(positions().template slave<D>(point)), outward(point),
                       last_faced(input, p));
  }

 private:
  /// Outward normal of the slave side at a point, by the sizes of its facets; zero where it has none.
  Place outward(const ContactPoint& point) const {
    const auto displacement = nodal_displacement<D>(compact);
    Place normal = Place::Zero();
    for (std::size_t f = 0; f < point.facet_places.size(); ++f) {
      const auto &facet = point.area_facets[f], &at = point.facet_places[f];
      Points<double> corners(D, static_cast<Eigen::Index>(facet.size()));
      std::vector<int> order;
      for (std::size_t k = 0; k < facet.size(); ++k) {
        const Vec<T, D> X = input.slots.points.template block<D, 1>(0, facet[k]);
        corners.col(static_cast<Eigen::Index>(k)) = place({X, displacement(at[k])});
        order.push_back(static_cast<int>(k));
      }
      normal += slave_normal<D>({order}, corners);
    }
    return normal;
  }
  auto positions() const { return positions_at<D>(input.model, input.slots, compact, input.time); }
  Place place(const Placed<T, T, D>& at) const {
    return values(at.start) - origin + values(frame.seen(at.start, at.moved));
  }
  Places<D> places_of(const MasterSurface& surface) const {
    if (surface.is_rigid()) return values(input.slots.vertices[surface.obstacle]).colwise() - origin;
    Places<D> at(D, surface.vertex_count);
    for (int v = 0; v < surface.vertex_count; ++v) at.col(v) = place(positions().template vertex<D>(surface, v));
    return at;
  }

  Places<D> places_;                              ///< of the vertices
  std::shared_ptr<const StillSurface<D>> still_;  ///< of an obstacle
  std::optional<SurfaceSearch<D>> own_;  ///< of what has moved, or has other places than the model was made for
};

/// Sets what the points of an integrated curve face.
template <class T>
void find_moved_segments(const ContactInput<T>& input, int curve, const Vector<T>& compact,
                         std::vector<Facing>& found) {
  const Model& model = input.model;
  const auto& master = model.surfaces[curve];
  Points<double> start = values(input.slots.points);
  if (master.obstacle >= 0) start.conservativeResize(Eigen::NoChange, model.node_count + master.vertex_count);
  Points<double> moved = Points<double>::Zero(start.rows(), start.cols());
  const auto displacement = nodal_displacement(compact);
  for (int n = 0; n < static_cast<int>(model.contact_nodes.size()); ++n)
    moved.col(model.contact_nodes[n]).template head<2>() = values(displacement(n));
  for (int v = 0; master.obstacle >= 0 && v < master.vertex_count; ++v) {
    const auto vertex = positions_at(input.model, input.slots, compact, input.time).vertex(master, v);
    start.col(model.node_count + v) = values(vertex.start);
    moved.col(model.node_count + v) = values(vertex.moved);
  }
  std::vector<int> last;
  for (int p = 0; !master.own.empty() && p < static_cast<int>(found.size()); ++p)
    last.push_back(model.points[p].surface == curve ? last_faced(input, p) : no_patch);
  find_segments(model, curve, start, moved, last, found);
}

/// Sets what the points of a surface face; the arguments are those of facings().
template <class T, int D>
void find_along_surface(const ContactInput<T>& input, int surface, const Vector<T>& compact,
                        const std::vector<int>& kept, std::vector<Facing>& found) {
  const Model& model = input.model;
  const MovedSurface<T, D> now(input, model.surfaces[surface], compact);
  for (int p = 0; p < static_cast<int>(found.size()); ++p) {
    const auto& point = model.points[p];
    if (point.surface != surface) continue;
    const SurfaceQuery<D> query = now.query(p);
    if (!kept.empty() && kept[p] != no_patch)
      found[p] = now.search().foot_on(kept[p], query);
    else
      found[p] = query.own ? now.search().facing_itself(query) : now.search().facing(query, !input.previous.faced[p]);
  }
}

template <class T>
std::vector<Facing> facings(const ContactInput<T>& input, const Vector<T>& compact, const std::vector<int>& kept) {
  const Model& model = input.model;
  std::vector<Facing> found(model.points.size());
  for (int c = 0; c < static_cast<int>(model.surfaces.size()); ++c) {
    if (model.surfaces[c].is_integrated())
      find_moved_segments(input, c, compact, found);
    else
      with_dimension(model.dimension, [&]<int D>() { find_along_surface<T, D>(input, c, compact, kept, found); });
  }
  return found;
}

template <class T, int D>
void place_open_vertices_beside(const ContactInput<T>& input, const Vector<T>& compact, ContactField<T>& field) {
  std::optional<MovedSurface<T, D>> now;
  for (int p = 0, of = -1; p < static_cast<int>(field.facing.size()); ++p) {
    const auto& point = input.model.points[p];
    auto& facing = field.facing[p];
    if (point.own.vertex == no_vertex || point.foot < 0 || facing.patch != no_patch) continue;
    const MasterSurface& side = input.model.surfaces[point.surface];
    if (of != point.surface) now.emplace(input, side, compact);
    of = point.surface;
    facing.nearest = now->search().nearest_of_itself(now->query(p));
    PlacedPoint<T, D> at;
    if (facing.nearest != no_patch)
      place_beside(positions_at<D>(input.model, input.slots, compact, input.time), point, facing.nearest, at);
    for (int i = 0; i < point.feet(D); ++i) field.foot[point.foot + i] = at.foot[i];
  }
}

template <class T>
void place_open_vertices(const ContactInput<T>& input, const Vector<T>& compact, ContactField<T>& field) {
  with_dimension(input.model.dimension, [&]<int D>() { place_open_vertices_beside<T, D>(input, compact, field); });
}

}  // namespace detail

}  // namespace stickslip
