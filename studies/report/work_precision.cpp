#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/report/chart_parts.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

const std::map<std::string, double>& errors_of(const Cell& cell, Against against) {
  if (against == Against::same_mesh) return cell.enforcement;
  return against == Against::discretization ? cell.discretization : cell.kkt;
}

/// Where most runs are exact, are off by the same, or by what they enforce contact with alone, that says it all.
std::string why_it_may_be_folded(const Study& study, Against against, Of of) {
  if (against != Against::discretization) return "";
  const std::string prefix = of == Of::sensitivities ? "sensitivity:" : "response:";
  std::vector<double> errors;
  std::ptrdiff_t exact = 0, of_method = 0;
  for (const auto& cell : study.cells) {
    const auto error = worst(cell.discretization, prefix), own = worst(cell.enforcement, prefix);
    if (!error || !cell.converged || cell.variant != study.main_variant) continue;
    constexpr double alike = 5, rounding = 1e-12;
    errors.push_back(*error);
    exact += *error <= rounding;
    of_method += *error > rounding && own && *error <= alike * *own && *own <= alike * *error;
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

}  // namespace

std::optional<Figure> work_precision(const Study& study, Against against, Of of) {
  const bool derivative = of == Of::sensitivities;
  std::vector<std::string> prefixes =
      derivative ? std::vector<std::string>{"sensitivity:"} : std::vector<std::string>{"response:", "field:"};
  if (against == Against::coulomb) prefixes = {""};
  const std::string worst_name = against == Against::coulomb ? "worst of all"
                                 : derivative                ? "worst sensitivity"
                                                             : "worst response";
  const bool frictionless = is_frictionless(study);
  Figure figure;
  SeriesList series(study);
  for (const auto& cell : study.cells) {
    const std::string knob = running_knob(study, cell.family);
    const std::string name = series_of(cell, knob);
    const double backsolves = cell.count("backsolves") + (derivative ? cell.count("sensitivity_backsolves") : 0);
    const double work = derivative ? cell.sensitivity_work : cell.work;
    const double seconds = derivative ? cell.sensitivity_seconds : cell.seconds;
    for (const auto& [quantity, error] : quantities(errors_of(cell, against), prefixes, worst_name)) {
      if (against == Against::coulomb && frictionless && is_of_friction(quantity)) continue;
      json r = row_of(cell);
      r["series"] = r["line"] = name;
      r["scene"] = cell.variant;
      r["quantity"] = against == Against::coulomb ? in_plain_words(quantity) : quantity;
      r["error"] = error;
      r["work"] = work;
      r["backsolves"] = backsolves;
      r["seconds"] = seconds;
      const Knob* value = find_knob(cell, knob);
      r["order"] = value && value->value ? *value->value : 0;
      if (value) r["setting"] = value->text;
      figure.rows.push_back(r);
      series.add(name, cell.family);
    }
  }
  if (figure.rows.empty()) return std::nullopt;
  show_zeros(figure.rows, "error");
  figure.series = series.list;

  const std::string what = derivative ? "sensitivities" : "responses";
  std::string along;
  for (const auto& family : study.families)
    if (const std::string knob = running_knob(study, family); !knob.empty())
      along += (along.empty() ? "" : ", ") + family_name(family) + " along " + knob;
  const std::string joined = along.empty() ? "" : "A curve joins the runs of one method: " + along + ".";
  std::string y_title = derivative ? "relative error of the sensitivity" : "relative error of the response";
  if (against == Against::same_mesh) {
    figure.id = "enforcement-" + what;
    figure.title = derivative ? "Sensitivities: what enforcing contact exactly costs"
                              : "Responses: what enforcing contact exactly costs";
    figure.text =
        "Enforcement error: the distance from the reference solution on the same mesh, so what is seen is "
        "the method alone. Lower left is better. " +
        joined +
        " A method that is the reference itself "
        "stands on the line of exact zeros. ";
  } else if (against == Against::discretization) {
    const std::string reference = discretization_reference(study);
    figure.id = "discretization-" + what;
    figure.title = (derivative ? "Sensitivities: error against " : "Responses: error against ") + reference;
    figure.text =
        "Discretisation error: the distance from " + reference +
        ", mesh, steps and method together. Where curves lie on one level, mesh and steps decide and a stricter method "
        "buys nothing. " +
        joined + " ";
  } else {
    figure.id = "kkt";
    figure.title = frictionless ? "How well equilibrium and the contact conditions are met"
                                : "How well equilibrium and Coulomb's law are met";
    figure.text =
        "Computed from the final state alone by code that does not know which method ran; every measure is "
        "dimensionless. " +
        joined + " ";
    y_title = "measure";
  }
  figure.text += derivative ? "Costs are those of the solution and its derivatives together." : "";
  figure.folded = against == Against::coulomb ? "of the final states" : why_it_may_be_folded(study, against, of);
  const json y = channel("shown", y_title, true);
  const json tips = tooltip({{"label", "method"},
                             {"error", "error"},
                             {"work", "work"},
                             {"seconds", "seconds"},
                             {"backsolves", "back-solves"},
                             {"status", "status"}});
  const auto panel = [&](const std::string& field, const std::string& title, bool folded) {
    const auto positive = [&](const json& r) { return r[field].get<double>() > 0; };
    if (std::none_of(figure.rows.begin(), figure.rows.end(), positive)) return;
    tag_lines(figure.rows, field, chart_height, "setting");
    json spec = curves(figure.title + ", against " + title, channel(field, title, true), y, tips, tag_field(field));
    spec["transform"] = only_if("datum." + field + " > 0");
    figure.panels.push_back({"against " + title, spec, field, "shown", true, true, "", folded, tag_field(field)});
  };
  panel("work", "work (factorisations)", false);
  panel("seconds", "seconds", false);
  panel("backsolves", "back-solves", true);
  if (figure.panels.empty()) return std::nullopt;
  offer(figure, "Quantity", "quantity", worst_name);
  offer(figure, "Scene", "scene", study.main_variant);
  return figure;
}

}  // namespace stickslip::report
