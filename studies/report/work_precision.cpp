#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/report/chart_parts.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/html.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

const std::map<std::string, double>& errors_of(const Cell& cell, Against against) {
  if (against == Against::same_mesh) return cell.enforcement;
  return against == Against::discretization ? cell.discretization : cell.kkt;
}

/// Where all runs err by rounding alone: by how much at most, in words; else "".
std::string within_rounding(const Study& study, Of of) {
  if (tells_apart(study, of)) return "";
  double most = 0;
  long runs = 0;
  for (const auto& cell : study.cells)
    if (const auto error = accuracy(cell, of); error && cell.converged && cell.variant == study.main_variant) {
      most = std::max(most, *error);
      ++runs;
    }
  return runs < 3 ? ""
                  : fmt::format("all {} runs are within {} of the reference, which is rounding", runs, number(most, 2));
}

/// Where most runs are exact, are off by the same, or by what they enforce contact with alone, that says it all.
std::string why_it_may_be_folded(const Study& study, Against against, Of of) {
  if (against == Against::same_mesh) return within_rounding(study, of);
  const std::string prefix = of == Of::sensitivities ? "sensitivity:" : "response:";
  std::vector<double> errors;
  std::ptrdiff_t exact = 0, of_method = 0;
  for (const auto& cell : study.cells) {
    const auto error = worst(cell.discretization, prefix), own = worst(cell.enforcement, prefix);
    if (!error || !cell.converged || cell.variant != study.main_variant) continue;
    constexpr double alike = 5;
    errors.push_back(*error);
    exact += *error <= rounding_error;
    of_method += *error > rounding_error && own && *error <= alike * *own && *own <= alike * *error;
  }
  if (errors.size() < 3) return "";
  const auto most = [&](std::ptrdiff_t n) { return 3 * n >= 2 * std::ssize(errors); };
  if (most(exact)) return fmt::format("{} of {} runs are exact to rounding", exact, errors.size());
  if (most(exact + of_method))
    return fmt::format("{} of {} runs are off by what they enforce contact with, as above{}", of_method, errors.size(),
                       exact > 0 ? fmt::format(", {} exact to rounding", exact) : "");
  std::sort(errors.begin(), errors.end());
  const double middle = errors[errors.size() / 2];
  const auto near =
      std::count_if(errors.begin(), errors.end(), [&](double e) { return std::abs(e - middle) <= 0.1 * middle; });
  return most(near)
             ? fmt::format("{} of {} runs are off by {}, whatever their method", near, errors.size(), percent(middle))
             : "";
}

/// What a curve is of.
struct Subject {
  Against against;
  bool derivative, frictionless;
  bool is_of_state() const { return against == Against::coulomb; }
  std::vector<std::string> prefixes() const {
    if (is_of_state()) return {""};
    return derivative ? std::vector<std::string>{"sensitivity:"} : std::vector<std::string>{"response:", "field:"};
  }
  std::string worst_name() const {
    return is_of_state() ? "worst of all" : derivative ? "worst sensitivity" : "worst response";
  }
};

json rows_of(const Study& study, const Subject& subject, SeriesList& series) {
  json rows = json::array();
  for (const auto& cell : study.cells) {
    const std::string knob = running_knob(study, cell.family);
    const std::string name = series_of(cell, knob);
    const bool derivative = subject.derivative;
    for (const auto& [quantity, error] :
         quantities(errors_of(cell, subject.against), subject.prefixes(), subject.worst_name())) {
      if (subject.is_of_state() && subject.frictionless && is_of_friction(quantity)) continue;
      json r = row_of(cell);
      r["series"] = r["line"] = name;
      r["scene"] = cell.variant;
      r["quantity"] = subject.is_of_state() ? in_plain_words(quantity) : quantity;
      r["error"] = error;
      const Counts counts = counts_of(cell, derivative ? Of::sensitivities : Of::responses);
      r["factorizations"] = counts.factorizations;
      r["backsolves"] = counts.backsolves;
      r["r"] = ratio_of(study.ratio, cell);
      r["work"] = derivative ? cell.sensitivity_work : cell.work;
      r["seconds"] = derivative ? cell.sensitivity_seconds : cell.seconds;
      const Knob* value = find_knob(cell, knob);
      if (const double median = derivative ? cell.median_sensitivity_seconds : cell.median_seconds; median > 0)
        r["median"] = median;
      r["order"] = value && value->value ? *value->value : 0;
      if (value) {
        r["option"] = knob;
        r["setting"] = value->text;
      }
      rows.push_back(r);
      series.add(name, cell.family);
    }
  }
  return rows;
}

/// What the runs of one method that a curve joins differ in; empty where none is joined.
std::string what_is_joined(const Study& study) {
  std::string along;
  for (const auto& family : study.families)
    if (const std::string knob = running_knob(study, family); !knob.empty())
      along += (along.empty() ? "" : ", ") + family_name(family) + " along " + knob;
  return along.empty() ? "" : "A curve joins the runs of one method: " + along + ".";
}

/// Name, title and text.
void describe(const Study& study, const Subject& subject, Figure& figure) {
  const std::string what = subject.derivative ? "sensitivities" : "responses", joined = what_is_joined(study);
  if (subject.against == Against::same_mesh) {
    const std::string named = reference_run(study);
    figure.id = "enforcement-" + what;
    figure.title = subject.derivative ? "Sensitivities: what enforcing contact exactly costs"
                                      : "Responses: what enforcing contact exactly costs";
    figure.text = "Enforcement error: the distance from " + (named.empty() ? "the reference solution" : named + ",") +
                  " on the same mesh. Lower left is better. ";
    if (!subject.derivative)
      figure.text += "What is seen is the method alone. " + joined +
                     " A run without any error stands on the line of exact zeros. ";
  } else if (subject.against == Against::discretization) {
    const std::string reference = discretization_reference(study);
    figure.id = "discretization-" + what;
    figure.title = (subject.derivative ? "Sensitivities: error against " : "Responses: error against ") + reference;
    figure.text =
        "Discretisation error: the distance from " + reference +
        (is_against_meshes_alone(study)
             ? ", which has the same steps: mesh and method together. Where curves lie on one level, the mesh decides "
               "and "
               "a stricter method buys nothing. "
             : ", mesh, steps and method together. Where curves lie on one level, mesh and steps decide and a stricter "
               "method buys nothing. ") +
        joined + " ";
  } else {
    figure.id = "kkt";
    figure.title = subject.frictionless ? "How well equilibrium and the contact conditions are met"
                                        : "How well equilibrium and Coulomb's law are met";
    figure.text =
        "Computed from the final state alone by code that does not know which method ran; every measure is "
        "dimensionless. " +
        joined + " ";
  }
  if (subject.derivative)
    figure.text +=
        "Errors are relative to the derivative, or to the response over the parameter if that is larger. Costs are "
        "those "
        "of the solution and its derivatives together.";
}

/// One chart a measure of cost, where some run has it.
void add_charts(const Study& study, const Subject& subject, Figure& figure) {
  const std::string y_title = subject.is_of_state() ? "measure"
                              : subject.derivative  ? "relative error of the sensitivity"
                                                    : "relative error of the response";
  const auto add = [&](const std::string& field, const std::string& name, const std::string& axis, bool folded) {
    const auto positive = [&](const json& r) { return r[field].get<double>() > 0; };
    if (std::none_of(figure.rows.begin(), figure.rows.end(), positive)) return;
    figure.charts.push_back({.title = "against " + name,
                             .x = {.field = field,
                                   .title = axis,
                                   .spacing = Spacing::logarithmic,
                                   .spread = field == "seconds" ? "median" : ""},
                             .y = {"shown", y_title, Spacing::logarithmic},
                             .tooltip = {{"label", "method"},
                                         {"error", "error"},
                                         {"work", "work"},
                                         {"seconds", "seconds"},
                                         {"median", "median"},
                                         {"backsolves", "back-solves"},
                                         {"status", "status"}},
                             .folded = folded,
                             .words = {"series", "setting"}});
  };
  add("work", "work (factorisations)", work_in_words(study), false);
  const bool timed =
      std::any_of(figure.rows.begin(), figure.rows.end(), [](const json& r) { return r.contains("median"); });
  add("seconds", "seconds", timed ? "seconds, least; the line ends at the median of the repeats" : "seconds", false);
  add("backsolves", "back-solves", "back-solves", true);
}

}  // namespace

std::optional<Figure> work_precision(const Study& study, Against against, Of of) {
  const Subject subject{against, of == Of::sensitivities, is_frictionless(study)};
  Figure figure;
  SeriesList series(study);
  figure.rows = rows_of(study, subject, series);
  if (figure.rows.empty()) return std::nullopt;
  show_zeros(figure.rows, "error");
  figure.series = series.list;
  describe(study, subject, figure);
  figure.folded = subject.is_of_state() ? "of the final states" : why_it_may_be_folded(study, against, of);
  add_charts(study, subject, figure);
  if (figure.charts.empty()) return std::nullopt;
  offer(figure, "Quantity", "quantity", subject.worst_name());
  offer(figure, "Scene", "scene", study.main_variant);
  return figure;
}

}  // namespace stickslip::report
