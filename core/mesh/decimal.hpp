/// Numbers in texts.
#pragma once

#include <optional>
#include <string_view>

namespace stickslip {

/// The number that the whole text writes in decimal notation, whatever the locale. None if it is not one, begins with
/// "+", or is out of the range of a double.
std::optional<double> decimal(std::string_view text);

}  // namespace stickslip
