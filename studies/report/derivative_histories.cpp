#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "studies/report/chart_parts.hpp"
#include "studies/report/history_parts.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// The derivative of `response` with most to see, of all where it has none.
std::string first_to_show(const std::vector<History>& runs, const std::string& response) {
  const std::string own =
      most_to_see(runs, [&](const std::string& name) { return name.starts_with("d " + response + " / d "); });
  return own.empty() ? most_to_see(runs, [](const std::string&) { return true; }) : own;
}

/// Keeps as many derivatives as a page has room for.
void limit(History& history) {
  constexpr std::size_t most_rows = 4000;  // of a run
  const std::size_t most = std::max<std::size_t>(most_rows / std::max<std::size_t>(history.times.size(), 1), 1);
  if (history.values.size() > most)
    history.values.erase(std::next(history.values.begin(), static_cast<long>(most)), history.values.end());
}

}  // namespace

std::optional<Figure> derivative_histories(const Study& study, const std::string& response) {
  constexpr std::size_t most_rows = 8000;
  Figure figure;
  SeriesList series(study);
  figure.id = "derivative-histories";
  const auto shown = telling_cells(study, Furthest::added);
  add_first(series, study, shown);
  std::vector<History> told;  // of the runs that are shown at first
  std::size_t derivatives = 0;
  double end = 0;
  for (const bool telling : {true, false})
    for (const auto& cell : study.cells) {
      const bool chosen = std::find(shown.begin(), shown.end(), cell.label) != shown.end();
      if (cell.variant != study.main_variant || chosen != telling) continue;
      History history = history_of(cell, Of::sensitivities);
      derivatives = std::max(derivatives, history.values.size());
      limit(history);
      const std::size_t rows = history.times.size() * history.values.size();
      if (history.times.size() < 2 || (!telling && figure.rows.size() + rows > most_rows)) continue;
      if (telling || told.empty()) told.push_back(history);
      end = std::max(end, history.times.back());
      series.add(in_words(cell), cell.family);
      json base = base_of_history(cell);
      base["panel"] = "time";
      for (const auto& [name, values] : history.values) {
        base["response"] = name;
        add_history(figure.rows, base, "time", history.times, values, 2 * series.place(in_words(cell)));
      }
    }
  if (figure.rows.empty()) return std::nullopt;
  figure.series = series.list;
  add_given(figure, study, Of::sensitivities, end);
  json spec = curves("Derivative over time", channel("time", "time", false), channel("value", "{response}", false),
                     tooltip({{"series", "run"}, {"time", "time"}, {"value", "value"}}));
  figure.panels.push_back({"", spec, "time", "value", false, false, "time", false});
  figure.title = "Histories: derivatives over time";
  figure.folded = "of any response by any parameter";
  figure.text =
      "Of every step. Where a point begins to slip, to stick or to open, a derivative has a kink or a jump, and what "
      "friction remembers goes on in it.";
  offer(figure, "Derivative", "response", first_to_show(told, response), "time");
  const auto kept = distinct(figure.rows, "response", "time").size();
  if (kept < derivatives) figure.text += fmt::format(" The first {} of {} derivatives.", kept, derivatives);
  offer_cells(figure, shown);
  return figure;
}

}  // namespace stickslip::report
