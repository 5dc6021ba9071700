/// Materials as files name them: for each its key, its schema and its reader. A material more is an entry_of() in
/// materials.cpp, beside the list of core/solids/materials.hpp and the file of its law.
#pragma once

#include "studies/input/scene_reading.hpp"

namespace stickslip {

/// What a mesh is made of, as far as materials ask.
enum class Filling { point, bars, continuum };

struct MaterialKind {
  const char* key;                                                               ///< of {"KEY": {...}}
  const char* schema;                                                            ///< JSON Schema of what it holds
  const char* place;                                                             ///< what it is for, a verb first
  std::optional<Material> (*read)(const JsonNode& node, SceneReading& reading);  ///< none where it is at fault
  bool (*goes_with)(Filling filling, bool finite_strain) = nullptr;
};

/// All, in the order of Material.
const std::vector<MaterialKind>& material_kinds();

}  // namespace stickslip
