#include "studies/wording.hpp"

#include <algorithm>
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

std::string listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list.empty() ? "nothing" : list;
}

namespace {

/// Letters put in, left out, replaced or swapped with their neighbour that turn one text into the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
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
  const auto& [shorter, longer] = a.size() < b.size() ? std::pair(a, b) : std::pair(b, a);
  const std::size_t lengths = longer.size() - shorter.size();
  if (holds(longer, shorter)) return lengths;
  if (lengths > farthest) return std::nullopt;  // which keeps the table of the distance small
  const std::size_t distance = edit_distance(a, b);
  // a name of two letters is within two edits of any other
  const bool near = distance <= farthest && (distance < shorter.size() || longer.substr(0, shorter.size()) == shorter);
  return near ? std::optional(distance) : std::nullopt;
}

}  // namespace

std::string suggestion(std::string_view name, const std::vector<std::string>& names) {
  constexpr std::size_t too_far = std::numeric_limits<std::size_t>::max();
  std::size_t least = too_far;
  std::string nearest;
  for (const std::string& candidate : names)
    if (const std::size_t distance = distance_where_near(name, candidate).value_or(too_far); distance < least) {
      least = distance;
      nearest = candidate;
    }
  return nearest.empty() ? "" : " did you mean " + in_quotes(nearest) + "?";
}

}  // namespace stickslip
