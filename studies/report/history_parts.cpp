#include "studies/report/history_parts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "studies/report/chart_parts.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// Name and value of each response or derivative of a step.
std::vector<std::pair<std::string, const json*>> values_of(const json& step, Of of) {
  std::vector<std::pair<std::string, const json*>> out;
  if (of == Of::responses) {
    for (const auto& [name, value] : object_at(step, "responses").items()) out.emplace_back(name, &value);
    return out;
  }
  for (const auto& [response, by] : object_at(step, "sensitivities").items())
    for (const auto& [parameter, value] : by.items()) out.emplace_back(derivative_name(response, parameter), &value);
  return out;
}

/// The name, as rows have it, of a given value: "u" of a response, "u/mu" of a derivative; "" of what is not asked for.
std::string given_name(const std::string& key, Of of) {
  const std::size_t slash = key.find('/');
  if (of == Of::responses) return slash == std::string::npos ? key : "";
  return slash == std::string::npos ? "" : derivative_name(key.substr(0, slash), key.substr(slash + 1));
}

/// Takes from the curves of derivatives what is no derivative: where both sides lie apart, they stand in its place.
void take_sides(const json& step, std::size_t place, History& history) {
  if (at(step, "differentiable") != false) return;
  const json& all = object_at(step, "one_sided");
  for (const auto& [response, by] : object_at(step, "sensitivities").items())
    for (const auto& [parameter, unused] : by.items()) {
      const json& sides = at(at(all, response), parameter);
      const auto side = [&](std::size_t k) {
        return sides.is_array() && sides.size() == 2 && sides[k].is_number() ? sides[k].get<double>() : std::nan("");
      };
      history.sides[derivative_name(response, parameter)].push_back({place, side(0), side(1)});
    }
}

/// Drops the sides that a reader would see as one, and ends the curves where there are others.
void keep_what_is_apart(History& history) {
  constexpr double unseen = 1e-6;  // of the height of a curve
  for (auto& [name, sides] : history.sides) {
    auto& values = history.values[name];
    const double size = size_of(values);
    std::erase_if(sides, [&](const DerivativeSides& of) { return std::abs(of.above - of.below) <= unseen * size; });
    for (const DerivativeSides& of : sides) values[of.place] = std::nan("");
  }
}

/// How far a curve goes up and down, over its largest size.
double eventfulness(const std::vector<double>& values) {
  double way = 0, size = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    size = std::max(size, std::abs(values[i]));
    if (i > 0 && std::isfinite(values[i - 1])) way += std::abs(values[i] - values[i - 1]);
  }
  return size > 0 ? way / size : 0;
}

}  // namespace

std::string derivative_name(const std::string& response, const std::string& parameter) {
  return "d " + response + " / d " + parameter;
}

double size_of(const std::vector<double>& values) {
  double size = 0;
  for (const double value : values)
    if (std::isfinite(value)) size = std::max(size, std::abs(value));
  return size;
}

History history_of(const Cell& cell, Of of) {
  constexpr std::size_t most = 400;
  const json& steps = array_at(cell.record, "steps");
  const std::size_t stride = std::max<std::size_t>((steps.size() + most - 1) / most, 1);
  History out;
  for (std::size_t n = 0; n < steps.size(); ++n) {
    const auto found = values_of(steps[n], of);
    if (found.empty() || (steps.size() - 1 - n) % stride != 0) continue;
    out.times.push_back(number_at(steps[n], "time"));
    for (const auto& [name, value] : found) {
      auto& values = out.values[name];
      values.resize(out.times.size() - 1, std::nan(""));
      values.push_back(value->is_number() ? value->get<double>() : std::nan(""));
    }
    if (of == Of::sensitivities) take_sides(steps[n], out.times.size() - 1, out);
  }
  for (auto& [name, values] : out.values) values.resize(out.times.size(), std::nan(""));
  keep_what_is_apart(out);
  return out;
}

bool goes_back(const std::vector<History>& runs) {
  return std::any_of(runs.begin(), runs.end(),
                     [](const History& run) { return !std::is_sorted(run.times.begin(), run.times.end()); });
}

std::string time_title(const std::vector<History>& runs) {
  return goes_back(runs) ? "time, which scales the load" : "time";
}

std::string most_to_see(const std::vector<History>& runs, const std::function<bool(const std::string&)>& passes) {
  constexpr double clearly = 1.01, rounding = 1e-9;  // neither orders curves
  std::string best;
  double most = -1;
  if (runs.empty()) return best;
  for (const auto& [name, unused] : runs.front().values) {
    if (!passes(name)) continue;
    double least = INFINITY;
    for (const auto& run : runs)
      if (const auto found = run.values.find(name); found != run.values.end())
        least = std::min(least, eventfulness(found->second));
    if (best.empty() || least > clearly * most + rounding) {
      most = least;
      best = name;
    }
  }
  return best;
}

json base_of_history(const Cell& cell) {
  json base = row_of(cell);
  base["failed"] = false;
  base["series"] = base["line"] = in_words(cell);
  base["of_cell"] = "yes";
  return base;
}

void add_history(json& rows, const json& base, const char* x_name, const std::vector<double>& x,
                 const std::vector<double>& y, std::size_t turn) {
  const std::size_t stride = std::max<std::size_t>(x.size() / 15, 1);
  std::size_t part = 0;
  bool going = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) {
      part += std::exchange(going, false);
      continue;
    }
    going = true;
    json r = base;
    if (part > 0) r["line"] = text_at(base, "line") + ", part " + std::to_string(part + 1);
    r[x_name] = x[i];
    r["value"] = y[i];
    r["order"] = i;
    const auto is_gap = [&](std::size_t k) { return k < y.size() && !std::isfinite(y[k]); };
    r["unmarked"] = (i + turn) % stride != 0 && !is_gap(i + 1) && !(i > 0 && is_gap(i - 1));
    rows.push_back(r);
  }
}

void add_sides(json& rows, const json& base, const std::vector<double>& times,
               const std::vector<DerivativeSides>& sides) {
  for (const DerivativeSides& of : sides)
    for (const auto& [value, side] : {std::pair(of.below, "from below"), std::pair(of.above, "from above")}) {
      if (!std::isfinite(value)) continue;
      json r = base;
      r["time"] = times[of.place];
      r["value"] = value;
      r["side"] = side;
      r["line"] = text_at(base, "line") + ", " + side + " at step " + std::to_string(of.place);
      r["order"] = 0;
      r["unmarked"] = false;
      rows.push_back(r);
    }
}

void add_given(Figure& figure, const Study& study, Of of, double end) {
  const std::string series = "given value";
  const auto shown = distinct(figure.rows, "response", "time");
  bool any = false;
  for (const auto& entry : array_at(study.description, "reference"))
    for (const auto& [key, value] : object_at(entry, "values").items()) {
      const std::string name = given_name(key, of);
      if (!value.is_number() || std::find(shown.begin(), shown.end(), name) == shown.end()) continue;
      figure.rows.push_back({{"panel", "time"},
                             {"response", name},
                             {"series", series},
                             {"line", series},
                             {"family", ""},
                             {"failed", false},
                             {"time", end},
                             {"value", value},
                             {"order", 0}});
      any = true;
    }
  if (any) figure.series.push_back({series, "$ink", "cross", {1, 0}, 160});
}

}  // namespace stickslip::report
