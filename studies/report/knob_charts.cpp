#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "studies/report/chart_parts.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// A row per cell and value for each that has one of `knobs`; for families that have none, their best cell as a level
/// line over the whole range. `add` is called with the row to complete and its cell.
template <class Add>
void rows_along(const Study& study, const std::vector<std::string>& knobs, SeriesList& series, Add add) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  std::set<std::string> with_knob;
  for (const auto& cell : study.cells)
    for (const auto& name : knobs)
      if (const Knob* knob = find_knob(cell, name); knob && knob->value && *knob->value > 0) {
        low = std::min(low, *knob->value);
        high = std::max(high, *knob->value);
        with_knob.insert(cell.family);
      }
  for (const auto& cell : study.cells) {
    const Knob* knob = nullptr;
    std::string name;
    for (const auto& candidate : knobs)
      if (const Knob* found = find_knob(cell, candidate); found && found->value && *found->value > 0) {
        knob = found;
        name = candidate;
      }
    json r = row_of(cell);
    r["scene"] = cell.variant;
    if (knob) {
      r["series"] = series_of(cell, name);
      r["line"] = r["series"];
      r["option_value"] = r["order"] = *knob->value;
      r["option"] = name;
      series.add(r["series"], cell.family);
      add(r, cell);
    } else if (with_knob.count(cell.family) == 0 && &cell == best_cell(study, cell.family)) {
      r["series"] = r["line"] = family_name(cell.family) + " (best run, without this option)";
      r["unmarked"] = true;
      series.add(r["series"], cell.family);
      for (const double x : {low, high}) {
        r["option_value"] = r["order"] = x;
        add(r, cell);
      }
    }
  }
}

/// A grey line of slope -1 through the middle of the penalty's falling branch: the rate theory gives.
void add_guides(json& rows) {
  std::map<std::tuple<std::string, std::string, std::string, std::string>, std::vector<std::pair<double, double>>> runs;
  for (const auto& r : rows)
    if (r["family"] == "penalty" && r.value("option", "") == "stiffness" && !r["failed"].get<bool>() &&
        r["error"].get<double>() > 0)
      runs[{r["panel"], r["quantity"], r["scene"], r["series"]}].emplace_back(r["option_value"], r["error"]);
  for (auto& [key, points] : runs) {
    std::sort(points.begin(), points.end());
    const auto least = std::min_element(points.begin(), points.end(),
                                        [](const auto& a, const auto& b) { return a.second < b.second; });
    if (least - points.begin() < 2) continue;
    // Below all points of the stiffer half, whether they follow it or not: its words stand below its end.
    double product = least->first * least->second;
    for (auto p = points.begin() + (least - points.begin()) / 2; p != least; ++p)
      product = std::min(product, p->first * p->second);
    // (of the least doubles it has no end that is a number)
    if (!std::isnormal(product / points.front().first / 3) || !std::isnormal(product / least->first / 3)) continue;
    for (const auto& end : {points.front(), *least}) {
      json r = {{"panel", std::get<0>(key)}, {"quantity", std::get<1>(key)}, {"scene", std::get<2>(key)}};
      r["family"] = "penalty";
      r["guide"] = true;
      r["failed"] = false;
      r["line"] = "guide " + std::get<3>(key);
      r["option_value"] = r["order"] = end.first;
      // Set off by a factor of 3, so that a curve that follows it is not hidden.
      r["error"] = product / end.first / 3;
      r["guide_tag"] = end.first == least->first ? "slope -1" : "";
      rows.push_back(r);
    }
  }
}

/// The rows of a panel over the option's value; a point says its `told`.
Chart panel_over_knob(const std::string& panel, const std::vector<std::string>& knobs, const char* field,
                      const std::string& title, const char* told) {
  return {.title = panel,
          .x = {"option_value", knob_title(knobs), Spacing::logarithmic},
          .y = {field, title, Spacing::logarithmic},
          .tooltip = {{"label", "method"}, {"option_value", "value of the option"}, {told, told}, {"status", "status"}},
          .only = panel};
}

}  // namespace

std::vector<std::vector<std::string>> knob_groups(const Study& study) {
  std::vector<std::vector<std::string>> groups;
  std::vector<std::string> regularisation;
  for (const auto& name : knob_names(study)) {
    if (name == "stiffness" || name == "scale")
      regularisation.push_back(name);
    else
      groups.push_back({name});
  }
  if (!regularisation.empty()) groups.insert(groups.begin(), regularisation);
  return groups;
}

std::optional<Figure> error_against_knob(const Study& study, const std::vector<std::string>& knobs) {
  Figure figure;
  SeriesList series(study);
  figure.id = slug("error-" + knobs.front());
  figure.title = "Error against " + knob_title(knobs);
  rows_along(study, knobs, series, [&](json r, const Cell& cell) {
    for (const auto& [panel, prefix, worst_name] : {std::tuple{"responses", "response:", "worst response"},
                                                    std::tuple{"sensitivities", "sensitivity:", "worst sensitivity"}})
      for (const auto& [quantity, error] : quantities(cell.enforcement, {prefix}, worst_name)) {
        r["panel"] = panel;
        r["quantity"] = quantity;
        r["error"] = error;
        figure.rows.push_back(r);
      }
  });
  if (figure.rows.empty()) return std::nullopt;
  add_guides(figure.rows);
  show_zeros(figure.rows, "error");
  figure.series = series.list;
  const bool penalty = std::find(knobs.begin(), knobs.end(), "stiffness") != knobs.end();
  figure.text = "Enforcement error (same mesh) as the option is turned. ";
  figure.text += penalty
                     ? "Penalty lets bodies penetrate" + std::string(is_frictionless(study) ? "" : " and creep") +
                           " by an amount that is proportional to 1/stiffness where it is small: the dotted line of "
                           "slope -1. Rounding, which grows with the stiffness, may lift the error again. "
                           "An augmented Lagrangian converges to the same answer with any scale. Its error comes from "
                           "rounding and from its tolerance; the latter may change with the scale. "
                     : "";
  if (std::any_of(figure.rows.begin(), figure.rows.end(), [](const json& r) { return r.value("unmarked", false); }))
    figure.text += "A level line is the best run of a method without the option. ";
  figure.text += "Crosses are runs that did not converge.";
  for (const std::string panel : {"responses", "sensitivities"}) {
    if (distinct(figure.rows, "quantity", panel).empty()) continue;
    const bool derivative = panel == "sensitivities";
    const bool noise = !tells_apart(study, derivative ? Of::sensitivities : Of::responses) &&
                       tells_apart(study, derivative ? Of::responses : Of::sensitivities);
    const char* const error = derivative ? "relative error of the sensitivity" : "relative error of the response";
    figure.charts.push_back(panel_over_knob(panel, knobs, "shown", error, "error"));
    figure.charts.back().folded = noise;
    offer(figure, derivative ? "Sensitivity" : "Response", "quantity", "", panel);
  }
  offer(figure, "Scene", "scene", study.main_variant);
  return figure;
}

/// Panels of iterations_against_knob, each with the count it shows.
const std::pair<std::string, std::string> counted_along_knobs[] = {
    {"Newton iterations", "newton"},
    {"augmentations", "augmentations"},
    {"back-solves for derivatives", "sensitivity_backsolves"}};

std::optional<Figure> iterations_against_knob(const Study& study, const std::vector<std::string>& knobs) {
  Figure figure;
  SeriesList series(study);
  figure.id = slug("iterations-" + knobs.front());
  figure.title = "Iterations against " + knob_title(knobs);
  figure.folded = "totals of the whole run";
  figure.text = "Totals of the whole run. Crosses are runs that did not converge, at what they had spent by then.";
  rows_along(study, knobs, series, [&](json r, const Cell& cell) {
    for (const auto& [panel, count] : counted_along_knobs)
      if (cell.count(count) > 0) {
        r["panel"] = panel;
        r["count"] = cell.count(count);
        figure.rows.push_back(r);
      }
  });
  if (figure.rows.empty()) return std::nullopt;
  figure.series = series.list;
  for (const auto& [panel, unused] : counted_along_knobs) {
    const auto along_the_knob = [&panel = panel](const json& r) {
      return r["panel"] == panel && !r.value("unmarked", false);
    };
    if (std::none_of(figure.rows.begin(), figure.rows.end(), along_the_knob)) continue;
    figure.charts.push_back(panel_over_knob(panel, knobs, "count", panel, "count"));
  }
  if (figure.charts.empty()) return std::nullopt;
  offer(figure, "Scene", "scene", study.main_variant);
  return figure;
}

}  // namespace stickslip::report
