/// JSON Schemas (draft 2020-12) of the files this program reads, for editors to complete and check them, and for the
/// tables of docs/. The readers decide; tests hold each object's keys, and the defaults, against theirs. Keys stand in
/// the order in which they are explained.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace stickslip {

nlohmann::ordered_json scene_schema();
nlohmann::ordered_json study_schema();

}  // namespace stickslip
