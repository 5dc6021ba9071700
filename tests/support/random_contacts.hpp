/// Random contact problems with few points, which plain Newton often does not solve.
#pragma once

#include <random>

#include "tests/support/scenes.hpp"

namespace stickslip::scenes {

inline Number random_normal(std::mt19937& random, double size) { return size * std::normal_distribution<>()(random); }

/// A random symmetric positive definite matrix.
inline std::vector<std::vector<Number>> random_stiffness(std::mt19937& random, int n) {
  std::normal_distribution<> normal;
  Matrix<double> G(n, n);
  for (int i = 0; i < n * n; ++i) G.data()[i] = normal(random);
  const Matrix<double> K = G * G.transpose() + 0.1 * Matrix<double>::Identity(n, n);
  std::vector<std::vector<Number>> rows(n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) rows[i].push_back(K(i, j));
  return rows;
}

/// A point on a spring over a floor, normal along the last axis.
inline Scene point_on_floor(std::vector<std::vector<Number>> stiffness, std::vector<Number> load, double mu) {
  const std::size_t D = load.size();
  Scene s;
  if (D == 3) s.space = Space::solid;
  s.legs = {{1, 1}};
  s.bodies = {{"point", PointMesh{std::vector<Number>(D, 0.0)}, GroundedSpring{std::move(stiffness)}, "", 1.0}};
  Plane floor{std::vector<Number>(D, 0.0), std::vector<Number>(D, 0.0)};
  floor.normal.back() = 1.0;
  s.obstacles = {{"floor", floor}};
  s.contacts = {contact("sole", "point.node", "floor")};
  s.contacts[0].friction = mu;
  s.loads = {force("point.node", std::move(load))};
  return s;
}

inline Scene random_point(std::mt19937& random, int dimension, double mu) {
  auto stiffness = random_stiffness(random, dimension);
  std::vector<Number> load;
  for (int i = 0; i < dimension; ++i) load.push_back(random_normal(random, 2));
  return point_on_floor(std::move(stiffness), std::move(load), mu);
}

/// The same in the plane with a second obstacle at a random angle, up to 0.3 away: two contacts on one node.
inline Scene random_corner(std::mt19937& random, double mu) {
  Scene s = random_point(random, 2, mu);
  const double angle = random_normal(random, 3).value, away = std::abs(random_normal(random, 0.3).value);
  const double n_x = std::sin(angle), n_y = std::cos(angle);
  s.obstacles.push_back({"wall", Plane{{-away * n_x, -away * n_y}, {n_x, n_y}}});
  s.contacts.push_back(contact("side", "point.node", "wall"));
  s.contacts.back().friction = mu;
  return s;
}

/// A distorted strip of n - 1 elements held at its top; each of the n nodes below has a plane of its own, tilted by up
/// to one radian, and a random force.
inline Scene random_strip(std::mt19937& random, int n, double mu) {
  std::uniform_real_distribution<> uniform(-1, 1);
  Scene s;
  s.legs = {{1, 1}};
  ImportedMesh strip;
  strip.mesh.node_count = 2 * n;
  strip.points.resize(2, 2 * n);
  for (int i = 0; i < n; ++i) {
    strip.points.col(i) << i + 0.25 * uniform(random), 0.25 * uniform(random);
    strip.points.col(n + i) << i + 0.25 * uniform(random), 0.7 + 0.3 * uniform(random);
  }
  for (int i = 0; i + 1 < n; ++i)
    for (int node : {i, i + 1, n + i + 1, n + i}) strip.mesh.connectivity.push_back(node);
  for (int i = n - 1; i >= 0; --i) strip.mesh.sides["top"].nodes.push_back(n + i);
  for (int i = n - 1; i > 0; --i) strip.mesh.sides["top"].facets.push_back({n + i, n + i - 1});
  for (int i = 0; i < n; ++i) {
    const std::string side = "at" + std::to_string(i), plane = "plane" + std::to_string(i);
    strip.mesh.sides[side].nodes = {i};
    const double tilt = uniform(random);
    s.obstacles.push_back({plane, Plane{{strip.points(0, i), strip.points(1, i)}, {std::sin(tilt), std::cos(tilt)}}});
    s.contacts.push_back(contact("on" + std::to_string(i), "strip." + side, plane));
    s.contacts.back().friction = mu;
    const Number f_x = random_normal(random, 0.2), f_y = random_normal(random, 0.2).value - 0.1;
    s.loads.push_back(force("strip." + side, {f_x, f_y}));
  }
  s.bodies = {{"strip", strip, LinearElastic{1.0, 0.3}, "", 1.0}};
  s.supports = {support("strip.top", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}})};
  return s;
}

}  // namespace stickslip::scenes
