/// Search of segment integration at finite strain: which pieces of their masters the points face where they are now.
#pragma once

#include "core/model/model.hpp"

namespace stickslip {

/// Sets what the points of an integrated curve face with all nodes at `places`. `points`: of the start; both D x nodes.
/// A point of whose area next to nothing faces the curve faces nothing of it.
void find_pieces(const Model& model, int curve, const Points<double>& points, const Points<double>& places,
                 std::vector<Facing>& found);

}  // namespace stickslip
