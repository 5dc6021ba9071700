#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "studies/report/chart_parts.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/history_parts.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// A force and the displacement it is drawn against.
struct Pair {
  std::string force, against;
  std::string words() const { return force + " against " + against; }
};

bool is_force(const json& kinds, const std::string& response) {
  const json& kind = at(kinds, response.c_str());
  return kind == "reaction" || kind == "contact_force";
}

/// What kind each response is of, as picture.json has it.
std::vector<Pair> pairs_of(const json& kinds) {
  std::vector<std::string> forces, ways;
  for (const auto& [name, kind] : kinds.items()) {
    if (is_force(kinds, name)) forces.push_back(name);
    if (kind == "displacement" || kind == "slip") ways.push_back(name);
  }
  std::vector<Pair> out;
  for (const auto& way : ways)
    for (const auto& force : forces) out.push_back({force, way});
  return out;
}

/// The histories without forces that are rounding beside the largest one.
std::vector<History> without_rounding(std::vector<History> runs, const json& kinds) {
  constexpr double rounding = 1e-9;
  std::map<std::string, double> largest;
  double most = 0;
  for (const auto& run : runs)
    for (const auto& [name, values] : run.values)
      for (const double value : values)
        if (is_force(kinds, name) && std::isfinite(value)) {
          largest[name] = std::max(largest[name], std::abs(value));
          most = std::max(most, std::abs(value));
        }
  for (auto& run : runs)
    std::erase_if(run.values, [&](const auto& of) {
      const auto found = largest.find(of.first);
      return found != largest.end() && found->second <= rounding * most;
    });
  return runs;
}

/// From the least to the largest value; 0 where that is rounding.
double extent_of(const std::vector<double>& values) {
  constexpr double rounding = 1e-9;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low > rounding * std::max(std::abs(*low), std::abs(*high)) ? *high - *low : 0;
}

/// The area that the path encloses, from a step on, with the chord from its end to that step, as a share of the box
/// around the whole path: what tells a loop from a line. 0 where the path has no extent.
double openness(const std::vector<double>& x, const std::vector<double>& y, std::size_t from = 0) {
  double twice = 0;
  for (std::size_t i = from; i < x.size(); ++i) {
    const std::size_t next = i + 1 < x.size() ? i + 1 : from;
    twice += (x[i] - x[from]) * (y[next] - y[from]) - (x[next] - x[from]) * (y[i] - y[from]);
  }
  const double box = extent_of(x) * extent_of(y);
  return box > 0 && std::isfinite(twice) ? std::abs(twice) / 2 / box : 0;
}

double openness(const History& history, const Pair& pair) {
  const auto force = history.values.find(pair.force), way = history.values.find(pair.against);
  return force == history.values.end() || way == history.values.end() ? -1 : openness(way->second, force->second);
}

/// The first step that the path comes back to at its end, up to a step's length; its last where there is none.
std::size_t where_it_closes(const std::vector<double>& x, const std::vector<double>& y) {
  constexpr double near = 0.01;  // of the extent
  const std::size_t last = x.size() - 1;
  const auto comes_back = [&](const std::vector<double>& values, std::size_t to) {
    const double step = std::abs(values[last] - values[last - 1]);
    return std::abs(values[last] - values[to]) <= step + near * extent_of(values);
  };
  std::size_t first = 0;
  while (first < last && !(comes_back(x, first) && comes_back(y, first))) ++first;
  return first;
}

/// The pair whose path is least like a line; of none, the first.
Pair widest(const std::vector<Pair>& pairs, const History& history) {
  return *std::max_element(pairs.begin(), pairs.end(),
                           [&](const Pair& a, const Pair& b) { return openness(history, a) < openness(history, b); });
}

constexpr double no_loop = 1e-3;  ///< a share of the box: what rounding and the first increment leave of a line

/// Whether the path ends in a closed loop that is no line.
bool ends_in_a_loop(const History& history, const Pair& pair) {
  const auto force = history.values.find(pair.force), way = history.values.find(pair.against);
  return force != history.values.end() && way != history.values.end() && way->second.size() > 2 &&
         openness(way->second, force->second, where_it_closes(way->second, force->second)) > no_loop;
}

/// The pair to begin with: the widest loop; where there is none, the force with most to see. Without a force of a pair,
/// that response.
Pair first_pair(const std::vector<Pair>& pairs, const std::vector<History>& runs) {
  const auto is_force = [&](const std::string& name) {
    return pairs.empty() ||
           std::any_of(pairs.begin(), pairs.end(), [&](const Pair& pair) { return pair.force == name; });
  };
  if (!pairs.empty())
    if (const Pair loop = widest(pairs, runs.front()); openness(runs.front(), loop) > no_loop) return loop;
  const std::string force = most_to_see(runs, is_force);
  const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const Pair& pair) { return pair.force == force; });
  return found == pairs.end() ? Pair{force, ""} : *found;
}

/// Whether a response keeps one value in every run, as far as a chart shows.
bool is_level(const std::vector<History>& runs, const std::string& response) {
  constexpr double shown = 1e-5;  // of a value, as an axis magnifies no less
  return std::all_of(runs.begin(), runs.end(), [&](const History& run) {
    const auto found = run.values.find(response);
    if (found == run.values.end()) return true;
    const auto [low, high] = std::minmax_element(found->second.begin(), found->second.end());
    return *high - *low <= shown * std::max(std::abs(*low), std::abs(*high));
  });
}

/// What is shown over time first: the force of the first pair; where that is level, what has most to see; of a path by
/// arc length, which time does not order, the displacement.
std::string first_over_time(const Pair& first, const std::vector<History>& runs) {
  if (goes_back(runs) && !first.against.empty()) return first.against;
  return is_level(runs, first.force) ? most_to_see(runs, [](const std::string&) { return true; }) : first.force;
}

/// The most that runs differ by in a response, over its largest value; nothing of a single run, or of unlike steps.
std::optional<double> spread_of(const std::vector<History>& runs, const std::string& response) {
  double most = 0, size = 0;
  const auto first = runs.front().values.find(response);
  for (const auto& run : runs) {
    const auto found = run.values.find(response);
    if (found == run.values.end() || first == runs.front().values.end() || run.times != runs.front().times) return {};
    for (std::size_t i = 0; i < run.times.size(); ++i) {
      most = std::max(most, std::abs(found->second[i] - first->second[i]));
      size = std::max(size, std::abs(first->second[i]));
    }
  }
  return runs.size() > 1 && size > 0 ? std::optional(most / size) : std::nullopt;
}

/// What is to be seen, and what is not.
std::string in_words(const std::vector<History>& runs, const Pair& first, const std::string& over_time, bool has_path) {
  constexpr double hardly = 0.02;  // of the height of a chart: the width of two markers
  std::string out = "Of every step.";
  if (const auto spread = spread_of(runs, over_time); spread && *spread < hardly)
    out += fmt::format(
        " The curves of {} lie on each other: the runs shown at first differ by {} of its largest value "
        "at most.",
        over_time, percent(*spread));
  if (has_path && ends_in_a_loop(runs.front(), first))
    out +=
        " A loop that does not come back along itself is friction's memory: where force and displacement are of the "
        "same place and direction, the area it encloses is the work that friction took; straight lines between "
        "the steps cut its corners, and smaller steps cut less.";
  return out;
}

/// All responses of a run over time, and the forces of `pairs` along their displacements.
void add_run(Figure& figure, const Cell& cell, const History& history, const std::vector<Pair>& pairs,
             std::size_t turn) {
  const json base = base_of_history(cell);
  for (const auto& [name, values] : history.values) {
    json r = base;
    r["panel"] = "time";
    r["response"] = name;
    add_history(figure.rows, r, "time", history.times, values, turn);
  }
  for (const auto& pair : pairs) {
    const auto force = history.values.find(pair.force), way = history.values.find(pair.against);
    if (force == history.values.end() || way == history.values.end()) continue;
    json r = base;
    r["panel"] = "path";
    r["path"] = pair.words();
    r["force"] = pair.force;
    r["against"] = pair.against;
    add_history(figure.rows, r, "displacement", way->second, force->second, turn);
  }
}

}  // namespace

std::optional<Figure> response_histories(const Study& study) {
  constexpr std::size_t most_rows = 8000;
  Figure figure;
  SeriesList series(study);
  figure.id = "response-histories";
  auto shown = telling_cells(study, Furthest::added);
  add_first(series, study, shown);
  const json& kinds = object_at(study.picture, "responses");
  auto pairs = pairs_of(kinds);
  std::vector<History> told;  // of the runs that are shown at first
  double end = 0;
  for (const bool telling : {true, false})
    for (const auto& cell : study.cells) {
      const bool chosen = std::find(shown.begin(), shown.end(), cell.label) != shown.end();
      if (cell.variant != study.main_variant || chosen != telling) continue;
      const History history = history_of(cell, Of::responses);
      const std::size_t rows = history.times.size() * (history.values.size() + pairs.size());
      if (history.times.size() < 2 || (!telling && figure.rows.size() + rows > most_rows)) continue;
      if (told.empty() && pairs.size() > 12) pairs = {widest(pairs, history)};  // else every one can be chosen
      if (telling || told.empty()) told.push_back(history);
      end = std::max(end, history.times.back());
      series.add(in_words(cell), cell.family);
      add_run(figure, cell, history, pairs, 2 * series.place(in_words(cell)));
    }
  if (told.empty()) return std::nullopt;
  for (const auto& peer : study.peers) {
    const History history = history_of(peer, Of::responses);
    if (peer.variant != study.main_variant || history.times.empty()) continue;
    told.push_back(history);
    shown.push_back(peer.label);
    series.add(in_words(peer), peer.family);
    add_run(figure, peer, history, pairs, 2 * series.place(in_words(peer)));
  }
  figure.series = series.list;
  add_given(figure, study, Of::responses, end);
  figure.charts.push_back({.title = "response over time",
                           .x = {"time", time_title(told)},
                           .y = {"value", "{response}"},
                           .tooltip = {{"series", "run"}, {"time", "time"}, {"value", "value"}},
                           .only = "time"});
  const bool has_path = !distinct(figure.rows, "path", "path").empty();
  figure.title =
      has_path ? "Histories: responses over time, and forces along displacements" : "Histories: responses over time";
  const auto clear = without_rounding(told, kinds);
  const Pair first = first_pair(pairs, clear);
  const std::string response = first_over_time(first, clear);
  figure.text = in_words(told, first, response, has_path);
  if (has_path)
    figure.charts.push_back({.title = "force along displacement",
                             .x = {"displacement", "{against}"},
                             .y = {"value", "{force}"},
                             .tooltip = {{"series", "run"}, {"displacement", "displacement"}, {"value", "value"}},
                             .only = "path",
                             .folded = is_level(told, first.force)});
  offer(figure, "Response", "response", response, "time");
  offer(figure, "Path", "path", first.words(), "path");
  offer_cells(figure, shown);
  return figure;
}

}  // namespace stickslip::report
