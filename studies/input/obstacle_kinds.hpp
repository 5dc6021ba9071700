/// Rigid surfaces as files name them: for each its key, its schema, its reader and what pictures know of it. A surface
/// more is an entry of this table, beside core/contact/rigid_surfaces.hpp and the file of its geometry.
#pragma once

#include <nlohmann/json.hpp>

#include "studies/input/scene_reading.hpp"

namespace stickslip {

struct ObstacleKind {
  const char* key;                                                                   ///< of {"KEY": {...}}
  const char* schema;                                                                ///< JSON Schema of what it holds
  bool is_in_space;                                                                  ///< or in the plane alone
  std::optional<RigidSurface> (*read)(const JsonNode& node, SceneReading& reading);  ///< none where it is at fault
  /// {"KIND": {...}} of picture.json, where it stands at the start, or null where it is no such surface. The report
  /// draws planes, circles and polylines: any other is one of these.
  nlohmann::json (*drawn)(const RigidSurface& surface);
};

const std::vector<ObstacleKind>& obstacle_kinds();

}  // namespace stickslip
