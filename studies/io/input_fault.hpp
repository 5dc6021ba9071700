/// What ends a command because of what it was given, a directory or a file of results; main() prints it, exit code 2.
#pragma once

#include <stdexcept>

namespace stickslip {

/// what() names the path, what is wrong with it, and what to do.
struct InputFault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace stickslip
