#include "core/contact/curve.hpp"

#include <cmath>
#include <map>
#include <numbers>

namespace stickslip {

std::vector<Patch> make_patches(const std::vector<std::vector<int>>& facets, Smoothing smoothing, double corner,
                                const Eigen::Matrix2Xd& places) {
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
      return (places.col(patch.vertices[2]) - places.col(patch.vertices[1])).normalized().eval();
    };
    if (smoothing == Smoothing::none || direction(before).dot(direction(after)) < least_cosine) continue;
    before.vertices[3] = after.vertices[2];
    after.vertices[0] = before.vertices[1];
  }
  return patches;
}

}  // namespace stickslip
