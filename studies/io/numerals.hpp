/// Numbers as pages and commands show them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace stickslip {

/// `digits` significant digits, with a power of ten below 0.001 and from 10000 on: "0.5", "1e5", "1.5e-4"; of larger
/// numbers all digits before the point. Not finite: "".
std::string number(double value, int digits = 3);

/// The same with as many digits as it takes to read back the same.
std::string exact_number(double value);

/// JSON in one line with its numbers in the style of exact_number().
std::string json_with_exact_numbers(const nlohmann::json& value);

}  // namespace stickslip
