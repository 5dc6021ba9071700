/// Derivatives of the coordinates of generated meshes.
#pragma once

#include <string>
#include <vector>

#include "core/mesh/generators.hpp"

namespace stickslip {

/// Holds the derivatives of all coordinates by the number in each slot against the complex step. `numbers`: those in
/// the slots, nine at most.
void expect_exact_derivatives(const MeshDescription& description, const std::string& element, int dimension,
                              const std::vector<double>& numbers);

}  // namespace stickslip
