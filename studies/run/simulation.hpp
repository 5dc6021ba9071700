/// From a scene, as a file or in memory, to its result: the way that the command line, the Python module and the
/// programs of others share.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "studies/input/scene_reader.hpp"
#include "studies/run/ledger.hpp"

namespace stickslip {

/// A scene that was read without a fault, and the problem it makes.
struct Simulation {
  Input input;
  std::shared_ptr<const Problem> problem;
};

/// Reads a scene and makes its problem: `overrides` are "POINTER=VALUE" each, `method` replaces the scene's. None where
/// there is a fault; all of them are in the diagnostics, those of the scene as a whole too.
std::optional<Simulation> prepare(const JsonDocument& document, const Overrides& overrides,
                                  const std::optional<std::string>& method, Diagnostics& diagnostics);
std::optional<Simulation> prepare(const std::string& file, const Overrides& overrides,
                                  const std::optional<std::string>& method, Diagnostics& diagnostics);

/// Throws ModelError, with the bytes and what to try, where a run would need more memory than there is.
void check_memory(const Problem& problem, const Input& input);

/// What the scene says of how to solve it.
RunOptions run_options(const Input& input);

/// Runs it. `on_step` is called after each step that the scene asks for; what it throws ends the run. `trace`, where it
/// is there, gathers every iterate.
CaseResult simulate(const Simulation& simulation, const std::function<void()>& on_step = {}, Trace* trace = nullptr);

/// Makes the directory of a run, and of its `report`, ready to be written to. Throws InputFault where it holds a study
/// or cannot be written to.
void prepare_run_directory(const std::filesystem::path& directory, bool report = false);

/// Removes the fields_NNNN.vtu of an earlier run, which would stand beside those of the next.
void remove_fields(const std::filesystem::path& directory);

/// Writes DIR/result.json and DIR/fields.pvd with its .vtu files, in place of an earlier run's; returns the former
/// (docs/results.md), whose ledger has the files `before` that were written already. Throws std::system_error where the
/// disk refuses.
nlohmann::json write_result(const std::filesystem::path& directory, const Simulation& simulation,
                            const CaseResult& result, const Written& before = {});

/// Bytes of files in a directory.
double file_bytes(const std::filesystem::path& directory, const std::vector<std::string>& files);

/// Names of the files that write_result writes.
std::vector<std::string> result_files(const Simulation& simulation, const CaseResult& result);

}  // namespace stickslip
