/// One-sided contact geometry, if a parameter moves a projection off a vertex of the master.
///
/// A slave node faces another part of the master as soon as a parameter changes in two cases: it faces a vertex at
/// which a facet begins (node-to-segment), or its segment ends at a master node (segment integration). The contact is
/// paired again with nodes moved by 1e-7 of their mesh size to that side. The geometry of this pairing, as a function
/// of the parameters, is evaluated at the unmoved nodes. If its value is that of the model, its derivative is that of
/// the side. If it jumps, as the normal at a corner of the master, there is no derivative. There is none either if a
/// node slides off the end of the master or onto it; pairing recognises that 1e-6 of a facet later.
#pragma once

#include "sensitivity/direct.hpp"

namespace stickslip {

/// What the slave nodes face on one side of a parameter.
struct SidedPairing {
  bool kink = false;  ///< whether a point faces another part of the master than in the model
  std::vector<ContactPoint> points;
  std::vector<int> leaving;  ///< indices of the points of the model that slide off the master
};

/// Pairing on one side. `parameter`: index in Scene::parameters; `side`: -1 or 1.
SidedPairing sided_pairing(const Model& model, int parameter, double side);

/// Replaces the geometry in `slots`, which are seeded with the parameter, by that of a side. False if the geometry of
/// an engaged point jumps. `engaged`: per point, whether it carries a force at some time or is about to.
bool take_side(const Model& model, const SidedPairing& pairing, const std::vector<char>& engaged,
               Slots<Direction>& slots);

}  // namespace stickslip
