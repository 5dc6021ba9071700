/// Uniform splitting of an imported mesh: each triangle or quadrangle into four, each tetrahedron or hexahedron into
/// eight.
#pragma once

#include "core/mesh/imported.hpp"

namespace stickslip {

/// The mesh with every element split into four (in space eight) of its own shape, at the middles of its sides. Nodes of
/// the mesh keep their numbers and places; the new ones lie where the element's own shape functions put them. So the
/// region stays what it was: sides of linear elements stay straight, those of quadratic elements keep their parabolas.
ImportedMesh split(const ImportedMesh&);
/// pre: the mesh is of tetrahedra or hexahedra.
ImportedMesh split_in_space(const ImportedMesh&);

}  // namespace stickslip
