/// Lumped bodies: a node on a spring, and chains of bars along a line or a circular arc, nodes in order along the
/// chain. Chains have the sides `start`, `end`, `nodes` (all), `interior` (all but the ends); a point `node` and
/// `anchor`.
#pragma once

#include <array>
#include <string>
#include <tuple>
#include <vector>

#include "core/algebra/described.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

/// One node and the anchor of its spring (grounded_spring), at the same place.
struct PointMesh {
  static constexpr const char *key = "point", *about = "one node on a spring; sides node, anchor";
  static constexpr Filling filling = Filling::point;
  std::vector<Number> at;  ///< 2 or 3 coordinates

  double cell_count() const { return 1; }
  static constexpr auto keys() {
    return std::tuple{Key{&PointMesh::at, "at", "of the node, and of its anchor (length)", Place2D{{0, 0}}}};
  }
};

struct LineMesh {
  static constexpr const char *key = "line",
                              *about =
                                  "a straight chain of bars; sides start, end, nodes (all), interior (all but the "
                                  "two ends)";
  static constexpr Filling filling = Filling::bars;
  std::vector<Number> from, to;
  int cells = 1;

  double cell_count() const { return cells; }
  static constexpr auto keys() {
    return std::tuple{Key{&LineMesh::from, "from", "first node (length)", Place2D{{0, 0}}},
                      Key{&LineMesh::to, "to", "last node (length)", Place2D{{1, 0}}},
                      Key{&LineMesh::cells, "cells", "number of bars", Count{30}}};
  }
};

struct ArcMesh {
  static constexpr const char *key = "arc", *about = "a chain of bars along a circle; sides as of a line",
                              *example = R"({"center": [0, 0], "radius": 1, "from_angle": 0, "to_angle": 180,
                                             "cells": 9})";
  static constexpr Filling filling = Filling::bars;
  std::array<Number, 2> center;
  Number radius, from_angle, to_angle;
  int cells = 1;

  double cell_count() const { return cells; }
  static constexpr auto keys() {
    return std::tuple{
        Key{&ArcMesh::center, "center", "of the circle (length)", Place2D{{0, 0}}},
        Key{&ArcMesh::radius, "radius", "of the circle, on which the nodes are (length)", InRange{Range::positive, 1}},
        Key{&ArcMesh::from_angle, "from_angle", "of the first node, in degrees from the x axis, counter-clockwise",
            InRange{Range::any, -11.25}},
        Key{&ArcMesh::to_angle, "to_angle", "of the last node, in degrees", InRange{Range::any, 191.25}},
        Key{&ArcMesh::cells, "cells", "number of bars", Count{9}}};
  }
};

/// What is wrong with the description, or "".
std::string fault(const PointMesh&, const std::string& element, int dimension);
std::string fault(const LineMesh&, const std::string& element, int dimension);
std::string fault(const ArcMesh&, const std::string& element, int dimension);

/// Node 0, `node`, and node 1, `anchor`, where the spring ends; they start at the same place.
Mesh topology(const PointMesh&, const std::string& element, int dimension);
/// The facets of `nodes` and of `interior` are the bars that touch the side, from start to end.
Mesh topology(const LineMesh&, const std::string& element, int dimension);
Mesh topology(const ArcMesh&, const std::string& element, int dimension);

/// Coordinates, dimension x 2.
template <class T>
Points<T> coordinates(const PointMesh& point, const Numbers<T>& numbers, int dimension) {
  Points<T> points(dimension, 2);
  for (int axis = 0; axis < dimension; ++axis) points(axis, 0) = points(axis, 1) = numbers(point.at[axis]);
  return points;
}

/// Coordinates, dimension x (cells + 1), in equal steps.
template <class T>
Points<T> coordinates(const LineMesh& line, const Numbers<T>& numbers, int dimension) {
  Points<T> points(dimension, line.cells + 1);
  for (int node = 0; node <= line.cells; ++node) {
    const double s = static_cast<double>(node) / line.cells;
    for (int axis = 0; axis < dimension; ++axis)
      points(axis, node) = numbers(line.from[axis]) * T(1 - s) + numbers(line.to[axis]) * T(s);
  }
  return points;
}

/// Coordinates, dimension x (cells + 1), in equal angles; z = 0 in 3D.
template <class T>
Points<T> coordinates(const ArcMesh& arc, const Numbers<T>& numbers, int dimension) {
  using std::cos, std::sin;
  const T degree(std::acos(-1.0) / 180), radius = numbers(arc.radius);
  Points<T> points = Points<T>::Constant(dimension, arc.cells + 1, T(0.0));
  for (int node = 0; node <= arc.cells; ++node) {
    const double s = static_cast<double>(node) / arc.cells;
    const T angle = (numbers(arc.from_angle) * T(1 - s) + numbers(arc.to_angle) * T(s)) * degree;
    points(0, node) = numbers(arc.center[0]) + radius * cos(angle);
    points(1, node) = numbers(arc.center[1]) + radius * sin(angle);
  }
  return points;
}

}  // namespace stickslip
