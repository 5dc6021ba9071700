/// Work that may end in an exception, whose result is then why.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace stickslip {

/// Why a piece of work ended without a result.
struct Breakdown {
  std::string status;   ///< `cap` where there was not enough memory, `failed` where the program broke down
  std::string message;  ///< for the user
};

/// Does it; what it throws is returned, whatever it is.
std::optional<Breakdown> attempt(const std::function<void()>& work);

}  // namespace stickslip
