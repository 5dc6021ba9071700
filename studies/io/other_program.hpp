/// Other programs, run without a shell.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stickslip {

/// What a program prints on standard output. `words`: its name, looked up in PATH, then its arguments; `variables` are
/// set in its environment. Nothing if there is no such program, or if it ends with another code than 0; what it says
/// then is on standard error. Throws std::system_error if the system has no process or pipe left.
std::optional<std::string> output_of(std::vector<std::string> words,
                                     const std::vector<std::pair<std::string, std::string>>& variables);

}  // namespace stickslip
