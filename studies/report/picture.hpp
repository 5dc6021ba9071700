/// The deformed bodies of the reference solution as one inline SVG.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace stickslip::report {

/// HTML of the picture: bodies deformed and coloured by equivalent stress, obstacles, contact points by state, a
/// close-up of the contact at true scale, and a legend. `picture` is picture.json. "" where there is no plane mesh to
/// draw (one node, three dimensions, no picture).
std::string draw_picture(const nlohmann::json& picture);

}  // namespace stickslip::report
