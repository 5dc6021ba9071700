#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "core/algebra/linear_solver.hpp"
#include "studies/app/commands.hpp"
#include "studies/io/input_fault.hpp"
#include "studies/io/printing.hpp"
#include "studies/io/provenance.hpp"

namespace {

void add_scene(CLI::App& command, stickslip::RunArguments& arguments) {
  command.add_option("SCENE", arguments.scene, "scene file (JSON)")->required();
  command.add_option("-m,--method", arguments.method, "penalty, uzawa_al or monolithic_al in place of the scene's");
  command.add_option("--set", arguments.overrides, "change a number of the scene; may be given again")
      ->type_name("POINTER=VALUE")
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_flag("--json", arguments.json, "one JSON document on standard output and nothing else");
}

/// Exit code of a command, or 2 where what it printed was not taken: a full disk, a closed pipe.
int finished(int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.flush()) return code;
  std::cerr << "stickslip: standard output cannot be written\n";
  return 2;
}

int out_of_memory() {
  std::cerr << "stickslip: there is not enough memory; a coarser mesh, fewer steps or fewer parameters need less\n";
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace stickslip;
  const CLI::Validator names_something(
      [](const std::string& text) { return text.empty() ? "is empty; must be a name" : ""; }, "");
  set_blas_threads(1);
  CLI::App app{"stickslip: one frictional contact problem, three ways to enforce it, and their derivatives"};
  app.require_subcommand(1);
  app.set_version_flag("--version", [] { return version_text(); });
  RunArguments run, explain, gradcheck;
  StudyArguments study;
  CompareArguments compare;
  std::string directory, merged;
  std::vector<std::string> shards;
  bool methods_json = false;
  auto& run_app = *app.add_subcommand("run", "simulate a scene");
  add_scene(run_app, run);
  run_app.add_option("-o,--output", run.output, "directory for result.json and fields")->check(names_something);
  run_app.add_flag("--report", run.report, "write report.html: bodies, histories, tractions, contact states");
  run_app.add_flag("--trace", run.trace, "print every iterate of Newton's method; written to trace.csv too");
  run_app.add_option("--export", run.export_to, "directory for K, G, lambda, ... of the last step (Matrix Market)")
      ->check(names_something);
  auto& study_app = *app.add_subcommand("study", "compare methods on a scene and write a report");
  study_app.add_option("STUDY", study.study, "study file (JSON)")->required();
  study_app.add_option("-o,--output", study.output, "directory for results.jsonl and report.html")
      ->check(names_something);
  auto& resume = *study_app.add_flag("--resume", study.resume, "keep the cells that are there and run what is missing");
  study_app.add_flag("--restart", study.restart, "delete the cells that are there and run all")->excludes(&resume);
  study_app.add_option("--shard", study.shard, "i/N: only every N-th cell, from the i-th on");
  study_app.add_option("-j,--jobs", study.jobs, "processes that run cells at once; seconds are measured apart");
  auto& merge_app = *app.add_subcommand("merge", "join the shards of a study and write their report");
  merge_app.add_option("DIR", shards, "directories of the shards")->required();
  merge_app.add_option("-o,--output", merged, "directory of the whole")->required()->check(names_something);
  auto& compare_app =
      *app.add_subcommand("compare", "two recordings of a study, cell by cell; fails where one is worse");
  compare_app.add_option("OLD", compare.before, "directory of a study")->required();
  compare_app.add_option("NEW", compare.after, "directory of a study")->required();
  compare_app.add_option("--relative", compare.relative, "share of itself that an error may grow by");
  compare_app.add_option("--rounding", compare.rounding, "error that is put down to rounding");
  compare_app.add_flag("--json", compare.json, "one JSON document on standard output and nothing else");
  auto& explain_app = *app.add_subcommand("explain", "say what would be simulated, and what would not");
  add_scene(explain_app, explain);
  auto& gradcheck_app = *app.add_subcommand("gradcheck", "hold every sensitivity against differences");
  add_scene(gradcheck_app, gradcheck);
  auto& report_app = *app.add_subcommand("report", "rebuild report.html of a study or a run from recorded results");
  report_app.add_option("DIR", directory, "directory of a study or a run")->required();
  auto& methods_app = *app.add_subcommand("methods", "list the methods and their options");
  methods_app.add_flag("--json", methods_json, "as JSON");
  auto& schema_app = *app.add_subcommand("schema", "print the JSON Schema of scene or study files, for editors");
  std::string schema_of = "scene";
  schema_app.add_option("KIND", schema_of, "scene or study")->check(CLI::IsMember({"scene", "study"}));
  try {
    app.parse(argc, argv);
    if (run_app) return finished(run_command(run));
    if (study_app) return finished(study_command(study));
    if (merge_app) return finished(merge_command(shards, merged));
    if (compare_app) return finished(compare_command(compare));
    if (explain_app) return finished(explain_command(explain));
    if (gradcheck_app) return finished(gradcheck_command(gradcheck));
    if (report_app) return finished(report_command(directory));
    if (schema_app) return finished(schema_command(schema_of));
    return finished(methods_command(methods_json));
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, faults;  // a fault quotes the argument
    const int code = app.exit(error, out, faults);
    std::cout << out.str();
    std::cerr << printable_lines(faults.str());
    return code == 0 ? finished(0) : 2;
  } catch (const InputFault& fault) {
    std::cerr << printable_lines(fault.what()) << '\n';
    return 2;
  } catch (const std::system_error& error) {
    std::cerr << "stickslip: " << printable_lines(error.what()) << '\n';
    return 2;
  } catch (const std::bad_alloc&) {
    return out_of_memory();
  } catch (const std::length_error&) {  // a container beyond all memory
    return out_of_memory();
  } catch (const std::exception& error) {
    std::cerr << "stickslip: " << printable_lines(error.what())
              << "\nthis is a bug of ours: please report it with the scene\n";
    return 1;
  }
}
