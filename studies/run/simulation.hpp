/// Simulation: from a scene, as a file or in memory, to its result. The command line, the Python module and programs
/// that use the library share it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "studies/input/scene_reader.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// A scene that was read without a fault, and its problem.
struct Simulation {
  Input input;
  std::shared_ptr<const Problem> problem;
  std::vector<int> order;  ///< indices of the parameters, in the order in which the scene names them
};

/// Simulation::order of a scene as it is written; parameters that it does not name, as they were set, are the last. A
/// node of a shape NAME is NAME/0, NAME/1, ...
std::vector<int> order_of(const std::vector<Parameter>& parameters, const JsonDocument& scene);

/// Reads a scene and makes its problem. None if there is a fault; the diagnostics then have all faults. `overrides`:
/// "POINTER=VALUE" each; `method`: replaces that of the scene.
std::optional<Simulation> prepare(const JsonDocument& document, const Overrides& overrides,
                                  const std::optional<std::string>& method, Diagnostics& diagnostics);
std::optional<Simulation> prepare(const std::string& file, const Overrides& overrides,
                                  const std::optional<std::string>& method, Diagnostics& diagnostics);

/// What is factorised where the run is not condensed.
SystemKind kind_of(const Input& input, const Model& model);

/// Bytes that a run needs, as estimated before it (studies/input/size_estimate.hpp).
double needed_bytes(const Problem& problem, const Input& input);

/// Throws ModelError if a run would need more memory than there is. The message has the bytes and what to try.
void check_memory(const Problem& problem, const Input& input);

/// Options of the run, from the scene.
RunOptions run_options(const Input& input);

/// Result of a run. `on_step` is called after each step of the scene; an exception from it ends the run. `trace`:
/// records every iterate; nullptr: none.
CaseResult simulate(const Simulation& simulation, const std::function<void()>& on_step = {}, Trace* trace = nullptr);

/// result.json of a simulation.
nlohmann::json result_json(const Simulation& simulation, const CaseResult& result);

}  // namespace stickslip
