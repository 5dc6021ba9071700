/// Obstacles in space as lines, for pictures.
#pragma once

#include <vector>

#include "core/model/scene.hpp"

namespace stickslip {

/// Lines on an obstacle at the start, each a row of places; none on an obstacle of the plane. On a plane a grid as wide
/// as what lies in front of it, and half as much more; on a cylinder lines as long as that; on a sphere circles of
/// latitude and longitude; of facets the edges beside the bodies.
///
///   bodies  places of the nodes, 3 x nodes, length
std::vector<std::vector<Vec<double, 3>>> wires_of(const Obstacle& obstacle, const Numbers<double>& numbers,
                                                  const Points<double>& bodies);

}  // namespace stickslip
