#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

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

/// What is shown at once, as a key.
std::string choice_of(const json& row) { return row.value("quantity", "") + '\n' + row.value("scene", ""); }

/// A stretch across a chart, as shares of its width.
struct Span {
  double from, to;
  bool overlaps(const Span& other) const { return from < other.to && other.from < to; }
};

enum class Side { right, left };

/// Words beside the points of the charts that are shown at once, and which of them fit.
class Words {
 public:
  void add(const json& row) {
    const Place at = place_of(row);
    for (std::size_t i = 0; i < at.size(); ++i)
      if (std::isfinite(at[i])) {
        least_[i] = std::min(least_[i], at[i]);
        most_[i] = std::max(most_[i], at[i]);
      }
    if (row.value("zero", false)) ground_ = at[0];
  }

  /// To be called when all points are known: the axes show at least a decade, and "exactly 0" stands at the left.
  void begin() {
    for (std::size_t i = 0; i < least_.size(); ++i)
      if (const double lacks = 1 - (most_[i] - least_[i]); lacks > 0) {
        least_[i] -= lacks / 2;
        most_[i] += lacks / 2;
      }
    const Span words = {-margin, -margin + width_of(9)};
    if (std::isfinite(ground_)) taken_.push_back({(ground_ - least_[0]) / (most_[0] - least_[0]), {words, words}});
  }

  /// Whether two points lie apart, in every chart, by a short word.
  bool apart(const json& a, const json& b) const {
    const Place one = shares_of(a), other = shares_of(b);
    const auto far = [&](std::size_t i, double room) {
      return !std::isfinite(one[i]) || !std::isfinite(other[i]) || std::abs(one[i] - other[i]) > room;
    };
    return far(0, line) || (far(1, width_of(3)) && far(2, width_of(3)));
  }

  /// Writes the text on one side of its point, where it has room in every chart.
  bool write(json& row, const std::string& text) {
    if (text.empty()) return false;
    return write(row, text, Side::right) || write(row, text, Side::left);
  }

 private:
  struct Word {
    double height;
    std::array<Span, 2> across;  ///< in the charts against work and against seconds
  };
  static constexpr double line = 0.08;    ///< of the height of the lowest chart
  static constexpr double margin = 0.04;  ///< beside the outermost points

  /// As a share of a chart's width.
  static double width_of(std::size_t letters) { return 0.03 + 0.013 * static_cast<double>(letters); }

  Place shares_of(const json& row) const {
    Place at = place_of(row);
    for (std::size_t i = 0; i < at.size(); ++i) at[i] = (at[i] - least_[i]) / (most_[i] - least_[i]);
    return at;
  }

  bool write(json& row, const std::string& text, Side side) {
    const Place at = shares_of(row);
    Word word{at[0], {}};
    for (std::size_t i = 0; i < word.across.size(); ++i) {
      const double x = at[i + 1], width = width_of(text.size());
      if (!std::isfinite(x)) continue;  // not drawn, and an empty span is in nobody's way
      word.across[i] = side == Side::right ? Span{x, x + width} : Span{x - width, x};
      if (word.across[i].from < -margin || word.across[i].to > 1 + margin) return false;
    }
    const bool covered = std::any_of(taken_.begin(), taken_.end(), [&](const Word& other) {
      return std::abs(word.height - other.height) < line &&
             (word.across[0].overlaps(other.across[0]) || word.across[1].overlaps(other.across[1]));
    });
    if (covered) return false;
    row["tag"] = text;
    row["tag_left"] = side == Side::left;
    taken_.push_back(word);
    return true;
  }

  Place least_ = filled(std::numeric_limits<double>::infinity()),
        most_ = filled(-std::numeric_limits<double>::infinity());
  double ground_ = std::numeric_limits<double>::quiet_NaN();  ///< height of the exact zeros
  std::vector<Word> taken_;

  static Place filled(double value) {
    Place place;
    place.fill(value);
    return place;
  }
};

/// The points of a line, in order.
using Line = std::vector<json*>;

/// Names a line at its end, else at its beginning, else in its middle; with the option's value where there is room.
void name(const Line& line, bool moves, const std::string& text_field, Words& words) {
  json &first = *line.front(), &last = *line.back(), &middle = *line[line.size() / 2];
  const auto named = [&](const json& row, bool with_value) {
    const std::string series = row.value("series", ""), value = row.value(text_field, "");
    return with_value && moves && !value.empty() ? series + ", " + value : series;
  };
  words.write(last, named(last, true)) || words.write(first, named(first, true)) ||
      words.write(last, named(last, false)) || words.write(first, named(first, false)) ||
      words.write(middle, named(middle, false));
}

}  // namespace

void tag_lines(json& rows, const std::string& text_field) {
  std::map<std::string, Words> charts;
  std::map<std::string, std::map<std::string, Line>> lines;  // by what is shown at once
  for (auto& row : rows) {
    if (row.value("failed", false)) continue;
    charts[choice_of(row)].add(row);
    lines[choice_of(row)][row.value("line", "")].push_back(&row);
  }
  for (auto& [choice, words] : charts) {
    words.begin();
    for (auto& [key, line] : lines[choice]) {
      std::stable_sort(line.begin(), line.end(),
                       [](const json* a, const json* b) { return (*a)["order"] < (*b)["order"]; });
      name(line, words.apart(*line.front(), *line.back()), text_field, words);
    }
    for (auto& [key, line] : lines[choice])
      if (words.apart(*line.front(), *line.back()))
        for (json* end : {line.back(), line.front()})
          if (!end->contains("tag")) words.write(*end, end->value(text_field, ""));
  }
}

}  // namespace stickslip::report
