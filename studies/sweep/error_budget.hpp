/// Arithmetic of the error budget: what the difference of an answer from the exact one is made of, each part signed and
/// measured by runs of its own. Which runs these are: studies/sweep/budget_runs.hpp.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stickslip {

/// One part of a budget.
struct BudgetPart {
  std::optional<double> value;  ///< none: it could not be measured
  double noise = 0;             ///< what rounding leaves uncertain of the value
  std::optional<double> order;  ///< observed, of a limit
  std::string reason;           ///< why there is no value, or why it is what it is without a run
  bool shared = false;          ///< the reference has this part too, so the error against it has not

  static BudgetPart unknown(std::string reason) { return {std::nullopt, 0, std::nullopt, std::move(reason)}; }
};

/// The mean of what several runs give, each rounded in its own way, with its standard error as noise. pre: at least
/// two.
BudgetPart mean_of(const std::vector<double>& values);

/// f(h) minus the limit of f, from f(h), f(h/2) and f(h/4). Where both differences are noise, h does not matter; else
/// they must fall as a power of h between 1/2 and 9/2, whose series is summed. No value where they do not: there is no
/// saying where such values go.
BudgetPart beyond_limit(double at_h, double at_half, double at_quarter, double noise);

/// What makes up an error, in the order in which it is shown.
struct Budget {
  std::vector<std::pair<std::string, BudgetPart>> parts;  ///< by name
  std::optional<double> error;                            ///< against a reference; none: there is none
  double scale = 1;                                       ///< all numbers are divided by it. pre: > 0
};

/// {"scale", "error", "parts": {NAME: {"value", "noise", "order", "reason", "shared"}}, "sum", "noise", "interaction",
/// "without"}: `sum` is that of the parts with a value, but those that the reference shares; `noise` its own,
/// `interaction` what it leaves of the error, `without` the parts that it lacks, which the interaction then holds too.
nlohmann::json to_json(const Budget& budget);

}  // namespace stickslip
