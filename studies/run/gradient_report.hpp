/// Comparison of the derivatives of a scene with differences, and its result as JSON and in words.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sensitivity/gradcheck.hpp"
#include "studies/run/simulation.hpp"

namespace stickslip {

/// Checks every derivative of the scene. `progress(done, total)` is called after each run; an exception from it ends
/// the check. Throws InputFault, with `name` for the scene, if the scene has no parameters or no responses.
GradientCheck check_gradients(const Simulation& simulation, const std::string& name,
                              const std::function<void(int, int)>& progress = {});

/// {"status", "message", "passed", "runs", "rejected", "entries": [{"response", "parameter", "time", "computed",
/// ...}]}.
nlohmann::json check_json(const GradientCheck& check);

/// Text: number of runs, one line per entry, and the scales of `error` and `allowed`.
std::string check_table(const GradientCheck& check);

/// Why the check did not pass, in one or two lines; "": it passed.
std::string check_faults(const GradientCheck& check);

}  // namespace stickslip
