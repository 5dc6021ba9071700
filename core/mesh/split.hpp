/// Uniform splitting of an imported mesh: each triangle or quadrangle into four.
#pragma once

#include "core/mesh/imported.hpp"

namespace stickslip {

/// The mesh with every element split into four of its own shape, at the middles of its sides. Nodes of the mesh keep their
/// numbers and places; the new ones lie where the element's own shape functions put them. So the region stays what it
/// was: sides of linear elements stay straight, those of quadratic elements keep their parabolas.
ImportedMesh split(const ImportedMesh&);

}  // namespace stickslip
