/// Derivatives of a scene held against differences, and what came out as JSON and in words.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sensitivity/gradcheck.hpp"
#include "studies/run/simulation.hpp"

namespace stickslip {

/// Checks every derivative of the scene; `progress(done, total)` is called after each run, and what it throws ends the
/// check. Throws InputFault, which names the scene by `name`, where it has no parameters or no responses.
GradientCheck check_gradients(const Simulation& simulation, const std::string& name,
                              const std::function<void(int, int)>& progress = {});

/// {"status", "message", "passed", "runs", "rejected", "entries": [{"response", "parameter", "time", "computed",
/// ...}]}.
nlohmann::json check_json(const GradientCheck& check);

/// How many runs it took, a line an entry, and what error and allowed are relative to.
std::string check_table(const GradientCheck& check);

/// Why it did not pass, in one or two lines; "" where it did.
std::string check_faults(const GradientCheck& check);

}  // namespace stickslip
