#include "studies/run/obstacle_wires.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace stickslip {
namespace {

using Spot = Vec<double, 3>;
using Wires = std::vector<std::vector<Spot>>;

constexpr double half_turn = 3.14159265358979323846;
constexpr int sides_of_circle = 48;

Spot values_of(const std::vector<Number>& numbers, const Numbers<double>& at) {
  return {at(numbers[0]), at(numbers[1]), at(numbers[2])};
}

/// Two directions across a third.
std::array<Spot, 2> two_across(const Spot& axis) {
  const Spot n = axis.normalized();
  Spot::Index least = 0;
  n.cwiseAbs().minCoeff(&least);
  const Spot first = n.cross(Spot::Unit(least)).normalized();
  return {first, n.cross(first)};
}

std::vector<Spot> circle_around(const Spot& center, const Spot& a, const Spot& b) {
  std::vector<Spot> out;
  for (int k = 0; k <= sides_of_circle; ++k) {
    const double angle = 2 * half_turn * k / sides_of_circle;
    out.emplace_back(center + std::cos(angle) * a + std::sin(angle) * b);
  }
  return out;
}

/// The range of the bodies along a direction, wider by a share of the size of them all at both ends.
std::array<double, 2> range_along(const Spot& direction, const Spot& from, const Points<double>& bodies) {
  constexpr double room = 0.25;
  const Eigen::RowVectorXd along = direction.transpose() * (bodies.colwise() - from);
  const double size = (bodies.rowwise().maxCoeff() - bodies.rowwise().minCoeff()).maxCoeff();
  return {along.minCoeff() - room * size, along.maxCoeff() + room * size};
}

Wires wires(const Plane& plane, const Numbers<double>& numbers, const Points<double>& bodies) {
  constexpr int lines = 8;
  const Spot at = values_of(plane.point, numbers);
  const auto directions = two_across(values_of(plane.normal, numbers));
  std::array<std::array<double, 2>, 2> range;
  for (int i = 0; i < 2; ++i) range[i] = range_along(directions[i], at, bodies);
  Wires out;
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k <= lines; ++k) {
      const double s = range[i][0] + (range[i][1] - range[i][0]) * k / lines;
      std::vector<Spot> line;
      for (const double t : range[1 - i]) line.emplace_back(at + s * directions[i] + t * directions[1 - i]);
      out.push_back(std::move(line));
    }
  return out;
}

Wires wires(const Sphere& sphere, const Numbers<double>& numbers, const Points<double>&) {
  constexpr int parts = 6;
  const Spot center = values_of(sphere.center, numbers);
  const double R = numbers(sphere.radius);
  Wires out;
  for (int k = 0; k < parts; ++k) {
    const double angle = half_turn * k / parts;
    out.push_back(circle_around(center, R * Spot(std::cos(angle), std::sin(angle), 0), R * Spot::UnitZ()));
  }
  for (int k = 1; k < parts; ++k) {
    const double angle = half_turn * k / parts, r = R * std::sin(angle);
    out.push_back(circle_around(center + R * std::cos(angle) * Spot::UnitZ(), r * Spot::UnitX(), r * Spot::UnitY()));
  }
  return out;
}

Wires wires(const Cylinder& cylinder, const Numbers<double>& numbers, const Points<double>& bodies) {
  constexpr int rings = 4, lines = 16;
  const Spot at = values_of(cylinder.point, numbers), axis = values_of(cylinder.axis, numbers).normalized();
  const double R = numbers(cylinder.radius);
  const auto directions = two_across(axis);
  const auto range = range_along(axis, at, bodies);
  Wires out;
  for (int k = 0; k <= rings; ++k) {
    const Spot center = at + (range[0] + (range[1] - range[0]) * k / rings) * axis;
    out.push_back(circle_around(center, R * directions[0], R * directions[1]));
  }
  for (int k = 0; k < lines; ++k) {
    const double angle = 2 * half_turn * k / lines;
    const Spot beside = at + R * (std::cos(angle) * directions[0] + std::sin(angle) * directions[1]);
    out.push_back({beside + range[0] * axis, beside + range[1] * axis});
  }
  return out;
}

/// Each edge of a facet that is as near to the bodies as half of their size, once; of many some. Of all facets, if none
/// is as near.
template <class Shape>
Wires edge_wires(const Shape& shape, const Numbers<double>& numbers, const Points<double>& bodies) {
  const auto vertices = vertices_of(shape, numbers);
  const Spot low = bodies.rowwise().minCoeff(), high = bodies.rowwise().maxCoeff();
  const double room = 0.5 * (high - low).maxCoeff();
  const auto is_near = [&](int v) {
    const Spot x = vertices.col(v);
    return ((low - x).array() <= room).all() && ((x - high).array() <= room).all();
  };
  std::set<std::pair<int, int>> edges;
  const auto add = [&](const std::vector<int>& facet) {
    for (std::size_t k = 0; k < facet.size(); ++k) edges.insert(std::minmax(facet[k], facet[(k + 1) % facet.size()]));
  };
  const auto facets = facets_of(shape);
  for (const auto& facet : facets)
    if (std::any_of(facet.begin(), facet.end(), is_near)) add(facet);
  if (edges.empty()) std::for_each(facets.begin(), facets.end(), add);
  constexpr std::size_t most = 3000;
  const std::size_t stride = (edges.size() + most - 1) / most;
  Wires out;
  std::size_t number = 0;
  for (const auto& [a, b] : edges)
    if (number++ % stride == 0) out.push_back({vertices.col(a), vertices.col(b)});
  return out;
}

}  // namespace

Wires wires_of(const Obstacle& obstacle, const Numbers<double>& numbers, const Points<double>& bodies) {
  return std::visit(
      [&]<class Shape>(const Shape& shape) -> Wires {
        if constexpr (requires { Shape::has_facets; })
          return edge_wires(shape, numbers, bodies);
        else if constexpr (requires { wires(shape, numbers, bodies); })
          return wires(shape, numbers, bodies);
        else
          return {};  // (a surface of the plane)
      },
      obstacle.shape);
}

}  // namespace stickslip
