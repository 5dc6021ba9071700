/// The nodes that a contact point touches: what it faces tells them.
#pragma once

#include "core/model/model.hpp"

namespace stickslip {

/// Calls f(place) for each vertex of a patch, Model::contact_nodes[place]; for none where no node moves the curve, or
/// `patch` is Patch::none.
template <class F>
void for_each_place(const MasterCurve& curve, int patch, F&& f) {
  if (curve.obstacle >= 0 || patch == Patch::none) return;
  for (int vertex : curve.vertices(patch))
    if (vertex != Patch::none) f(curve.places[vertex]);
}

/// Calls f(place) for each node of a point that faces `facing`, Model::contact_nodes[place], in the order of the weights
/// of its geometry.
template <class F>
void for_each_place(const Model& model, const ContactPoint& point, const Facing& facing, F&& f) {
  if (point.curve < 0 || !model.slides_along_curves()) {
    for (int place : point.places) f(place);
  } else if (!facing.nodes.empty()) {
    for (int node : facing.nodes) f(model.place_of(node));
  } else {
    f(point.places[0]);
    for_each_place(model.curves[point.curve], facing.patch, f);
  }
}

}  // namespace stickslip
