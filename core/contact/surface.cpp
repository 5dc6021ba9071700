#include "core/contact/surface.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>

#include "core/contact/face.hpp"
#include "core/contact/gregory.hpp"

namespace stickslip {
namespace {

using Edge = std::pair<int, int>;

Vec<double, 3> facet_normal(const Patch<3>& patch, const Places<3>& positions) {
  const auto corner = [&](int k) -> Vec<double, 3> { return positions.col(patch.vertices[k]); };
  return area_vector<double>(patch.corners, corner).normalized();
}

/// The two ends of an edge, counter-clockwise.
Edge edge_of(const Patch<3>& patch, int edge) {
  return {patch.vertices[edge], patch.vertices[(edge + 1) % patch.corners]};
}

void join(Surface<3>& patches) {
  std::map<Edge, std::pair<int, int>> begins;  // edge -> patch and its number there
  for (int f = 0; f < static_cast<int>(patches.size()); ++f)
    for (int k = 0; k < patches[f].corners; ++k)
      if (!begins.emplace(edge_of(patches[f], k), std::pair(f, k)).second)
        throw std::runtime_error("three of its faces meet at one edge, so it is no surface that bodies can slide on");
  for (auto& patch : patches)
    for (int k = 0; k < patch.corners; ++k) {
      const auto [from, to] = edge_of(patch, k);
      const auto found = begins.find({to, from});
      if (found == begins.end()) continue;
      patch.across[k] = found->second.first;
      patch.across_edge[k] = found->second.second;
    }
}

/// Cosine of a turn of `corner` degrees; less by what rounding makes of faces that turn by just that.
double least_cosine(double corner) { return std::cos(corner * std::numbers::pi / 180) - 1e-9; }

/// Edges at which the surface is not smooth, by their ends in ascending order: borders, and creases.
std::set<Edge> sharp_edges(const Surface<3>& patches, double corner, const Places<3>& positions) {
  const double least = least_cosine(corner);
  std::set<Edge> sharp;
  for (const auto& patch : patches)
    for (int k = 0; k < patch.corners; ++k) {
      const int other = patch.across[k];
      if (other == no_patch || facet_normal(patch, positions).dot(facet_normal(patches[other], positions)) < least)
        sharp.insert(std::minmax(patch.vertices[k], patch.vertices[(k + 1) % patch.corners]));
    }
  return sharp;
}

/// Per vertex, whether borders and creases have a corner there: they turn by more than `corner` degrees, others than
/// two meet, or a smooth part of the surface has one face there.
std::vector<char> border_corners(const Surface<3>& patches, const std::set<Edge>& sharp, double corner,
                                 const Places<3>& positions) {
  std::map<int, std::vector<int>> ends;
  for (const auto& [a, b] : sharp) {
    ends[a].push_back(b);
    ends[b].push_back(a);
  }
  std::vector<char> is_corner(static_cast<std::size_t>(positions.cols()), 0);
  const double least = least_cosine(corner);
  for (const auto& [a, others] : ends) {
    const auto along = [&positions, from = a, &to = others](int k) -> Vec<double, 3> {
      return (positions.col(to[k]) - positions.col(from)).normalized();
    };
    is_corner[a] = others.size() != 2 || -along(0).dot(along(1)) < least;
  }
  for (const auto& patch : patches)
    for (int j = 0; j < patch.corners; ++j)
      if (!patch.goes_on(j) && !patch.goes_on((j + patch.corners - 1) % patch.corners))
        is_corner[patch.vertices[j]] = 1;
  return is_corner;
}

/// Patch::slope_factor of both facets at the vertex b between them, a -> b and b -> c: the slope (c - a) / (1 + q) over
/// that of the uniform spline, (c - a) / 2. q is the length of the longer facet over that of the shorter one. Why: the
/// slope of the uniform spline at the end of a short facet grows with its neighbour, and beside neighbours of more than
/// five times its length the spline folds back. With the slope of the short facet on both sides, the long one is
/// rounded near its end only, and a flat stays flat. q is rounded to a whole number, so weights stay as they are if a
/// vertex moves a little. They change where a ratio passes k + 0.618: ratios that people draw are not there.
double slope_factor(double before, double after) {
  constexpr double rest = 0.3819660112501051;  // 2 minus the golden section
  return 2 / (1 + std::floor(std::max(before, after) / std::min(before, after) + rest));
}

}  // namespace

template <>
Surface<2> make_surface<2>(const std::vector<std::vector<int>>& facets, Smoothing smoothing, double corner,
                           const Places<2>& positions) {
  Surface<2> patches(facets.size());
  std::map<int, int> starts;  // vertex -> the patch that starts there
  for (std::size_t f = 0; f < facets.size(); ++f) {
    patches[f].vertices = {no_vertex, facets[f][0], facets[f][1], no_vertex};
    patches[f].smoothing = smoothing;
    starts.emplace(facets[f][0], static_cast<int>(f));
  }
  const double least_cosine = std::cos(corner * std::numbers::pi / 180);
  for (std::size_t f = 0; f < facets.size(); ++f) {
    const auto found = starts.find(facets[f][1]);
    if (found == starts.end()) continue;
    Patch<2>&before = patches[f], &after = patches[found->second];
    before.across[1] = found->second;
    after.across[0] = static_cast<int>(f);
    const auto along = [&](const Patch<2>& patch) -> Vec<double, 2> {
      return positions.col(patch.corner(1)) - positions.col(patch.corner(0));
    };
    const Vec<double, 2> first = along(before), next = along(after);
    if (smoothing == Smoothing::none || first.normalized().dot(next.normalized()) < least_cosine) continue;
    before.vertices[3] = after.corner(1);
    after.vertices[0] = before.corner(0);
    if (smoothing != Smoothing::catmull_rom) continue;
    before.slope_factor[1] = after.slope_factor[0] = slope_factor(first.norm(), next.norm());
  }
  return patches;
}

template <>
Surface<3> make_surface<3>(const std::vector<std::vector<int>>& faces, Smoothing smoothing, double corner,
                           const Places<3>& positions) {
  Surface<3> patches;
  for (const auto& face : faces) patches.push_back({static_cast<int>(face.size()), face});
  join(patches);
  for (auto& patch : patches)
    for (int k = 0; k < patch.corners; ++k)
      patch.widths[k] = width_behind<double>(patch.corners, k,
                                             [&](int j) -> Vec<double, 3> { return positions.col(patch.vertices[j]); });
  if (smoothing == Smoothing::none) return patches;
  const auto sharp = sharp_edges(patches, corner, positions);
  for (auto& patch : patches)
    for (int k = 0; k < patch.corners; ++k) {
      const auto [a, b] = edge_of(patch, k);
      patch.smooth_at[k] = sharp.count(std::minmax(a, b)) == 0;
    }
  detail::set_control_points(patches, smoothing, border_corners(patches, sharp, corner, positions));
  return patches;
}

std::vector<std::vector<int>> corners_of(const Surface<3>& patches) {
  std::vector<std::vector<int>> corners;
  for (const auto& patch : patches)
    corners.emplace_back(patch.vertices.begin(), patch.vertices.begin() + patch.corners);
  return corners;
}

}  // namespace stickslip
