/// What the charts over time share: the values of a run's steps, and the rows made of them.
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "studies/report/charts.hpp"

namespace stickslip::report {

/// Both sides of a derivative at a step that is not differentiable; not a number where a side has none.
struct DerivativeSides {
  std::size_t place;  ///< in History::times
  double below, above;
};

/// Responses, or derivatives named "d RESPONSE / d PARAMETER", of one run over its steps.
struct History {
  std::vector<double> times;
  std::map<std::string, std::vector<double>> values;  ///< by name, one a step; not a number where a step has none
  std::map<std::string, std::vector<DerivativeSides>> sides;  ///< by name, of derivatives: where the two differ
};

/// The largest of the values that are numbers, by its size.
double size_of(const std::vector<double>& values);

/// Of at most 400 steps, evenly spaced, the last among them.
History history_of(const Cell& cell, Of of);

/// "d RESPONSE / d PARAMETER".
std::string derivative_name(const std::string& response, const std::string& parameter);

/// Whether some run goes back in time, as a path by arc length does: its time scales the load.
bool goes_back(const std::vector<History>& runs);

/// The title of the axis of time.
std::string time_title(const std::vector<History>& runs);

/// Of the names that pass, the one whose curve goes furthest up and down over its largest size; by the run in which it
/// does so least, since what only some runs show may be rounding. Of equals the first; "" where none passes.
std::string most_to_see(const std::vector<History>& runs, const std::function<bool(const std::string&)>& passes);

/// What every row of a run's curves has. A failed run is a curve like any other; its name tells the status.
nlohmann::json base_of_history(const Cell& cell);

/// Rows along a curve: `base` with x under `x_name` and y under `value`. Curves of unlike `turn` mark unlike points, so
/// that those which coincide stay readable. A curve ends where y is not a number, and another begins behind it.
void add_history(nlohmann::json& rows, const nlohmann::json& base, const char* x_name, const std::vector<double>& x,
                 const std::vector<double>& y, std::size_t turn);

/// Rows of the sides of a derivative: points that are on no curve, with the side in words under `side`.
void add_sides(nlohmann::json& rows, const nlohmann::json& base, const std::vector<double>& times,
               const std::vector<DerivativeSides>& sides);

/// Marks at the end of time what the study gives as exact, of the names that the rows of the panel "time" have under
/// `response`.
void add_given(Figure& figure, const Study& study, Of of, double end);

}  // namespace stickslip::report
