/// What ends a command because of what it was given, a directory or a file of results; main() prints it, exit code 2.
#pragma once

#include <exception>
#include <stdexcept>
#include <string>

namespace stickslip {

/// what() names the path, what is wrong with it, and what to do.
struct InputFault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Of recorded files, which may have been edited: `whose` names those that something else must have written.
inline InputFault not_written(const std::string& whose, const std::exception& why, const std::string& advice = "") {
  return InputFault(whose + " hold what stickslip does not write (" + why.what() + ")" + advice);
}

}  // namespace stickslip
