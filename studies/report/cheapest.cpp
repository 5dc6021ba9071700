#include "studies/report/cheapest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <sstream>

#include "studies/io/wording.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {
namespace {

constexpr double much_faster = 1.25;  ///< seconds of runs this short vary by some 20 %

/// The options that tell a run from others of its row; "default" where there are none.
std::string setting_of(const Cell& cell, const std::string& row) {
  std::string out;
  std::istringstream words(series_of(cell, "")), common(row);
  const std::set<std::string> known{std::istream_iterator<std::string>(common), {}};
  for (std::string word; words >> word;)
    if (known.count(word) == 0) out += (out.empty() ? "" : " ") + word;
  return out.empty() ? "default" : out;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}

/// "scale=1, 10 or 100" of "scale=1", "scale=10" and "scale=100": of settings that differ in one option, what the first
/// says is not said again. Of more than three the first two, and how many others there are.
std::string alternatives(const std::vector<std::string>& settings) {
  constexpr std::size_t most = 3;
  const std::size_t told = settings.size() > most ? most - 1 : settings.size();
  const auto first = words_of(settings.front());
  const auto value = [&](const std::string& setting) {  // "" where more than the value of the last option differs
    const auto words = words_of(setting);
    const std::string option = first.back().substr(0, first.back().find('=') + 1);
    const bool alike = !option.empty() && words.size() == first.size() && words.back().starts_with(option) &&
                       std::equal(words.begin(), words.end() - 1, first.begin());
    return alike ? words.back().substr(option.size()) : "";
  };
  const bool alike =
      std::none_of(settings.begin(), settings.end(), [&](auto& setting) { return value(setting).empty(); });
  std::string out = settings.front();
  for (std::size_t i = 1; i < told; ++i)
    out += (i + 1 < settings.size() ? ", " : " or ") + (alike ? value(settings[i]) : settings[i]);
  return told < settings.size() ? out + " or " + counted(static_cast<long>(settings.size() - told), "other") : out;
}

/// "stiffness 1 to 100" of the numbers that an option has in the runs; "" of fewer than two.
std::string range_of(const std::vector<const Cell*>& runs, const std::string& option) {
  std::set<double> values;
  for (const Cell* run : runs)
    if (const Knob* knob = find_knob(*run, option); knob && knob->value) values.insert(*knob->value);
  return values.size() < 2 ? ""
                           : option + " " + exact_number(*values.begin()) + " to " + exact_number(*values.rbegin());
}

/// The run of a row that reaches an accuracy with least work; of equals the default setting, else the first.
Pick cheapest(const Row& row, const Measure& measure, double level) {
  Pick best;
  best.row = row.name;
  for (const Cell* cell : row.runs) {
    const auto error = measure.error(*cell);
    if (!error || *error > level) continue;
    const double work = measure.work(*cell), least = best.run ? measure.work(*best.run) : INFINITY;
    if (work * same < least) {
      best = {cell, {}, row.name};
    } else if (work <= least * same) {
      best.equals.push_back(cell);
      if (at(cell->record, "default") == true) std::swap(best.run, best.equals.back());
    }
  }
  return best;
}

}  // namespace

std::string Level::title() const { return percent(error); }

std::string Measure::noun() const { return of == Of::responses ? "response" : "derivative"; }

std::optional<double> Measure::error(const Cell& cell) const {
  if (!cell.converged) return std::nullopt;
  const std::string prefix = of == Of::responses ? "response:" : "sensitivity:";
  return worst(on_same_mesh ? cell.enforcement : cell.discretization, prefix);
}

double Measure::work(const Cell& cell) const { return work_of(cell, of); }

double Measure::weight(const Cell& cell) const { return ratio_of(ratio, cell); }

double Measure::median(const Cell& cell) const {
  return of == Of::responses ? cell.median_seconds : cell.median_sensitivity_seconds;
}

double Measure::seconds(const Cell& cell) const {
  return of == Of::responses ? cell.seconds : cell.sensitivity_seconds;
}

std::optional<Measure> measure_of(const Study& study, Of of) {
  Measure measure{.of = of, .ratio = study.ratio};
  const auto runs = main_cells(study);
  const auto has_errors = [&] {
    return std::any_of(runs.begin(), runs.end(), [&](auto* c) { return measure.error(*c); });
  };
  if (!has_errors()) measure.on_same_mesh = false;
  if (!has_errors()) return std::nullopt;
  std::vector<double> asked;
  for (const auto& error : array_at(study.description, "accuracy"))
    if (error.is_number()) asked.push_back(error.get<double>());
  if (asked.empty()) asked = {1e-2, 1e-4, 1e-6};
  std::sort(asked.rbegin(), asked.rend());
  for (const double error : asked) measure.levels.push_back({error});
  const double digits = discretization_reference(study) == "the given values" ? digits_of_given_values : rounding_error;
  if (const auto own = own_error(study, of); measure.on_same_mesh && own && *own > digits)
    measure.levels.push_back({*own, fmt::format("own error of {}: ", fmt::join(what_else_errs(study), ", "))});
  return measure;
}

std::pair<std::vector<Row>, std::string> rows_of(const Study& study) {
  constexpr std::size_t most = 8;  // that a first screen has room for
  std::vector<Row> by_method, by_series;
  for (const auto& family : study.families) by_method.push_back({family_name(family), {}});
  const std::string knob = study.families.size() == 1 ? running_knob(study, study.families.front()) : "";
  for (const Cell* cell : main_cells(study)) {
    const auto method = std::find(study.families.begin(), study.families.end(), cell->family) - study.families.begin();
    by_method[static_cast<std::size_t>(method)].runs.push_back(cell);
    const std::string series = series_of(*cell, knob);
    const auto known = std::find_if(by_series.begin(), by_series.end(), [&](auto& row) { return row.name == series; });
    (known == by_series.end() ? by_series.emplace_back(Row{series, {}, beside_method(series, cell->family)}) : *known)
        .runs.push_back(cell);
  }
  const bool apart = !knob.empty() && by_series.size() >= 2 && by_series.size() <= most;
  auto& rows = apart ? by_series : by_method;
  for (auto& row : rows)
    if (!row.runs.empty()) row.swept = range_of(row.runs, running_knob(study, row.runs.front()->family));
  return {rows, apart ? family_name(study.families.front()) : "method"};
}

std::optional<double> nearest_of(const Row& row, const Measure& measure) {
  std::optional<double> nearest;
  for (const Cell* cell : row.runs)
    if (const auto error = measure.error(*cell)) nearest = std::min(nearest.value_or(*error), *error);
  return nearest;
}

std::string Pick::setting() const {
  std::vector<std::string> settings = {setting_of(*run, row)};
  for (const Cell* equal : equals) settings.push_back(setting_of(*equal, row));
  return alternatives(settings);
}

std::string Pick::name() const { return row + (setting() == "default" ? "" : " (" + setting() + ")"); }

Column column_of(const std::vector<Row>& rows, const Measure& measure, double level) {
  Column column;
  for (const auto& row : rows) {
    const Pick choice = cheapest(row, measure, level);
    column.runs.push_back(choice);
    const Cell* run = choice.run;
    if (!run) continue;
    if (!column.least || measure.work(*run) < measure.work(*column.least)) column.least = run;
    if (measure.seconds(*run) > 0 && (!column.fastest || measure.seconds(*run) < measure.seconds(*column.fastest)))
      column.fastest = run;
  }
  return column;
}

bool is_least(const Column& column, const Measure& measure, const Cell& cell) {
  return measure.work(cell) <= much_the_same * measure.work(*column.least);
}

bool is_fastest(const Column& column, const Measure& measure, const Cell& cell) {
  if (!column.fastest || measure.seconds(cell) == 0) return false;
  const double fast = much_faster * measure.seconds(*column.fastest);
  return measure.seconds(cell) <= fast && std::any_of(column.runs.begin(), column.runs.end(), [&](const Pick& other) {
           return other.run && is_least(column, measure, *other.run) && measure.seconds(*other.run) > fast;
         });
}

}  // namespace stickslip::report
