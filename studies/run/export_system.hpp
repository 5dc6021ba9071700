/// The linear system of the last step as Matrix Market files, for people who bring a solver of their own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studies/run/case.hpp"

namespace stickslip {

/// Names of the files.
std::vector<std::string> exported_files();

/// Writes K, G, lambda, f, u, g and area as .mtx (all digits), rows.csv and points.csv that say what rows and
/// multipliers are, and a README with sizes, units and signs. They satisfy, at the end of the run and to rounding,
///
///   K u + G lambda = f       free displacements, u prescribed elsewhere
///   G^T u + g = area * (gap; slip since the start)      closed form of the kinematics, with what is prescribed in g
///
/// (n x n, n x m; m: 1 + tangents for each contact point), by write_outputs(). Returns exported_files(). pre: the run
/// has an increment. Throws std::system_error.
std::vector<std::string> export_system(const std::filesystem::path& folder, const CaseResult& result);

}  // namespace stickslip
