#include "studies/io/wording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace stickslip {

using nlohmann::json;

std::string shown(const json& value) {
  constexpr std::size_t room = 40;
  if (value.is_object() && value.size() > 2) return "an object of " + std::to_string(value.size()) + " keys";
  if (value.is_number_float()) {
    const double number = value.get<double>();
    if (number == std::trunc(number) && std::abs(number) < 1e15) return std::to_string(static_cast<long long>(number));
  }
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() <= room) return text;
  std::size_t end = room;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // not inside a character
  return text.substr(0, end) + "...";
}

std::string in_quotes(std::string_view name) { return "\"" + std::string(name) + "\""; }

std::string counted(long count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string in_percent(double share) {
  constexpr double rounds_to_all = 0.995;
  return share < rounds_to_all ? fmt::format("{:.2g} %", 100 * share) : fmt::format("{:.0f} %", 100 * share);
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t most = 40;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i) list += (i ? ", " : "") + names[i];
  if (names.size() > most) list += ", ... (" + std::to_string(names.size()) + " in all)";
  return list.empty() ? "nothing" : list;
}

namespace {

constexpr std::size_t longest_name = 64;  // that is looked for among others

/// Letters put in, left out, replaced or swapped with their neighbour that turn one text into the other. pre: neither
/// is longer than longest_name.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::array<std::array<std::size_t, longest_name + 1>, 3> rows;  // of the table: row i, and the two before it
  for (std::size_t i = 0; i <= a.size(); ++i) {
    auto &now = rows[i % 3], &before = rows[(i + 2) % 3], &earlier = rows[(i + 1) % 3];
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        now[j] = i + j;
        continue;
      }
      now[j] = std::min({before[j] + 1, now[j - 1] + 1, before[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) now[j] = std::min(now[j], earlier[j - 2] + 1);
    }
  }
  return rows[a.size() % 3][b.size()];
}

/// Whether one is the other's beginning, or, of four letters or more, any part of it.
bool holds(std::string_view longer, std::string_view shorter) {
  return longer.substr(0, shorter.size()) == shorter
             ? shorter.size() >= 3
             : shorter.size() >= 4 && longer.find(shorter) != std::string_view::npos;
}

/// How many letters two names differ by, where one may be meant by the other.
std::optional<std::size_t> distance_where_near(std::string_view a, std::string_view b) {
  constexpr std::size_t farthest = 2;
  if (a.size() > longest_name || b.size() > longest_name) return std::nullopt;
  const auto& [shorter, longer] = a.size() < b.size() ? std::pair(a, b) : std::pair(b, a);
  const std::size_t lengths = longer.size() - shorter.size();
  if (holds(longer, shorter)) return lengths;
  if (lengths > farthest) return std::nullopt;
  const std::size_t distance = edit_distance(a, b);
  // a name of two letters is within two edits of any other
  const bool near = distance <= farthest && (distance < shorter.size() || longer.substr(0, shorter.size()) == shorter);
  return near ? std::optional(distance) : std::nullopt;
}

}  // namespace

std::string suggestion(std::string_view name, const std::vector<std::string>& names) {
  constexpr std::size_t too_far = std::numeric_limits<std::size_t>::max(), most = 1000;
  std::size_t least = too_far;
  std::string nearest;
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i)
    if (const std::size_t distance = distance_where_near(name, names[i]).value_or(too_far); distance < least) {
      least = distance;
      nearest = names[i];
    }
  return nearest.empty() ? "" : " did you mean " + in_quotes(nearest) + "?";
}

}  // namespace stickslip
