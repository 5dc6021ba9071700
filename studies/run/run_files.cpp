#include "studies/run/run_files.hpp"

#include <nlohmann/json.hpp>

#include "studies/io/atomic_file.hpp"
#include "studies/io/input_fault.hpp"
#include "studies/io/printing.hpp"
#include "studies/run/fields.hpp"
#include "studies/run/solution_file.hpp"

namespace stickslip {

OutputFolder folder_of_run(const std::filesystem::path& directory, const std::vector<std::string>& others,
                           const Caller& caller) {
  if (holds(directory, "study.json"))
    throw InputFault(directory.string() + ": holds a study; " + caller.directory + " writes to another directory");
  std::vector<std::string> names(others);
  names.insert(names.end(), {"result.json", "solution.json"});
  names.insert(names.end(), std::begin(field_names), std::end(field_names));
  return {directory, names};
}

void remove_run(const std::filesystem::path& directory) {
  remove_outputs(directory, {"result.json", "solution.json", "fields.pvd", "fields_#.vtu", "obstacles_#.vtu",
                             "picture.json", "certificate.json", "report.html", "figures/*", "trace.csv", "cones.svg"});
}

void write_fields(const std::filesystem::path& directory, const CaseResult& result, int every) {
  for_each_field(result, every,
                 [&](const std::string& name, const std::string& text) { write_output(directory / name, text); });
}

/// Writes solution.json, or nothing where it would be too large; returns what result.json says of it.
nlohmann::json write_solution(const std::filesystem::path& directory, const Simulation& simulation,
                              const CaseResult& result, Written& written) {
  const Stopwatch time(written.seconds);
  const auto [text, left_out] = solution_file(result, simulation.input.document);
  if (!left_out.empty()) return {{"left_out", left_out}};
  write_output(directory / "solution.json", text);
  written.solution = static_cast<double>(text.size());
  ++written.files;
  return {{"file", "solution.json"}};
}

nlohmann::json write_result(const std::filesystem::path& directory, const Simulation& simulation,
                            const CaseResult& result, const Written& before) {
  Written written = before;
  const int every = simulation.input.fields_every;
  {
    const Stopwatch time(written.seconds);
    write_fields(directory, result, every);
  }
  const auto fields = field_files(result, every);
  written.files += static_cast<long>(fields.size());
  written.fields = file_bytes(directory, fields);
  const auto solution = write_solution(directory, simulation, result, written);
  auto document = result_json(simulation, result);
  document["solution"] = solution;
  document["cost"]["seconds"]["output"] = written.seconds;
  document["ledger"] = ledger_json(ledger(result, written));
  write_output(directory / "result.json", json_text(document, 2) + "\n");
  return document;
}

double file_bytes(const std::filesystem::path& directory, const std::vector<std::string>& files) {
  double bytes = 0;
  for (const auto& file : files) bytes += static_cast<double>(std::filesystem::file_size(directory / file));
  return bytes;
}

std::vector<std::string> result_files(const Simulation& simulation, const CaseResult& result) {
  std::vector<std::string> files{"result.json"};
  for (auto& file : field_files(result, simulation.input.fields_every)) files.push_back(std::move(file));
  return files;
}

}  // namespace stickslip
