/// Numbers and contact points in words of the scene.
#pragma once

#include <cstdio>
#include <string>

#include "core/model/slots.hpp"

namespace stickslip {

/// Six digits of a number, for messages.
inline std::string short_number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

/// A contact point in words of the scene: its contact, and where its node was at the start.
template <class T>
std::string name_of_point(const Model& model, const Slots<T>& slots, int p) {
  const auto& point = model.points[p];
  std::string place;
  for (int i = 0; i < model.dimension; ++i)
    place += (i ? ", " : "") + short_number(value(slots.points(i, point.nodes[0])));
  return "the contact point of " + model.scene.contacts[point.contact].name + " at (" + place + ")";
}

}  // namespace stickslip
