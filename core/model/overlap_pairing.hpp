/// Pairing of segment-integrated contact in space.
#pragma once

#include "core/model/slave_point.hpp"

namespace stickslip {

/// Makes the points of a contact: the multiplier of each slave node on the overlaps of its facets with those of its
/// master, or on whole facets against an obstacle that has none. A node whose facets face nothing has no point.
/// `points`: initial nodal positions, 3 x nodes. pre: small strain; the slave side has facets of a solid body.
void pair_overlaps(Model& model, const Points<double>& points, const Pairing& pairing);

}  // namespace stickslip
