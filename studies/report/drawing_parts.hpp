/// What the writers of a drawing (SVG, PGF) share.
#pragma once

#include <string>

namespace stickslip::report {

/// Whether a colour is one of the names ink, soft, line, paper.
bool is_named(const std::string& color);

/// Whether a colour is "curve #RRGGBB", which has a shade of its own on dark paper.
inline bool is_of_curve(const std::string& color) { return color.starts_with("curve "); }

/// "#RRGGBB" in the light scheme; "none" of "".
std::string in_light(const std::string& color);

/// A number without what carries nothing: "12.5", "3".
std::string short_number(double value);

}  // namespace stickslip::report
