/// The parts of the study reader. `scene` is the document of the scene that the study names; null where it cannot be
/// read: then the study is not held against it.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "studies/input/file_objects.hpp"
#include "studies/input/method_options.hpp"
#include "studies/io/json_node.hpp"
#include "studies/sweep/study_reader.hpp"

namespace stickslip {

/// The objects of a study by name (studies/input/file_objects.hpp).
const nlohmann::ordered_json& study_objects();
inline const nlohmann::ordered_json& study_object(const char* name) { return study_objects().at(name); }

inline constexpr int finest_level = 10;  ///< of meshes: a thousand times the cells each way

/// The one method of an object, with the values of its options. None where it is at fault.
std::optional<MethodSweep> read_method_sweep(const JsonNode&, OptionLists);

/// The methods of a study; where it lists none, the one of its scene.
std::vector<MethodSweep> read_methods(const JsonNode& study, const std::optional<JsonNode>& scene);
std::vector<Variation> read_vary(const JsonNode&, const nlohmann::json& scene);
/// Values of the meshes of bodies, one each.
std::vector<Knob> read_meshes(const JsonNode&, const nlohmann::json& scene);
std::vector<PlacedValue> read_levels(const JsonNode&);
std::vector<Reference> read_references(const JsonNode&, const nlohmann::json& scene);
/// Solutions of other programs, whose files are looked for beside the study's `file`.
std::vector<std::shared_ptr<const PeerSolution>> read_solutions(const JsonNode&, const std::string& file);
/// Patterns of the errors that are asked for.
std::vector<std::string> read_errors(const JsonNode&, const nlohmann::json& scene);

}  // namespace stickslip
