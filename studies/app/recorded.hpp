/// Directories that results are looked for in, and what is said of their rows.
#pragma once

#include <filesystem>
#include <iostream>
#include <string>
#include <system_error>

#include "studies/io/input_fault.hpp"
#include "studies/io/printing.hpp"
#include "studies/io/result_rows.hpp"

namespace stickslip {

/// Throws InputFault where the name is of no directory.
inline void check_recorded(const std::string& directory) {
  std::error_code ignored;
  if (std::filesystem::is_directory(directory, ignored)) return;
  throw InputFault(directory +
                   (std::filesystem::exists(directory, ignored) ? ": is a file" : ": there is no such directory") +
                   "; must be a directory that `stickslip study` or `stickslip run` wrote");
}

/// Says on standard error what was wrong with the rows of a directory.
inline void tell_faults(const StoredRows& stored, const std::string& directory) {
  if (!stored.sound()) std::cerr << printable("note: " + directory + "/results.jsonl: " + stored.faults()) << '\n';
}

}  // namespace stickslip
