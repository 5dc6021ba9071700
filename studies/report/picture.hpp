/// The deformed bodies of the reference solution as a drawing.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "studies/report/charts.hpp"

namespace stickslip::report {

/// Bodies deformed and coloured by equivalent stress, obstacles, contact points by state (in a close-up of the contact
/// at true scale, where that shows more), and a legend; points with the springs to their anchors; what is in space as
/// it is seen along z. `picture` is picture.json. Nothing where there is nothing to draw (one place, no picture).
std::optional<Plate> draw_picture(const nlohmann::json& picture);

/// Whether draw_picture() shows the contact larger, which draw_overview() has no room for.
bool needs_close_up(const nlohmann::json& picture);

/// The same for half the width of a page, with the close-up only where the bodies leave room beside them.
std::optional<Plate> draw_overview(const nlohmann::json& picture);

}  // namespace stickslip::report
