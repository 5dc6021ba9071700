#include "studies/verify/elements.hpp"

#include <Eigen/LU>
#include <cmath>

namespace stickslip::verify {
namespace {

/// Gauss points of an element: r, s, weight. Rules of full rank: three points of Q8 each way, three of T3 of
/// revolution.
std::vector<std::array<double, 3>> rule(const std::string& element, bool of_revolution) {
  if (element == "T3" && !of_revolution) return {{1.0 / 3, 1.0 / 3, 0.5}};
  if (element[0] == 'T') return {{1.0 / 6, 1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6, 1.0 / 6}, {1.0 / 6, 2.0 / 3, 1.0 / 6}};
  std::vector<std::array<double, 2>> line{{-std::sqrt(1.0 / 3), 1}, {std::sqrt(1.0 / 3), 1}};
  if (element == "Q8") line = {{-std::sqrt(0.6), 5.0 / 9}, {0, 8.0 / 9}, {std::sqrt(0.6), 5.0 / 9}};
  std::vector<std::array<double, 3>> points;
  for (const auto& [r, weight] : line)
    for (const auto& [s, other] : line) points.push_back({r, s, weight * other});
  return points;
}

constexpr double R[4] = {-1, 1, 1, -1}, S[4] = {-1, -1, 1, 1};  ///< corners of a square

/// Linear functions of the corners: value, slopes by r and s.
std::vector<Vec3> linear(bool triangle, double r, double s) {
  if (triangle) return {{1 - r - s, -1, -1}, {r, 1, 0}, {s, 0, 1}};
  std::vector<Vec3> N;
  for (int a = 0; a < 4; ++a)
    N.emplace_back((1 + R[a] * r) * (1 + S[a] * s) / 4, R[a] * (1 + S[a] * s) / 4, S[a] * (1 + R[a] * r) / 4);
  return N;
}

/// The function of the middle between corners a and b.
Vec3 middle(const std::vector<Vec3>& N, std::size_t a, std::size_t b, double r, double s) {
  if (N.size() == 3)
    return {4 * N[a][0] * N[b][0], 4 * (N[a][0] * N[b][1] + N[b][0] * N[a][1]),
            4 * (N[a][0] * N[b][2] + N[b][0] * N[a][2])};
  const double m = (R[a] + R[b]) / 2, n = (S[a] + S[b]) / 2;  // where the middle is
  if (m == 0) return {(1 - r * r) * (1 + n * s) / 2, -r * (1 + n * s), n * (1 - r * r) / 2};
  return {(1 - s * s) * (1 + m * r) / 2, m * (1 - s * s) / 2, -s * (1 + m * r)};
}

}  // namespace

Shape shape(const std::string& element, double r, double s) {
  auto N = linear(element[0] == 'T', r, s);
  if (element == "T6" || element == "Q8") {  // a middle takes half of itself off its two corners
    const auto corners = N;
    for (std::size_t a = 0; a < corners.size(); ++a) {
      const std::size_t b = (a + 1) % corners.size();
      N.push_back(middle(corners, a, b, r, s));
      N[a] -= N.back() / 2;
      N[b] -= N.back() / 2;
    }
  }
  const Eigen::Map<const Eigen::Matrix3Xd> all(N[0].data(), 3, static_cast<Eigen::Index>(N.size()));
  return {all.row(0), all.bottomRows<2>()};
}

std::vector<Point> points_of(const Scene& scene, const Body& body, const std::vector<int>& element) {
  const Eigen::Matrix2Xd X = scene.points(Eigen::seqN(0, 2), element);
  std::vector<Point> points;
  for (const auto& [r, s, weight] : rule(body.element, scene.axisymmetric)) {
    const Shape at = shape(body.element, r, s);
    const Eigen::Matrix2d jacobian = X * at.gradient.transpose();
    const double radius = X.row(0).dot(at.value);
    points.push_back({at.value, at.gradient.transpose() * jacobian.inverse(), radius,
                      jacobian.determinant() * weight * scene.depth(body, radius)});
  }
  return points;
}

std::vector<EdgePoint> edge_points(std::size_t nodes, bool of_revolution) {
  const auto at = [&](double s, double weight) -> EdgePoint {
    if (nodes == 2) return {weight, s, {1 - s, s, 0}, {-1, 1, 0}};
    return {weight, s, {(1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s)}, {4 * s - 3, 4 * s - 1, 4 - 8 * s}};
  };
  const double two = std::sqrt(3.0) / 6, three = std::sqrt(0.6) / 2;
  if (nodes == 3) return {at(0.5 - three, 5.0 / 18), at(0.5, 8.0 / 18), at(0.5 + three, 5.0 / 18)};
  if (of_revolution) return {at(0.5 - two, 0.5), at(0.5 + two, 0.5)};
  return {at(0.5, 1)};
}

std::array<double, 3> edge_areas(const Scene& scene, const Body& body, const std::vector<int>& edge) {
  std::array<double, 3> areas{0, 0, 0};
  for (const auto& point : edge_points(edge.size(), scene.axisymmetric)) {
    Vec3 x = Vec3::Zero(), tau = x;
    for (std::size_t a = 0; a < edge.size(); ++a) {
      x += point.value[a] * scene.points.col(edge[a]);
      tau += point.slope[a] * scene.points.col(edge[a]);
    }
    for (std::size_t a = 0; a < edge.size(); ++a)
      areas[a] += point.value[a] * point.weight * tau.norm() * scene.depth(body, x[0]);
  }
  return areas;
}

}  // namespace stickslip::verify
