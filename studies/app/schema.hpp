/// JSON Schemas (draft 2020-12) of the files this program reads, for editors to complete and check them, and for the
/// tables of docs/. The keys of an object are those that its reader allows, from one description
/// (studies/input/file_objects.hpp, studies/input/described.hpp); tests hold defaults and rules against the readers.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace stickslip {

nlohmann::ordered_json scene_schema();
nlohmann::ordered_json study_schema();

}  // namespace stickslip
