#include "studies/app/commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <utility>

#include "studies/app/exit_codes.hpp"
#include "studies/app/recorded.hpp"
#include "studies/app/say.hpp"
#include "studies/app/schema.hpp"
#include "studies/app/trace_table.hpp"
#include "studies/input/method_options.hpp"
#include "studies/io/atomic_file.hpp"
#include "studies/io/input_fault.hpp"
#include "studies/io/output_folder.hpp"
#include "studies/io/printing.hpp"
#include "studies/io/progress.hpp"
#include "studies/io/result_rows.hpp"
#include "studies/report/report.hpp"
#include "studies/run/certificate.hpp"
#include "studies/run/contact_start.hpp"
#include "studies/run/explain.hpp"
#include "studies/run/export_system.hpp"
#include "studies/run/film.hpp"
#include "studies/run/gradient_report.hpp"
#include "studies/run/ledger_forecast.hpp"
#include "studies/run/picture_json.hpp"
#include "studies/run/run_files.hpp"
#include "studies/run/simulation.hpp"
#include "studies/sweep/closed_forms.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

/// None where the scene has a fault; everything known of it is then on standard error.
std::optional<Simulation> load(const RunArguments& arguments) {
  Diagnostics diagnostics;
  auto simulation = prepare(arguments.scene, arguments.overrides, arguments.method, diagnostics);
  if (simulation) std::cerr << diagnostics.notes_text();
  std::cerr << diagnostics.text();
  return simulation;
}

std::filesystem::path output_directory(const std::string& given, const std::string& input) {
  return given.empty() ? std::filesystem::path("results") / std::filesystem::path(input).stem()
                       : std::filesystem::path(given);
}

/// A derivative of the table; those of what is not determined are no numbers.
std::string derivative_in_words(double derivative) {
  return std::isfinite(derivative) ? fmt::format("{: .6e}", derivative) : " not determined";
}

void print_summary(const CaseResult& result) {
  const auto& scene = result.problem->model.scene;
  say(std::cout, "{:>10} {:>21} {:>7} {:>7} {:>6} {:>6} {:>6} {:>10}\n", "time", "status", "newton", "augm.", "open",
      "stick", "slip", "kkt");
  for (const auto& step : result.steps) {
    int open = 0, stick = 0, slip = 0;
    for (const auto& s : summarise(result.problem->model, result.problem->slots, step.increment->state)) {
      open += s.open;
      stick += s.stick;
      slip += s.slip;
    }
    say(std::cout, "{:>10.6g} {:>21} {:>7} {:>7} {:>6} {:>6} {:>6} {:>10.1e}\n", step.increment->time,
        name_of(step.increment->status), step.newton, step.augmentations, open, stick, slip, step.kkt.largest());
  }
  const auto solved = solved_steps(result);
  if (!has_ended(result))
    say(std::cout, "\nNO SOLUTION at t = {:g}: {}{}\n", result.steps.back().increment->time, name_of(result.status()),
        solved.empty() ? "; no step before it converged, so there are no responses" : "");
  if (solved.empty()) return;
  const auto& last = solved.back();
  const bool is_inaccurate = last.increment->status == Status::inaccurate;
  if (is_inaccurate)
    say(std::cout,
        "\nINACCURATE at t = {:g}: the error {:.1e} is larger than method and rounding explain; do not use these "
        "values\n",
        last.increment->time, last.kkt.largest());
  say(std::cout, "\nresponses at t = {:g}{}, and their derivatives\n", last.increment->time,
      is_inaccurate       ? ", inaccurate"
      : has_ended(result) ? ""
                          : ", the last step that converged");
  constexpr std::size_t below_value = 4;  // indent of a row that goes on
  for (std::size_t i = 0; i < scene.responses.size(); ++i) {
    std::vector<std::string> row{fmt::format("  {:<20} {: .10e}", scene.responses[i].name, last.responses[i])};
    for (std::size_t j = 0; last.sensitivities.size() && j < scene.parameters.size(); ++j)
      row.push_back(fmt::format("d/d{} {}", scene.parameters[j].name, derivative_in_words(last.sensitivities(i, j))));
    say(std::cout, "{}\n", wrapped(row, "   ", below_value, terminal_width()));
  }
  for (std::size_t i = 0; has_ended(result) && i < scene.objectives.size(); ++i) {
    std::vector<std::string> row{fmt::format("  {:<20} {: .10e}", scene.objectives[i].name, result.objectives[i])};
    const auto& gradient = result.gradients.of_objectives;
    constexpr Eigen::Index shown = 8;
    for (Eigen::Index j = 0; j < std::min(gradient.cols(), shown); ++j)
      row.push_back(fmt::format("d/d{} {}", scene.parameters[j].name, derivative_in_words(gradient(i, j))));
    if (gradient.cols() > shown) row.emplace_back("...");
    say(std::cout, "{}\n", wrapped(row, "   ", below_value, terminal_width()));
  }
  if (!scene.parameters.empty() && !last.differentiable)
    say(std::cout,
        "  a contact point is about to change state: these hold on one side only (result.json: one_sided)\n");
}

/// One line for each contact: its gaps at the start.
void print_start_gaps(const Problem& problem) {
  std::cout << '\n';
  for (const auto& gaps : start_gaps_of_rules(problem))
    say(std::cout, "gap of {} at the start: {}\n", gaps.name, gaps.in_words());
}

/// picture.json, with what a study's rows hold of it.
void write_picture(const std::filesystem::path& directory, const Simulation& simulation, const CaseResult& result,
                   Written& written) {
  const Stopwatch time(written.seconds);
  json picture = picture_json(result, simulation.input.fields_every);
  if (picture.is_null()) return;
  picture["interface"] = interface_json(result);
  picture["film"] = film_json(result);
  picture["scene"] = simulation.input.document;
  write_output(directory / "picture.json", json_text(picture));
  written.picture = file_bytes(directory, {"picture.json"});
  ++written.files;
}

/// trace.csv, and of scenes with few contact points cones.svg; returns their names.
std::vector<std::string> trace_files(const std::filesystem::path& directory, const Problem& problem,
                                     const Trace& trace) {
  write_output(directory / "trace.csv", trace_csv(problem, trace));
  const auto paths = cone_paths(problem, trace);
  if (paths.empty()) return {"trace.csv"};
  const std::string& title = problem.model.scene.title;
  write_output(directory / "cones.svg", report::draw_cones(paths, title.empty() ? "Friction cones" : title).svg_file());
  return {"trace.csv", "cones.svg"};
}

/// Adds the files of a folder to those that a run has written.
void add_files(const std::filesystem::path& folder, const std::vector<std::string>& names,
               std::vector<std::string>& written) {
  for (const auto& name : names) written.push_back(printable((folder / name).string()));
}

/// The trace's files; returns their names.
std::vector<std::string> write_trace(const std::filesystem::path& directory, const Problem& problem, const Trace* trace,
                                     Written& written) {
  if (!trace) return {};
  const Stopwatch time(written.seconds);
  const auto files = trace_files(directory, problem, *trace);
  written.trace = file_bytes(directory, files);
  written.files += static_cast<long>(files.size());
  return files;
}

/// All files of a run; adds their names to `written`. Returns result.json, which holds the bytes of the others, so it
/// comes last but for the report that is made from it.
json write_run(const std::filesystem::path& directory, const RunArguments& arguments, const Simulation& simulation,
               const CaseResult& result, const Trace* trace, std::vector<std::string>& names) {
  Written written;
  remove_run(directory);
  const auto traced = write_trace(directory, *simulation.problem, trace, written);
  if (arguments.report) write_picture(directory, simulation, result, written);
  json document = write_result(directory, simulation, result, written);
  const bool has_solution = document["solution"].contains("file"), certified = arguments.report && has_solution;
  if (certified)
    write_output(directory / "certificate.json", json_text(certificate_json(certificate_of(directory)), 2) + "\n");
  if (arguments.report) write_run_report(directory);
  add_files(directory, result_files(simulation, result), names);
  if (has_solution) add_files(directory, {"solution.json"}, names);
  add_files(directory, traced, names);
  if (certified) add_files(directory, {"certificate.json"}, names);
  if (arguments.report) add_files(directory, {"picture.json", "report.html", "figures/"}, names);
  return document;
}

/// The folders that a run writes to, of which --export may name the same.
std::vector<OutputFolder> folders_of_run(const std::filesystem::path& directory, const RunArguments& arguments,
                                         bool writes) {
  std::vector<std::string> names, exported;
  if (arguments.report) names = report_files();
  if (arguments.report) names.insert(names.end(), {"picture.json", "certificate.json"});
  if (arguments.trace) names.insert(names.end(), {"trace.csv", "cones.svg"});
  if (!arguments.export_to.empty()) exported = exported_files();
  using std::filesystem::weakly_canonical;
  const bool same = writes && !exported.empty() && weakly_canonical(arguments.export_to) == weakly_canonical(directory);
  if (same) names.insert(names.end(), exported.begin(), exported.end());
  std::vector<OutputFolder> folders;
  if (writes) folders.push_back(folder_of_run(directory, names));
  if (!exported.empty() && !same) folders.emplace_back(arguments.export_to, exported);
  return folders;
}

/// Simulates, and shows how far it is where the output is not for programs.
CaseResult simulate_with_progress(const Simulation& simulation, const RunArguments& arguments, Trace* trace) {
  if (arguments.json) return simulate(simulation, {}, trace);
  constexpr std::chrono::seconds quiet(2);  // a run of a second or two speaks for itself
  Progress progress(std::cerr, progress_style_of_stderr(), "steps", simulation.problem->model.most_steps(),
                    std::chrono::steady_clock::now, quiet);
  const Ticker ticker(progress);
  return simulate(
      simulation, [&] { progress.advance(); }, trace);
}

/// A line for each option: name, default, meaning. `before`: what the names begin with.
void print_options(const nlohmann::ordered_json& options, const std::string& before) {
  constexpr std::size_t below_meaning = 38;  // columns of name and default
  for (const auto& [name, option] : options.items())
    if (option.contains("properties"))
      print_options(option.at("properties"), before + name + "/");
    else
      std::cout << wrapped_lines(fmt::format("  {:<22} {:<12} {}\n", before + name, option.at("default").dump(),
                                             option.at("description").get<std::string>()),
                                 below_meaning, terminal_width());
}

}  // namespace

int run_command(const RunArguments& arguments) {
  const auto loaded = load(arguments);
  if (!loaded) return bad_input;
  const bool writes = arguments.writes_results();
  const auto directory = output_directory(arguments.output, arguments.scene);
  if (!arguments.export_to.empty()) check_folder(arguments.export_to);
  if (!arguments.export_to.empty() && !has_constant_stiffness(loaded->input.scene))
    throw InputFault(
        "--export: the system of finite strain, or of bodies that flow, is not linear; only linear bodies have a K to "
        "write");
  if (!writes && arguments.report) throw InputFault("--report: with --json nothing is written; give -o DIR too");
  const auto folders = folders_of_run(directory, arguments, writes);
  Trace trace;
  const auto result = simulate_with_progress(*loaded, arguments, arguments.trace ? &trace : nullptr);
  std::vector<std::string> written;
  const json document =
      writes ? write_run(directory, arguments, *loaded, result, arguments.trace ? &trace : nullptr, written)
             : result_json(*loaded, result);
  if (!arguments.export_to.empty() && !result.trajectory.increments.empty())
    add_files(arguments.export_to, export_system(arguments.export_to, result), written);
  if (arguments.json) {
    std::cout << json_text(document, 2) << '\n';
  } else {
    if (arguments.trace) say(std::cout, "{}\n", trace_table(trace));
    print_summary(result);
    print_start_gaps(*loaded->problem);
    const std::string ending =
        fmt::format("effects: {}\nwritten: {}\n", ledger_line(document["ledger"]), fmt::join(written, ", "));
    std::cout << wrapped_lines(ending, 2, terminal_width());
  }
  for (const auto& warning : document["warnings"])
    say(std::cerr, "warning ({}): {}; {}\n", warning["code"].get<std::string>(),
        printable(warning["text"].get<std::string>()), printable(warning["remedy"].get<std::string>()));
  if (is_converged(result.status())) return done;
  say(std::cerr, "{}: {}\n", name_of(result.status()), printable(result.message()));
  return not_solved;
}

int explain_command(const RunArguments& arguments) {
  const auto loaded = load(arguments);
  if (!loaded) return bad_input;
  const std::string text = explain(loaded->input, *loaded->problem);
  if (arguments.json)
    std::cout << json_text({{"explain", text}, {"ledger", ledger_json(forecast(loaded->input, *loaded->problem))}}, 2)
              << '\n';
  else
    say(std::cout, "{}", wrapped_lines(text, 6, terminal_width()));
  return done;
}

int gradcheck_command(const RunArguments& arguments) {
  const auto loaded = load(arguments);
  if (!loaded) return bad_input;
  GradientCheck check;
  {
    std::optional<Progress> bar;
    check = check_gradients(*loaded, arguments.scene, [&](int, int total) {
      if (!bar) bar.emplace(std::cerr, progress_style_of_stderr(), "difference runs", total);
      bar->advance();
    });
  }
  if (arguments.json)
    std::cout << json_text(check_json(check), 2) << '\n';
  else
    say(std::cout, "{} by {}: {}", printable(arguments.scene), name_of(loaded->input.method), check_table(check));
  if (check.passed()) return done;
  std::cerr << check_faults(check);
  return not_solved;
}

int study_command(const StudyArguments& arguments) {
  Diagnostics diagnostics;
  const auto study = run_study(arguments, std::cerr, diagnostics);
  if (!study) {
    std::cerr << diagnostics.text();
    return bad_input;
  }
  say(std::cout, "{} cells, {} run now, {} of these without a converged result (kept as rows)\nreport: {}\n",
      study->cells, study->run, study->failed, printable((study->directory / "report.html").string()));
  for (const auto& line : study->refuted) say(std::cerr, "{}\n", printable(line));
  if (study->lost > 0)
    say(std::cerr,
        "{} cells have no row: their processes were ended from outside, by the system where memory runs out; "
        "--resume runs them again, fewer --jobs need less memory at once\n",
        study->lost);
  return study->lost == 0 && study->refuted.empty() ? done : not_solved;
}

int methods_command(bool as_json) {
  if (as_json) {
    json all = json::object();
    for (const auto& name : method_names()) all.update(to_json(*default_method(name)));
    std::cout << all.dump(2) << '\n';
    return done;
  }
  const auto schema = method_schema(OptionLists::refused);
  for (const auto& [name, method] : schema.at("properties").items()) {
    say(std::cout, "{}\n", name);
    print_options(method.at("properties"), "");
  }
  say(std::cout, "\nclosed forms, as a study's reference (inputs -> what they give)\n");
  for (const auto& form : closed_forms()) {
    say(std::cout, "{}: {}\n", form.name, form.about);
    for (const auto& [quantities, sign] : {std::pair{&form.inputs, ""}, {&form.outputs, "-> "}})
      for (const auto& quantity : *quantities)
        say(std::cout, "  {:<24} {}{}\n", sign + quantity.name, quantity.meaning,
            quantity.required ? "" : " (optional)");
  }
  return done;
}

int schema_command(const std::string& kind) {
  std::cout << (kind == "study" ? study_schema() : scene_schema()).dump(2) << '\n';
  return done;
}

int report_command(const ReportArguments& arguments) {
  const std::string& directory = arguments.directory;
  const Pdfs pdfs = arguments.pdf ? Pdfs::added : Pdfs::left_out;
  check_recorded(directory);
  const bool of_run = holds(directory, "result.json");
  if (!of_run && !holds(directory, "results.jsonl"))
    throw InputFault(directory + ": there are no results; run `stickslip study`, or `stickslip run` first");
  if (arguments.pdf) check_pdf_writer();
  const OutputFolder folder(directory, report_files());
  if (of_run) {
    write_run_report(directory, pdfs);
    say(std::cout, "{}\n", printable((std::filesystem::path(directory) / "report.html").string()));
    return done;
  }
  check_records(directory);
  const auto stored = read_rows(directory, [](json& row) { row = json::object(); });  // what counts is which there are
  tell_faults(stored, directory);
  if (stored.rows.empty())
    throw InputFault(directory + ": there are no rows in results.jsonl; run `stickslip study` with --resume first");
  write_report(directory, pdfs);
  say(std::cout, "{}\n", printable((std::filesystem::path(directory) / "report.html").string()));
  return done;
}

}  // namespace stickslip
