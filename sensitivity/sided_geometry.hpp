/// One-sided contact geometry where a parameter moves a projection off a vertex of the master.
///
/// A slave node faces another part of the master as soon as a parameter moves, if it faces a vertex at which one of its
/// facets begins (node-to-segment), or if its segment ends at a master node (segment integration). The contact is
/// paired anew on nodes moved by 1e-7 of their mesh size to that side. The geometry there, as a function of the
/// parameters, is taken at the nodes as they are. Where it is continuous in value, its derivative is that of the side.
/// Where it jumps, as the normal at a corner of the master, there is none. There is none either where a node slides off
/// the end of the master or onto it; pairing sees that 1e-6 of a facet later.
#pragma once

#include "sensitivity/direct.hpp"

namespace stickslip {

/// What the slave nodes face on one side of a parameter.
struct SidedPairing {
  bool kink = false;  ///< some point faces another part of the master than at the start
  std::vector<ContactPoint> points;
  std::vector<int> leaving;  ///< points of the model that slide off
};

/// `parameter`: index in Scene::parameters; `side`: -1 or 1.
SidedPairing sided_pairing(const Model& model, int parameter, double side);

/// Makes the geometry in `slots`, seeded with the parameter, that of a side. False where that of a point jumps which is
/// `engaged`: it carries a force at some time, or is about to.
bool take_side(const Model& model, const SidedPairing& pairing, const std::vector<char>& engaged,
               Slots<Direction>& slots);

}  // namespace stickslip
