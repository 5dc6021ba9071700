/// The files that a run leaves in its folder.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/io/caller.hpp"
#include "studies/io/output_folder.hpp"
#include "studies/run/ledger.hpp"
#include "studies/run/simulation.hpp"

namespace stickslip {

/// The folder of a run, for result.json, fields and `others`. Throws what OutputFolder throws, and InputFault if it
/// holds a study.
OutputFolder folder_of_run(const std::filesystem::path& directory, const std::vector<std::string>& others = {},
                           const Caller& caller = command_line);

/// Deletes what an earlier run left, which would mix with the files of the next.
void remove_run(const std::filesystem::path& directory);

/// Writes the files of for_each_field() (write_output).
void write_fields(const std::filesystem::path& directory, const CaseResult& result, int every);

/// Writes DIR/fields.pvd with its .vtu files, DIR/solution.json where it is not too large, and then DIR/result.json
/// (write_output). Returns the content of result.json (docs/results.md). `before`: files already written, for its
/// ledger. Throws std::system_error if writing fails. pre: remove_run()
nlohmann::json write_result(const std::filesystem::path& directory, const Simulation& simulation,
                            const CaseResult& result, const Written& before = {});

/// Bytes of files in a directory.
double file_bytes(const std::filesystem::path& directory, const std::vector<std::string>& files);

/// Names of the files that write_result writes, but for solution.json, of which result.json says whether it is there.
std::vector<std::string> result_files(const Simulation& simulation, const CaseResult& result);

}  // namespace stickslip
