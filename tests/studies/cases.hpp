/// Scene documents run as the program runs them: read, checked, solved, differentiated.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "studies/input/scene_reader.hpp"
#include "studies/run/case.hpp"

namespace stickslip::cases {

/// Folder of the scenes that come with the program.
inline const std::filesystem::path shipped = STICKSLIP_SOURCE_DIR "/studies/scenes";

/// What a scene file says, comments dropped.
nlohmann::json load(const std::filesystem::path& file);

/// Reads a document as the file `name` (other files are looked for beside it). Throws with all faults.
Input read(const nlohmann::json& document, const std::filesystem::path& name);

/// Runs a document with `method` ({"penalty": {...}}) in place of its own.
CaseResult run(nlohmann::json document, const nlohmann::json& method, const std::filesystem::path& name);

/// Scales of the monolithic method that all come to the one solution of a scene. A large one comes, where points slide
/// along facets at finite strain, to a vertex at which neither facet has an equilibrium, and fails.
std::vector<nlohmann::json> scales_of(const nlohmann::json& scene);

/// A block of `cells` cells in the width of its sole, driven on to a slab of one cell, whose modulus is `soft`.
nlohmann::json block_on_a_slab(int cells, double soft);

}  // namespace stickslip::cases
