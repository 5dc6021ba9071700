#include "studies/report/history_parts.hpp"

#include <algorithm>
#include <cmath>

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
  }
  for (auto& [name, values] : out.values) values.resize(out.times.size(), std::nan(""));
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
