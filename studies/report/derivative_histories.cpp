#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "studies/report/chart_parts.hpp"
#include "studies/report/history_parts.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// Derivatives that are rounding: over its response, each is next to nothing beside that of another response by the
/// same parameter.
std::set<std::string> rounding_of(const History& derivatives, const History& responses) {
  constexpr double rounding = 1e-9;
  std::map<std::string, std::map<std::string, double>> shares;  // by parameter and name
  std::map<std::string, double> largest;                        // by parameter
  for (const auto& [response, values] : responses.values)
    for (const auto& [name, derivative] : derivatives.values)
      if (const std::string head = derivative_name(response, ""); name.starts_with(head) && size_of(values) > 0) {
        const std::string parameter = name.substr(head.size());
        const double share = shares[parameter][name] = size_of(derivative) / size_of(values);
        largest[parameter] = std::max(largest[parameter], share);
      }
  std::set<std::string> out;
  for (const auto& [parameter, by_name] : shares)
    for (const auto& [name, share] : by_name)
      if (share <= rounding * largest[parameter]) out.insert(name);
  return out;
}

/// The derivative of `response` with most to see, of all where it has none; rounding only where there is nothing else.
std::string first_to_show(const std::vector<History>& runs, const std::set<std::string>& rounding,
                          const std::string& response) {
  const auto is_own = [&](const std::string& name) { return name.starts_with(derivative_name(response, "")); };
  const auto is_clear = [&](const std::string& name) { return rounding.count(name) == 0; };
  const std::string own = most_to_see(runs, [&](const std::string& name) { return is_own(name) && is_clear(name); });
  if (!own.empty()) return own;
  const std::string clear = most_to_see(runs, is_clear);
  return clear.empty() ? most_to_see(runs, [](const std::string&) { return true; }) : clear;
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
  std::set<std::string> rounding;
  std::size_t derivatives = 0;
  double end = 0;
  bool has_sides = false;  // a derivative with two
  for (const bool telling : {true, false})
    for (const auto& cell : study.cells) {
      const bool chosen = std::find(shown.begin(), shown.end(), cell.label) != shown.end();
      if (cell.variant != study.main_variant || chosen != telling) continue;
      History history = history_of(cell, Of::sensitivities);
      derivatives = std::max(derivatives, history.values.size());
      limit(history);
      const std::size_t rows = history.times.size() * history.values.size();
      if (history.times.size() < 2 || (!telling && figure.rows.size() + rows > most_rows)) continue;
      if (told.empty()) rounding = rounding_of(history, history_of(cell, Of::responses));
      if (telling || told.empty()) told.push_back(history);
      end = std::max(end, history.times.back());
      series.add(in_words(cell), cell.family);
      json base = base_of_history(cell);
      base["panel"] = "time";
      for (const auto& [name, values] : history.values) {
        base["response"] = name;
        add_history(figure.rows, base, "time", history.times, values, 2 * series.place(in_words(cell)));
        add_sides(figure.rows, base, history.times, history.sides[name]);
        has_sides |= !history.sides[name].empty();
      }
    }
  if (figure.rows.empty()) return std::nullopt;
  figure.series = series.list;
  add_given(figure, study, Of::sensitivities, end);
  Chart chart{.title = "",
              .x = {"time", time_title(told)},
              .y = {"value", "{response}"},
              .tooltip = {{"series", "run"}, {"time", "time"}, {"value", "value"}},
              .only = "time"};
  if (has_sides) chart.tooltip.emplace_back("side", "side");
  figure.charts.push_back(std::move(chart));
  figure.title = "Histories: derivatives over time";
  figure.folded = "of any response by any parameter";
  figure.text = is_frictionless(study)
                    ? "Of every step. Where a point begins to touch or to open, a derivative has a kink or a jump."
                    : "Of every step. Where a point begins to slip, to stick or to open, a derivative has a kink or a "
                      "jump, and what friction remembers goes on in it.";
  if (has_sides)
    figure.text +=
        " If its values from below and from above differ at a step, the curve has a gap there, and each value a point.";
  offer(figure, "Derivative", "response", first_to_show(told, rounding, response), "time");
  const auto kept = distinct(figure.rows, "response", "time").size();
  if (kept < derivatives) figure.text += fmt::format(" The first {} of {} derivatives.", kept, derivatives);
  offer_cells(figure, shown);
  return figure;
}

}  // namespace stickslip::report
