/// What files say of a contact's points.
#pragma once

#include <vector>

#include "studies/run/case.hpp"

namespace stickslip {

/// Length along the points of a contact, in their order, from the first.
std::vector<double> arc_of(const Problem& problem, int contact);

/// Whether a point has a place of its master before it, or with segments a part of it; otherwise its gap is a distance
/// to what it does not face.
inline bool faces_master(const ContactPoint& point, const Facing& facing) {
  return point.surface < 0 || facing.patch != no_patch || !facing.pieces.empty();
}

/// "open", "stick" or "slip", whichever piece of the law it slips on.
inline const char* branch_name(ContactState state) {
  if (state == ContactState::open) return "open";
  return state == ContactState::stick ? "stick" : "slip";
}
/// The same; but "closed" of a frictionless point that touches, which neither holds nor rubs.
const char* state_name(const ContactPoint& point, ContactState state);
/// 0 open, 1 stick, 2 slip.
inline int state_code(ContactState state) { return is_slipping(state) ? 2 : static_cast<int>(state); }

}  // namespace stickslip
