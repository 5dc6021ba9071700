/// Values and names in messages.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip {

/// Text of a value for a message, at most about 40 characters.
std::string shown(const nlohmann::json& value);
/// "NAME" in quotes.
std::string in_quotes(std::string_view name);
/// "1 cell", "2 cells": a noun that an s makes many.
std::string counted(long count, const std::string& noun);
/// "0.031 %", "5800 %": two digits, or all of a whole number.
std::string in_percent(double share);
/// Names as a list: "a, b, c"; of more than 40 the first 40, and how many there are.
std::string listed(const std::vector<std::string>& names);
/// ` did you mean "NAME"?` with the nearest of the names, where at most two letters differ (a swap counts as one) or
/// one is the beginning of the other or, of four letters or more, a part of it; otherwise "". Of very many names it
/// looks at the first 1000, and at none of more than 64 letters: a file may hold as many faults as names.
std::string suggestion(std::string_view name, const std::vector<std::string>& names);

}  // namespace stickslip
