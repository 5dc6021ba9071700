#include "core/contact/own_vertex.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/facet_search.hpp"

namespace stickslip {

OwnVertex own_vertex(const Surface<2>& patches, const Places<2>& positions, int vertex, const Vec<double, 2>& outward,
                     double mesh_size) {
  const auto cross = [](const Vec<double, 2>& a, const Vec<double, 2>& b) { return a[0] * b[1] - a[1] * b[0]; };
  const Vec<double, 2> x = positions.col(vertex), inward = -outward.normalized();
  double thickness = std::numeric_limits<double>::infinity();
  for (const auto& patch : patches) {
    if (patch.corner(0) == vertex || patch.corner(1) == vertex) continue;
    const Vec<double, 2> a = positions.col(patch.corner(0)) - x, b = positions.col(patch.corner(1)) - x;
    const double side_a = cross(inward, a), side_b = cross(inward, b);
    if (side_a * side_b > 0 || side_a == side_b) continue;
    const double depth = (a + side_a / (side_a - side_b) * (b - a)).dot(inward);
    if (depth > 0) thickness = std::min(thickness, depth);
  }
  OwnVertex own{vertex, std::max(mesh_size, thickness), std::vector<char>(patches.size(), 0)};
  if (!std::isfinite(thickness)) return own;  // the side is not closed
  const Vec<double, 2> exit = x + thickness * inward;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const Vec<double, 2> a = positions.col(patches[p].corner(0)), b = positions.col(patches[p].corner(1));
    const Vec<double, 2> tau = b - a;
    const bool is_behind = cross(x - a, tau) < -at_facet_end * tau.squaredNorm();
    const double distance = std::min(nearest_of_facet(a, b, x).distance, nearest_of_facet(a, b, exit).distance);
    own.wall[p] = is_behind && distance < 2 * thickness + tau.norm();
  }
  return own;
}

}  // namespace stickslip
