#include "studies/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>

#include "studies/atomic_file.hpp"
#include "studies/input_fault.hpp"
#include "studies/report/charts.hpp"
#include "studies/report/embedded.hpp"
#include "studies/report/figure_files.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/picture.hpp"
#include "studies/report/plot.hpp"
#include "studies/report/records.hpp"
#include "studies/report/sample.hpp"
#include "studies/report/tables.hpp"
#include "studies/report/verdict.hpp"

namespace stickslip {

namespace {

using namespace report;
using nlohmann::json;

// --- figures -------------------------------------------------------------------------------------------------------

std::string control(const Choice& choice) {
  const std::string data = fmt::format("data-field=\"{}\" data-when-field=\"{}\" data-when=\"{}\"",
                                       escape(choice.field), escape(choice.when_field), escape(choice.when));
  const auto is_chosen = [&](const std::string& option) {
    return std::find(choice.chosen.begin(), choice.chosen.end(), option) != choice.chosen.end();
  };
  std::string out;
  if (!choice.several) {
    for (const auto& option : choice.options)
      out += fmt::format("<option value=\"{0}\"{1}>{0}</option>", escape(option), is_chosen(option) ? " selected" : "");
    return fmt::format("<label>{}: <select autocomplete=\"off\" {}>{}</select></label>\n", escape(choice.label), data,
                       out);
  }
  for (const auto& option : choice.options)
    out += fmt::format("<label><input type=\"checkbox\" autocomplete=\"off\" value=\"{0}\"{1}> {0}</label>",
                       escape(option), is_chosen(option) ? " checked" : "");
  return fmt::format("<details class=\"several\"><summary>{}</summary><div {}>{}</div></details>\n",
                     escape(choice.label), data, out);
}

/// The panel for readers without scripts; "" where it has nothing to draw.
std::string plain_picture(const Figure& figure, const Panel& panel) {
  const auto drawing = draw_plot(figure, panel);
  return drawing ? drawing->inline_svg() : std::string();
}

/// Six digits are more than a chart shows, in a third of the bytes. The files beside the page hold all of them.
json rounded(const json& value) {
  return value.is_number_float() ? json(std::strtod(fmt::format("{:.6g}", value.get<double>()).c_str(), nullptr))
                                 : value;
}

std::string to_html(const Figure& figure) {
  std::string open, folded_panels;
  json specs = json::array();
  for (const bool folded : {false, true})
    for (const auto& panel : figure.panels)
      if (panel.folded == folded) {
        json spec = panel.spec;
        spec["usermeta"] = {{"panel", panel.only}};
        specs.push_back(spec);
        (folded ? folded_panels : open) += fmt::format(
            "<div class=\"panel\"><h4>{}</h4><div class=\"vega\"></div><div class=\"static\">{}</div></div>\n",
            escape(panel.title), plain_picture(figure, panel));
      }
  json series = json::array();
  for (const auto& s : figure.series)
    series.push_back({{"name", s.name}, {"color", s.color}, {"shape", s.shape}, {"dash", s.dash}, {"size", s.size}});
  // Rows as arrays under one list of fields: half the bytes of objects.
  std::set<std::string> fields;
  for (const auto& row : figure.rows)
    for (const auto& [field, value] : row.items()) fields.insert(field);
  json rows = json::array();
  for (const auto& row : figure.rows) {
    json values = json::array();
    for (const auto& field : fields) values.push_back(rounded(at(row, field)));
    rows.push_back(values);
  }
  std::string controls;
  for (const auto& choice : figure.choices) controls += control(choice);
  std::string out = fmt::format(
      "<figure data-chart id=\"{0}\" aria-labelledby=\"{0}-title\">\n<figcaption><h3 "
      "id=\"{0}-title\">{1}</h3><p>{2}</p>"
      "</figcaption>\n",
      figure.id, escape(figure.title), escape(figure.text));
  if (!controls.empty()) out += "<div class=\"choices\">" + controls + "</div>\n";
  out += "<div class=\"panels\">" + open + "</div>\n";
  if (!folded_panels.empty())
    out += "<details class=\"panels-folded\"><summary>More views</summary><div class=\"panels\">" + folded_panels +
           "</div></details>\n";
  out += "<details class=\"data\"><summary>Data of this chart</summary></details>\n";
  return out + fmt::format("<script type=\"application/json\" id=\"{}-data\">{}</script>\n</figure>\n", figure.id,
                           embed({{"fields", fields},
                                  {"columns", columns_of(figure.rows)},
                                  {"rows", rows},
                                  {"series", series},
                                  {"panels", specs}}));
}

std::string to_html(const Plate& plate) {
  return fmt::format(
      "<figure class=\"plate\" id=\"{0}\" aria-labelledby=\"{0}-title\">\n<figcaption><h3 id=\"{0}-title\">{1}</h3>"
      "<p>{2}</p></figcaption>\n<div class=\"drawn\" role=\"region\" tabindex=\"0\" aria-label=\"{1}\">{3}</div>\n{4}"
      "</figure>\n",
      plate.id, escape(plate.title), escape(plate.text), plate.drawing.inline_svg(),
      plate.table.rows.empty() ? "" : folded("Data of this chart", report::to_html(plate.table, plate.title)));
}

// --- sections ------------------------------------------------------------------------------------------------------

struct Section {
  std::string id, title, content;
};

std::string definitions(const std::vector<std::pair<std::string, json>>& entries) {
  std::string out;
  for (const auto& [term, value] : entries)
    if (!value.is_null() && value != "")
      out += fmt::format("<dt>{}</dt><dd>{}</dd>", escape(term), escape(plain(value)));
  return out.empty() ? out : "<dl>" + out + "</dl>\n";
}

/// What `work` means on the charts of this study.
std::string ratio_text(const Study& study) {
  if (study.ratio.empty())
    return "Back-solves could not be weighed (no seconds recorded), so work is factorisations alone.";
  std::string values;
  for (const auto& [refine, ratio] : study.ratio)
    values +=
        fmt::format("{}{}", values.empty() ? "" : ", ",
                    study.refined ? fmt::format("{} on mesh level {}", number(ratio, 2), refine) : number(ratio, 2));
  return fmt::format(
      "Work is factorisations plus r times back-solves, with r the measured cost of one back-solve over "
      "one factorisation, pooled over all runs: {}.",
      values);
}

std::string how_to_read(const Study& study) {
  return "<p>Every dot is one complete run of one method with one setting. Three methods make bodies keep apart and "
         "obey Coulomb's friction:</p><ul>"
         "<li><b>Penalty</b> puts stiff springs between the bodies. One solve, but they sink in a little; stiffer "
         "springs err less and make the equations harder to solve accurately.</li>"
         "<li><b>Uzawa AL</b> (augmented Lagrangian) solves with soft springs, adds the force that was missing, and "
         "repeats until nothing is missing: exact in the limit, at the price of repetition.</li>"
         "<li><b>Monolithic AL</b> makes the contact forces unknowns of the same equations: exact at once, with a "
         "larger "
         "and less friendly system.</li></ul>"
         "<p>A <b>response</b> is a number the study asks for, such as a force. A <b>sensitivity</b> is the derivative "
         "of a response with respect to a parameter, computed the way that matches the method. The <b>enforcement "
         "error</b> compares with the exact contact conditions on the same mesh, so it blames the method alone; the "
         "<b>discretisation error</b> compares with a closed form, a finer mesh or given values and blames mesh and "
         "method together. All errors are "
         "relative. <b>Counts</b> (factorisations, back-solves) are equal on every machine; <b>seconds</b> are of the "
         "machine named at the end. Error and cost axes are logarithmic: a grid line is usually a factor of ten. Runs "
         "that failed stay, as crosses and as rows. " +
         escape(ratio_text(study)) + "</p>\n";
}

bool is_merged(const Study& study) { return text_at(study.description, "command").starts_with("stickslip merge "); }

std::string provenance(const Study& study) {
  std::string out;
  if (const std::string command = text_at(study.description, "command"); !command.empty())
    out +=
        (is_merged(study) ? "<p>Shards of the study were run apart, each with a report of its own that says how, and "
                            "joined by:</p><pre>"
                          : "<p>This repeats the study; cells already recorded are kept with "
                            "<code>--resume</code>:</p><pre>") +
        escape(command) + "</pre>\n";
  if (study.cells.empty()) return out;
  // Seconds compare only between cells of one machine and build.
  std::set<std::string> builds;
  for (const auto& cell : study.cells) {
    const json& p = at(cell.record, "provenance");
    std::string build;
    for (const char* key : {"git", "compiler", "flags", "cpu", "blas", "threads"}) build += plain(at(p, key)) + '\n';
    builds.insert(build);
  }
  if (builds.size() > 1)
    out += fmt::format(
        "<p class=\"warning\">The runs come from {} different builds or machines: compare their counts, "
        "not their seconds. What follows is the first run's.</p>\n",
        builds.size());
  const json& p = object_at(study.cells.front().record, "provenance");
  std::vector<std::pair<std::string, json>> entries;
  for (const auto& [key, value] : p.items())
    if (key != "libraries" && key != "checksum") entries.emplace_back(key, value);
  for (const auto& [name, version] : object_at(p, "libraries").items())
    entries.emplace_back("library " + name, version);
  entries.emplace_back("scene hash", at(study.description, "scene_hash"));
  return out + definitions(entries);
}

/// What `explain` says of a cell, without what its method alone makes so: the line "method: ..." and the multipliers.
std::string scene_in_words(const std::string& explain) {
  std::istringstream lines(explain);
  std::string out;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("method: ")) continue;
    if (line.starts_with("unknowns: ")) line.erase(std::min(line.find(','), line.size()));
    out += line + "\n";
  }
  return out;
}

std::string the_study(const Study& study) {
  const json& d = study.description;
  if (!d.is_object()) return "<p>No study.json was recorded.</p>\n";
  std::string out;
  if (const std::string explain = text_at(d, "explain"); !explain.empty())
    out +=
        "<p class=\"note\">The scene of the study's last run; what varies, and the methods, are in the study as "
        "given.</p>\n<pre class=\"wrap\">" +
        escape(scene_in_words(explain)) + "</pre>\n";
  std::vector<std::pair<std::string, json>> entries;
  for (const char* group : {"mesh", "size"})
    for (const auto& [key, value] : object_at(d, group).items()) {
      std::string words = key;
      std::replace(words.begin(), words.end(), '_', ' ');
      entries.emplace_back(std::string(group) + ": " + words, value);
    }
  out += definitions(entries);
  json given = d;
  for (const char* added : {"command", "scene_title", "analytic", "mesh", "size", "scene_hash", "explain"})
    given.erase(added);
  return out + folded("The study as given",
                      "<pre>" + escape(given.dump(2, ' ', false, json::error_handler_t::replace)) + "</pre>\n");
}

/// What the page shows, kept for the files beside it.
class Figures {
 public:
  std::string show(std::optional<Figure> figure) {
    if (!figure) return {};
    figures.push_back(*std::move(figure));
    return to_html(figures.back());
  }
  std::string show(std::optional<Plate> plate) {
    if (!plate) return {};
    plates.push_back(*std::move(plate));
    return to_html(plates.back());
  }

  std::vector<Figure> figures;
  std::vector<Plate> plates;
};

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
  for (const auto& sentence : headline(study)) out += "<li>" + escape(sentence) + "</li>\n";
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

/// The chart beside the verdict: the worst response of the main variant against work.
std::optional<Figure> first_chart(const Study& study) {
  auto figure = work_precision(study, Against::same_mesh, Of::responses);
  if (!figure) figure = work_precision(study, Against::discretization, Of::responses);
  if (!figure) return std::nullopt;
  json rows = json::array();
  for (auto& row : figure->rows)
    if (std::all_of(figure->choices.begin(), figure->choices.end(), [&](const Choice& choice) {
          return choice.several || choice.chosen.empty() || at(row, choice.field) == choice.chosen.front();
        }))
      rows.push_back(std::move(row));
  figure->rows = std::move(rows);
  figure->choices.clear();
  figure->panels.erase(figure->panels.begin() + 1, figure->panels.end());
  figure->panels.front().title.clear();
  figure->panels.front().spec["height"] = 250;
  figure->id = "first";
  figure->title = "What accuracy costs";
  figure->text = "Error of the worst response. Lower left is better.";
  return figure;
}

/// What a reader sees first: the scene, a chart of what `study` shows of `all`, and who is the cheapest.
std::string first_screen(const Study& all, const Study& study, Figures& figures) {
  auto overview = draw_overview(study.picture);
  if (const std::string title = text_at(study.description, "scene_title"); overview && !title.empty())
    overview->title = title;
  const std::string scene = figures.show(std::move(overview)), chart = figures.show(first_chart(study));
  const std::string sights = scene.empty() && chart.empty() ? "" : "<div class=\"first\">" + scene + chart + "</div>\n";
  return sights + verdict(all);
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
  std::string out = figures.show(draw_picture(study.picture));
  out += figures.show(tractions(study));
  return out + figures.show(film_of_states(study));
}

std::string of_solver(const Study& study, Figures& figures) {
  const std::string out = figures.show(convergence_histories(study));
  return out + figures.show(work_precision(study, Against::coulomb, Of::responses));
}

/// Scene, methods and options that tell no run from another.
std::string what_was_run(const Study& study) {
  std::string out;
  if (const std::string scene = text_at(study.description, "scene_title"); !scene.empty())
    out += "<p>Scene: " + escape(scene) + "</p>\n";
  std::string methods;
  for (const auto& family : study.families) methods += (methods.empty() ? "" : ", ") + family_name(family);
  if (!study.cells.empty())
    out += fmt::format("<p class=\"note\">Runs: {}. Methods: {}. Scene variants: {}.</p>\n", study.cells.size(),
                       escape(methods), study.variants.size());
  std::string shared;
  for (const auto& option : study.shared) shared += (shared.empty() ? "" : ", ") + option;
  if (!shared.empty())
    out += "<p class=\"note\">Left out of the names of runs, since it tells none apart: " + escape(shared) + ".</p>\n";
  return out;
}

/// `study`: what of `all` is shown run by run.
std::vector<Section> sections_of(const Study& all, const Study& study, Figures& figures) {
  return {
      {"findings", "What came out", findings(all, study)},
      {"responses", "Accuracy against cost: responses", of_errors(all, study, Of::responses, figures)},
      {"sensitivities", "Accuracy against cost: sensitivities", of_errors(all, study, Of::sensitivities, figures)},
      {"knobs", "Turning the knobs", of_knobs(study, figures)},
      {"solution", "The solution", of_solution(study, figures)},
      {"solver", "The solver at work", of_solver(study, figures)},
      {"results", "All results",
       study.cells.empty() ? std::string() : results_table(study) + values_table(study) + status_table(study)},
      {"reading", "How to read this", how_to_read(all)},
      {"study", "What was simulated", what_was_run(all) + the_study(all)},
      {"provenance", "Provenance",
       provenance(all) + folded("Licences of the chart library in this file",
                                "<pre>" + escape(embedded::third_party_notices()) + "</pre>\n")},
  };
}

/// The template with each {{name}} replaced once; what is put in is not searched again.
std::string fill(std::string_view page, const std::map<std::string, std::string, std::less<>>& parts) {
  std::string out;
  for (;;) {
    const std::size_t open = page.find("{{"), close = page.find("}}", open);
    if (close == std::string_view::npos) return out.append(page);
    out.append(page.substr(0, open)).append(parts.find(page.substr(open + 2, close - open - 2))->second);
    page.remove_prefix(close + 2);
  }
}

std::string page_of(const Study& study, const Study& shown, Figures& figures) {
  const std::string title = text_at(study.description, "title");
  const std::string first = "<section id=\"verdict\">\n" + first_screen(study, shown, figures) + "</section>\n";
  std::string navigation, content;
  for (const auto& section : sections_of(study, shown, figures)) {
    if (section.content.empty()) continue;
    navigation += fmt::format("<a href=\"#{}\">{}</a>\n", section.id, section.title);
    content +=
        fmt::format("<section><h2 id=\"{}\">{}</h2>\n{}</section>\n", section.id, section.title, section.content);
  }
  return fill(embedded::page_html(), {{"title", escape(title.empty() ? "Frictional contact study" : title)},
                                      {"css", std::string(embedded::page_css())},
                                      {"first", first},
                                      {"navigation", navigation},
                                      {"content", content},
                                      {"vega", embed_script(embedded::vega_js())},
                                      {"vega_lite", embed_script(embedded::vega_lite_js())},
                                      {"vega_embed", embed_script(embedded::vega_embed_js())},
                                      {"js", embed_script(embedded::page_js())}});
}

}  // namespace

void write_report(const std::filesystem::path& directory) try {
  const Study study = read_study(directory);
  const Study shown = sample_of(study);
  Figures figures;
  write_file_atomically(directory / "report.html", page_of(study, shown, figures));
  write_figures(directory, figures.figures, figures.plates);
} catch (const json::exception& error) {  // rows have checksums; what else is recorded may have been edited
  throw InputFault(directory.string() + ": study.json, picture.json or rows without a checksum hold what stickslip " +
                   "does not write (" + error.what() + "); delete them, and run the study again with --resume");
}

}  // namespace stickslip
