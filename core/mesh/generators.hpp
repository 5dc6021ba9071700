/// From the description of a mesh to its topology (numbers play no part) and its coordinates (in any scalar, so that
/// the derivative with respect to every dimension is exact). One file per family: box, half_disk, chain; each gives
/// fault, topology and coordinates of its descriptions.
#pragma once

#include <string>
#include <variant>

#include "core/mesh/box.hpp"
#include "core/mesh/chain.hpp"
#include "core/mesh/half_disk.hpp"
#include "core/mesh/mesh.hpp"
#include "core/model/scene.hpp"

namespace stickslip {

std::string fault(const ImportedMesh&, const std::string& element, int dimension);
Mesh topology(const ImportedMesh&, const std::string& element, int dimension);

/// Coordinates as read: constants.
template <class T>
Points<T> coordinates(const ImportedMesh& imported, const Numbers<T>&, int) {
  return imported.points.unaryExpr([](double x) { return T(x); });
}

/// What is wrong with a description, this element and this dimension of the space, as a sentence without a full stop;
/// "" if nothing. `element`: "T3" or "Q4" (box, half disk), "bar" (chains), "point", or "" for the default.
std::string mesh_fault(const MeshDescription&, const std::string& element, int dimension);

/// Topology and sides. Throws std::invalid_argument with mesh_fault.
Mesh make_mesh(const MeshDescription&, const std::string& element, int dimension);

/// Coordinates, dimension x nodes, of the mesh make_mesh gives. pre: mesh_fault is empty.
template <class T>
Points<T> make_points(const MeshDescription& description, const Numbers<T>& numbers, int dimension) {
  return std::visit([&](const auto& mesh) { return coordinates(mesh, numbers, dimension); }, description);
}

}  // namespace stickslip
