/// A plane mesh drawn out along z.
///
/// Node n of the plane mesh in layer k, counted from `from` on, has number k (plane nodes) + n. Quadrilaterals become
/// hexahedra. The prism on a triangle becomes three tetrahedra. The numbers of its nodes decide which, so the diagonals
/// of neighbours agree. The sides are those of the plane mesh, and front and back, where z is `from` and `to`.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <variant>

#include "core/algebra/described.hpp"
#include "core/mesh/box.hpp"
#include "core/mesh/disk.hpp"
#include "core/mesh/half_disk.hpp"
#include "core/mesh/mesh.hpp"
#include "core/mesh/middles.hpp"
#include "core/mesh/quad.hpp"
#include "core/mesh/ring.hpp"

namespace stickslip {

/// Generated meshes of the plane.
using PlaneMesh = std::variant<BoxMesh, QuadMesh, RingMesh, DiskMesh, HalfDiskMesh>;

struct ExtrudedMesh {
  static constexpr const char *key = "extruded", *about =
                                                     "a plane mesh drawn out along z, in space alone; its sides, and "
                                                     "front and back at the ends";
  static constexpr Filling filling = Filling::continuum;
  static constexpr bool fills_space = true;
  PlaneMesh mesh;
  Number from, to;
  int cells = 1;

  double cell_count() const {
    return cells * std::visit([](const auto& plane) { return plane.cell_count(); }, mesh);
  }
  static constexpr auto keys() {
    return std::tuple{
        Key{&ExtrudedMesh::mesh, "mesh", "box, quad, ring, disk or half_disk, as in a plane space",
            MeshInPlane{R"({"ring": {"center": [0, 0], "inner": 1, "outer": 2, "cells": [4, 24]}})"}},
        Key{&ExtrudedMesh::from, "from", "z of the front (length)", InRange{Range::any, 0}},
        Key{&ExtrudedMesh::to, "to", "z of the back, above that of the front (length)", InRange{Range::any, 1}},
        Key{&ExtrudedMesh::cells, "cells", "along z", Count{4}}};
  }
};

/// What is wrong with the description, or "".
std::string fault(const ExtrudedMesh&, const std::string& element, int dimension);
Mesh topology(const ExtrudedMesh&, const std::string& element, int dimension);
/// The plane mesh with middles, on which a mesh of quadratic elements of space stands.
Mesh plane_with_middles(const ExtrudedMesh&, ElementShape of_space);

/// Coordinates, 3 x nodes.
template <class T>
Points<T> coordinates(const ExtrudedMesh& extruded, const Numbers<T>& numbers, int) {
  const Points<T> plane = std::visit([&](const auto& mesh) { return coordinates(mesh, numbers, 2); }, extruded.mesh);
  Points<T> points(3, plane.cols() * (extruded.cells + 1));
  for (int k = 0; k <= extruded.cells; ++k) {
    const double share = static_cast<double>(k) / extruded.cells;
    const T z = T(1 - share) * numbers(extruded.from) + T(share) * numbers(extruded.to);
    for (Eigen::Index n = 0; n < plane.cols(); ++n) {
      const Eigen::Index node = k * plane.cols() + n;
      points(0, node) = plane(0, n);
      points(1, node) = plane(1, n);
      points(2, node) = z;
    }
  }
  return points;
}

/// Puts the middles of edges over an edge of the plane mesh where that has its middle.
template <class T>
void bend(const ExtrudedMesh& extruded, const Mesh& mesh, const Numbers<T>& numbers, Points<T>& points) {
  const Mesh plane = plane_with_middles(extruded, mesh.shape);
  Points<T> places = std::visit([&](const auto& kind) { return coordinates(kind, numbers, 2); }, extruded.mesh);
  const auto layer = static_cast<int>(places.cols());
  places = with_middles(plane, places);
  const auto bend_sides = [&](const auto& kind) {
    if constexpr (requires { bend(kind, plane, numbers, places); }) bend(kind, plane, numbers, places);
  };
  std::visit(bend_sides, extruded.mesh);
  std::map<std::pair<int, int>, int> middle_of;
  for (std::size_t k = 0; k < plane.middles.size(); ++k)
    middle_of[std::minmax(plane.middles[k][0], plane.middles[k][1])] = layer + static_cast<int>(k);
  const auto first = layer * (extruded.cells + 1);
  for (std::size_t k = 0; k < mesh.middles.size(); ++k) {
    const int a = mesh.middles[k][0] % layer, b = mesh.middles[k][1] % layer;
    const int below = a == b ? a : middle_of.at(std::minmax(a, b));
    for (int i = 0; i < 2; ++i) points(i, first + static_cast<Eigen::Index>(k)) = places(i, below);
  }
}

}  // namespace stickslip
