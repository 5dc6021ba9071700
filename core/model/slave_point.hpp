/// Contact points as they are made for a model: what every kind of contact sets.
#pragma once

#include "core/model/model.hpp"

namespace stickslip {

/// One contact while its points are made.
struct Pairing {
  int index;     ///< in Scene::contacts
  int obstacle;  ///< in Scene::obstacles; -1: deformable master
  SideSet slave, master;
};

/// Contact point of a slave node, with its facets, its sizes and its tangents. `points`: initial nodal coordinates, D x
/// nodes. The caller sets its master.
ContactPoint slave_point(const Model& model, const Points<double>& points, const Pairing& pairing, int node);

/// Appends a point, numbers its multiplier and sets its effects.
void add_point(Model& model, ContactPoint point);

}  // namespace stickslip
