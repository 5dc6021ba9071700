/// JSON Schemas (draft 2020-12) of the files this program reads, for editors to complete and check them. The readers
/// decide; tests hold each object's keys against what the reader allows.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace stickslip {

nlohmann::json scene_schema();
nlohmann::json study_schema();

}  // namespace stickslip
