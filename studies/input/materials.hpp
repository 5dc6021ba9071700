/// Materials as files name them: for each its key, its schema and its reader. They are made from what a material says
/// of its keys (core/algebra/described.hpp). One with a key that is written in another way has an entry_of() in
/// materials.cpp.
#pragma once

#include <nlohmann/json.hpp>

#include "studies/input/scene_reading.hpp"

namespace stickslip {

struct MaterialKind {
  const char* key;                                                               ///< of {"KEY": {...}}
  nlohmann::ordered_json (*schema)();                                            ///< JSON Schema of what it holds
  const char* place;                                                             ///< what it is for, a verb first
  std::optional<Material> (*read)(const JsonNode& node, SceneReading& reading);  ///< none where it is at fault
  bool (*goes_with)(Filling filling, bool finite_strain) = nullptr;
};

/// All, in the order of Material.
const std::vector<MaterialKind>& material_kinds();

}  // namespace stickslip
