#include "studies/sweep/error_budget.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace stickslip {
namespace {

using nlohmann::json;

/// Orders outside are those of no element and no integration in time here: 1 to 2 of steps, 1 to 4 of meshes, and some
/// room for what is not yet quite asymptotic.
constexpr double least_order = 0.5, most_order = 4.5;

}  // namespace

BudgetPart mean_of(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  double sum = 0, squares = 0;
  for (const double value : values) sum += value;
  for (const double value : values) squares += (value - sum / count) * (value - sum / count);
  return {sum / count, std::sqrt(squares / (count - 1) / count), std::nullopt, ""};
}

BudgetPart beyond_limit(double at_h, double at_half, double at_quarter, double noise) {
  const double first = at_h - at_half, second = at_half - at_quarter;
  if (std::abs(second) <= noise)  // what is left has been gone over in the first halving, or there is nothing
    return {first + second, noise, std::nullopt, ""};
  const double ratio = first / second, order = ratio > 0 ? std::log2(ratio) : 0;
  if (!(order >= least_order && order <= most_order))
    return BudgetPart::unknown(fmt::format(
        "two halvings change it by {:.2g} and {:.2g}, no power of the size: it is not in its asymptotic range", -first,
        -second));
  return {first + second + second / (ratio - 1), noise, order, ""};
}

json to_json(const Budget& budget) {
  json parts = json::object(), without = json::array();
  double sum = 0, squares = 0;
  for (const auto& [name, part] : budget.parts) {
    json& entry = parts[name];
    entry["value"] = part.value ? json(*part.value / budget.scale) : json();
    if (part.value) entry["noise"] = part.noise / budget.scale;
    if (part.order) entry["order"] = *part.order;
    if (!part.reason.empty()) entry["reason"] = part.reason;
    if (part.shared) {
      entry["shared"] = true;
      continue;
    }
    if (part.value)
      sum += *part.value / budget.scale;
    else
      without.push_back(name);
    squares += part.noise * part.noise;
  }
  json out = {{"scale", budget.scale},
              {"parts", parts},
              {"sum", sum},
              {"noise", std::sqrt(squares) / budget.scale},
              {"error", nullptr},
              {"interaction", nullptr},
              {"without", without}};
  if (budget.error) {
    out["error"] = *budget.error / budget.scale;
    out["interaction"] = *budget.error / budget.scale - sum;
  }
  return out;
}

}  // namespace stickslip
