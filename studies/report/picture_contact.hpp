/// The contact points of a picture: as symbols of their states, a node's contacts as one.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "studies/report/drawing.hpp"
#include "studies/report/picture_frame.hpp"

namespace stickslip::report {

/// A contact point of picture.json.
struct ContactPoint {
  Point place, displacement;  ///< deformed; of its node, 0 where that is not recorded
  std::string name, state;
  nlohmann::json normal, tangential;  ///< tractions
  int node = -1;                      ///< of the mesh; -1 where that is not recorded
  Point enlarged(double scale) const {
    return {place.x + (scale - 1) * displacement.x, place.y + (scale - 1) * displacement.y};
  }
};

/// `displacement`: of the nodes of the mesh.
std::vector<ContactPoint> read_contact(const nlohmann::json& contact, const std::vector<Point>& displacement);

/// Contact points inside the window, at the mesh's scale, with the states and tractions as a tooltip. A node that is in
/// several contacts has one symbol, of the state that holds most (stick, then slip or touch, then open), and tells of
/// all. Where neighbours would cover one another, symbols are smaller.
void draw_contact(const std::vector<ContactPoint>& contact, double scale, const Frame& frame, Drawing& drawing);

/// The legend of the states that the points are in, with its upper edge at y; stick and slip go together.
void draw_states(const std::vector<ContactPoint>& contact, double y, Drawing& drawing);

}  // namespace stickslip::report
