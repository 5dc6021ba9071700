/// solution.json: what a solution is checked by (docs/verify.md has the schema). It holds the scene as it was
/// simulated, its mesh, and of each increment the displacements of the nodes and the tractions of the contacts.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "studies/run/case.hpp"

namespace stickslip {

/// Bytes that a solution.json may have at most; a larger one is left out.
inline constexpr std::size_t largest_solution = std::size_t{64} << 20;

/// The text of solution.json, or the reason why there is none.
struct SolutionFile {
  std::string text;      ///< empty: left out
  std::string left_out;  ///< the reason, in words that complete "solution.json: "
};

/// `scene`: the document as simulated (Input::document). Numbers have the fewest digits that read back the same.
SolutionFile solution_file(const CaseResult& result, const nlohmann::json& scene,
                           std::size_t largest = largest_solution);

/// {"scene", "mesh"} of solution.json, without a solution.
nlohmann::json solution_frame(const Problem& problem, const nlohmann::json& scene);

}  // namespace stickslip
