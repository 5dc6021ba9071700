#include "studies/run/simulation.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "methods/engine_choice.hpp"
#include "studies/input/size_estimate.hpp"
#include "studies/io/atomic_file.hpp"
#include "studies/io/input_fault.hpp"
#include "studies/io/printing.hpp"
#include "studies/run/fields.hpp"

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
    check_memory(*problem, *input);
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

void check_memory(const Problem& problem, const Input& input) {
  using Engine = LinearAlgebra::Engine;
  const auto& model = problem.model;
  const Engine engine = input.linear_algebra.engine;
  const double limit = memory_limit();
  ProblemSize size{static_cast<double>(model.free_dofs.size()),
                   static_cast<double>(model.contact_nodes.size()) * model.dimension,
                   static_cast<double>(model.points.size()), 0, false};
  if (estimated_bytes(size) > limit)
    throw ModelError("the bodies need " + too_much(estimated_bytes(size), limit) + "; try fewer cells", "/bodies");
  size.condensed = true;  // or so: to find out takes an analysis, which is made where it matters
  bool is_known = false;
  const auto is_too_much = [&] {
    if (estimated_bytes(size) > limit && !std::exchange(is_known, true))
      size.condensed = condenses(model, input.method, engine);
    return estimated_bytes(size) > limit;
  };
  if (is_too_much())
    throw ModelError("the bodies, condensed to " + shown(size.contact_dofs) + " contact dofs, need " +
                         too_much(estimated_bytes(size), limit) + R"(; try {"engine": "sparse"}, or fewer cells)",
                     engine == Engine::condensed ? "/linear_solver/engine" : "/linear_solver");
  size.steps = static_cast<double>(model.times.size());
  if (const auto plan = plan_checkpoints(model, run_options(input)))
    size.thin_steps = std::max(0.0, size.steps - static_cast<double>(plan->whole() + plan->stride - 1));
  if (is_too_much())
    throw ModelError("its " + shown(size.steps) + " steps need " + too_much(estimated_bytes(size), limit) +
                         "; try fewer, or tables with fewer points",
                     "/time");
}

RunOptions run_options(const Input& input) {
  RunOptions options{input.linear_algebra, input.backend};
  if (input.scene.sensitivity_mode == SensitivityMode::adjoint) options.state_memory = input.state_memory;
  options.output_every = fields_every(input.output);
  return options;
}

CaseResult simulate(const Simulation& simulation, const std::function<void()>& on_step, Trace* trace) {
  auto options = run_options(simulation.input);
  options.on_step = on_step;
  options.trace = trace;
  std::shared_ptr<Condensation<double>> condensation;
  return run_case(simulation.problem, simulation.input.method, options, condensation);
}

void prepare_run_directory(const std::filesystem::path& directory, bool report) {
  if (holds(directory, "study.json"))
    throw InputFault(directory.string() + ": holds a study; -o DIR writes to another directory");
  std::vector<std::string> files = {"result.json", "fields.pvd"}, folders;
  if (report) {
    files.insert(files.end(), {"picture.json", "report.html"});
    folders.emplace_back("figures");
  }
  prepare_directory(directory, files, folders);
}

void remove_fields(const std::filesystem::path& directory) {
  constexpr std::string_view begin = "fields_", end = ".vtu";
  std::vector<std::filesystem::path> old;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(directory, none)) {
    const std::string name = entry.path().filename();
    const bool framed = name.size() > begin.size() + end.size() && name.starts_with(begin) && name.ends_with(end);
    if (framed && name.substr(begin.size(), name.size() - begin.size() - end.size()).find_first_not_of("0123456789") ==
                      std::string::npos)
      old.push_back(entry.path());
  }
  for (const auto& file : old) std::filesystem::remove(file);
}

nlohmann::json write_result(const std::filesystem::path& directory, const Simulation& simulation,
                            const CaseResult& result, const Written& before) {
  Written written = before;
  const int every = fields_every(simulation.input.output);
  {
    const Stopwatch time(written.seconds);
    remove_fields(directory);
    write_fields(directory, result, every);
  }
  const auto fields = field_files(result, every);
  written.files += static_cast<long>(fields.size());
  written.fields = file_bytes(directory, fields);
  auto document = result_json(result, canonical_text(simulation.input));
  document["cost"]["seconds"]["output"] = written.seconds;
  document["ledger"] = ledger_json(ledger(result, written));
  write_file_atomically(directory / "result.json", json_text(document, 2) + "\n");
  return document;
}

double file_bytes(const std::filesystem::path& directory, const std::vector<std::string>& files) {
  double bytes = 0;
  for (const auto& file : files) bytes += static_cast<double>(std::filesystem::file_size(directory / file));
  return bytes;
}

std::vector<std::string> result_files(const Simulation& simulation, const CaseResult& result) {
  std::vector<std::string> files{"result.json"};
  for (auto& file : field_files(result, fields_every(simulation.input.output))) files.push_back(std::move(file));
  return files;
}

}  // namespace stickslip
