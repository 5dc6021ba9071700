#include "studies/run/gradient_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "studies/io/input_fault.hpp"

namespace stickslip {

using nlohmann::json;

GradientCheck check_gradients(const Simulation& simulation, const std::string& name,
                              const std::function<void(int, int)>& progress) {
  const auto& model = simulation.problem->model;
  if (model.scene.parameters.empty() || model.scene.responses.empty())
    throw InputFault(name + ": gradcheck needs parameters and responses");
  RunOptions options = run_options(simulation.input);
  options.state_memory = std::numeric_limits<double>::infinity();  // (it reads the states of all steps)
  return check_gradients(model, simulation.input.method, options, progress);
}

namespace {

const char* side_of(const GradientCheck::Entry& entry) {
  return entry.side == 0 ? "both" : entry.side < 0 ? "below" : "above";
}

/// Verdict in words: of which side, or how many steps were not checked.
std::string verdict_of(const GradientCheck::Entry& entry) {
  static const char* const verdicts[] = {"agrees", "DIFFERS", "not checked", "not determined by equilibrium"};
  std::string text = verdicts[static_cast<int>(entry.verdict)];
  if (entry.side != 0) text += fmt::format(" from {}", side_of(entry));
  if (entry.verdict == GradientCheck::Verdict::not_checked && entry.unchecked < entry.steps)
    text =
        fmt::format("not checked: {} of {} steps, from t = {:g} on", entry.unchecked, entry.steps, entry.unchecked_at);
  if (entry.undetermined > 0 && entry.steps > 0)
    text += fmt::format(", in {} steps not determined by equilibrium", entry.undetermined);
  return text;
}

}  // namespace

json check_json(const GradientCheck& check) {
  static const char* const verdicts[] = {"agrees", "differs", "not checked", "undetermined"};
  json entries = json::array();
  for (const auto& e : check.entries)
    entries.push_back({{"response", e.response},
                       {"parameter", e.parameter},
                       {"time", e.time},
                       {"side", side_of(e)},
                       {"computed", e.computed},
                       {"difference", e.difference},
                       {"error", e.error},
                       {"estimate", e.estimate},
                       {"allowed", e.allowed},
                       {"scale", e.scale},
                       {"step", e.step},
                       {"steps", e.steps},
                       {"unchecked", e.unchecked},
                       {"unchecked_at", e.unchecked > 0 ? json(e.unchecked_at) : json(nullptr)},
                       {"undetermined", e.undetermined},
                       {"verdict", verdicts[static_cast<int>(e.verdict)]}});
  return {{"status", name_of(check.status)}, {"message", check.message},
          {"passed", check.passed()},        {"runs", check.runs},
          {"rejected", check.rejected},      {"entries", entries}};
}

std::string check_table(const GradientCheck& check) {
  std::string text =
      fmt::format("{} difference runs, {} of them through other contact states\n", check.runs, check.rejected);
  text += fmt::format("{:<16} {:<12} {:>9} {:>18} {:>18} {:>9} {:>9}  {}\n", "response", "parameter", "time",
                      "computed", "difference", "error", "allowed", "verdict");
  for (const auto& e : check.entries)
    text += fmt::format("{:<16} {:<12} {:>9.4g} {:>18.10e} {:>18.10e} {:>9.1e} {:>9.1e}  {}\n", e.response, e.parameter,
                        e.time, e.computed, e.difference, e.error, e.allowed, verdict_of(e));
  return text + "error and allowed are relative to the largest derivative of the run (or response / parameter)\n";
}

std::string check_faults(const GradientCheck& check) {
  if (check.passed()) return "";
  if (check.entries.empty()) return fmt::format("{}: {}\n", name_of(check.status), check.message);
  const auto count = [&](GradientCheck::Verdict verdict) {
    return std::count_if(check.entries.begin(), check.entries.end(),
                         [&](const auto& entry) { return entry.verdict == verdict; });
  };
  std::string text;
  if (const auto differ = count(GradientCheck::Verdict::differs); differ > 0)
    text += fmt::format("{} of {} derivatives differ\n", differ, check.entries.size());
  if (const auto unchecked = count(GradientCheck::Verdict::not_checked); unchecked > 0)
    text += fmt::format(
        "{} of {} derivatives are not checked: no difference step gives them to three digits, as of what is zero but "
        "for rounding, or near a change of contact states\n",
        unchecked, check.entries.size());
  return text;
}

}  // namespace stickslip
