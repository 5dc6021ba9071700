/// The deformed bodies of the reference solution as a drawing.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

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

/// A step of a run, the states of its points, and a drawing.
struct StepPicture {
  long step;          ///< its number; 0: the start
  std::string words;  ///< "step 2, t = 0.5: 3 open, 1 slip"
  Drawing drawing;
};

/// The steps that picture.json has as `frames`, all in one window and at one scale; of many as many as a page holds,
/// the last among them.
std::vector<StepPicture> draw_steps(const nlohmann::json& picture);

}  // namespace stickslip::report
