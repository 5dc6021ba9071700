#include "studies/report/disagreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "studies/io/result_rows.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using report::at, report::array_at, report::number_at, report::object_at, report::text_at;

constexpr double negligible = 1e-5;  // of a response: results that differ by less are alike
constexpr double headroom = 10;      // a response may be off by more than the error of a point
constexpr double rounding = 1e-9;    // of the size of its kind, as KktScales has it

/// What a row says of one response.
struct Answer {
  const json* row;
  double value = 0, error = 0, scale = 0;
};

/// What the method was asked to reach: 1e-4 of {"uzawa_al": {"tolerance": 1e-4}}; 0 without one.
double tolerance_of(const json& row) {
  const json& method = object_at(row, "method");
  return method.empty() ? 0 : number_at(method.front(), "tolerance");
}

/// The largest method-blind error, or the tolerance of the method, as errors of many steps may add up; nothing if the
/// row has no errors.
std::optional<double> error_of(const json& row) {
  const json& kkt = at(at(row, "errors"), "kkt");
  if (kkt.is_null()) return std::nullopt;
  double largest = tolerance_of(row);
  for (const json& error : kkt)
    if (error.is_number()) largest = std::max(largest, error.get<double>());
  return largest;
}

/// Two answers that differ by more than what is explained, `times` as much.
struct Pair {
  const Answer *a = nullptr, *b = nullptr;
  double apart = 0, explained = 0, times = 1;
};

/// The pair of answers with the largest excess; none if all agree.
Pair worst_pair(const std::vector<Answer>& answers) {
  double size = 0, scale = 0;
  for (const auto& answer : answers) {
    size = std::max(size, std::abs(answer.value));
    scale = std::max(scale, answer.scale);
  }
  Pair worst;
  for (std::size_t i = 0; i < answers.size(); ++i)
    for (std::size_t k = i + 1; k < answers.size(); ++k) {
      const Answer &a = answers[i], &b = answers[k];
      const double apart = std::abs(a.value - b.value);
      const double explained =
          std::max({negligible * size, headroom * (a.error + b.error) * std::max(size, scale), rounding * scale});
      if (apart > worst.times * explained) worst = {&a, &b, apart / size, explained / size, apart / explained};
    }
  return worst;
}

std::string share(double x) { return x < 1e-3 ? fmt::format("{:.1g}", x) : fmt::format("{:.2g} %", 100 * x); }

/// "penalty stiffness=10"; of a row without a label its method.
std::string label_of(const json& row) {
  const std::string label = text_at(row, "label");
  const json& method = object_at(row, "method");
  return !label.empty() || method.empty() ? label : method.begin().key();
}

/// Codes of warnings that may say why two runs differ.
std::string reasons(const Pair& pair) {
  static const std::set<std::string> known = {"non_unique",   "branch_ends",    "cut_steps",
                                              "soft_penalty", "folded_element", "unstable"};
  std::set<std::string> codes;
  for (const auto* answer : {pair.a, pair.b})
    for (const json& warning : array_at(*answer->row, "warnings"))
      if (const std::string code = text_at(warning, "code"); known.count(code)) codes.insert(code);
  return fmt::format("{}", fmt::join(codes, ", "));
}

}  // namespace

std::vector<std::string> disagreements(const std::vector<const json*>& rows) {
  std::map<std::string, std::map<std::string, std::vector<Answer>>> answers;  // by response and variant
  for (const json* row : rows) {
    const auto error = error_of(*row);
    if (!converged(*row) || !error) continue;
    for (const auto& [name, value] : object_at(*row, "responses").items())
      if (value.is_number() && std::isfinite(value.get<double>()))
        answers[name][variant_text(*row)].push_back({row, value, *error, number_at(at(*row, "scales"), name)});
  }
  std::vector<std::string> sentences;
  for (const auto& [name, by_variant] : answers) {
    Pair worst;
    std::string where;
    for (const auto& [variant, all] : by_variant)
      if (const Pair pair = worst_pair(all); pair.times > worst.times) {
        worst = pair;
        where = variant;
      }
    if (!worst.a) continue;
    const std::string warned = reasons(worst);
    sentences.push_back(
        fmt::format("Runs disagree about {}{}: {:.6g} by {}, {:.6g} by {}. They are {} apart, and their errors explain "
                    "{}: they are "
                    "different solutions, or one is wrong; {}.",
                    name, where.empty() ? "" : " for " + where, worst.a->value, label_of(*worst.a->row), worst.b->value,
                    label_of(*worst.b->row), share(worst.apart), share(worst.explained),
                    warned.empty() ? "smaller steps may tell which" : "they warn of " + warned));
  }
  return sentences;
}

}  // namespace stickslip
