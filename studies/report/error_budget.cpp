#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "studies/report/chart_parts.hpp"
#include "studies/report/colors.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// How a part is drawn, and what makes it smaller.
struct PartLooks {
  std::string name, color;
  std::vector<int> dash;
  std::string remedy;
};

/// In the order of the legend. Dashes tell them apart in grey print, and each line carries its name.
const std::vector<PartLooks>& part_looks() {
  static const std::vector<PartLooks> all = {{"error", "$ink", {1, 0}, ""},
                                             {"enforcement", vermilion, {7, 3}, "a stricter enforcement"},
                                             {"iteration", blue, {4, 2}, "a stricter tolerance"},
                                             {"step", green, {9, 3, 2, 3}, "smaller steps"},
                                             {"mesh", purple, {2, 2}, "a finer mesh"},
                                             {"rounding", orange, {12, 4}, "a smaller stiffness or scale"},
                                             {"interaction", sky_blue, {1, 4}, ""}};
  return all;
}

const json& budgets_of(const Cell& cell) { return object_at(at(cell.record, "error_budget"), "quantities"); }

/// "u", or "du/dmu" of "sensitivity:u/mu".
std::string quantity_in_words(const std::string& name) {
  const std::string bare = name.substr(name.find(':') + 1);
  if (!name.starts_with("sensitivity:")) return bare;
  const auto slash = bare.find('/');
  return "d" + bare.substr(0, slash) + "/d" + bare.substr(slash + 1);
}

/// A part of a budget, or its error or interaction; null where it has no value.
struct Entry {
  json value;
  double noise = 0;
  bool drawn() const { return value.is_number() && std::abs(value.get<double>()) > noise; }
};

Entry entry_of(const json& budget, const std::string& name) {
  if (name == "error") return {at(budget, "error"), 0};
  if (name == "interaction") return {at(budget, "interaction"), number_at(budget, "noise")};
  const json& part = at(object_at(budget, "parts"), name);
  return {at(part, "value"), number_at(part, "noise")};
}

std::string series_name(const std::string& part, double value) { return part + (value > 0 ? " (+)" : " (-)"); }

/// A mark for each entry of each budget.
json marks_of(const Study& study) {
  json rows = json::array();
  for (const auto& cell : study.cells) {
    const std::string knob = running_knob(study, cell.family);
    const Knob* const along = find_knob(cell, knob);
    for (const auto& [quantity, budget] : budgets_of(cell).items())
      for (const auto& look : part_looks()) {
        const Entry entry = entry_of(budget, look.name);
        json r = row_of(cell);
        r["panel"] = family_name(cell.family);
        r["scene"] = cell.variant;
        r["quantity"] = quantity_in_words(quantity);
        r["curve"] = series_of(cell, knob);
        r["part"] = r["line"] = look.name;
        r["value"] = entry.value;
        r["noise"] = entry.noise;
        r["axis"] = knob.empty() ? "one setting" : knob_title({knob});
        r["option_value"] = r["order"] = along && along->value && *along->value > 0 ? *along->value : 1;
        if (const json& reason = at(at(object_at(budget, "parts"), look.name), "reason"); !reason.is_null())
          r["reason"] = reason;
        r["series"] = entry.drawn() ? series_name(look.name, entry.value.get<double>()) : "";
        r["shown"] = entry.drawn() ? json(std::abs(entry.value.get<double>())) : json();
        rows.push_back(r);
      }
  }
  return rows;
}

std::vector<Series> series_of_parts() {
  std::vector<Series> out;
  for (const auto& look : part_looks())
    for (const double sign : {1.0, -1.0})
      out.push_back({series_name(look.name, sign), look.color, sign > 0 ? "triangle-up" : "triangle-down", look.dash,
                     look.name == "error" ? 130 : 60});
  return out;
}

/// The quantity shown first: of those with an error the response that is off by most in the median run.
std::string first_quantity(const Study& study) {
  std::map<std::string, std::vector<double>> errors;
  for (const auto& cell : study.cells)
    for (const auto& [name, budget] : budgets_of(cell).items())
      if (const json& error = at(budget, "error"); error.is_number() && name.starts_with("response:"))
        errors[name].push_back(std::abs(error.get<double>()));
  std::string best;
  double largest = -1;
  for (auto& [name, values] : errors) {
    std::nth_element(values.begin(), values.begin() + std::ssize(values) / 2, values.end());
    if (const double middle = values[values.size() / 2]; middle > largest) {
      largest = middle;
      best = name;
    }
  }
  if (best.empty())
    for (const auto& cell : study.cells)
      if (!budgets_of(cell).empty()) return budgets_of(cell).begin().key();
  return best;
}

std::string signed_number(double value) { return (value > 0 ? "+" : "") + number(value, 2); }

/// The parts of a budget with a value above its noise, the largest first.
/// Whether the reference has a part too, so that it is none of the error.
bool is_shared(const json& budget, const std::string& part) {
  return at(at(object_at(budget, "parts"), part), "shared") == true;
}

std::vector<std::pair<std::string, double>> parts_by_size(const json& budget) {
  std::vector<std::pair<std::string, double>> parts;
  for (const auto& look : part_looks())
    if (const Entry entry = entry_of(budget, look.name);
        look.name != "error" && look.name != "interaction" && entry.drawn() && !is_shared(budget, look.name))
      parts.emplace_back(look.name, entry.value.get<double>());
  std::sort(parts.begin(), parts.end(),
            [](const auto& a, const auto& b) { return std::abs(a.second) > std::abs(b.second); });
  return parts;
}

std::string remedy_of(const std::string& part) {
  return std::find_if(part_looks().begin(), part_looks().end(), [&](const auto& look) { return look.name == part; })
      ->remedy;
}

/// What makes the error of the method's best setting, and what would lessen it.
std::string dominant_part(const Study& study, const std::string& family, const std::string& quantity) {
  const Cell* best = nullptr;
  const auto off_by = [&](const Cell& cell) {
    const json& budget = at(budgets_of(cell), quantity);
    const json& error = at(budget, "error").is_number() ? at(budget, "error") : at(budget, "sum");
    return error.is_number() ? std::abs(error.get<double>()) : std::numeric_limits<double>::infinity();
  };
  constexpr double alike = 1.001;  // what differs by less is the choice of rounding
  const auto of_the_method = [&](const Cell& cell) {
    return cell.family == family && cell.variant == study.main_variant && std::isfinite(off_by(cell));
  };
  for (const auto& cell : study.cells)
    if (of_the_method(cell) && (!best || off_by(cell) < off_by(*best))) best = &cell;
  if (!best) return {};
  const bool all_alike = std::count_if(study.cells.begin(), study.cells.end(), of_the_method) > 1 &&
                         std::all_of(study.cells.begin(), study.cells.end(), [&](const Cell& cell) {
                           return !of_the_method(cell) || off_by(cell) <= alike * off_by(*best);
                         });
  const json& budget = at(budgets_of(*best), quantity);
  const bool known = at(budget, "error").is_number();
  const double off = (known ? at(budget, "error") : at(budget, "sum")).get<double>();
  const std::string who = all_alike ? family_name(family) + " is the same at every setting"
                                    : series_of(*best, "") + " comes nearest of its method";
  std::string out = fmt::format("{}: off by {} in {}{}", who, signed_number(off), quantity_in_words(quantity),
                                known ? "" : ", the sum of its parts");
  const auto parts = parts_by_size(budget);
  if (parts.empty()) return out + "; no part is above what rounding leaves uncertain.";
  const auto& [part, value] = parts.front();
  constexpr double cancelling = 1.25;  // times the error: then other parts take away a fifth of it at least
  if (parts.size() > 1 && std::abs(value) > cancelling * std::abs(off))
    return out +
           fmt::format(". That is small because {} ({}) and {} ({}) cancel in part; with other numbers they may not.",
                       part, signed_number(value), parts[1].first, signed_number(parts[1].second));
  constexpr double nearly_all = 0.8;  // of the error
  const char* const rest = std::abs(value) >= nearly_all * std::abs(off) ? ", and hardly anything else does" : " most";
  return out +
         fmt::format(". Most of it is {} ({}): {} lowers it{}.", part, signed_number(value), remedy_of(part), rest);
}

/// Parts without a value, each reason once, and runs of the budgets that failed.
std::string what_is_missing(const Study& study) {
  std::map<std::array<std::string, 3>, int> reasons;  // quantity, part, reason
  Table failed{{"method", "scene", "run", "status", "message"}, {}, {}};
  for (const auto& cell : study.cells) {
    for (const auto& [quantity, budget] : budgets_of(cell).items())
      for (const auto& [part, entry] : object_at(budget, "parts").items())
        if (at(entry, "value").is_null()) ++reasons[{quantity_in_words(quantity), part, text_at(entry, "reason")}];
    for (const auto& run : array_at(at(cell.record, "error_budget"), "failed"))
      failed.rows.push_back(
          {cell.label, cell.variant, text_at(run, "run"), text_at(run, "status"), text_at(run, "message")});
  }
  Table missing{{"quantity", "part", "why", "runs"}, {}, {}};
  for (const auto& [key, count] : reasons) missing.rows.push_back({key[0], key[1], key[2], std::to_string(count)});
  std::string out;
  if (!missing.rows.empty())
    out += folded("Parts that could not be measured", to_html(missing, "Parts without a value"));
  if (!failed.rows.empty()) out += folded("Runs of the budgets that failed", to_html(failed, "Failed runs"));
  return out;
}

}  // namespace

std::optional<Figure> error_budget(const Study& study) {
  Figure figure;
  figure.id = "error-budget";
  figure.title = "What each error is made of";
  figure.text =
      "Each part of the error, measured by runs of its own, along the method's option. A triangle that points up makes "
      "the answer too large, one that points down too small. Where the black curve of the error flattens, it runs "
      "along "
      "the part that this option does not lessen. The interaction is what the parts leave of the error. What is less "
      "than its noise, or exactly zero, is not drawn.";
  figure.rows = marks_of(study);
  if (figure.rows.empty()) return std::nullopt;
  figure.series = series_of_parts();
  for (const std::string& panel : distinct(figure.rows, "panel")) {
    figure.charts.push_back({.title = panel,
                             .x = {"option_value", "{axis}", Spacing::logarithmic},
                             .y = {"shown", "part of the relative error, its size", Spacing::logarithmic},
                             .tooltip = {{"label", "method"}, {"part", "part"}, {"value", "value"}, {"noise", "noise"}},
                             .only = panel,
                             .words = {"line"}});
    offer(figure, "Setting", "curve", "", panel);
  }
  offer(figure, "Quantity", "quantity", quantity_in_words(first_quantity(study)));
  offer(figure, "Scene", "scene", study.main_variant);
  return figure;
}

std::string budget_in_words(const Study& study) {
  const std::string quantity = first_quantity(study);
  if (quantity.empty()) return {};
  std::string out = "<ul class=\"headline\">";
  for (const auto& family : study.families)
    if (const std::string sentence = dominant_part(study, family, quantity); !sentence.empty())
      out += "<li>" + escape_sentence(sentence) + "</li>\n";
  return out + "</ul>\n" + what_is_missing(study);
}

}  // namespace stickslip::report
