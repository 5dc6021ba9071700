/// Rigid surfaces as files name them: for each its key, its schema, its reader and what pictures know of it. A surface
/// more is an entry_of() in obstacle_kinds.cpp, beside the list of core/contact/rigid_surfaces.hpp and the file of its
/// geometry.
#pragma once

#include <nlohmann/json.hpp>

#include "studies/input/scene_reading.hpp"

namespace stickslip {

struct ObstacleKind {
  const char* key;                                                                   ///< of {"KEY": {...}}
  const char* schema;                                                                ///< JSON Schema of what it holds
  std::optional<RigidSurface> (*read)(const JsonNode& node, SceneReading& reading);  ///< none where it is at fault
  bool is_in_space = false;                                                          ///< or in the plane alone
};

/// {"KIND": {...}} of picture.json, where it stands at the start. The report draws planes, circles and polylines: any
/// other is one of these.
nlohmann::json drawn(const RigidSurface& surface);

/// All, in the order of RigidSurface.
const std::vector<ObstacleKind>& obstacle_kinds();

}  // namespace stickslip
