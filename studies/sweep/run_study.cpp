#include "studies/sweep/run_study.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <vector>

#include "studies/io/atomic_file.hpp"
#include "studies/io/input_fault.hpp"
#include "studies/io/interrupts.hpp"
#include "studies/io/output_folder.hpp"
#include "studies/io/printing.hpp"
#include "studies/io/progress.hpp"
#include "studies/io/result_rows.hpp"
#include "studies/report/disagreement.hpp"
#include "studies/report/report.hpp"
#include "studies/run/certificate.hpp"
#include "studies/run/explain.hpp"
#include "studies/run/fields.hpp"
#include "studies/run/picture_json.hpp"
#include "studies/run/simulation.hpp"
#include "studies/run/solution_file.hpp"
#include "studies/sweep/attempt.hpp"
#include "studies/sweep/shard.hpp"
#include "studies/sweep/study_cell.hpp"
#include "studies/sweep/timing.hpp"
#include "studies/sweep/workers.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using namespace nlohmann::literals;
namespace fs = std::filesystem;

/// A study that was found valid, and where its results go.
struct Plan {
  Study study;
  std::vector<std::string> ids;  ///< of the study's cells
  CellInput last;                ///< of these
  std::vector<CellInput> cells;  ///< those of the shard
  Shard shard;
  fs::path directory;
};

/// "results/hertz.study" of hertz.study.json: apart from "results/hertz", where a run of its scene writes.
fs::path directory_of(const StudyArguments& arguments) {
  return arguments.output.empty() ? "results" / fs::path(arguments.study).stem() : fs::path(arguments.output);
}

/// Makes a model of every variant, so that a scene that makes no sense as a whole is found before anything is written.
void check_models(const Study& study, const std::vector<CellInput>& cells, MeshFiles& meshes,
                  Diagnostics& diagnostics) {
  std::string checked;
  for (const auto& cell : cells) {
    if (variant_key(cell) == checked) continue;
    checked = variant_key(cell);
    try {
      const Input input = input_of(cell, meshes);
      check_memory(*problem_of(input), input);
    } catch (const ModelError& error) {
      diagnostics.error(in_study(study, {cell.document.place(error.pointer), error.pointer, error.what()}));
    }
  }
}

/// Finds solutions of other programs that do not fit their variants, before anything is written.
void check_solutions(const Study& study, const std::vector<CellInput>& cells, MeshFiles& meshes,
                     Diagnostics& diagnostics) {
  for (const auto& cell : cells)
    if (cell.peer) try {
        const Input input = input_of(cell, meshes);
        certificate_of_peer(solution_frame(*problem_of(input), input.document), cell.peer->solution);
      } catch (const InputFault& fault) {
        const std::string pointer = cell.peer->place.pointer + "/file";
        const auto* const located = dynamic_cast<const SolutionFault*>(&fault);
        const fs::path file = (fs::path(study.document.file()).parent_path() / cell.peer->file).lexically_normal();
        diagnostics.error({study.document.place(pointer), pointer,
                           located ? in_file(file, *located) : file.string() + ": " + fault.what()});
      }
}

std::optional<Plan> make_plan(const StudyArguments& arguments, MeshFiles& meshes, Diagnostics& diagnostics) {
  Plan plan;
  if (const auto shard = parse_shard(arguments.shard))
    plan.shard = *shard;
  else
    diagnostics.error(
        {{diagnostics.caller().shard + arguments.shard}, "", "must be i/N, whole numbers with 1 <= i <= N"});
  constexpr int most_jobs = 1024;  // beyond, a system runs out of processes
  if (arguments.jobs < 1 || arguments.jobs > most_jobs)
    diagnostics.error({{diagnostics.caller().jobs + std::to_string(arguments.jobs)}, "", "must be 1 to 1024"});
  auto study = read_study(arguments.study, diagnostics);
  if (!study) return std::nullopt;
  plan.study = *std::move(study);
  auto all = expand(plan.study, program_version(), diagnostics, meshes);
  if (!all.empty()) plan.last = all.back();
  for (std::size_t i = 0; i < all.size(); ++i) {
    plan.ids.push_back(all[i].id);
    if (plan.shard.holds(i)) plan.cells.push_back(std::move(all[i]));
  }
  if (!diagnostics.has_errors()) check_models(plan.study, plan.cells, meshes, diagnostics);
  if (!diagnostics.has_errors()) check_solutions(plan.study, plan.cells, meshes, diagnostics);
  if (diagnostics.has_errors()) return std::nullopt;
  plan.directory = directory_of(arguments);
  return plan;
}

/// study.json: the study as given, which cells it has, and what the report says of the scene beside the rows.
json description(const Plan& plan, const StudyArguments& arguments, MeshFiles& meshes) {
  json out = plan.study.document.root();
  const Input input = input_of(plan.last, meshes);
  const auto problem = problem_of(input);
  out["command"] = "stickslip study " + shell_word(arguments.study) +
                   (arguments.output.empty() ? "" : " -o " + shell_word(arguments.output)) +
                   (plan.shard.count > 1 ? " --shard " + plan.shard.text() : "");
  out["program"] = program_version();
  out["cells"] = plan.ids;
  out["shard"] = plan.shard.text();
  out["scene_title"] = problem->model.scene.title;
  for (const StudyScene& scene : plan.study.scenes)
    if (!scene.file.empty()) out["scene_titles"][scene.file] = scene.document.root().value("title", "");
  out["scene_hash"] = fingerprint(canonical_text(input));
  out["explain"] = explain(input, *problem);
  int elements = 0;
  for (const auto& body : problem->model.bodies) elements += body.mesh.element_count();
  out["mesh"] = {{"nodes", problem->model.node_count}, {"elements", elements}};
  double size = 0;
  for (const auto& point : problem->model.points)
    if (point.mesh_size > 0) size = size == 0 ? point.mesh_size : std::min(size, point.mesh_size);
  if (size > 0) out["mesh"]["size_at_contact"] = size;
  out["analytic"] = nullptr;
  return out;
}

void write_description(const fs::path& directory, const json& description) {
  write_output(directory / "study.json", json_text(description, 2) + "\n");
}

std::ptrdiff_t rows_of_other_shards(const Plan& plan, const RowsById& rows) {
  return static_cast<std::ptrdiff_t>(rows.size()) -
         std::count_if(plan.cells.begin(), plan.cells.end(), [&](const auto& cell) { return rows.count(cell.id) > 0; });
}

/// Makes the rows those of this study in what the id of a cell does not know: where the cell stands in the study, what
/// its errors are against, its error budget and its certificate. What is asked for and is not there is to be measured;
/// what is not is not shown.
void match_extras(const Plan& plan, RowsById& rows, std::vector<std::string>& notes) {
  const bool certifies = !plan.study.solutions.empty();
  const std::string references = reference_hash(plan.study);
  long others = 0;
  for (const auto& cell : plan.cells) {
    const auto row = rows.find(cell.id);
    if (row == rows.end()) continue;
    if (row->second.value("reference_hash", references) != references) {
      rows.erase(row);
      ++others;
      continue;
    }
    row->second.erase("scene");
    row->second.update(place_of(cell));
    if (cell.peer) continue;
    const int copies = row->second.value("/error_budget/copies"_json_pointer, 0);
    const bool uncertified = certifies && converged(row->second) && !row->second.contains("certificate");
    if (plan.study.budget_copies == 0) row->second.erase("error_budget");
    if (!certifies) row->second.erase("certificate");
    if (uncertified || (plan.study.budget_copies > 0 && copies != plan.study.budget_copies)) rows.erase(row);
  }
  if (others > 0)
    notes.push_back(fmt::format(R"({} of another "reference" or "errors" of the study: these cells run again)",
                                others == 1 ? "1 row is" : fmt::format("{} rows are", others)));
}

struct Tally {
  long run = 0, failed = 0;
};

/// Who hears of a study that runs.
struct Listener {
  std::ostream& log;
  const std::function<void()>& on_run;  ///< after each run

  void end_of_run() const {
    if (on_run) on_run();
  }
};

/// A cell in words: its label and variant.
std::string name_of_cell(const CellInput& cell) {
  const std::string variant = variant_text({{"scene", cell.scene}, {"vary", cell.vary}, {"refine", cell.refine}});
  return cell.label + (variant.empty() ? "" : ", " + variant);
}

/// The picture of the last variant, its fields, and the closed form's curves beside it; `fault` where it cannot be
/// drawn, as for want of memory.
json showcase_of(const Plan& plan, CellRunner& runner) {
  json out;
  const auto breakdown = attempt([&] {
    const auto result = runner.showcase(plan.cells.size() - 1);
    out = {{"picture", picture_json(result)}, {"size", size_json(result)}, {"fields", json::object()}};
    out["picture"]["scene"] = plan.cells.back().document.root();
    for_each_field(result, 0, [&](const std::string& name, const std::string& text) { out["fields"][name] = text; });
    if (!is_converged(result.status())) return;
    for (const auto& reference : plan.study.references)
      if (reference.kind == Reference::Kind::analytic && !out.contains("analytic"))
        if (const auto values = reference_values(reference.entry, result); !values.curves.is_null())
          out["analytic"] = {{"name", reference.entry.value("analytic", "")}, {"curves", values.curves}};
  });
  return breakdown ? json{{"fault", breakdown->message}} : out;
}

/// A picture that cannot be drawn is missing in the report; the rows are what counts.
void note_fault(const Listener& listener, const std::string& fault) {
  listener.log << printable(fmt::format("note: there is no picture of the solution: {}", fault)) << '\n';
}

/// Writes the picture, and study.json, which has its size.
void write_showcase(const Plan& plan, const json& showcase, const Listener& listener, json& described) {
  if (showcase.contains("fault")) return note_fault(listener, showcase["fault"]);
  remove_outputs(plan.directory, {std::begin(field_names), std::end(field_names)});
  write_output(plan.directory / "picture.json", json_text(showcase["picture"]));
  for (const auto& [name, text] : showcase["fields"].items())
    write_output(plan.directory / name, text.get_ref<const std::string&>());
  for (const char* drawn : {"size", "analytic"})
    if (showcase.contains(drawn)) described[drawn] = showcase[drawn];
  write_description(plan.directory, described);
}

/// The accuracy pass: runs what is missing and records each cell as soon as it is done. Then draws the picture, unless
/// that is `drawn`. Neither is done by this process: a crash is a row, and takes no other cell with it.
Tally run_missing(const Plan& plan, const OutputFolder& folder, const Listener& listener, CellRunner& runner, int jobs,
                  bool drawn, json& described, RowsById& rows) {
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < plan.cells.size(); ++i)
    if (rows.count(plan.cells[i].id) == 0) missing.push_back(i);
  Tally tally;
  Progress progress(listener.log, progress_style_of_stderr(), "cells", static_cast<long>(plan.cells.size()));
  progress.skip(static_cast<long>(plan.cells.size() - missing.size()));
  const auto record = [&](const CellInput& cell, json row) {
    folder.check();
    append_row(plan.directory, row);
    ++tally.run;
    if (!converged(row)) {
      ++tally.failed;
      progress.note(printable(fmt::format("{}: {} ({})", name_of_cell(cell), row["status"].get<std::string>(),
                                          row["message"].get<std::string>())));
    }
    rows[cell.id] = std::move(row);
    progress.advance();
    listener.end_of_run();
  };
  const bool draws = !drawn && !plan.cells.empty();
  const auto is_cell = [&](std::size_t i) { return i < missing.size(); };
  run_in_processes(
      jobs, missing.size() + (draws ? 1 : 0),
      [&](std::size_t i) { return json_text(is_cell(i) ? runner.row(missing[i]) : showcase_of(plan, runner)); },
      [&](std::size_t i, const std::string& text) {
        if (is_cell(i)) return record(plan.cells[missing[i]], json::parse(text));
        folder.check();
        write_showcase(plan, json::parse(text), listener, described);
      },
      [&](std::size_t i, const Loss& loss) {
        if (!is_cell(i)) return note_fault(listener, loss.words);
        if (loss.from_outside)
          progress.note(
              printable(fmt::format("{}: {}; it has no row", name_of_cell(plan.cells[missing[i]]), loss.words)));
        else
          record(plan.cells[missing[i]], runner.failed_row(missing[i], "failed", loss.words + ", please report it"));
      });
  return tally;
}

/// The timing pass: serial, over the cells that converged; what is recorded is not run again.
void time_cells(const Plan& plan, const OutputFolder& folder, const Listener& listener, CellRunner& runner,
                const RowsById& rows) {
  std::vector<std::size_t> cells;
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < plan.cells.size(); ++i)
    if (const auto row = rows.find(plan.cells[i].id);
        row != rows.end() && converged(row->second) && !plan.cells[i].peer) {
      cells.push_back(i);
      keys.push_back(variant_key(plan.cells[i]));
    }
  const auto timings = read_timings(plan.directory);
  const auto known = [&](const TimedRun& run) {
    const auto found = timings.find(plan.cells[cells[run.cell]].id);
    return found != timings.end() && found->second.count(run.round) > 0;
  };
  auto runs = timing_plan(keys, plan.study.repeat);
  std::erase_if(runs, known);
  if (runs.empty()) return;
  Progress progress(listener.log, progress_style_of_stderr(), "timed runs", static_cast<long>(runs.size()));
  for (const auto& run : runs) {
    const std::size_t cell = cells[run.cell];
    json seconds;
    try {
      seconds = runner.seconds(cell);
    } catch (const std::exception& error) {
      progress.note(printable(fmt::format("{}: not timed: {}", name_of_cell(plan.cells[cell]), error.what())));
    }
    folder.check();
    if (!seconds.is_null()) append_timing(plan.directory, plan.cells[cell].id, run.round, seconds);
    progress.advance();
    listener.end_of_run();
  }
}

/// Puts what the timing pass measured into the rows: cost.seconds the least, cost.timing how many runs and the median.
void take_timings(const fs::path& directory, std::ostream& log, RowsById& rows) {
  int damaged = 0;
  const auto timings = read_timings(directory, &damaged);
  if (damaged > 0) log << "note: " << damaged << " line(s) of timings.jsonl are damaged and were left out\n";
  for (const auto& [id, rounds] : timings) {
    const auto row = rows.find(id);
    if (row == rows.end()) continue;
    std::vector<json> runs;
    for (const auto& [round, seconds] : rounds) runs.push_back(seconds);
    auto& cost = row->second["cost"];
    cost["seconds"] = least_seconds(runs);
    cost["timing"] = {{"repeat", runs.size()}, {"median", median_seconds(runs)}};
  }
}

/// Whether study.json is that of this study, and the picture beside it drawn.
bool is_described(const fs::path& directory, const json& described) {
  if (!fs::exists(directory / "study.json") || !fs::exists(directory / "picture.json")) return false;
  json there = read_description(directory), ours = described;
  for (const char* drawn : {"size", "analytic"})
    for (json* each : {&there, &ours}) each->erase(drawn);
  return there == ours;
}

/// Says how to go on where Ctrl-C, or a scheduler, ends the study.
class InterruptNote {
 public:
  explicit InterruptNote(const std::string& command)
      : text_("\ninterrupted: finished cells are kept; to go on:\n  " + command + " --resume\n"),
        at_interrupt_(say, text_.c_str()) {}

 private:
  static void say(const char* text) {  // only what a signal handler may call
    if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) return;
  }
  std::string text_;
  AtInterrupt at_interrupt_;
};

/// Notes what runs disagree about, as the report's page says too.
void note_disagreements(const RowsById& rows, std::ostream& log) {
  std::vector<const json*> all;
  for (const auto& [id, row] : rows) all.push_back(&row);
  for (const auto& sentence : disagreements(all)) log << "note: " << printable(sentence) << '\n';
}

StudyOutcome carry_out(const Plan& plan, const StudyArguments& arguments, const Listener& listener, MeshFiles& meshes,
                       const Caller& caller) {
  const std::string elsewhere = caller.directory + " writes to another directory";
  if (holds(plan.directory, "result.json"))
    throw InputFault(plan.directory.string() + ": holds the result of a run; " + elsewhere);
  const OutputFolder folder(plan.directory, study_files());
  if (!arguments.restart) check_records(plan.directory);
  if (const auto found = read_rows(plan.directory).rows.size(); found > 0 && !arguments.resume && !arguments.restart)
    throw InputFault(fmt::format(
        "{}: holds {} finished cells; {} keeps those of this study and runs what is missing, {} deletes them, {}",
        plan.directory.string(), found, caller.resume, caller.restart, elsewhere));
  if (arguments.restart)
    remove_outputs(plan.directory, {"results.jsonl", "timings.jsonl", "study.json", "picture.json"});
  json described = description(plan, arguments, meshes);
  const bool drawn = is_described(plan.directory, described);
  if (!drawn) write_description(plan.directory, described);
  std::vector<std::string> notes;
  const InterruptNote note_of_interrupt(described["command"]);
  RowsById rows = resume_rows(plan.directory, plan.ids, notes);
  match_extras(plan, rows, notes);
  if (const auto others = rows_of_other_shards(plan, rows); others > 0)
    notes.push_back(
        fmt::format("{} row(s) of this study that are not of shard {} stay as they are", others, plan.shard.text()));
  for (const auto& note : notes) listener.log << "note: " << printable(note) << '\n';
  CellRunner runner(plan.study, plan.cells, meshes);
  const Tally tally = run_missing(plan, folder, listener, runner, arguments.jobs, drawn, described, rows);
  time_cells(plan, folder, listener, runner, rows);
  folder.check();
  take_timings(plan.directory, listener.log, rows);
  write_rows(plan.directory, plan.ids, rows);
  std::vector<std::string> ids;  // of the shard
  for (const auto& cell : plan.cells) ids.push_back(cell.id);
  const auto recorded = std::ranges::count_if(ids, [&](const auto& id) { return rows.count(id) > 0; });
  auto broken = refuted(ids, rows);
  note_disagreements(rows, listener.log);
  rows.clear();  // the report reads them again, and not all of each
  write_report(plan.directory);
  return {plan.directory, std::ssize(plan.cells),     tally.run,
          tally.failed,   std::ssize(ids) - recorded, std::move(broken)};
}

}  // namespace

std::vector<std::string> study_files() {
  std::vector<std::string> files = report_files();
  files.insert(files.end(), std::begin(record_files), std::end(record_files));
  files.insert(files.end(), std::begin(field_names), std::end(field_names));
  files.emplace_back("picture.json");
  return files;
}

std::optional<StudyOutcome> run_study(const StudyArguments& arguments, std::ostream& log, Diagnostics& diagnostics,
                                      const std::function<void()>& on_run) {
  MeshFiles meshes;
  const auto plan = make_plan(arguments, meshes, diagnostics);
  if (!plan) return std::nullopt;
  log << diagnostics.notes_text();
  return carry_out(*plan, arguments, {log, on_run}, meshes, diagnostics.caller());
}

}  // namespace stickslip
