#include "studies/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "studies/io/input_fault.hpp"
#include "studies/io/other_program.hpp"
#include "studies/io/output_folder.hpp"
#include "studies/report/about.hpp"
#include "studies/report/certificates.hpp"
#include "studies/report/chart_parts.hpp"
#include "studies/report/charts.hpp"
#include "studies/report/embedded.hpp"
#include "studies/report/figure_files.hpp"
#include "studies/report/figure_html.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/html.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/page.hpp"
#include "studies/report/picture.hpp"
#include "studies/report/play_link.hpp"
#include "studies/report/records.hpp"
#include "studies/report/run_page.hpp"
#include "studies/report/sample.hpp"
#include "studies/report/scene_winners.hpp"
#include "studies/report/tables.hpp"
#include "studies/report/verdict.hpp"

namespace stickslip {

namespace {

using namespace report;
using nlohmann::json;

/// "3900 converged, 100 cap" of the runs' statuses.
std::string statuses(const Study& study) {
  std::map<std::string, int> count;
  for (const auto& cell : study.cells) ++count[cell.converged ? "converged" : cell.status];
  std::string out;
  for (const auto& [status, cells] : count) out += fmt::format("{}{} {}", out.empty() ? "" : ", ", cells, status);
  return out;
}

std::string findings(const Study& study, const Study& shown) {
  std::string out = "<ul class=\"headline\">";
  for (const auto& sentence : headline(study)) out += "<li>" + escape_sentence(sentence) + "</li>\n";
  out += "</ul>\n";
  if (!study.faults.empty()) out += fmt::format("<p class=\"warning\">results.jsonl: {}.</p>\n", escape(study.faults));
  if (study.unrecorded > 0)
    out += fmt::format("<p class=\"warning\">Of the study's {} runs {} {} not recorded, and missing here; {}.</p>\n",
                       study.unrecorded + study.cells.size(), study.unrecorded, study.unrecorded == 1 ? "is" : "are",
                       is_merged(study) ? "run their shards with <code>--resume</code>, and merge again"
                                        : "the command at the end runs them with <code>--resume</code>");
  if (shown.cells.size() < study.cells.size())
    out += fmt::format(
        "<p class=\"note\">Of {} runs ({}) the charts and tables show {}: scene variants evenly spaced, or "
        "settings of one. The sentences above, and the profiles, are of all; so is results.jsonl.</p>\n",
        study.cells.size(), escape(statuses(study)), shown.cells.size());
  const std::string settings = settings_table(shown);
  return settings.empty() ? out : out + folded("Default, tuned and strict settings side by side", settings);
}

/// What the first chart is of: responses, but where their errors are rounding in all runs, and those of derivatives are
/// not.
Of first_measure(const Study& study) {
  return !tells_apart(study, Of::responses) && tells_apart(study, Of::sensitivities) ? Of::sensitivities
                                                                                     : Of::responses;
}

/// The chart beside the verdict: the worst response, or derivative, of the main variant against work; lower beside a
/// verdict of many rows.
std::optional<Figure> first_chart(const Study& study, std::size_t rows_of_verdict) {
  const Of of = first_measure(study);
  auto figure = work_precision(study, Against::same_mesh, of);
  const bool on_same_mesh = figure.has_value();
  if (!figure) figure = work_precision(study, Against::discretization, of);
  if (!figure) return std::nullopt;
  json rows = json::array();
  for (auto& row : figure->rows)
    if (std::all_of(figure->choices.begin(), figure->choices.end(), [&](const Choice& choice) {
          return choice.several || choice.chosen.empty() || at(row, choice.field) == choice.chosen.front();
        }))
      rows.push_back(std::move(row));
  figure->rows = std::move(rows);
  if (study.families.size() == 1) {  // its name is the same in all
    for (auto& row : figure->rows) row["series"] = beside_method(row["series"], study.families.front());
    for (auto& series : figure->series) series.name = beside_method(series.name, study.families.front());
  }
  figure->choices.clear();
  figure->folded.clear();
  figure->charts.erase(figure->charts.begin() + 1, figure->charts.end());
  figure->charts.front().title.clear();
  constexpr std::size_t few = 4;  // rows, beside which a screen of 800 pixels has room for the whole chart
  figure->charts.front().height = 200 - 20 * static_cast<double>(std::max(rows_of_verdict, few) - few);
  figure->id = "first";
  figure->title = "What accuracy costs" + (study.main_variant.empty() ? "" : ": " + study.main_variant);
  figure->text = std::string("Error of the worst ") + (of == Of::responses ? "response" : "derivative") +
                 (on_same_mesh && !reference_run(study).empty() ? " against " + reference_run(study) : "") +
                 ". Lower left is better.";
  if (const std::string words = understood(study); !words.empty()) figure->text += " " + words;
  return figure;
}

/// "Varied together as meshes, 2 variants: /a, /b." of linked lists.
std::string together_in_words(const std::string& name, const json& lists) {
  std::string pointers;
  std::size_t values = 0;
  for (const auto& [pointer, list] : lists.items()) {
    pointers += (pointers.empty() ? "" : ", ") + pointer;
    values = list.size();
  }
  return fmt::format("Varied together as {}, {} variants: {}.", name, values, pointers);
}

/// What a reader sees first: who is the cheapest and why, the scene, a chart of what `study` shows of `all`.
std::string first_screen(const Study& all, const Study& study, Figures& figures) {
  auto overview = draw_overview(study.picture);
  if (const std::string title = text_at(study.description, "scene_title"); overview && !title.empty())
    overview->title = title;
  if (const std::string run = run_of_picture(all); overview && !run.empty())
    overview->text = run + ". " + overview->text;
  const Verdict best = verdict(all);
  const std::string scene = figures.show(std::move(overview)), chart = figures.show(first_chart(study, best.rows));
  const std::string sights = scene.empty() && chart.empty() ? "" : "<div class=\"first\">" + scene + chart + "</div>\n";
  const std::string failed = failures(all);
  std::string linked;
  for (const auto& [name, lists] : linked_lists(all.description))
    linked += escape(together_in_words(name, lists)) + " ";
  return (failed.empty() ? "" : "<p class=\"reason\">" + escape_sentence(failed) + "</p>\n") +
         (linked.empty() ? "" : "<p class=\"reason\">" + linked + "</p>\n") + cheapest_by_scene(all) + best.reason +
         sights + best.table;
}

std::string of_errors(const Study& all, const Study& study, Of of, Figures& figures) {
  std::string out = figures.show(work_precision(study, Against::same_mesh, of));
  out += figures.show(work_precision(study, Against::discretization, of));
  if (of == Of::responses) out += figures.show(mesh_convergence(study));
  return out + figures.show(profiles(all, of));
}

std::string of_knobs(const Study& study, Figures& figures) {
  std::string out;
  for (const auto& group : knob_groups(study)) {
    out += figures.show(error_against_knob(study, group));
    out += figures.show(iterations_against_knob(study, group));
    out += figures.show(robustness_windows(study, group));
  }
  return out;
}

std::string of_solution(const Study& study, Figures& figures) {
  auto responses = response_histories(study);
  auto derivatives = derivative_histories(study, first_choice(responses, "response"));
  std::string out = figures.beside(std::move(responses), film_of_states(study)) + figures.show(std::move(derivatives));
  if (needs_close_up(study.picture)) out += figures.show(draw_picture(study.picture));
  return out + figures.show(tractions(study));
}

std::string of_solver(const Study& study, Figures& figures) {
  const std::string out = figures.show(convergence_histories(study));
  return out + figures.show(work_precision(study, Against::coulomb, Of::responses));
}

/// `study`: what of `all` is shown run by run.
std::vector<Section> sections_of(const Study& all, const Study& study, Figures& figures) {
  const std::string variant = study.main_variant.empty() ? "" : ": " + escape(study.main_variant);
  return {
      {"findings", "What came out", findings(all, study)},
      {"solution", "The solution" + variant, of_solution(study, figures)},
      {"certificates", "Certificates", certificates_of_study(study)},
      {"responses", "Accuracy against cost: responses", of_errors(all, study, Of::responses, figures)},
      {"sensitivities", "Accuracy against cost: sensitivities", of_errors(all, study, Of::sensitivities, figures)},
      {"budget", "Where the error comes from", figures.show(error_budget(study)) + budget_in_words(study)},
      {"knobs", "Turning the knobs", of_knobs(study, figures)},
      {"solver", "The solver at work", of_solver(study, figures)},
      {"results", "All results",
       study.cells.empty() ? std::string() : results_table(study) + values_table(study) + status_table(study)},
      {"reading", "How to read this", how_to_read(all)},
      {"study", "What was simulated", what_was_simulated(all)},
      {"provenance", "Provenance",
       provenance(all) + folded("Licences of the chart library in this file",
                                "<pre>" + escape(embedded::third_party_notices()) + "</pre>\n")},
  };
}

}  // namespace

void check_pdf_writer() {
  if (!output_of({"rsvg-convert", "--version"}, {}))
    throw InputFault(
        "--pdf: rsvg-convert makes the PDFs, and is not here; install it (Debian: apt install librsvg2-bin)");
}

std::vector<std::string> report_files() {
  std::vector<std::string> files(std::begin(figure_files), std::end(figure_files));
  files.emplace_back("report.html");
  return files;
}

void write_report(const std::filesystem::path& directory, Pdfs pdfs) try {
  const Study study = read_study(directory);
  const Study shown = sample_of(study);
  Figures figures;
  const std::string title = text_at(study.description, "title");
  const std::string first = "<section id=\"verdict\">\n" + first_screen(study, shown, figures) +
                            play_link(directory, study.picture) + "</section>\n";
  write_output(directory / "report.html",
               page(title.empty() ? "Frictional contact study" : title, first, sections_of(study, shown, figures)));
  write_figures(directory, figures.figures, figures.plates, pdfs);
} catch (const json::exception& error) {  // rows have checksums; what else is recorded may have been edited
  throw not_written(directory.string() + ": study.json, picture.json or rows without a checksum", error,
                    "; delete them, and resume the study");
}

void write_run_report(const std::filesystem::path& directory, Pdfs pdfs) try {
  const Study run = read_run(directory);
  Figures figures;
  const std::string title = text_at(run.description, "title");
  const std::string first =
      "<section id=\"run\">\n" + first_of_run(run, figures) + play_link(directory, run.picture) + "</section>\n";
  write_output(directory / "report.html",
               page(title.empty() ? "Frictional contact" : title, first, sections_of_run(run, figures)));
  write_figures(directory, figures.figures, figures.plates, pdfs);
} catch (const json::exception& error) {  // it may have been edited
  throw not_written(directory.string() + ": result.json or picture.json", error, "; run the scene again with --report");
}

}  // namespace stickslip
