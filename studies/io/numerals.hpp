/// Numbers as pages and commands show them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace stickslip {

/// `digits` significant digits, with a power of ten below 0.001 and from 10000 on: "0.5", "1e5", "1.5e-4"; of larger
/// numbers all digits before the point. Not finite: "".
std::string number(double value, int digits = 3);

/// The same with as many digits as it takes to read back the same.
std::string exact_number(double value);

/// "2·10⁻⁴" of "2e-4".
std::string with_power(const std::string& numeral);

/// "-" and the digits as they are raised, at their place in `lowered`.
inline constexpr std::string_view raised[] = {"⁻", "⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
inline constexpr std::string_view lowered = "-0123456789";

/// JSON in one line with its numbers in the style of exact_number().
std::string json_with_exact_numbers(const nlohmann::json& value);

}  // namespace stickslip
