#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "studies/io/numerals.hpp"
#include "studies/io/wording.hpp"
#include "studies/report/chart_parts.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// The step of a cell whose iterations are shown, the one that took most, or of a run that failed the last; none where
/// none was recorded.
std::optional<std::size_t> hardest_step(const Cell& cell) {
  const json& steps = array_at(cell.record, "steps");
  std::optional<std::size_t> hardest;
  std::size_t most = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const std::size_t length = array_at(steps[i], "history").size();
    if (length == 0 || (length < most && cell.converged)) continue;
    most = length;
    hardest = i;
  }
  return hardest;
}

/// How many iterations the step has taken at each iterate of its history, so that the last is the number in the step
/// table. Every solve begins with a guess, which is no iteration; a new solve begins where the augmentation changes.
/// Iterations without an iterate, as a prediction or what other tries took, come before.
std::vector<long> counted_iterations(const json& step) {
  std::vector<long> counts;
  const json* before = nullptr;
  for (const auto& record : array_at(step, "history")) {
    const bool starts = !before || at(record, "augmentation") != at(*before, "augmentation");
    counts.push_back(counts.empty() ? 0 : counts.back() + (starts ? 0 : 1));
    before = &record;
  }
  const long unlisted = std::lround(number_at(step, "newton")) - (counts.empty() ? 0 : counts.back());
  for (long& count : counts) count += std::max(unlisted, 0L);
  return counts;
}

/// The iterates of one step of a cell. `turn`: which of them are marked.
void add_iterations(json& rows, const Cell& cell, std::size_t step, std::size_t turn) {
  const json& history = cell.record["steps"][step]["history"];
  const auto counts = counted_iterations(cell.record["steps"][step]);
  // Long curves stay readable where they mark few points, and other ones than their neighbours.
  const std::size_t stride = std::max<std::size_t>(history.size() / 15, 1);
  for (std::size_t i = 0; i < history.size(); ++i) {
    const json& record = history[i];
    const json& residual = at(record, "residual");
    if (!residual.is_number()) continue;
    json r = row_of(cell);
    r["failed"] = false;  // the residuals of a failed run are a curve like any other; its name tells the status
    r["series"] = r["line"] = in_words(cell);
    r["of_cell"] = "yes";
    r["error"] = residual;
    r["step"] = step + 1;
    r["time"] = number_at(cell.record["steps"][step], "time");
    r["iteration"] = counts[i];
    r["order"] = i;
    r["unmarked"] = (i + turn) % stride != 0;
    r["changed"] = number_at(record, "changed");
    r["augmentation"] = number_at(record, "augmentation");
    rows.push_back(r);
  }
}

}  // namespace

namespace {

/// "step 3, t = 0.3", or of runs whose steps differ "step 3, t = 0.3 (2 runs); step 4, t = 0.4 (1 run)".
std::string in_words(const std::map<std::pair<std::size_t, double>, long>& steps) {
  std::string out;
  for (const auto& [step, runs] : steps)
    out += fmt::format("{}step {}, t = {}{}", out.empty() ? "" : "; ", step.first + 1, number(step.second),
                       steps.size() > 1 ? " (" + counted(runs, "run") + ")" : "");
  return out;
}

}  // namespace

std::optional<Figure> convergence_histories(const Study& study) {
  Figure figure;
  SeriesList series(study);
  figure.id = "histories";
  figure.folded = "of each run";
  figure.title = "Convergence: residual per iteration in the hardest step";
  figure.text = (study.cells.size() > 1 ? "For each run, the load step" : "The load step") +
                std::string(
                    " that took most iterations (of a run that failed, the last). The residual is the largest "
                    "of equilibrium") +
                (is_frictionless(study) ? " and contact" : ", normal and tangential contact") +
                ", each relative to its own scale. The last iteration has the number that the step table gives; the "
                "first guess comes before the first";
  const auto shown = telling_cells(study, Furthest::left_out);
  add_first(series, study, shown);
  std::map<std::pair<std::size_t, double>, long> steps;  // with how many runs each is shown of
  for (const auto& cell : study.cells) {
    if (cell.variant != study.main_variant) continue;
    const auto step = hardest_step(cell);
    if (!step) continue;
    const std::string name = in_words(cell);
    series.add(name, cell.family);
    add_iterations(figure.rows, cell, *step, 2 * series.place(name));
    ++steps[{*step, number_at(cell.record["steps"][*step], "time")}];
  }
  if (figure.rows.empty()) return std::nullopt;
  const bool augmented =
      std::any_of(figure.rows.begin(), figure.rows.end(), [](const json& r) { return r["augmentation"] > 1; });
  figure.text +=
      augmented ? "; an augmented run begins each augmentation with a new guess, which is the sawtooth." : ".";
  figure.text += steps.size() == 1 ? " It is " + in_words(steps) + "." : " They are " + in_words(steps) + ".";
  show_zeros(figure.rows, "error");
  figure.series = series.list;
  figure.charts.push_back({.title = "",
                           .x = {.field = "iteration", .title = "Newton iterations of the step", .least_step = 1},
                           .y = {"shown", "relative residual", Spacing::logarithmic},
                           .tooltip = {{"series", "run"},
                                       {"step", "step"},
                                       {"time", "t"},
                                       {"iteration", "iteration"},
                                       {"error", "residual"},
                                       {"changed", "points that changed state"},
                                       {"augmentation", "augmentation"}}});
  offer_cells(figure, shown);
  return figure;
}

}  // namespace stickslip::report
