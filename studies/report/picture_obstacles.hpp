/// The rigid obstacles of a picture.
#pragma once

#include <nlohmann/json.hpp>

#include "studies/report/drawing.hpp"
#include "studies/report/picture_frame.hpp"

namespace stickslip::report {

/// Obstacles of picture.json where they have moved to, their motion enlarged by `scale` as that of the bodies is;
/// solids are hatched.
void draw_obstacles(const nlohmann::json& obstacles, double scale, const Frame& frame, Drawing& drawing);

/// Lines on obstacles in space, likewise. They are drawn over the bodies: who looks at the sides in contact has the
/// obstacle before these.
void draw_wires(const nlohmann::json& obstacles, double scale, const Frame& frame, Drawing& drawing);

}  // namespace stickslip::report
