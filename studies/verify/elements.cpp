#include "studies/verify/elements.hpp"

#include <Eigen/LU>
#include <cmath>

namespace stickslip::verify {
namespace {

/// The polynomials r^a s^b of T3, T6, Q4 and Q8 at a place, and their derivatives by r and s.
Field polynomials(const Body& body, const Vec2& at) {
  static const Eigen::Matrix2Xi triangle{{0, 1, 0, 2, 1, 0}, {0, 0, 1, 0, 1, 2}},
      square{{0, 1, 0, 1, 2, 0, 2, 1}, {0, 0, 1, 1, 0, 2, 1, 2}};
  Field rows(3, natural_nodes(body).cols());
  for (Eigen::Index k = 0; k < rows.cols(); ++k) {
    const int a = (body.corners() == 3 ? triangle : square)(0, k), b = (body.corners() == 3 ? triangle : square)(1, k);
    const auto power = [&](int i, int p) { return p > 0 ? std::pow(at[i], p) : 1.0; };
    rows.col(k) << power(0, a) * power(1, b), a * power(0, a - 1) * power(1, b), b * power(0, a) * power(1, b - 1);
  }
  return rows;
}

/// r, s, weight. Rules of full rank: three points of Q8 each way, three of T3 of revolution.
std::vector<Vec3> rule(const Body& body, bool of_revolution) {
  if (body.element == "T3" && !of_revolution) return {{1.0 / 3, 1.0 / 3, 0.5}};
  if (body.corners() == 3)
    return {{1.0 / 6, 1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6, 1.0 / 6}, {1.0 / 6, 2.0 / 3, 1.0 / 6}};
  std::vector<Vec3> points;
  for (const auto& along : edge_points(body.quadratic() ? 3 : 2, true))
    for (const auto& across : edge_points(body.quadratic() ? 3 : 2, true))
      points.emplace_back(2 * along.s - 1, 2 * across.s - 1, 4 * along.weight * across.weight);
  return points;
}

}  // namespace

Places natural_nodes(const Body& body) {
  static const Places triangle{{0, 1, 0, 0.5, 0.5, 0}, {0, 0, 1, 0, 0.5, 0.5}},
      square{{-1, 1, 1, -1, 0, 1, 0, -1}, {-1, -1, 1, 1, -1, 0, 1, 0}};
  const auto nodes = static_cast<Eigen::Index>(body.corners() * (body.quadratic() ? 2 : 1));
  return (body.corners() == 3 ? triangle : square).leftCols(nodes);
}

Shape shape(const Body& body, const Vec2& at) {
  const Places nodes = natural_nodes(body);
  Eigen::MatrixXd at_nodes(nodes.cols(), nodes.cols());
  for (Eigen::Index a = 0; a < nodes.cols(); ++a) at_nodes.row(a) = polynomials(body, nodes.col(a)).row(0);
  const Field N = polynomials(body, at) * at_nodes.inverse();
  return {N.row(0), N.bottomRows<2>().transpose()};
}

std::vector<Point> points_of(const Scene& scene, const Body& body, const Nodes& element) {
  static std::map<std::pair<std::string, bool>, std::vector<std::pair<Shape, double>>> known;
  auto& shapes = known[{body.element, scene.axisymmetric}];
  if (shapes.empty())
    for (const auto& at : rule(body, scene.axisymmetric)) shapes.emplace_back(shape(body, at.head<2>()), at[2]);
  const Places X = scene.points(Eigen::seqN(0, 2), element);
  std::vector<Point> points;
  for (const auto& [at, weight] : shapes) {
    const Eigen::Matrix2d jacobian = X * at.gradient;
    const double radius = X.row(0).dot(at.value), volume = jacobian.determinant() * weight * scene.depth(body, radius);
    points.push_back({{at.value, at.gradient * jacobian.inverse()}, radius, volume});
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

std::map<int, double> areas_of(const Scene& scene, const Body& body, const Side& side) {
  std::map<int, double> areas;
  for (const auto& edge : side.edges)
    for (const auto& point : edge_points(edge.size(), scene.axisymmetric)) {
      const auto n = static_cast<Eigen::Index>(edge.size());
      const Field X = scene.points(Eigen::all, edge);
      const double dA =
          point.weight * (X * point.slope.head(n)).norm() * scene.depth(body, X.row(0) * point.value.head(n));
      for (Eigen::Index a = 0; a < n; ++a)
        if (side.has(edge[a])) areas[edge[a]] += point.value[a] * dA;
    }
  return areas;
}

}  // namespace stickslip::verify
