/// Ring, or a sector of one, between two concentric circles: a grid (core/mesh/structured.hpp) with i along the radius,
/// from the inner circle outwards, and j around, counter-clockwise from from_angle. Sides `inner outer`, and `start`
/// (at from_angle) and `end` where it is open. A ring of 360 degrees is closed: its last row of nodes is the first.
#pragma once

#include <array>
#include <string>
#include <tuple>

#include "core/algebra/described.hpp"
#include "core/mesh/circle.hpp"
#include "core/mesh/structured.hpp"

namespace stickslip {

/// Angles in degrees from +x. `grade`: as in a box, towards inner or outer.
struct RingMesh {
  static constexpr const char *key = "ring",
                              *about = "between two circles; sides inner, outer, of an open ring also start, end",
                              *example = R"({"center": [0, 0], "inner": 1, "outer": 2, "cells": [8, 100]})";
  static constexpr Filling filling = Filling::continuum;
  std::array<Number, 2> center;
  Number inner, outer, from_angle = 0.0, to_angle = 360.0;
  std::array<int, 2> cells{1, 8};  ///< [along the radius, around]
  std::vector<Grading> grade;

  double cell_count() const { return product(cells); }
  static constexpr auto keys() {
    return std::tuple{
        Key{&RingMesh::center, "center", "of both circles (length)", Place2D{{0, 0}}},
        Key{&RingMesh::inner, "inner", "radius (length)", InRange{Range::positive, 1}},
        Key{&RingMesh::outer, "outer", "radius (length), greater than inner", InRange{Range::positive, 2}},
        Key{&RingMesh::cells, "cells", "along the radius, around", Counts{{8, 25}}},
        Key{&RingMesh::from_angle, "from_angle",
            "where an open ring starts, in degrees from the x axis, counter-clockwise", IfGiven{Range::any, 0}},
        Key{&RingMesh::to_angle, "to_angle", "where it ends, in degrees; 360 further than from_angle: closed",
            EndOfTurn{&RingMesh::from_angle, 90}},
        Key{&RingMesh::grade, "grade",
            "largest cell over smallest, smallest at the side that is named (left out: all alike)",
            Grade{std::array{"inner", "outer"}, 3}}};
  }
};

/// Whether two angles, in degrees, span a full turn, to rounding.
bool is_full_turn(double from_angle, double to_angle);

/// What is wrong with the description, or "".
std::string fault(const RingMesh&, const std::string& element, int dimension);
Mesh topology(const RingMesh&, const std::string& element, int dimension);

/// Coordinates, 2 x nodes. The last angle of a closed ring is no number of it.
template <class T>
Points<T> coordinates(const RingMesh& ring, const Numbers<T>& numbers, int) {
  using std::cos, std::sin;
  const bool closed = is_full_turn(ring.from_angle.value, ring.to_angle.value);
  const T from = numbers(ring.from_angle), span = closed ? T(360.0) : numbers(ring.to_angle) - from;
  const T degree(std::acos(-1.0) / 180), inner = numbers(ring.inner), outer = numbers(ring.outer);
  const auto along = grid_fractions(ring.cells[0], ring.grade, numbers, "inner", "outer");
  const int around = ring.cells[1], rows = closed ? around : around + 1;
  Points<T> points(2, static_cast<Eigen::Index>(along.size()) * rows);
  int node = 0;
  for (int j = 0; j < rows; ++j) {
    const T angle = (from + span * T(static_cast<double>(j) / around)) * degree, x = cos(angle), y = sin(angle);
    for (const T& f : along) {
      const T radius = (T(1.0) - f) * inner + f * outer;
      points(0, node) = numbers(ring.center[0]) + radius * x;
      points(1, node++) = numbers(ring.center[1]) + radius * y;
    }
  }
  return points;
}

/// Puts the middles of the edges around the ring on their circles.
template <class T>
void bend(const RingMesh& ring, const Mesh& mesh, const Numbers<T>& numbers, Points<T>& points) {
  const int row = ring.cells[0] + 1, corners = mesh.node_count - static_cast<int>(mesh.middles.size());
  for (std::size_t k = 0; k < mesh.middles.size(); ++k) {
    const auto [a, b] = mesh.middles[k];
    if (a % row != b % row) continue;
    const T x = points(0, a) - numbers(ring.center[0]), y = points(1, a) - numbers(ring.center[1]);
    using std::sqrt;
    onto_circle<T>(ring.center, sqrt(x * x + y * y), numbers, corners + static_cast<int>(k), points);
  }
}

}  // namespace stickslip
