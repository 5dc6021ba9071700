/// The nodes that a contact point touches: what it faces tells them.
#pragma once

#include "core/model/state.hpp"

namespace stickslip {

/// Calls f(place) for each vertex of a patch, Model::contact_nodes[place]; for none where no node moves the surface, or
/// `patch` is no_patch.
template <class F>
void for_each_place(const MasterSurface& surface, int patch, F&& f) {
  if (surface.is_rigid() || patch == no_patch) return;
  for (int vertex : surface.vertices(patch))
    if (vertex != no_vertex) f(surface.places[vertex]);
}

/// Calls f(place) for each node of a point that faces `facing`, Model::contact_nodes[place], in the order of the
/// weights of its geometry.
template <class F>
void for_each_place(const Model& model, const ContactPoint& point, const Facing& facing, F&& f) {
  if (point.surface < 0 || !model.slides_on_surfaces()) {
    for (int place : point.places) f(place);
  } else if (!facing.nodes.empty()) {
    for (int node : facing.nodes) f(model.place_of(node));
  } else {
    f(point.places[0]);
    for_each_place(model.surfaces[point.surface], facing.patch, f);
  }
}

/// What point p faces of its surface in a field.
template <class T>
const Facing& facing_in(const Model& model, const ContactField<T>& field, std::size_t p) {
  return field.facing.empty() ? model.points[p].facing : field.facing[p];
}

/// Calls f(n, place) for each n. weights[n] of geometry_in() belongs to the node Model::contact_nodes[place].
template <class T, class F>
void for_each_place(const Model& model, const ContactField<T>& field, std::size_t p, F&& f) {
  std::size_t n = 0;
  for_each_place(model, model.points[p], facing_in(model, field, p), [&](int place) { f(n++, place); });
}

/// The nodes to which the weights of geometry_in() belong.
template <class T>
std::vector<int> nodes_in(const Model& model, const ContactField<T>& field, std::size_t p) {
  std::vector<int> nodes;
  for_each_place(model, field, p, [&](std::size_t, int place) { nodes.push_back(model.contact_nodes[place]); });
  return nodes;
}

}  // namespace stickslip
