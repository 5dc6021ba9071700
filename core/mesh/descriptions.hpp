/// What a mesh is made from, as the user wrote it: one description a generator, or an imported mesh.
#pragma once

#include <array>
#include <string>
#include <variant>
#include <vector>

#include "core/algebra/number.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Axis-parallel block; sides left right bottom top. `grade` > 1 makes cells grow away from the side named in
/// `grade_towards` by that total ratio (largest cell / smallest cell).
struct BoxMesh {
  std::array<Number, 2> min, max;
  std::array<int, 2> cells{1, 1};
  std::string grade_towards;  ///< empty: uniform
  Number grade = 1.0;
};
/// Half disk below or above its diameter: the arc points in `facing` direction ("down" or "up"). Graded towards the
/// pole of the arc. Sides: arc, flat.
struct HalfDiskMesh {
  std::array<Number, 2> center;
  Number radius;
  std::array<int, 2> cells{8, 8};  ///< [along a quarter of the arc, from arc to centre]
  Number grade = 1.0;              ///< largest / smallest cell along the arc, smallest at the pole
  std::string facing = "down";
};
/// Quadrilateral by its corners, counter-clockwise; sides and grading as a box, bottom from corner 0 to corner 1.
struct QuadMesh {
  std::array<std::array<Number, 2>, 4> corners;
  std::array<int, 2> cells{1, 1};
  std::string grade_towards;
  Number grade = 1.0;
};
/// Ring between two circles, angles in degrees from +x, counter-clockwise; closed where they span 360. Sides inner,
/// outer, and start, end of an open one. `grade`: as in a box, towards inner or outer.
struct RingMesh {
  std::array<Number, 2> center;
  Number inner, outer, from_angle = 0.0, to_angle = 360.0;
  std::array<int, 2> cells{1, 8};  ///< [along the radius, around]
  std::string grade_towards;
  Number grade = 1.0;
};
/// Disk with a square core. Side: arc.
struct DiskMesh {
  std::array<Number, 2> center;
  Number radius;
  std::array<int, 2> cells{4, 2};  ///< [along a quarter of the arc, rings around the core]
  Number grade = 1.0;              ///< innermost / outermost ring
};
/// One node and the anchor of its spring, at the same place. Sides NAME.node, NAME.anchor (grounded_spring).
struct PointMesh {
  std::vector<Number> at;  ///< 2 or 3 coordinates
};
/// Chain of bars. Sides start, end, nodes (all), interior (all but the two ends).
struct LineMesh {
  std::vector<Number> from, to;
  int cells = 1;
};
/// Chain of bars along a circular arc, angles in degrees from +x, counter-clockwise. Sides as LineMesh.
struct ArcMesh {
  std::array<Number, 2> center;
  Number radius, from_angle, to_angle;
  int cells = 1;
};
/// Body of an imported mesh: topology and coordinates as read.
struct ImportedMesh {
  std::string file, body;
  Mesh mesh;
  Points<double> points;
};
using MeshDescription =
    std::variant<BoxMesh, QuadMesh, HalfDiskMesh, DiskMesh, RingMesh, PointMesh, LineMesh, ArcMesh, ImportedMesh>;

}  // namespace stickslip
