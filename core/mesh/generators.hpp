/// From the description of a mesh to its topology (numbers play no part) and its coordinates (in any scalar, so that
/// the derivative with respect to every dimension is exact). A family has a file of its own, with
///
///   its description   for the scene, as the user wrote it: its keys (core/algebra/described.hpp); what it is made of
///                     (filling); the number of its quadrilaterals, hexahedra or bars (cell_count); fills_space if it
///                     has meshes in space
///   fault()           what is wrong with the description, by its values
///   topology()        elements of linear shape and sides; of grids, core/mesh/structured.hpp has both
///   coordinates()     in the scalar of the numbers
///   bend()            only if it has curved sides: moves the middles of quadratic elements onto them
///
/// What a description lacks does not compile; a bend() that is forgotten does.
#pragma once

#include <string>
#include <variant>

#include "core/mesh/ball.hpp"
#include "core/mesh/box.hpp"
#include "core/mesh/chain.hpp"
#include "core/mesh/disk.hpp"
#include "core/mesh/extruded.hpp"
#include "core/mesh/half_ball.hpp"
#include "core/mesh/half_disk.hpp"
#include "core/mesh/imported.hpp"
#include "core/mesh/mesh.hpp"
#include "core/mesh/middles.hpp"
#include "core/mesh/quad.hpp"
#include "core/mesh/ring.hpp"

namespace stickslip {

/// In the order in which messages and the schema name them.
using MeshDescription = std::variant<BoxMesh, QuadMesh, RingMesh, DiskMesh, HalfDiskMesh, HalfBallMesh, BallMesh,
                                     ExtrudedMesh, PointMesh, LineMesh, ArcMesh, ImportedMesh>;

/// What the mesh is made of.
Filling filling_of(const MeshDescription&);

/// What is wrong with a description, this element and this dimension of the space, as a sentence without a full stop;
/// "" if nothing. `element`: "Q4", "Q4_mean_dilatation", "Q8", "T3" or "T6" (plane meshes), "H8",
/// "H8_mean_dilatation", "H20", "H27", "T4" or "T10" (meshes of space), "bar" (chains), "point", or "" for the default.
std::string mesh_fault(const MeshDescription&, const std::string& element, int dimension);

/// Topology and sides. Throws std::invalid_argument with mesh_fault.
Mesh make_mesh(const MeshDescription&, const std::string& element, int dimension);

/// Coordinates, dimension x nodes, of the mesh of linear elements that make_mesh gives. pre: mesh_fault is empty.
template <class T>
Points<T> make_points(const MeshDescription& description, const Numbers<T>& numbers, int dimension) {
  return std::visit([&](const auto& mesh) { return coordinates(mesh, numbers, dimension); }, description);
}

/// Coordinates, dimension x nodes, of any mesh that make_mesh made of the description.
template <class T>
Points<T> make_points(const MeshDescription& description, const Mesh& mesh, const Numbers<T>& numbers) {
  Points<T> points = make_points(description, numbers, mesh.dimension);
  if (mesh.middles.empty()) return points;
  points = with_middles(mesh, points);
  const auto bend_sides = [&](const auto& kind) {
    if constexpr (requires { bend(kind, mesh, numbers, points); }) bend(kind, mesh, numbers, points);
  };
  std::visit(bend_sides, description);
  if (mesh.centres.empty()) return points;
  place_centres(mesh, points);  // between middles that lie on curved sides now; those of curved faces go there again
  std::visit(bend_sides, description);
  return points;
}

extern template Points<double> make_points(const MeshDescription&, const Numbers<double>&, int);
extern template Points<double> make_points(const MeshDescription&, const Mesh&, const Numbers<double>&);

}  // namespace stickslip
