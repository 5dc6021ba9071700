#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "studies/report/chart_parts.hpp"
#include "studies/report/labels.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// Pixels of a chart, from its lower left corner.
struct Place {
  double x, y;
};

struct Box {
  double left, right, low, high;
  bool overlaps(const Box& other) const {
    return left < other.right && other.left < right && low < other.high && other.low < high;
  }
  /// Whether a part of the line from a to b lies inside.
  bool is_crossed_by(const Place& a, const Place& b) const {
    double from = 0, to = 1;
    const auto cut = [&](double start, double way, double least, double most) {
      if (way == 0) return start > least && start < most;
      const auto [in, out] = std::minmax({(least - start) / way, (most - start) / way});
      from = std::max(from, in);
      to = std::min(to, out);
      return true;
    };
    return cut(a.x, b.x - a.x, left, right) && cut(a.y, b.y - a.y, low, high) && from < to;
  }
};

/// The names of sides are those of chart_parts.hpp.
struct Side {
  const char* name;
  bool left, below;
};
constexpr std::array<Side, 4> sides = {
    {{"right", false, false}, {"left", true, false}, {"right below", false, true}, {"left below", true, true}}};

/// Pixels of a chart's field.
struct Size {
  double width, height;
};
constexpr double of_two = 400, of_three = 290;  ///< wide is a chart beside others, at the narrowest
constexpr double of_phone = 260;                ///< on a screen of 360, the narrowest that names are placed for
constexpr Size on_paper{of_two, 220};           ///< page.js draws it so for print; those in files are larger
constexpr double padding = 18;                  ///< between the outermost points and the border
constexpr double font = 11, half_marker = 5, aside = 8;

/// The points of a line, in order.
using Line = std::vector<json*>;

/// A chart with its markers and curves, and words beside them that cover nothing.
class Chart {
 public:
  Chart(std::string across, Size size) : across_(std::move(across)), size_(size) {}

  /// To be called for all points before anything else: they span the axes.
  void span(const json& row) {
    const Place at = logarithms(row);
    least_ = {std::min(least_.x, at.x), std::min(least_.y, at.y)};
    most_ = {std::max(most_.x, at.x), std::max(most_.y, at.y)};
  }

  /// The axes show at least a decade.
  void begin() {
    for (double Place::*along : {&Place::x, &Place::y})
      if (const double lacks = 1 - (most_.*along - least_.*along); lacks > 0) {
        least_.*along -= lacks / 2;
        most_.*along += lacks / 2;
      }
  }

  void mark(const json& row) {
    const Place at = place_of(row);
    taken_.push_back({at.x - half_marker, at.x + half_marker, at.y - half_marker, at.y + half_marker});
    if (!row.value("zero", false)) return;
    const double words = 6 + width_of("exactly 0");  // they stand at one end of their line or at the other
    taken_.push_back({0, words, at.y, at.y + 4 + font});
    taken_.push_back({size_.width - words, size_.width, at.y, at.y + 4 + font});
  }

  void join(const Line& line) {
    for (std::size_t i = 1; i < line.size(); ++i) curves_.push_back({place_of(*line[i - 1]), place_of(*line[i])});
  }

  /// Whether two points lie apart by a short word.
  bool apart(const json& a, const json& b) const {
    const Place one = place_of(a), other = place_of(b);
    return std::abs(one.x - other.x) > width_of("1e-8") || std::abs(one.y - other.y) > font + 4;
  }

  /// Whether a text at that side of its point covers nothing, so many pixels around it included.
  bool has_room(const json& row, const std::string& text, const Side& side, double around) const {
    Box word = box_of(place_of(row), text, side);
    if (!(word.left > 0 && word.right < size_.width && word.low > 0 && word.high < size_.height)) return false;
    word = {word.left - around, word.right + around, word.low - around, word.high + around};
    return std::none_of(taken_.begin(), taken_.end(), [&](const Box& other) { return word.overlaps(other); }) &&
           std::none_of(curves_.begin(), curves_.end(),
                        [&](const auto& piece) { return word.is_crossed_by(piece[0], piece[1]); });
  }

  void take(const json& row, const std::string& text, const Side& side) {
    taken_.push_back(box_of(place_of(row), text, side));
  }

 private:
  Place logarithms(const json& row) const {
    return {std::log10(row[across_].get<double>()), std::log10(row["shown"].get<double>())};
  }
  Place place_of(const json& row) const {
    const Place at = logarithms(row);
    return {padding + (size_.width - 2 * padding) * (at.x - least_.x) / (most_.x - least_.x),
            padding + (size_.height - 2 * padding) * (at.y - least_.y) / (most_.y - least_.y)};
  }
  static double width_of(const std::string& text) {
    constexpr double of_wide_fonts = 1.15;  // over Helvetica
    return of_wide_fonts * text_width(text, font);
  }
  static Box box_of(const Place& at, const std::string& text, const Side& side) {
    const double from = side.left ? at.x - aside - width_of(text) : at.x + aside;
    const double low = side.below ? at.y - 6 - font : at.y + 5;
    return {from, from + width_of(text), low, low + font + 1};
  }
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  std::string across_;
  Size size_;
  Place least_{infinity, infinity}, most_{-infinity, -infinity};
  std::vector<Box> taken_;
  std::vector<std::array<Place, 2>> curves_;
};

/// The same chart in each of the sizes that it is shown in: words stand where they have room in all of them, and in the
/// rows' fields that begin with `field`.
class Views {
 public:
  Views(const std::string& across, std::string field, const std::vector<Size>& sizes) : field_(std::move(field)) {
    for (const Size& size : sizes) charts_.emplace_back(across, size);
  }

  /// The lines by their names; their points span the charts and are marked in them.
  std::map<std::string, Line> draw(const std::vector<json*>& rows) {
    std::map<std::string, Line> lines;
    for (json* row : rows)
      if (!row->value("failed", false)) lines[row->value("line", "")].push_back(row);
    for (auto& [key, line] : lines)
      std::stable_sort(line.begin(), line.end(),
                       [](const json* a, const json* b) { return (*a)["order"] < (*b)["order"]; });
    for (Chart& chart : charts_) {
      for (const json* row : rows) chart.span(*row);
      chart.begin();
      for (const json* row : rows) chart.mark(*row);
      for (const auto& [key, line] : lines) chart.join(line);
    }
    return lines;
  }

  bool apart(const json& a, const json& b) const { return charts_.front().apart(a, b); }
  bool names(const json& row) const { return row.contains(field_); }

  /// Writes the text beside its point, where it has room; where only the first chart has, for that one.
  bool write(json& row, const std::string& text) {
    if (text.empty()) return false;
    const auto somewhere = [&](const auto& write_at_side) {
      return std::any_of(sides.begin(), sides.end(), write_at_side);
    };
    if (somewhere([&](const Side& side) { return write_at(row, text, side, 0); })) return true;
    return somewhere([&](const Side& side) {
      if (!charts_.front().has_room(row, text, side, 0)) return false;
      charts_.front().take(row, text, side);
      tell(row, text, side);
      row[field_ + "_tall"] = true;
      return true;
    });
  }

  /// In all charts at one side, if so many pixels around the text are free too.
  bool write_at(json& row, const std::string& text, const Side& side, double around) {
    const auto has_room = [&](const Chart& chart) { return chart.has_room(row, text, side, around); };
    if (!std::all_of(charts_.begin(), charts_.end(), has_room)) return false;
    for (Chart& chart : charts_) chart.take(row, text, side);
    tell(row, text, side);
    return true;
  }

 private:
  void tell(json& row, const std::string& text, const Side& side) const {
    row[field_] = text;
    row[field_ + "_at"] = side.name;
  }

  std::string field_;
  std::vector<Chart> charts_;
};

/// Names a line at its end, else at its beginning, with the option's value where there is room; else at any point.
void name(const Line& line, const std::string& text_field, Views& chart) {
  const bool moves = chart.apart(*line.front(), *line.back());
  const std::string series = line.front()->value("series", "");
  for (json* end : {line.back(), line.front()})
    if (const std::string value = end->value(text_field, ""); moves && !value.empty())
      if (chart.write(*end, series + ", " + value)) return;
  if (chart.write(*line.back(), series)) return;
  for (json* row : line)
    if (chart.write(*row, series)) return;
}

/// Says the option's value at the ends of a line that has its name at one of them.
void say_values(const Line& line, const std::string& text_field, Views& chart) {
  if (!chart.apart(*line.front(), *line.back())) return;
  const bool named = std::any_of(line.begin(), line.end(), [&](const json* row) { return chart.names(*row); });
  for (json* end : {line.back(), line.front()})
    if (named && !chart.names(*end)) chart.write(*end, end->value(text_field, ""));
}

/// The rows that a chart against the field `across` shows at once, of each choice; words of before are taken away.
std::vector<std::vector<json*>> charts_of(json& rows, const std::string& across) {
  std::map<std::array<std::string, 4>, std::vector<json*>> shown;
  for (auto& row : rows) {
    for (const char* part : {"", "_at", "_tall", "_narrow", "_narrow_at"}) row.erase(tag_field(across) + part);
    if (row[across] > 0 && row["shown"].is_number())
      shown[{row.value("panel", ""), row.value("quantity", ""), row.value("scene", ""), row.value("curve", "")}]
          .push_back(&row);
  }
  std::vector<std::vector<json*>> out;
  for (auto& [choice, chart] : shown) out.push_back(std::move(chart));
  return out;
}

/// Names a line beside any of its points, so many pixels apart from all else, if it can.
bool name_apart(const std::string& name, const Line& line, double around, Views& chart) {
  for (const Side& side : sides)
    for (auto row = line.rbegin(); row != line.rend(); ++row)
      if (chart.write_at(**row, name, side, around)) return true;
  return false;
}

/// Names a line beside any of its points, well apart from all else, if it can.
void name_anywhere(const std::string& name, const Line& line, Views& chart) {
  if (!name_apart(name, line, 4, chart)) name_apart(name, line, 0, chart);
}

/// Names the lines of a chart on a narrow screen, where there is no room for values: by what a line has beside its
/// method's name, which the legend says, where there is no room for both.
void name_on_phone(const std::vector<json*>& shown, const std::string& across, double height) {
  constexpr double well_apart = 12, apart = 4;
  Views chart(across, tag_field(across) + "_narrow", {{of_phone, height}});
  for (const auto& [key, line] : chart.draw(shown)) {
    const std::string series = line.front()->value("series", ""),
                      brief = beside_method(series, line.front()->value("family", ""));
    for (const auto& [name, around] :
         {std::pair(series, well_apart), {brief, apart}, {series, apart}, {brief, 0.0}, {series, 0.0}})
      if (name_apart(name, line, around, chart)) break;
  }
}

}  // namespace

std::string tag_field(const std::string& across) { return "tag_" + across; }

void tag_lines(json& rows, const std::string& across, double height, const std::string& text_field) {
  const Size on_screen{of_two, height};
  for (const auto& shown : charts_of(rows, across)) {
    Views chart(across, tag_field(across), {on_screen, {on_paper.width, std::min(on_paper.height, height)}});
    const auto lines = chart.draw(shown);
    for (const auto& [key, line] : lines) name(line, text_field, chart);
    for (const auto& [key, line] : lines) say_values(line, text_field, chart);
    name_on_phone(shown, across, height);
  }
}

void name_lines(json& rows, const std::string& across) {
  for (const auto& shown : charts_of(rows, across)) {
    Views chart(across, tag_field(across), {{of_three, chart_height}, on_paper});
    for (const auto& [key, line] : chart.draw(shown)) name_anywhere(key, line, chart);
    Views narrow(across, tag_field(across) + "_narrow", {{of_phone, chart_height}});
    for (const auto& [key, line] : narrow.draw(shown)) name_anywhere(key, line, narrow);
  }
}

}  // namespace stickslip::report
