#include "core/contact/curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace stickslip {

FacetPlace nearest_of_facet(const Vec<double, 2>& a, const Vec<double, 2>& b, const Vec<double, 2>& x) {
  const Vec<double, 2> tau = b - a;
  const double xi = (x - a).dot(tau) / tau.squaredNorm();
  return {xi, (x - a - std::clamp(xi, 0.0, 1.0) * tau).norm()};
}

std::vector<Patch> make_patches(const std::vector<std::vector<int>>& facets, Smoothing smoothing, double corner,
                                const Eigen::Matrix2Xd& positions) {
  std::vector<Patch> patches(facets.size());
  std::map<int, int> starts;  // vertex -> the patch that starts there
  for (std::size_t f = 0; f < facets.size(); ++f) {
    patches[f].vertices = {Patch::none, facets[f][0], facets[f][1], Patch::none};
    patches[f].smoothing = smoothing;
    starts.emplace(facets[f][0], static_cast<int>(f));
  }
  const double least_cosine = std::cos(corner * std::numbers::pi / 180);
  for (std::size_t f = 0; f < facets.size(); ++f) {
    const auto found = starts.find(facets[f][1]);
    if (found == starts.end()) continue;
    Patch &before = patches[f], &after = patches[found->second];
    before.next = found->second;
    after.previous = static_cast<int>(f);
    const auto direction = [&](const Patch& patch) {
      return (positions.col(patch.vertices[2]) - positions.col(patch.vertices[1])).normalized().eval();
    };
    if (smoothing == Smoothing::none || direction(before).dot(direction(after)) < least_cosine) continue;
    before.vertices[3] = after.vertices[2];
    after.vertices[0] = before.vertices[1];
  }
  return patches;
}

OwnVertex own_vertex(const std::vector<Patch>& patches, const Eigen::Matrix2Xd& positions, int vertex,
                     const Vec<double, 2>& outward, double mesh_size) {
  const auto cross = [](const Vec<double, 2>& a, const Vec<double, 2>& b) { return a[0] * b[1] - a[1] * b[0]; };
  const Vec<double, 2> x = positions.col(vertex), inward = -outward.normalized();
  double thickness = std::numeric_limits<double>::infinity();
  for (const auto& patch : patches) {
    if (patch.vertices[1] == vertex || patch.vertices[2] == vertex) continue;
    const Vec<double, 2> a = positions.col(patch.vertices[1]) - x, b = positions.col(patch.vertices[2]) - x;
    const double side_a = cross(inward, a), side_b = cross(inward, b);
    if (side_a * side_b > 0 || side_a == side_b) continue;
    const double depth = (a + side_a / (side_a - side_b) * (b - a)).dot(inward);
    if (depth > 0) thickness = std::min(thickness, depth);
  }
  OwnVertex own{vertex, std::max(mesh_size, thickness), std::vector<char>(patches.size(), 0)};
  if (!std::isfinite(thickness)) return own;  // the side is not closed
  const Vec<double, 2> exit = x + thickness * inward;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const Vec<double, 2> a = positions.col(patches[p].vertices[1]), b = positions.col(patches[p].vertices[2]);
    const Vec<double, 2> tau = b - a;
    const bool is_behind = cross(x - a, tau) < -at_facet_end * tau.squaredNorm();
    const double distance = std::min(nearest_of_facet(a, b, x).distance, nearest_of_facet(a, b, exit).distance);
    own.wall[p] = is_behind && distance < 2 * thickness + tau.norm();
  }
  return own;
}

}  // namespace stickslip
