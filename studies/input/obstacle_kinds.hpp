/// Rigid surfaces as files name them: for each its key, its schema, its reader and what pictures know of it. They are
/// made from what a surface says of its keys (core/algebra/described.hpp).
#pragma once

#include <nlohmann/json.hpp>

#include "studies/input/scene_reading.hpp"

namespace stickslip {

struct ObstacleKind {
  const char* key;                                                                   ///< of {"KEY": {...}}
  nlohmann::ordered_json (*schema)();                                                ///< JSON Schema of what it holds
  std::optional<RigidSurface> (*read)(const JsonNode& node, SceneReading& reading);  ///< none where it is at fault
  bool is_in_plane = false, is_in_space = false;                                     ///< where it is made for
};

/// {"KIND": {...}} of picture.json, where it stands at the start. The report draws planes, circles and
/// polylines; null among the points of a polyline is between two pieces of it.
nlohmann::json drawn(const RigidSurface& surface, const Numbers<double>& numbers);

/// All, in the order of RigidSurface.
const std::vector<ObstacleKind>& obstacle_kinds();

}  // namespace stickslip
