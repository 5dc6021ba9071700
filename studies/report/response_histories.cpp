#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "studies/report/chart_parts.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// Responses of one run over its steps; not a number where a step has none.
struct History {
  std::vector<double> times;
  std::map<std::string, std::vector<double>> values;  ///< by response, one a step
};

History history_of(const Cell& cell) {
  constexpr std::size_t most = 400;
  const json& steps = array_at(cell.record, "steps");
  const std::size_t stride = std::max<std::size_t>((steps.size() + most - 1) / most, 1);
  History out;
  for (std::size_t n = 0; n < steps.size(); ++n) {
    const json& responses = object_at(steps[n], "responses");
    if (responses.empty() || (steps.size() - 1 - n) % stride != 0) continue;  // the last step is always there
    out.times.push_back(number_at(steps[n], "time"));
    for (const auto& [name, value] : responses.items()) {
      auto& values = out.values[name];
      values.resize(out.times.size() - 1, std::nan(""));
      values.push_back(value.is_number() ? value.get<double>() : std::nan(""));
    }
  }
  for (auto& [name, values] : out.values) values.resize(out.times.size(), std::nan(""));
  return out;
}

/// A force and the displacement it is drawn against.
struct Pair {
  std::string force, against;
  std::string words() const { return force + " against " + against; }
};

/// What kind each response is of, as picture.json has it.
std::vector<Pair> pairs_of(const json& kinds) {
  std::vector<std::string> forces, ways;
  for (const auto& [name, kind] : kinds.items()) {
    if (kind == "reaction" || kind == "contact_force") forces.push_back(name);
    if (kind == "displacement" || kind == "slip") ways.push_back(name);
  }
  std::vector<Pair> out;
  for (const auto& way : ways)
    for (const auto& force : forces) out.push_back({force, way});
  return out;
}

/// The area that the path encloses with the chord from its end to its beginning, as a share of the box around it: what
/// tells a loop from a line. 0 where it has no extent.
double openness(const std::vector<double>& x, const std::vector<double>& y) {
  double twice = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::size_t next = (i + 1) % x.size();
    twice += x[i] * y[next] - x[next] * y[i];
  }
  const auto [left, right] = std::minmax_element(x.begin(), x.end());
  const auto [low, high] = std::minmax_element(y.begin(), y.end());
  const double box = (*right - *left) * (*high - *low);
  return box > 0 && std::isfinite(twice) ? std::abs(twice) / 2 / box : 0;
}

/// The pair whose path is least like a line; of none, the first.
Pair widest(const std::vector<Pair>& pairs, const History& history) {
  Pair best = pairs.front();
  double most = -1;
  for (const auto& pair : pairs) {
    const auto force = history.values.find(pair.force), way = history.values.find(pair.against);
    if (force == history.values.end() || way == history.values.end()) continue;
    if (const double area = openness(way->second, force->second); area > most) {
      most = area;
      best = pair;
    }
  }
  return best;
}

void add_rows(json& rows, const json& base, const char* x_name, const std::vector<double>& x,
              const std::vector<double>& y, std::size_t turn) {
  // Curves that coincide stay readable when each marks other points.
  const std::size_t stride = std::max<std::size_t>(x.size() / 15, 1);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) continue;
    json r = base;
    r[x_name] = x[i];
    r["value"] = y[i];
    r["order"] = i;
    r["unmarked"] = (i + turn) % stride != 0;
    rows.push_back(r);
  }
}

/// All responses of a run over time, and the forces of `pairs` along their displacements.
void add_run(Figure& figure, const Cell& cell, const History& history, const std::vector<Pair>& pairs,
             std::size_t turn) {
  json base = row_of(cell);
  base["failed"] = false;  // a curve like any other; its name tells the status
  base["series"] = base["line"] = in_words(cell);
  base["of_cell"] = "yes";
  for (const auto& [name, values] : history.values) {
    json r = base;
    r["panel"] = "time";
    r["response"] = name;
    add_rows(figure.rows, r, "time", history.times, values, turn);
  }
  for (const auto& pair : pairs) {
    const auto force = history.values.find(pair.force), way = history.values.find(pair.against);
    if (force == history.values.end() || way == history.values.end()) continue;
    json r = base;
    r["panel"] = "path";
    r["path"] = pair.words();
    r["force"] = pair.force;
    r["against"] = pair.against;
    add_rows(figure.rows, r, "displacement", way->second, force->second, turn);
  }
}

/// What the study says the responses are at the end, as marks.
void add_given(Figure& figure, const Study& study, double end) {
  const std::string name = "given value";
  bool any = false;
  for (const auto& entry : array_at(study.description, "reference"))
    for (const auto& [response, value] : object_at(entry, "values").items()) {
      const auto shown = distinct(figure.rows, "response", "time");
      if (!value.is_number() || std::find(shown.begin(), shown.end(), response) == shown.end()) continue;
      figure.rows.push_back({{"panel", "time"},
                             {"response", response},
                             {"series", name},
                             {"line", name},
                             {"family", ""},
                             {"failed", false},
                             {"time", end},
                             {"value", value},
                             {"order", 0}});
      any = true;
    }
  if (any) figure.series.push_back({name, "$ink", "cross", {1, 0}, 160});
}

}  // namespace

std::optional<Figure> response_histories(const Study& study) {
  constexpr std::size_t most_rows = 8000;
  Figure figure;
  SeriesList series(study);
  figure.id = "response-histories";
  const auto shown = telling_cells(study, Furthest::added);
  add_first(series, study, shown);
  auto pairs = pairs_of(object_at(study.picture, "responses"));
  std::optional<History> first;
  double end = 0;
  for (const bool telling : {true, false})
    for (const auto& cell : study.cells) {
      const bool chosen = std::find(shown.begin(), shown.end(), cell.label) != shown.end();
      if (cell.variant != study.main_variant || chosen != telling) continue;
      const History history = history_of(cell);
      const std::size_t rows = history.times.size() * (history.values.size() + pairs.size());
      if (history.times.size() < 2 || (!telling && figure.rows.size() + rows > most_rows)) continue;
      if (!first) {
        first = history;
        if (pairs.size() > 12) pairs = {widest(pairs, history)};  // else every one can be chosen
      }
      end = std::max(end, history.times.back());
      series.add(in_words(cell), cell.family);
      add_run(figure, cell, history, pairs, 2 * series.place(in_words(cell)));
    }
  if (!first) return std::nullopt;
  figure.series = series.list;
  add_given(figure, study, end);
  const auto tips = [](const char* x, const char* title) {
    return tooltip({{"series", "run"}, {x, title}, {"value", "value"}});
  };
  json over_time = curves("Response over time", channel("time", "time", false), channel("value", "{response}", false),
                          tips("time", "time"));
  over_time["transform"] = only_if("datum.panel == 'time'");
  figure.panels.push_back({"response over time", over_time, "time", "value", false, false, "time", false});
  const bool has_path = !distinct(figure.rows, "path", "path").empty();
  figure.title =
      has_path ? "Histories: responses over time, and forces along displacements" : "Histories: responses over time";
  figure.text =
      "Of every step. A path that does not come back along itself is friction's memory: the area it encloses "
      "is the work that friction took.";
  if (!has_path) figure.text = "Of every step.";
  const Pair widest_pair = pairs.empty() ? Pair{} : widest(pairs, *first);
  if (has_path) {
    json path = curves("Force along displacement", channel("displacement", "{against}", false),
                       channel("value", "{force}", false), tips("displacement", "displacement"));
    path["transform"] = only_if("datum.panel == 'path'");
    figure.panels.push_back({"force along displacement", path, "displacement", "value", false, false, "path", false});
  }
  offer(figure, "Response", "response", widest_pair.force, "time");
  offer(figure, "Path", "path", widest_pair.words(), "path");
  offer_cells(figure, shown);
  return figure;
}

}  // namespace stickslip::report
