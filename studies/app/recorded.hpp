/// Directories that results are looked for in.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#include "studies/io/input_fault.hpp"

namespace stickslip {

/// Throws InputFault where the name is of no directory.
inline void check_recorded(const std::string& directory) {
  std::error_code ignored;
  if (std::filesystem::is_directory(directory, ignored)) return;
  throw InputFault(directory +
                   (std::filesystem::exists(directory, ignored) ? ": is a file" : ": there is no such directory") +
                   "; must be a directory that `stickslip study` or `stickslip run` wrote");
}

}  // namespace stickslip
