#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "studies/report/chart_parts.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// Height, and the places across in the charts against work and against seconds, in logarithms.
using Place = std::array<double, 3>;

Place place_of(const json& row) {
  const auto logarithm = [&](const char* field) { return std::log10(row[field].get<double>()); };
  return {logarithm("shown"), logarithm("work"), logarithm("seconds")};
}

/// The first and the last point of a line.
struct Ends {
  json *first = nullptr, *last = nullptr;
};

/// What is shown at once, as a key.
std::string choice_of(const json& row) { return row.value("quantity", "") + '\n' + row.value("scene", ""); }

/// Words beside points, and which of them fit.
class Words {
 public:
  void span(const Place& at) {
    for (std::size_t i = 0; i < at.size(); ++i)
      if (std::isfinite(at[i])) {
        least_[i] = std::min(least_[i], at[i]);
        most_[i] = std::max(most_[i], at[i]);
      }
  }

  /// Whether two points lie apart, in every chart, by a word of so many letters.
  bool apart(const Place& a, const Place& b, std::size_t letters) const {
    constexpr double line = 0.055;  // of a chart's height
    const auto far = [&](std::size_t i, double room) { return std::abs(a[i] - b[i]) > room * (most_[i] - least_[i]); };
    const auto drawn = [&](std::size_t i) { return std::isfinite(a[i]) && std::isfinite(b[i]); };
    const double width = width_of(letters);
    return far(0, line) || ((far(1, width) || !drawn(1)) && (far(2, width) || !drawn(2)));
  }

  /// Writes the first of the texts that has room; on the left of a point that stands far right.
  void write(json& row, std::initializer_list<std::string> texts) {
    const Place at = place_of(row);
    auto& others = taken_[choice_of(row)];
    for (const auto& text : texts) {
      if (text.empty() || !std::all_of(others.begin(), others.end(), [&](const auto& other) {
            return apart(at, other.first, std::max(text.size(), other.second));
          }))
        continue;
      row["tag"] = text;
      row["tag_left"] = at[1] > most_[1] - width_of(text.size()) * (most_[1] - least_[1]);
      others.emplace_back(at, text.size());
      return;
    }
  }

 private:
  /// Of a word beside its point, as a share of a chart's width.
  static double width_of(std::size_t letters) { return 0.03 + 0.013 * static_cast<double>(letters); }

  Place least_ = filled(std::numeric_limits<double>::infinity()),
        most_ = filled(-std::numeric_limits<double>::infinity());
  std::map<std::string, std::vector<std::pair<Place, std::size_t>>> taken_;  ///< by what is shown at once

  static Place filled(double value) {
    Place place;
    place.fill(value);
    return place;
  }
};

}  // namespace

void tag_lines(json& rows, const std::string& text_field) {
  Words words;
  std::map<std::string, Ends> lines;
  for (auto& r : rows) {
    if (r.value("failed", false)) continue;
    words.span(place_of(r));
    auto& [first, last] = lines[r.value("line", "") + '\n' + choice_of(r)];
    if (!first || r["order"] < (*first)["order"]) first = &r;
    if (!last || r["order"] > (*last)["order"]) last = &r;
  }
  const auto moves = [&](const Ends& ends) {
    return ends.first != ends.last && words.apart(place_of(*ends.first), place_of(*ends.last), 3);
  };
  for (auto& [key, ends] : lines) {
    const std::string name = ends.last->value("series", ""), value = ends.last->value(text_field, "");
    words.write(*ends.last, {moves(ends) && !value.empty() ? name + ", " + value : name, moves(ends) ? value : ""});
  }
  for (auto& [key, ends] : lines)
    if (moves(ends)) words.write(*ends.first, {ends.first->value(text_field, "")});
}

}  // namespace stickslip::report
