/// Search for the segments that segment-integrated points face at finite strain.
#pragma once

#include "core/model/model.hpp"

namespace stickslip {

/// Sets found[p] for each point p of an integrated curve.
///
///   curve      index in Model::curves
///   points     initial nodal positions, D x nodes, length
///   positions  present nodal positions, D x nodes, length; where the master is a polyline, then those of its vertices
///
/// A point less than 1 % of whose area faces the curve counts as facing nothing.
void find_segments(const Model& model, int curve, const Points<double>& points, const Points<double>& positions,
                   std::vector<Facing>& found);

}  // namespace stickslip
