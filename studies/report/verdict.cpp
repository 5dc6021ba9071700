#include "studies/report/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>

#include "studies/report/headline.hpp"
#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/settings.hpp"

namespace stickslip::report {
namespace {

constexpr double much_the_same = 1.05;  ///< work or seconds within 5 % of the least name no winner
constexpr double much_faster = 1.25;    ///< seconds of runs this short vary by some 20 %

/// An accuracy that is asked for.
struct Level {
  std::string title;
  double error = 0;
};

/// Responses or derivatives, by which errors they are judged, and to which accuracies.
struct Measure {
  Of of = Of::responses;
  bool on_same_mesh = true;  ///< else against the closed form, a finer mesh or given values
  std::vector<Level> levels;

  std::string prefix() const { return of == Of::responses ? "response:" : "sensitivity:"; }
  std::string noun() const { return of == Of::responses ? "response" : "derivative"; }
  std::optional<double> error(const Cell& cell) const {
    return cell.converged ? worst(on_same_mesh ? cell.enforcement : cell.discretization, prefix()) : std::nullopt;
  }
  double work(const Cell& cell) const { return work_of(cell, of); }
  double seconds(const Cell& cell) const { return of == Of::responses ? cell.seconds : cell.sensitivity_seconds; }
};

std::vector<const Cell*> runs_of(const Study& study, const std::string& family) {
  std::vector<const Cell*> out;
  for (const auto& cell : study.cells)
    if (cell.variant == study.main_variant && (family.empty() || cell.family == family)) out.push_back(&cell);
  return out;
}

/// What the mesh itself is off by: the error, against the study's discretisation reference, of the run that enforces
/// contact best.
std::optional<double> own_error(const Study& study, const std::string& prefix) {
  const Cell* best = nullptr;
  double least = 0;
  for (const Cell* cell : runs_of(study, ""))
    if (const auto error = worst(cell->enforcement, prefix); cell->converged && error && (!best || *error < least)) {
      best = cell;
      least = *error;
    }
  return best ? worst(best->discretization, prefix) : std::nullopt;
}

/// Three digits, with a power of ten outside 0.001 to 10000: "0.5", "1e5", "1e-4".
std::string short_number(double x, int digits = 3) {
  if (x == 0 || (std::abs(x) >= 1e-3 && std::abs(x) < 1e4)) return fmt::format("{:.{}g}", x, std::max(digits, 4));
  const int power = static_cast<int>(std::floor(std::log10(std::abs(x)) + 1e-9));
  return number(x / std::pow(10, power), digits) + "e" + std::to_string(power);
}

std::string percent(double error) {
  return error >= 1e-3 && error < 1 ? number(100 * error, 2) + " %" : short_number(error, 2);
}

std::optional<Measure> measure_of(const Study& study, Of of) {
  Measure measure{of, true, {}};
  const auto runs = runs_of(study, "");
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
  for (const double error : asked) measure.levels.push_back({percent(error), error});
  if (const auto own = own_error(study, measure.prefix()); measure.on_same_mesh && own && *own > 0)
    measure.levels.push_back({"mesh: " + percent(*own), *own});
  return measure;
}

/// The options that tell a run from others of its method, numbers in one style; "default" where there are none.
std::string setting_of(const Cell& cell) {
  std::istringstream words(series_of(cell, "").substr(family_name(cell.family).size()));
  std::string out;
  for (std::string word; words >> word;) {
    const std::size_t sign = word.find('=');
    char* end = nullptr;
    const std::string text = sign == std::string::npos ? "" : word.substr(sign + 1);
    const double value = std::strtod(text.c_str(), &end);
    if (!text.empty() && *end == '\0') word = word.substr(0, sign + 1) + short_number(value);
    out += (out.empty() ? "" : " ") + word;
  }
  return out.empty() ? "default" : out;
}

std::string named(const Cell& cell) {
  const std::string setting = setting_of(cell);
  return family_name(cell.family) + (setting == "default" ? "" : " (" + setting + ")");
}

std::string seconds_in_words(double seconds) {
  return seconds < 0.1 ? number(1e3 * seconds, 2) + " ms" : number(seconds, 2) + " s";
}

/// The run of a method that reaches an accuracy with least work; nullptr where none does.
const Cell* cheapest(const std::vector<const Cell*>& runs, const Measure& measure, double level) {
  const Cell* best = nullptr;
  for (const Cell* cell : runs) {
    const auto error = measure.error(*cell);
    if (error && *error <= level && (!best || measure.work(*cell) < measure.work(*best))) best = cell;
  }
  return best;
}

/// Of an accuracy: the cheapest run of each method, the least work among them, and the least seconds.
struct Column {
  std::vector<const Cell*> runs;  ///< per method; nullptr: not reached
  const Cell* least = nullptr;    ///< by work
  const Cell* fastest = nullptr;  ///< by seconds, where they were measured
};

Column column_of(const Study& study, const Measure& measure, double level) {
  Column column;
  for (const auto& family : study.families) {
    const Cell* run = cheapest(runs_of(study, family), measure, level);
    column.runs.push_back(run);
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

/// Whether seconds name a winner that work does not.
bool is_fastest(const Column& column, const Measure& measure, const Cell& cell) {
  return column.fastest == &cell && !is_least(column, measure, cell) &&
         measure.seconds(*column.least) > much_faster * measure.seconds(cell);
}

std::string entry(const Study& study, const std::string& family, const Measure& measure, const Column& column,
                  const Cell* run) {
  if (!run) {
    std::optional<double> nearest;
    for (const Cell* cell : runs_of(study, family))
      if (const auto error = measure.error(*cell)) nearest = std::min(nearest.value_or(*error), *error);
    return "<td class=\"missed\">" + (nearest ? "best " + percent(*nearest) : std::string("no run")) + "</td>";
  }
  const bool least = is_least(column, measure, *run), fastest = is_fastest(column, measure, *run);
  std::string cost = "work " + number(measure.work(*run), 2);
  if (measure.seconds(*run) > 0) cost += " &middot; " + escape(seconds_in_words(measure.seconds(*run)));
  return fmt::format("<td{}>{}<br><small>{}{}</small></td>", least ? " class=\"least\"" : "", escape(setting_of(*run)),
                     cost,
                     least     ? " &#9733;"
                     : fastest ? " fastest"
                               : "");
}

/// Who is the cheapest at the first accuracy that any method reaches, and what the others need.
std::string reason(const Study& study, const Measure& measure) {
  for (const auto& level : measure.levels) {
    const Column column = column_of(study, measure, level.error);
    if (!column.least) continue;
    std::string winners, others;
    for (const Cell* run : column.runs) {
      if (!run) continue;
      if (is_least(column, measure, *run))
        winners += (winners.empty() ? "<b>" : " and <b>") + escape(named(*run)) + "</b>";
      else
        others +=
            (others.empty() ? " where " : ", ") + escape(named(*run)) + " takes " + work_in_words(*run, measure.of);
    }
    std::string out = "To " + level.title + " the " + measure.noun() + " is cheapest by " + winners + ": " +
                      work_in_words(*column.least, measure.of) + others;
    for (const Cell* run : column.runs)
      if (run && is_fastest(column, measure, *run))
        out += fmt::format("; by the clock {} was faster ({} for {})", escape(named(*run)),
                           escape(seconds_in_words(measure.seconds(*run))),
                           escape(seconds_in_words(measure.seconds(*column.least))));
    return out + ".";
  }
  return "";
}

}  // namespace

std::string verdict(const Study& study) {
  std::vector<Measure> measures;
  for (const Of of : {Of::responses, Of::sensitivities})
    if (auto measure = measure_of(study, of)) measures.push_back(*std::move(measure));
  if (measures.empty()) return "";
  std::string groups, heads, sentence;
  std::vector<std::string> rows(study.families.size());
  for (const auto& measure : measures) {
    groups +=
        fmt::format("<th scope=\"colgroup\" colspan=\"{}\">{} within</th>", measure.levels.size(), measure.noun());
    for (const auto& level : measure.levels) {
      heads += "<th scope=\"col\">" + escape(level.title) + "</th>";
      const Column column = column_of(study, measure, level.error);
      for (std::size_t i = 0; i < study.families.size(); ++i)
        rows[i] += entry(study, study.families[i], measure, column, column.runs[i]);
    }
    sentence += (sentence.empty() ? "" : " ") + reason(study, measure);
  }
  std::string body;
  for (std::size_t i = 0; i < study.families.size(); ++i)
    body += "<tr><th scope=\"row\">" + escape(family_name(study.families[i])) + "</th>" + rows[i] + "</tr>\n";
  const std::string against =
      measures.front().on_same_mesh ? "exact contact on the same mesh" : discretization_reference(study);
  return fmt::format(
      "<div class=\"wide\" role=\"region\" tabindex=\"0\" aria-label=\"Verdict\"><table class=\"verdict\">"
      "<caption>The cheapest setting of each method that gets within an accuracy of {}{}; &#9733; least work "
      "(factorisations and their worth in back-solves)</caption>\n<thead><tr><th rowspan=\"2\">method</th>{}</tr>"
      "<tr>{}</tr></thead><tbody>\n{}</tbody></table></div>\n<p class=\"reason\">{}</p>\n",
      escape(against), study.main_variant.empty() ? "" : escape(" (" + study.main_variant + ")"), groups, heads, body,
      sentence);
}

}  // namespace stickslip::report
