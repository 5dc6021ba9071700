#include "studies/report/differentiability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

constexpr double no_way = std::numeric_limits<double>::infinity();

/// A distance as result.json has it: null is none.
double way_of(const json& value) { return value.is_number() ? value.get<double>() : no_way; }

/// The nearest of both sides.
double nearest_way(const json& sides) {
  return sides.is_array() && sides.size() == 2 ? std::min(way_of(sides[0]), way_of(sides[1])) : no_way;
}

/// Distances up to a share of the parameter's value, the nearest darkest, so that grey print tells them apart.
struct ChangeShade {
  double most;
  const char *words, *fill;
};
constexpr std::array<ChangeShade, 6> change_shades = {{{0, "at a change", "#111111"},
                                                       {1e-3, "within 0.1 %", "#8c2d04"},
                                                       {1e-2, "1 %", "#d94801"},
                                                       {1e-1, "10 %", "#fd8d3c"},
                                                       {1, "100 %", "#fdd0a2"},
                                                       {no_way, "farther, or none", "#ffffff"}}};
constexpr ChangeShade of_no_size = {0, "parameter is 0: no share", "#b9bdc4"};

const ChangeShade& shade_of(double way, double value) {
  if (value == 0 && way > 0 && way < no_way) return of_no_size;
  const double share = value == 0 ? way : way / std::abs(value);
  constexpr double rounded = 1 + 1e-9;  // a share that is a bound but for rounding has its shade
  return *std::find_if(change_shades.begin(), change_shades.end(),
                       [&](const ChangeShade& shade) { return share <= rounded * shade.most; });
}

/// Some steps side by side as one, by the nearest of their changes.
struct MapColumn {
  double from, to;  ///< times
  bool differentiable = true;
  std::vector<double> ways;  ///< per parameter
};

std::vector<MapColumn> map_columns(const json& steps, const std::vector<std::string>& parameters) {
  constexpr std::size_t most = 100;
  const std::size_t together = std::max<std::size_t>((steps.size() + most - 1) / most, 1);
  std::vector<MapColumn> columns;
  for (std::size_t n = 0; n < steps.size(); ++n) {
    if (!steps[n].contains("nearest_change")) continue;
    const double time = number_at(steps[n], "time");
    if (columns.empty() || n % together == 0)
      columns.push_back({time, time, true, std::vector<double>(parameters.size(), no_way)});
    MapColumn& column = columns.back();
    column.to = time;
    column.differentiable &= at(steps[n], "differentiable") == true;
    for (std::size_t j = 0; j < parameters.size(); ++j)
      column.ways[j] = std::min(column.ways[j], nearest_way(at(at(steps[n], "nearest_change"), parameters[j])));
  }
  return columns;
}

std::string times_of(const MapColumn& column) {
  return column.from == column.to ? number(column.to, 6) : number(column.from, 6) + " to " + number(column.to, 6);
}

/// Pixels of the map.
struct MapLayout {
  static constexpr double row = 20, top = 8, width = 692, aside = 8;
};

/// The map's rows: what is differentiable, then each parameter.
void draw_map(const std::vector<MapColumn>& columns, const std::vector<std::string>& parameters, const json& values,
              double left, Drawing& drawing) {
  const double width = (MapLayout::width - left) / static_cast<double>(columns.size());
  const auto cell = [&](std::size_t row, std::size_t n, const char* fill, const std::string& words) {
    drawing.path(
        Path().rectangle(left + width * static_cast<double>(n),
                         MapLayout::top + MapLayout::row * static_cast<double>(row), width, MapLayout::row - 3),
        {"line", fill, 0.6, {}}, words);
  };
  for (std::size_t n = 0; n < columns.size(); ++n) {
    const MapColumn& column = columns[n];
    cell(0, n, column.differentiable ? "#ffffff" : change_shades[0].fill,
         fmt::format("t = {}: {}", times_of(column), column.differentiable ? "one derivative" : "two sides"));
    for (std::size_t j = 0; j < parameters.size(); ++j) {
      const double way = column.ways[j];
      cell(j + 1, n, shade_of(way, number_at(values, parameters[j])).fill,
           fmt::format("{} at t = {}: {}", parameters[j], times_of(column),
                       way < no_way ? number(way) + " to the nearest change" : "no change in reach"));
    }
  }
  const auto label = [&](std::size_t row, const std::string& text) {
    drawing.text(left - MapLayout::aside, MapLayout::top + MapLayout::row * static_cast<double>(row) + 13, text,
                 {Anchor::end, 12});
  };
  label(0, "two sides");
  for (std::size_t j = 0; j < parameters.size(); ++j) label(j + 1, parameters[j]);
  const double bottom = MapLayout::top + MapLayout::row * static_cast<double>(parameters.size() + 1);
  drawing.text(left, bottom + 12, "t = " + number(columns.front().from, 6), {Anchor::start, 10, "soft"});
  drawing.text(MapLayout::width, bottom + 12, number(columns.back().to, 6), {Anchor::end, 10, "soft"});
}

void draw_shades(const std::vector<MapColumn>& columns, const std::vector<std::string>& parameters, const json& values,
                 double left, double y, Drawing& drawing) {
  constexpr double of_wide_fonts = 1.15;  // over Helvetica
  std::vector<ChangeShade> shown(change_shades.begin(), change_shades.end());
  for (const auto& column : columns)
    for (std::size_t j = 0; j < parameters.size() && shown.size() == change_shades.size(); ++j)
      if (&shade_of(column.ways[j], number_at(values, parameters[j])) == &of_no_size) shown.push_back(of_no_size);
  double x = left;
  for (const auto& shade : shown) {
    if (&shade == &shown.back() && shown.size() > change_shades.size()) {  // (one line has no room for it)
      x = left;
      y += 18;
    }
    drawing.path(Path().rectangle(x, y, 16, 12), {"ink", shade.fill, 1, {}});
    drawing.text(x + 20, y + 10, shade.words, {Anchor::start, 11});
    x += 20 + of_wide_fonts * text_width(shade.words, 11) + 12;
  }
}

std::vector<std::string> parameters_of(const json& record) {
  std::vector<std::string> names;
  for (const auto& [name, unused] : object_at(record, "parameters").items()) names.push_back(name);
  return names;
}

/// By what a parameter may change: "-0.03 or +0.2".
std::string ways_in_words(const json& sides) {
  if (!sides.is_array() || sides.size() != 2) return "";
  if (way_of(sides[0]) == 0 && way_of(sides[1]) == 0) return "0, at a change";
  std::string out;
  for (const auto& [way, sign] : {std::pair(way_of(sides[0]), "-"), std::pair(way_of(sides[1]), "+")})
    if (way < no_way) out += (out.empty() ? "" : " or ") + (sign + number(way));
  return out.empty() ? "any amount" : out;
}

}  // namespace

std::optional<Plate> map_of_changes(const Study& run) {
  const json& record = run.cells.front().record;
  auto parameters = parameters_of(record);
  constexpr std::size_t most = 40;  // rows that a reader takes in
  const std::size_t all = parameters.size();
  parameters.resize(std::min(all, most));
  const auto columns = map_columns(array_at(record, "steps"), parameters);
  if (columns.empty()) return std::nullopt;
  double left = text_width("two sides", 12);
  for (const auto& name : parameters) left = std::max(left, text_width(name, 12));
  left += 2 * MapLayout::aside;
  const std::string title = "How far the nearest change of a branch is";
  std::string text =
      "Steps to the right, parameters downwards: by what share of its value a parameter may change before some point "
      "opens, closes, slips, sticks, yields or passes to another facet, to first order. At a step with \"two sides\" "
      "the derivatives from below and from above differ.";
  if (all > most) text += fmt::format(" The first {} of {} parameters.", most, all);
  const double bottom = MapLayout::top + MapLayout::row * static_cast<double>(parameters.size() + 1) + 24;
  Plate plate{"nearest-change", title, text, Drawing(MapLayout::width, bottom + 38, title, text), {}};
  const json& values = object_at(record, "parameters");
  draw_map(columns, parameters, values, left, plate.drawing);
  draw_shades(columns, parameters, values, left, bottom, plate.drawing);
  for (const auto& step : array_at(record, "steps"))
    for (const auto& [parameter, sides] : object_at(step, "nearest_change").items())
      plate.rows.push_back({{"time", at(step, "time")},
                            {"parameter", parameter},
                            {"value", at(values, parameter)},
                            {"below", sides.is_array() && sides.size() == 2 ? sides[0] : json()},
                            {"above", sides.is_array() && sides.size() == 2 ? sides[1] : json()},
                            {"differentiable", at(step, "differentiable")}});
  return plate;
}

std::string table_of_margins(const Study& run) {
  const json& record = run.cells.front().record;
  const json& steps = array_at(record, "steps");
  const auto parameters = parameters_of(record);
  if (parameters.empty()) return "";
  Table table;
  table.header = {"time", "derivatives have", "open", "slip", "yield", "vertex"};
  constexpr std::size_t most_apart = 20;  // columns that a table has room for
  const std::size_t shown = std::min(parameters.size(), most_apart);
  for (std::size_t j = 0; j < shown; ++j) table.header.push_back(parameters[j] + " may change by");
  constexpr std::size_t most = 1000;
  const std::size_t stride = std::max<std::size_t>((steps.size() + most - 1) / most, 1);
  for (std::size_t n = 0; n < steps.size(); ++n) {
    const json& step = steps[n];
    if ((steps.size() - 1 - n) % stride != 0 || !step.contains("differentiable")) continue;
    const bool one = at(step, "differentiable") == true;
    std::vector<std::string> row = {number(number_at(step, "time"), 6), one ? "one value" : "two sides"};
    for (const char* margin : {"open", "slip", "yield", "vertex"})
      row.push_back(plain(at(at(step, "margins"), margin)));
    for (std::size_t j = 0; j < shown; ++j) row.push_back(ways_in_words(at(at(step, "nearest_change"), parameters[j])));
    table.rows.push_back(row);
    table.row_classes.emplace_back(one ? "" : "failed");
  }
  if (table.rows.empty()) return "";
  return compact_html(
      table,
      "Margins of every step, dimensionless, and by what each parameter may change, in its units, before "
      "a point changes its branch");
}

}  // namespace stickslip::report
