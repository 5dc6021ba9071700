/// What the writers of a drawing (SVG, PGF) share.
#pragma once

#include <string>

namespace stickslip::report {

/// Whether a colour is one of the names ink, soft, line, paper.
bool is_named(const std::string& color);

/// "#RRGGBB" in the light scheme; "none" of "".
std::string in_light(const std::string& color);

/// A number without what carries nothing: "12.5", "3".
std::string short_number(double value);

}  // namespace stickslip::report
