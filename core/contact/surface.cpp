#include "core/contact/surface.hpp"

#include <Eigen/LU>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>

#include "core/contact/gregory.hpp"

namespace stickslip {
namespace {

using Edge = std::pair<int, int>;

Vec<double, 3> facet_normal(const SurfacePatch& patch, const Points<double>& positions) {
  const auto corner = [&](int k) -> Vec<double, 3> { return positions.col(patch.vertices[k]); };
  return area_vector<double>(patch.corners, corner).normalized();
}

/// The two ends of an edge, counter-clockwise.
Edge edge_of(const SurfacePatch& patch, int edge) {
  return {patch.vertices[edge], patch.vertices[(edge + 1) % patch.corners]};
}

void join(std::vector<SurfacePatch>& patches) {
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
std::set<Edge> sharp_edges(const std::vector<SurfacePatch>& patches, double corner, const Points<double>& positions) {
  const double least = least_cosine(corner);
  std::set<Edge> sharp;
  for (const auto& patch : patches)
    for (int k = 0; k < patch.corners; ++k) {
      const int other = patch.across[k];
      if (other == Patch::none || facet_normal(patch, positions).dot(facet_normal(patches[other], positions)) < least)
        sharp.insert(std::minmax(patch.vertices[k], patch.vertices[(k + 1) % patch.corners]));
    }
  return sharp;
}

/// Per vertex, whether borders and creases have a corner there: they turn by more than `corner` degrees, others than
/// two meet, or a smooth part of the surface has one face there.
std::vector<char> border_corners(const std::vector<SurfacePatch>& patches, const std::set<Edge>& sharp, double corner,
                                 const Points<double>& positions) {
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
      if (!patch.goes_on[j] && !patch.goes_on[(j + patch.corners - 1) % patch.corners])
        is_corner[patch.vertices[j]] = 1;
  return is_corner;
}

/// Basis functions and the derivatives in PlaceWeights, a row a control point.
PlaceWeights basis_at(const SurfacePatch& patch, const Vec<double, 2>& at) {
  using First = Dual<2>;
  using Second = Dual<2, First>;
  const auto seed = [&](int i) {
    Second x(First::seed(at[i], i));
    x.d[i] = First(1.0);
    return x;
  };
  const Second s = seed(0), t = seed(1);
  const auto fill = [&](int count, const auto& value, const auto& along_s, const auto& along_t) {
    PlaceWeights n(count, 10);
    for (int c = 0; c < count; ++c)
      n.row(c) << value[c].v.v, along_s[c].v.v, along_t[c].v.v, along_s[c].v.d[0], along_s[c].v.d[1], along_t[c].v.d[1],
          along_s[c].d[0].d[0], along_s[c].d[0].d[1], along_s[c].d[1].d[1], along_t[c].d[1].d[1];
    return n;
  };
  if (patch.control.size() == 0) {
    const auto w = face_weights<Second>(patch.corners, s, t);
    return fill(patch.corners, w.value, w.along_s, w.along_t);
  }
  const auto w = detail::gregory_basis<Second>(patch.corners, s, t);
  return fill(detail::points_per_corner * patch.corners, w.value, w.along_s, w.along_t);
}

/// Basis functions with their slopes alone.
Eigen::Matrix<double, Eigen::Dynamic, 3> slopes_at(const SurfacePatch& patch, const Vec<double, 2>& at) {
  const auto fill = [](int count, const auto& w) {
    Eigen::Matrix<double, Eigen::Dynamic, 3> n(count, 3);
    for (int c = 0; c < count; ++c) n.row(c) << w.value[c], w.along_s[c], w.along_t[c];
    return n;
  };
  if (!patch.is_smooth()) return fill(patch.corners, face_weights<double>(patch.corners, at[0], at[1]));
  return fill(detail::points_per_corner * patch.corners, detail::gregory_basis<double>(patch.corners, at[0], at[1]));
}

/// Of the vertices, from those of the control points.
template <class Rows>
auto of_vertices(const SurfacePatch& patch, Rows rows) {
  if (!patch.is_smooth()) return rows;
  return Rows(patch.control.transpose() * rows);
}

}  // namespace

std::vector<SurfacePatch> make_surface(const std::vector<std::vector<int>>& faces, Smoothing smoothing, double corner,
                                       const Points<double>& positions) {
  std::vector<SurfacePatch> patches;
  for (const auto& face : faces) patches.push_back({static_cast<int>(face.size()), face});
  join(patches);
  if (smoothing == Smoothing::none) return patches;
  const auto sharp = sharp_edges(patches, corner, positions);
  for (auto& patch : patches)
    for (int k = 0; k < patch.corners; ++k) {
      const auto [a, b] = edge_of(patch, k);
      patch.goes_on[k] = sharp.count(std::minmax(a, b)) == 0;
    }
  detail::set_control_points(patches, smoothing, border_corners(patches, sharp, corner, positions));
  return patches;
}

double beyond_edge(int corners, int edge, const Vec<double, 2>& at) {
  if (edge == 0) return -at[1];
  if (edge == corners - 1) return -at[0];
  if (corners == 3) return at.sum() - 1;
  return at[edge - 1] - 1;
}

bool is_past_border(const SurfacePatch& patch, const Vec<double, 2>& at, double by) {
  for (int k = 0; k < patch.corners; ++k)
    if (patch.across[k] == Patch::none && beyond_edge(patch.corners, k, at) > by) return true;
  return false;
}

PlaceWeights place_weights(const SurfacePatch& patch, const Vec<double, 2>& at) {
  return of_vertices(patch, basis_at(patch, at));
}

Eigen::VectorXd weights_moved(const SurfacePatch& patch, const Vec<double, 2>& from, const Vec<double, 2>& to) {
  // The difference loses the digits of a short way, and the mean slope along a long one is not exact: its error is of
  // the ninth power of the way. Both are good to rounding where they meet.
  constexpr double is_short = 0.01;
  const Vec<double, 2> way = to - from;
  if (way == Vec<double, 2>::Zero()) return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(patch.vertices.size()));
  if (way.cwiseAbs().maxCoeff() > is_short)
    return of_vertices(patch, Eigen::VectorXd(slopes_at(patch, to).col(0) - slopes_at(patch, from).col(0)));
  // Gauss's rule with four points on (0, 1)
  constexpr std::array place{0.06943184420297371, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629};
  constexpr std::array share{0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693};
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(patch.is_smooth() ? patch.control.rows() : patch.corners);
  for (std::size_t g = 0; g < place.size(); ++g)
    moved += share[g] * slopes_at(patch, from + place[g] * way).rightCols<2>() * way;
  return of_vertices(patch, std::move(moved));
}

Mat<double, 2> foot_slope(const PlaceWeights& weights, const Eigen::Matrix3Xd& arms, const Vec<double, 3>& off) {
  const Eigen::Matrix<double, 3, 5> y = arms * weights.middleCols<5>(1);
  Mat<double, 2> slope = y.leftCols<2>().transpose() * y.leftCols<2>();
  slope(0, 0) -= off.dot(y.col(2));
  slope(0, 1) -= off.dot(y.col(3));
  slope(1, 0) -= off.dot(y.col(3));
  slope(1, 1) -= off.dot(y.col(4));
  return slope.inverse();
}

}  // namespace stickslip
