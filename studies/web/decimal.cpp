/// core/mesh/decimal.hpp by the C library, since that of Emscripten has no std::from_chars of a double.
#include "core/mesh/decimal.hpp"

#include <cerrno>
#include <cstdlib>
#include <string>

namespace stickslip {

std::optional<double> decimal(std::string_view text) {
  if (text.empty() || text.find_first_of("+ \t\n\r") == 0 || text.find_first_of("xX") != text.npos) return std::nullopt;
  const std::string ended(text);
  char* end = nullptr;
  errno = 0;
  const double value = std::strtod(ended.c_str(), &end);
  if (errno == ERANGE || end != ended.c_str() + ended.size()) return std::nullopt;
  return value;
}

}  // namespace stickslip
