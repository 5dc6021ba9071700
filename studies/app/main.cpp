#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <functional>
#include <iostream>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/algebra/linear_solver.hpp"
#include "core/algebra/memory.hpp"
#include "studies/app/command_line.hpp"
#include "studies/app/commands.hpp"
#include "studies/app/exit_codes.hpp"
#include "studies/input/method_options.hpp"
#include "studies/io/input_fault.hpp"
#include "studies/io/printing.hpp"
#include "studies/io/provenance.hpp"
#include "studies/io/wording.hpp"

namespace {

using namespace stickslip;

/// What each command is given.
struct Arguments {
  RunArguments run, explain, gradcheck;
  StudyArguments study;
  CompareArguments compare;
  VerifyArguments verify;
  ReportArguments report;
  std::vector<std::string> shards;
  std::string merged, schema_of = "scene";
  bool methods_json = false;
};

/// The commands, with what each does once the line is parsed; the exit code is what that returns.
using Actions = std::vector<std::pair<CLI::App*, std::function<int()>>>;

CLI::Option* names_something(CLI::Option* option) {
  const auto fault = [](const std::string& text) { return text.empty() ? "is empty; must be a name" : ""; };
  return option->check(CLI::Validator(fault, ""));
}

/// Refuses what is no such number in the words of all other faults; `what` completes "must be ...".
template <class Number>
void is_number(CLI::Option* option, const char* what) {
  const auto fault = [what](const std::string& text) {
    Number number;
    return CLI::detail::lexical_cast(text, number) ? std::string() : "is " + in_quotes(text) + "; must be " + what;
  };
  option->check(CLI::Validator(fault, ""));
}

/// a, b or c in place of the scene's
const std::string& about_method() {
  static const std::string text = [] {
    std::string words;
    words.reserve(100);
    for (const auto& name : method_names())
      words.append(words.empty() ? "" : &name == &method_names().back() ? " or " : ", ").append(name);
    return words.append(" in place of the scene's");
  }();
  return text;
}

void add_scene(CLI::App& command, RunArguments& arguments) {
  command.add_option("SCENE", arguments.scene, "scene file (JSON)")->required();
  command.add_option("-m,--method", arguments.method, about_method());
  command.add_option("--set", arguments.overrides, "change a number of the scene; may be given again")
      ->type_name("POINTER=VALUE")
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_flag("--json", arguments.json, "one JSON document on standard output and nothing else");
}

/// Whether what was printed was taken, as neither a full disk nor a closed pipe does; said where it was not.
bool was_printed() {
  if (std::cout.flush() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return true;
  std::cerr << "stickslip: standard output cannot be written\n";
  return false;
}

/// Exit code of a command whose results are in files, whatever became of what it printed beside them.
int with_files(int code) {
  was_printed();
  return code;
}

/// Exit code of a command all of whose results are printed.
int on_standard_output(int code) { return was_printed() ? code : bad_input; }

int out_of_memory() {
  std::cerr << "stickslip: there is not enough memory; a coarser mesh, fewer steps or fewer parameters need less\n";
  return bad_input;
}

void add_run(CLI::App& command, RunArguments& run) {
  add_scene(command, run);
  names_something(command.add_option("-o,--output", run.output, "directory for result.json and fields"));
  command.add_flag("--report", run.report, "write report.html: bodies, histories, tractions, contact states");
  command.add_flag("--trace", run.trace, "print every iterate of Newton's method; written to trace.csv too");
  names_something(command.add_option("--export", run.export_to,
                                     "directory for K, G, lambda, ... of the last step (Matrix Market)"));
}

void add_study(CLI::App& command, StudyArguments& study) {
  command.add_option("STUDY", study.study, "study file (JSON)")->required();
  names_something(command.add_option("-o,--output", study.output, "directory for results.jsonl and report.html"));
  auto& resume = *command.add_flag("--resume", study.resume, "keep the cells that are there and run what is missing");
  command.add_flag("--restart", study.restart, "delete the cells that are there and run all")->excludes(&resume);
  command.add_option("--shard", study.shard, "i/N: only every N-th cell, from the i-th on");
  is_number<int>(
      command.add_option("-j,--jobs", study.jobs, "processes that run cells at once; seconds are measured apart"),
      "a whole number from 1 to 1024");
}

void add_merge(CLI::App& command, Arguments& given) {
  command.add_option("DIR", given.shards, "directories of the shards")->required();
  names_something(command.add_option("-o,--output", given.merged, "directory of the whole")->required());
}

void add_compare(CLI::App& command, CompareArguments& compare) {
  command.add_option("OLD", compare.before, "directory of a study")->required();
  command.add_option("NEW", compare.after, "directory of a study")->required();
  is_number<double>(command.add_option("--relative", compare.relative, "share of itself that an error may grow by"),
                    "a number >= 0");
  is_number<double>(command.add_option("--rounding", compare.rounding, "error that is put down to rounding"),
                    "a number >= 0");
  command.add_flag("--json", compare.json, "one JSON document on standard output and nothing else");
}

void add_verify(CLI::App& command, VerifyArguments& verify) {
  command.add_option("DIR", verify.directory, "directory of a run")->required();
  command.add_option("--solution", verify.solution, "solution of another program, in place of the run's (JSON)");
  command.add_flag("--json", verify.json, "one JSON document on standard output and nothing else");
}

void add_report(CLI::App& command, ReportArguments& report) {
  command.add_option("DIR", report.directory, "directory of a study or a run")->required();
  command.add_flag("--pdf", report.pdf, "write the figures as PDF too, by rsvg-convert");
}

/// Adds all commands, in the order of the help. `given` must outlive the actions.
Actions add_commands(CLI::App& app, Arguments& given) {
  Actions actions;
  const auto add = [&](const char* name, const char* description, auto action) -> CLI::App& {
    actions.emplace_back(app.add_subcommand(name, description), std::move(action));
    actions.back().first->allow_extras();  // left_over() refuses them
    return *actions.back().first;
  };
  add_run(add("run", "simulate a scene",
              [&] {
                const int code = run_command(given.run);
                return given.run.writes_results() ? with_files(code) : on_standard_output(code);
              }),
          given.run);
  add_study(add("study", "compare methods on a scene and write a report",
                [&] { return with_files(study_command(given.study)); }),
            given.study);
  add_merge(add("merge", "join the shards of a study and write their report",
                [&] { return with_files(merge_command(given.shards, given.merged)); }),
            given);
  add_compare(add("compare", "two recordings of a study, cell by cell; fails where one is worse",
                  [&] { return on_standard_output(compare_command(given.compare)); }),
              given.compare);
  add_scene(add("explain", "say what would be simulated, and what would not",
                [&] { return on_standard_output(explain_command(given.explain)); }),
            given.explain);
  add_scene(add("gradcheck", "hold every sensitivity against differences",
                [&] { return on_standard_output(gradcheck_command(given.gradcheck)); }),
            given.gradcheck);
  add_verify(add("verify", "check a result by its files alone: equilibrium, contact, friction, energy",
                 [&] { return on_standard_output(verify_command(given.verify)); }),
             given.verify);
  add_report(add("report", "rebuild report.html of a study or a run from recorded results",
                 [&] { return with_files(report_command(given.report)); }),
             given.report);
  add("methods", "list the methods and their options", [&] {
    return on_standard_output(methods_command(given.methods_json));
  }).add_flag("--json", given.methods_json, "as JSON");
  add("schema", "print the JSON Schema of scene or study files, for editors",
      [&] { return on_standard_output(schema_command(given.schema_of)); })
      .add_option("KIND", given.schema_of, "scene or study")
      ->check(CLI::IsMember({"scene", "study"}));
  return actions;
}

/// What is wrong with the first word of the line; "" where it is a command or an option, or there is none.
std::string unknown_command(const Actions& actions, int argc, char** argv) {
  const std::string word = argc > 1 ? argv[1] : "-";
  std::vector<std::string> names;
  for (const auto& [command, action] : actions) names.push_back(command->get_name());
  if (word.starts_with('-') || std::find(names.begin(), names.end(), word) != names.end()) return "";
  return "there is no command " + in_quotes(word) + ";" + suggestion(word, names) + " allowed: " + listed(names);
}

/// What is wrong with words that a command left over; "": nothing is left.
std::string left_over(const CLI::App& command) {
  const std::vector<std::string> words = command.remaining();
  if (words.empty()) return "";
  std::vector<std::string> options;
  for (const auto* option : command.get_options())
    if (const auto& names = option->get_lnames(); !names.empty()) options.push_back("--" + names.front());
  return unexpected_word(command.get_name(), options, words);
}

/// Exit code of the command that the line names; 2 where the line is at fault, which is printed.
int run_line(CLI::App& app, const Actions& actions, int argc, char** argv) {
  if (const std::string fault = unknown_command(actions, argc, argv); !fault.empty()) throw InputFault(fault);
  if (const std::string fault = set_in_two_words({argv, argv + argc}); !fault.empty()) throw InputFault(fault);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, faults;  // a fault quotes the argument
    const int code = app.exit(error, out, faults);
    constexpr std::size_t below_meaning = 30;  // columns of an option or a command
    std::cout << wrapped_lines(out.str(), below_meaning, terminal_width());
    std::cerr << printable_lines(faults.str());
    return code == 0 ? on_standard_output(done) : bad_input;
  }
  for (const auto& [command, action] : actions) {
    if (!*command) continue;
    if (const std::string fault = left_over(*command); !fault.empty()) throw InputFault(fault);
    return action();
  }
  return done;  // never: one is required
}

/// What a user does about a file that cannot be written or read; "" if that depends on the file.
std::string what_helps(const std::error_code& code) {
  if (code == std::errc::no_space_on_device || code == std::error_code(EDQUOT, std::generic_category()))
    return "; make room there and run it again, a study with --resume";
  if (code == std::errc::permission_denied || code == std::errc::read_only_file_system)
    return "; take a directory that you may write to";
  if (code == std::errc::file_too_large)
    return "; raise the limit of a file's size (ulimit -f) and run it again, a study with --resume";
  return "";
}

/// Opens what of the standard streams is closed, so that no file of results takes its number and what is printed to it.
/// Standard output cannot be written to then, as was_printed() finds.
void open_standard_streams() {
  while (true) {
    const int file = ::open("/dev/null", O_RDONLY);
    if (file < 0 || file > STDERR_FILENO) {
      if (file >= 0) ::close(file);
      return;
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of writing, with a message
  set_blas_threads(1);
  keep_freed_memory();
  CLI::App app{"stickslip: one frictional contact problem, three ways to enforce it, and their derivatives"};
  app.require_subcommand(1);
  app.set_version_flag("--version", [] { return version_text(); });
  Arguments given;
  const Actions actions = add_commands(app, given);
  try {
    return run_line(app, actions, argc, argv);
  } catch (const InputFault& fault) {
    std::cerr << printable_lines(fault.what()) << '\n';
    return bad_input;
  } catch (const std::system_error& error) {
    std::cerr << "stickslip: " << printable_lines(error.what()) << what_helps(error.code()) << '\n';
    return bad_input;
  } catch (const NoWorkSpace& error) {
    std::cerr << "stickslip: " << error.what() << '\n';
    return bad_input;
  } catch (const std::bad_alloc&) {
    return out_of_memory();
  } catch (const std::length_error&) {  // a container beyond all memory
    return out_of_memory();
  } catch (const std::exception& error) {
    std::cerr << "stickslip: " << printable_lines(error.what())
              << "\nthis is a bug in stickslip: please report it with the scene\n";
    return our_bug;
  }
}
