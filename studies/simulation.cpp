#include "studies/simulation.hpp"

#include <nlohmann/json.hpp>

#include "studies/atomic_file.hpp"
#include "studies/fields.hpp"

namespace stickslip {
namespace {

int fields_every(const OutputOptions& output) {
  switch (output.fields) {
    case OutputOptions::Fields::last:
      return 0;
    case OutputOptions::Fields::all:
      return 1;
    case OutputOptions::Fields::every:
      return output.every;
  }
  return 0;
}

}  // namespace

std::optional<Simulation> prepare(const JsonDocument& document, const Overrides& overrides,
                                  const std::optional<std::string>& method, Diagnostics& diagnostics) {
  auto input = read_scene(document, overrides, method, diagnostics);
  if (!input) return std::nullopt;
  try {
    auto problem = std::make_shared<const Problem>(input->scene);
    return Simulation{std::move(*input), problem};
  } catch (const ModelError& error) {
    diagnostics.error({document.place(error.pointer), error.pointer, error.what()});
    return std::nullopt;
  }
}

std::optional<Simulation> prepare(const std::string& file, const Overrides& overrides,
                                  const std::optional<std::string>& method, Diagnostics& diagnostics) {
  const auto document = JsonDocument::read(file, diagnostics);
  return document ? prepare(*document, overrides, method, diagnostics) : std::nullopt;
}

RunOptions run_options(const Input& input) { return {input.linear_algebra, input.backend, {}, {}}; }

CaseResult simulate(const Simulation& simulation, const std::function<void()>& on_step, Trace* trace) {
  auto options = run_options(simulation.input);
  options.on_step = on_step;
  options.trace = trace;
  std::shared_ptr<Condensation<double>> condensation;
  return run_case(simulation.problem, simulation.input.method, options, condensation);
}

nlohmann::json write_result(const std::filesystem::path& directory, const Simulation& simulation,
                            const CaseResult& result) {
  double seconds = 0;
  {
    const Stopwatch time(seconds);
    write_fields(directory, result, fields_every(simulation.input.output));
  }
  auto document = result_json(result, canonical_text(simulation.input));
  document["cost"]["seconds"]["output"] = seconds;
  write_file_atomically(directory / "result.json", document.dump(2) + "\n");
  return document;
}

}  // namespace stickslip
