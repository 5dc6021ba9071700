#include "core/contact/own_vertex.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/contact/facet_search.hpp"

namespace stickslip {
namespace {

/// The axes in which a symmetric matrix is largest; if several are equal, all of these. Columns, orthonormal.
Eigen::Matrix3Xd largest_axes(const Mat<double, 3>& matrix) {
  constexpr double equal = 1e-6;
  const Eigen::SelfAdjointEigenSolver<Mat<double, 3>> axes(matrix);
  const Vec<double, 3>& sizes = axes.eigenvalues();  // in increasing order
  const auto smaller = (sizes.array() < (1 - equal) * sizes[2]).count();
  return axes.eigenvectors().rightCols(3 - smaller);
}

/// The direction of order_in_space(). `outward`: area vectors of the vertices, 3 x vertices.
Vec<double, 3> way_across(const FaceSearch& faces, const Places<3>& positions, const Places<3>& outward) {
  const Eigen::RowVectorXd area = outward.colwise().norm();
  Mat<double, 3> across_voids = Mat<double, 3>::Zero(), extent = across_voids;
  const Vec<double, 3> middle = positions * area.transpose() / area.sum();
  for (Eigen::Index v = 0; v < positions.cols(); ++v) {
    const Vec<double, 3> off = positions.col(v) - middle;
    extent += area[v] * off * off.transpose();
    if (!(area[v] > 0)) continue;
    const Vec<double, 3> way = outward.col(v) / area[v];
    const double length = faces.first_hit(positions.col(v), way, [&](int face) {
      return !faces.has(face, static_cast<int>(v)) && faces.across(face).dot(way) < 0;
    });
    if (length > 0) across_voids += area[v] / (length * length) * way * way.transpose();  // (0 where there is none)
  }
  const Eigen::Matrix3Xd axes = largest_axes(across_voids.isZero(0) ? extent : across_voids);
  const Vec<double, 3> along_none(0.8, 0.53, 0.28);
  const Vec<double, 3> along = (axes * (axes.transpose() * along_none)).normalized();
  const Eigen::RowVectorXd off = along.transpose() * (positions.colwise() - middle);
  const double tail = (area.array() * off.array().cube()).sum(),
               even = 1e-6 * (area.array() * off.array().abs().cube()).sum();
  return tail < -even ? Vec<double, 3>(-along) : along;
}

}  // namespace

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

OwnVertex own_vertex(const FaceSearch& faces, int vertex, const Vec<double, 3>& outward, double mesh_size) {
  const Vec<double, 3> inward = -outward.normalized();
  const double thickness = faces.first_hit(faces.position(vertex), inward, [&](int face) {
    return !faces.has(face, vertex) && faces.across(face).dot(inward) > 0;
  });
  OwnVertex own{vertex, std::max(mesh_size, thickness)};
  own.reach =
      std::isfinite(thickness) ? 3 * thickness : -std::numeric_limits<double>::infinity();  // (it is not closed)
  return own;
}

FaceMiddle face_middle(const Patch<3>& patch, const Places<3>& positions) {
  const double third = 1.0 / 3;
  const auto weights = patch.corners == 3 ? face_weights<double>(3, third, third) : face_weights<double>(4, 0.5, 0.5);
  const auto corner = [&](int k) -> Vec<double, 3> {
    return positions.col(patch.corner(std::min(k, patch.corners - 1)));
  };
  const auto at = face_position<double>({corner(0), corner(1), corner(2), corner(3)}, weights);
  FaceMiddle middle{patch.corners, at.y, at.along_s, at.along_t};
  for (int k = 0; k < patch.corners; ++k) middle.reach = std::max(middle.reach, (corner(k) - at.y).norm());
  return middle;
}

bool FaceMiddle::is_beside(const Vec<double, 3>& x) const {
  constexpr double past = 0.5;
  Mat<double, 2> metric;
  metric << along_s.dot(along_s), along_s.dot(along_t), along_s.dot(along_t), along_t.dot(along_t);
  const Vec<double, 3> off = x - place;
  const Vec<double, 2> way = metric.inverse() * Vec<double, 2>(off.dot(along_s), off.dot(along_t));
  if (corners == 4) return way.cwiseAbs().maxCoeff() <= 0.5 + past;
  return std::min({way[0], way[1], -way.sum()}) >= -1.0 / 3 - past;
}

bool is_of_own_wall(const OwnVertex& own, const Patch<3>& patch, const Places<3>& start) {
  const FaceMiddle middle = face_middle(patch, start);
  const Vec<double, 3> off = start.col(own.vertex) - middle.place,
                       across = cross<double>(middle.along_s, middle.along_t);
  const bool is_behind = off.dot(across) < -at_face_edge * middle.reach * across.norm();
  return is_behind && off.norm() < own.reach + 2 * middle.reach;
}

std::vector<int> order_in_space(const std::vector<std::vector<int>>& facets, const Places<3>& positions) {
  Places<3> outward = Places<3>::Zero(3, positions.cols());
  for (const auto& facet : facets) {
    const auto corner = [&](int k) -> Vec<double, 3> { return positions.col(facet[k]); };
    const Vec<double, 3> across = area_vector<double>(static_cast<int>(facet.size()), corner);
    for (const int vertex : facet) outward.col(vertex) += across / static_cast<double>(facet.size());
  }
  const FaceSearch faces(positions, facets);
  const Eigen::RowVectorXd along = way_across(faces, positions, outward).transpose() * positions;
  std::vector<int> order(positions.cols());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return along[a] < along[b]; });
  return order;
}

}  // namespace stickslip
