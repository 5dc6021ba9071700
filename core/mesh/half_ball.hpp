/// Half ball, fine at the pole of its surface and coarse at its flat side: a half disk (core/mesh/half_disk.hpp) in
/// space.
///
/// A block sits on the surface around the pole, square seen along the axis, which is parallel to z. Shells of cells
/// grow from its other five faces to the flat side. Seen along any of the two middle planes it is the half disk:
///
///     along the surface, pole to edge: block_width + shells = cells[0]
///     along the axis, pole to centre: block_height + shells = cells[1]
///
/// The faces of the block bulge, so that its edges leave room for the cells around them. Over all grades from 1 to 100
/// the corners of all hexahedra keep a volume above 0.5 with as many cells along the surface as along the axis, and
/// above 0.2 with up to one and a half times as many: that of the parallelepiped of unit vectors along the edges, 1 at
/// a right angle. Sides `surface`, on the sphere, and `flat`; a half ball facing up is the mirror image of one facing
/// down, node by node.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <tuple>
#include <vector>

#include "core/algebra/described.hpp"
#include "core/mesh/circle.hpp"
#include "core/mesh/half_disk.hpp"

namespace stickslip {

/// The surface points where it faces, along z. Graded towards its pole.
struct HalfBallMesh {
  static constexpr const char *key = "half_ball",
                              *about = "in space alone, fine at the pole of its surface; sides surface, flat",
                              *example = R"({"center": [0, 0, 1], "radius": 1, "cells": [8, 8], "grade": 5})";
  static constexpr Filling filling = Filling::continuum;
  static constexpr bool fills_space = true;
  using Facing = HalfDiskMesh::Facing;
  std::vector<Number> center = std::vector<Number>(3);
  Number radius;
  std::array<int, 2> cells{8, 8};
  Number grade = 1.0;
  Facing facing = Facing::down;

  double cell_count() const;
  static constexpr auto keys() {
    return std::tuple{
        Key{&HalfBallMesh::center, "center", "middle of the flat side (length)", Place3D{{0, 0, 1}}},
        Key{&HalfBallMesh::radius, "radius", "of the sphere (length)", InRange{Range::positive, 1}},
        Key{&HalfBallMesh::cells, "cells",
            "along the surface from the pole to the flat side, along the axis from the pole to the centre",
            Counts{{8, 8}}},
        Key{&HalfBallMesh::grade, "grade", "largest cell over smallest along the surface, smallest at the pole",
            IfGiven{Range::positive, 5}},
        Key{&HalfBallMesh::facing, "facing", "where the surface points to along z", std::array{"down", "up"}}};
  }
};

/// What is wrong with the description, or "".
std::string fault(const HalfBallMesh&, const std::string& element, int dimension);
Mesh topology(const HalfBallMesh&, const std::string& element, int dimension);

/// Numbering of the nodes: layers of the block from the surface inwards, then shell by shell.
struct HalfBallLayout {
  int width, height, shells;  ///< cells: half width and height of the block, number of shells
  explicit HalfBallLayout(const HalfBallMesh&);
  int row() const { return 2 * width + 1; }
  int around() const { return 8 * width; }
  int node_count() const { return (height + 1) * row() * row() + shells * (height * around() + row() * row()); }
  /// Node p[0], p[1] = -width .. width across the axis, q = 0 .. height inwards, on shell j = 0 .. shells; shell 0 is
  /// the block. Further shells have a node where q is height, at the top, or p is at the edge.
  int node(const std::array<int, 2>& p, int q, int j) const;
  bool is_edge(const std::array<int, 2>& p) const { return std::max(std::abs(p[0]), std::abs(p[1])) == width; }
  /// f(p, q, j) of all nodes.
  template <class F>
  void for_each_node(F&& f) const {
    for (int p = -width; p <= width; ++p)
      for (int r = -width; r <= width; ++r)
        for (int q = 0; q <= height; ++q)
          for (int j = 0; j <= (q == height || is_edge({p, r}) ? shells : 0); ++j) f(std::array{p, r}, q, j);
  }
};

/// Places in a half ball of unit radius that faces down, as seen from its pole.
template <class T>
class HalfBallPlaces {
 public:
  using Position = Vec<T, 3>;
  HalfBallPlaces(const HalfBallLayout& layout, const T& grade)
      : of_(layout),
        along_(graded_fractions(grade, layout.width + layout.shells)),
        axis_(graded_fractions(grade, layout.height + layout.shells)),
        opening_(along_[layout.width] * right_angle()) {
    using std::sin;
    const T half = opening_ * T(0.5), height = axis_[layout.height];
    corner_ = inner_corner<T>(Vec<T, 2>(sin(opening_), sin(half) * sin(half) * T(2.0)), opening_, height);
  }

  Position at(const std::array<int, 2>& p, int q, int j) const { return j == 0 ? in_block(p, q) : on_shell(p, q, j); }

 private:
  static double right_angle() { return std::acos(0.0); }

  /// A square of half width 1 with sides that bulge: its corners are drawn in, to 2 - 0.4 of the squared half width. Of
  /// 0.4 the three cells around a corner share the full turn about evenly.
  static Vec<T, 2> bulged(const T& u, const T& v) {
    using std::sqrt;
    return Vec<T, 2>(u * sqrt(T(1.0) - v * v * T(0.2)), v * sqrt(T(1.0) - u * u * T(0.2)));
  }

  /// Across the axis, in half widths of the block: where node p of it is.
  Vec<T, 2> across(const std::array<int, 2>& p) const {
    const auto share = [&](int k) { return along_[std::abs(k)] / along_[of_.width] * T(k < 0 ? -1.0 : 1.0); };
    return bulged(share(p[0]), share(p[1]));
  }

  /// On the sphere, at an angle from the pole in a direction of unit length.
  static Position on_sphere(const T& angle, const Vec<T, 2>& direction) {
    using std::sin;
    const T half = sin(angle * T(0.5));
    return Position(sin(angle) * direction[0], sin(angle) * direction[1], half * half * T(2.0));  // 1 - cos
  }

  Position on_surface(const std::array<int, 2>& p) const {
    if (p[0] == 0 && p[1] == 0) return Position::Constant(T(0.0));
    const Vec<T, 2> place = across(p);
    const T length = norm(place);
    return on_sphere(opening_ * length, place / length);
  }

  /// Straight from the surface to the top of the block, a paraboloid.
  Position in_block(const std::array<int, 2>& p, int q) const {
    const Vec<T, 2> place = across(p);
    const T height = axis_[of_.height], y = axis_[q] / height;
    const T top = height + (corner_[1] - height) * (place[0] * place[0] + place[1] * place[1]);
    const Position above(corner_[0] * place[0], corner_[0] * place[1], top);
    return on_surface(p) * T(T(1.0) - y) + above * y;
  }

  /// Direction from the centre of the flat side to its edge, of a node of the edge of the block: equal steps.
  Vec<T, 2> spoke(const std::array<int, 2>& p) const {
    const bool along_second = std::abs(p[0]) == of_.width;
    const double angle = right_angle() / 2 * p[along_second ? 1 : 0] / of_.width;
    const double ahead = std::cos(angle) * (p[along_second ? 0 : 1] < 0 ? -1 : 1), aside = std::sin(angle);
    return along_second ? Vec<T, 2>(T(ahead), T(aside)) : Vec<T, 2>(T(aside), T(ahead));
  }

  /// Straight rays from the block to equal steps on the flat side, bent near the surface to follow it.
  Position on_shell(const std::array<int, 2>& p, int q, int j) const {
    const auto share = [j](const std::vector<T>& f, int from) { return (f[from + j] - f[from]) / (T(1.0) - f[from]); };
    const T at_surface = share(along_, of_.width), at_axis = share(axis_, of_.height);
    const double core = static_cast<double>(of_.width) / (of_.width + of_.height), w = of_.width;
    const Vec<T, 2> inner = bulged(T(p[0] / w), T(p[1] / w)) * T(core);
    const Position from = in_block(p, q);
    if (!of_.is_edge(p)) {
      const double out = core * std::max(std::abs(p[0]), std::abs(p[1])) / w;
      const Position to(inner[0], inner[1], T(1.0));
      return from + (to - from) * T(at_surface * T(out) + at_axis * T(1 - out));
    }
    const Vec<T, 2> spoke = this->spoke(p), start = across(p);
    const double y = static_cast<double>(q) / of_.height, out = 1 - y + core * y;
    const Vec<T, 2> place = spoke * T(1 - y) + inner * T(y);
    const Position to(place[0], place[1], T(1.0));
    // on the sphere: from the block's edge at equal shares of the angle to the edge of the flat side
    const T length = norm(start), angle = opening_ * length;
    const Vec<T, 2> direction = start / length * T(T(1.0) - at_surface) + spoke * at_surface;
    const Position beside = on_sphere(angle + (T(right_angle()) - angle) * at_surface, direction / norm(direction));
    if (q == 0) return beside;
    const Position foot = on_surface(p),
                   bulge = beside - foot - (Position(spoke[0], spoke[1], T(1.0)) - foot) * at_surface;
    return from + (to - from) * T(at_surface * T(out) + at_axis * T(1 - out)) + bulge * T(out * out);
  }

  HalfBallLayout of_;
  std::vector<T> along_, axis_;
  T opening_;         ///< angle of the block's half width at the centre
  Vec<T, 2> corner_;  ///< of the block's top in a middle plane
};

/// Coordinates, 3 x nodes.
template <class T>
Points<T> coordinates(const HalfBallMesh& ball, const Numbers<T>& numbers, int) {
  const HalfBallLayout layout(ball);
  const HalfBallPlaces<T> places(layout, numbers(ball.grade));
  const T radius = numbers(ball.radius), up(ball.facing == HalfBallMesh::Facing::up ? -1.0 : 1.0);
  Points<T> points(3, layout.node_count());
  layout.for_each_node([&](const std::array<int, 2>& p, int q, int j) {
    const Vec<T, 3> at = places.at(p, q, j);
    const int node = layout.node(p, q, j);
    for (int axis = 0; axis < 2; ++axis) points(axis, node) = numbers(ball.center[axis]) + radius * at[axis];
    points(2, node) = numbers(ball.center[2]) + radius * (at[2] - T(1.0)) * up;
  });
  return points;
}

/// Puts the middles of the surface's faces on the sphere.
template <class T>
void bend(const HalfBallMesh& ball, const Mesh& mesh, const Numbers<T>& numbers, Points<T>& points) {
  const Vec<T, 3> center(numbers(ball.center[0]), numbers(ball.center[1]), numbers(ball.center[2]));
  bend_side(mesh.sides.at("surface"), center, numbers(ball.radius), points);
}

}  // namespace stickslip
