/// Laws of friction as files name them: reader and schema, made from what each law says of its numbers
/// (core/contact/friction_law.hpp). A law more needs nothing here.
#pragma once

#include <nlohmann/json.hpp>

#include "studies/input/scene_reading.hpp"

namespace stickslip {

/// A number alone, which is Coulomb's, or {"KEY": number, ...} of a law. Faults are reported.
FrictionLaw<Number> read_friction(const JsonNode&, SceneReading&);

/// JSON Schema of the object of each law, in the order of their list.
std::vector<nlohmann::ordered_json> friction_schemas();

}  // namespace stickslip
