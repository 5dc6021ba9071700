/// Scene documents run as the program runs them: read, checked, solved, differentiated.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "studies/input/scene_reader.hpp"
#include "studies/run/case.hpp"

namespace stickslip::cases {

/// What a scene file says, comments dropped.
nlohmann::json load(const std::filesystem::path& file);

/// Reads a document as the file `name` (other files are looked for beside it). Throws with all faults.
Input read(const nlohmann::json& document, const std::filesystem::path& name);

/// Runs a document with `method` ({"penalty": {...}}) in place of its own.
CaseResult run(nlohmann::json document, const nlohmann::json& method, const std::filesystem::path& name);

/// Scales of the monolithic method that all come to the one solution of a scene. A large one comes, where points slide
/// along facets at finite strain, to a vertex at which neither facet has an equilibrium, and fails.
std::vector<nlohmann::json> scales_of(const nlohmann::json& scene);

}  // namespace stickslip::cases
