/// Search for the segments that segment-integrated points face at finite strain.
#pragma once

#include "core/model/model.hpp"

namespace stickslip {

/// Area of segments as a share of the area of the slave facets of their point, initial; `start` and `moved` as below.
double area_share(const std::vector<Segment>& segments, const ContactPoint& point, const Points<double>& start,
                  const Points<double>& moved, int node_count);

/// Sets found[p] for each point p of an integrated curve.
///
///   curve  index in Model::surfaces
///   start  initial positions of the nodes, D x nodes, length; if the master is an obstacle, then those of its vertices
///   moved  displacements likewise
///   last   of a side in contact with itself: per point, the patch that it faced in the last increment, or no_patch
///
/// A point less than 1 % of whose area faces the curve counts as facing nothing. Its distance is that to the nearest
/// facet of the curve; of a side in contact with itself, to the nearest that it may touch, or else the size of the
/// scene.
void find_segments(const Model& model, int curve, const Points<double>& start, const Points<double>& moved,
                   const std::vector<int>& last, std::vector<Facing>& found);

}  // namespace stickslip
