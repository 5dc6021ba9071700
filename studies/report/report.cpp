#include "studies/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "studies/atomic_file.hpp"
#include "studies/report/charts.hpp"
#include "studies/report/embedded.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/html.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/picture.hpp"
#include "studies/report/plot.hpp"
#include "studies/report/records.hpp"

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
            escape(panel.title), draw_plot(figure, panel));
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
    for (const auto& field : fields) values.push_back(at(row, field));
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
  out += folded("Data of this chart", report::to_html(figure.table, figure.title));
  return out + fmt::format("<script type=\"application/json\" id=\"{}-data\">{}</script>\n</figure>\n", figure.id,
                           embed({{"fields", fields}, {"rows", rows}, {"series", series}, {"panels", specs}}));
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
         "<b>discretisation error</b> compares with a closed form and blames mesh and method together. All errors are "
         "relative. <b>Counts</b> (factorisations, back-solves) are equal on every machine; <b>seconds</b> are of the "
         "machine named at the end. Error and cost axes are logarithmic: a grid line is usually a factor of ten. Runs "
         "that failed stay, as crosses and as rows. " +
         escape(ratio_text(study)) + "</p>\n";
}

/// Settings against variants of the scene: the windows in which each setting works.
std::string robustness(const Study& study) {
  if (study.variants.size() < 2) return {};
  Table table;
  table.header = {"method"};
  for (const auto& variant : study.variants) table.header.push_back(variant);
  std::vector<std::string> labels;
  std::map<std::pair<std::string, std::string>, const Cell*> at;
  for (const auto& cell : study.cells) {
    if (std::find(labels.begin(), labels.end(), cell.label) == labels.end()) labels.push_back(cell.label);
    at[{cell.label, cell.variant}] = &cell;
  }
  for (const auto& label : labels) {
    std::vector<std::string> row = {label};
    bool failed = false;
    for (const auto& variant : study.variants) {
      const auto found = at.find({label, variant});
      if (found == at.end()) {
        row.emplace_back("not run");
        continue;
      }
      const Cell& cell = *found->second;
      failed = failed || !cell.converged;
      row.push_back(cell.converged ? fmt::format("ok, {} Newton", number(cell.count("newton"), 9))
                                   : (cell.status.empty() ? "no status" : cell.status));
    }
    table.rows.push_back(row);
    table.row_classes.emplace_back(failed ? "failed" : "");
  }
  return "<h3>Which setting works where</h3>\n" + report::to_html(table, "Status by setting and scene");
}

std::string results_table(const Study& study) {
  Table table;
  table.header = {"method",
                  "scene",
                  "status",
                  "worst response error",
                  "worst sensitivity error",
                  "response error to closed form",
                  "sensitivity error to closed form",
                  "worst KKT measure",
                  "Newton",
                  "augmentations",
                  "cutbacks",
                  "factorisations",
                  "back-solves",
                  "sensitivity back-solves",
                  "seconds",
                  "of these sensitivities",
                  "memory MB",
                  "condition",
                  "message"};
  const auto shown = [](const std::optional<double>& v) { return v ? number(*v) : std::string(); };
  for (const auto& cell : study.cells) {
    const json &cost = at(cell.record, "cost"), &seconds = at(cost, "seconds");
    const auto count = [&](const char* name) { return number(cell.count(name), 9); };
    const auto recorded = [](const json& v) { return v.is_number() ? number(v.get<double>()) : std::string(); };
    table.rows.push_back({cell.label, cell.variant, cell.status.empty() ? "no status" : cell.status,
                          shown(worst(cell.enforcement, "response:")), shown(worst(cell.enforcement, "sensitivity:")),
                          shown(worst(cell.discretization, "response:")),
                          shown(worst(cell.discretization, "sensitivity:")), shown(worst(cell.kkt, "")),
                          count("newton"), count("augmentations"), count("cutbacks"), count("factorizations"),
                          count("backsolves"), count("sensitivity_backsolves"), recorded(at(seconds, "total")),
                          recorded(at(seconds, "sensitivity")), recorded(at(cost, "peak_memory_mb")),
                          recorded(at(cost, "condition_estimate")), plain(at(cell.record, "message"))});
    table.row_classes.emplace_back(cell.converged ? "" : "failed");
  }
  return report::to_html(table, "All runs");
}

/// Responses and sensitivities at the last step, ten digits: enough to see where two runs part.
std::string values_table(const Study& study) {
  std::set<std::pair<std::string, std::string>> columns;  // response, parameter or ""
  for (const auto& cell : study.cells) {
    for (const auto& [name, value] : object_at(cell.record, "responses").items()) columns.emplace(name, "");
    for (const auto& [name, by] : object_at(cell.record, "sensitivities").items())
      if (by.is_object())
        for (const auto& [parameter, value] : by.items()) columns.emplace(name, parameter);
  }
  if (columns.empty()) return {};
  Table table;
  table.header = {"method", "scene", "status"};
  for (const auto& [name, by] : columns) table.header.push_back(by.empty() ? name : "d " + name + " / d " + by);
  for (const auto& cell : study.cells) {
    std::vector<std::string> row = {cell.label, cell.variant, cell.status};
    for (const auto& [name, by] : columns) {
      const json& v =
          by.empty() ? at(at(cell.record, "responses"), name) : at(at(at(cell.record, "sensitivities"), name), by);
      row.push_back(v.is_number() ? number(v.get<double>(), 10) : plain(v));
    }
    table.rows.push_back(row);
    table.row_classes.emplace_back(cell.converged ? "" : "failed");
  }
  return folded("Values of responses and sensitivities at the last step",
                report::to_html(table, "Responses and sensitivities at the last step"));
}

std::string provenance(const Study& study) {
  std::string out;
  if (const std::string command = text_at(study.description, "command"); !command.empty())
    out += "<p>This repeats the study; cells already recorded are kept with <code>--resume</code>:</p><pre>" +
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
    if (key != "libraries") entries.emplace_back(key, value);
  for (const auto& [name, version] : object_at(p, "libraries").items())
    entries.emplace_back("library " + name, version);
  entries.emplace_back("scene hash", at(study.description, "scene_hash"));
  return out + definitions(entries);
}

std::string the_study(const Study& study) {
  const json& d = study.description;
  if (!d.is_object()) return "<p>No study.json was recorded.</p>\n";
  std::string out;
  if (const std::string explain = text_at(d, "explain"); !explain.empty())
    out += "<pre class=\"wrap\">" + escape(explain) + "</pre>\n";
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

template <class... Maybe>
std::string join(const Maybe&... figures) {
  std::string out;
  ((out += figures ? to_html(*figures) : std::string()), ...);
  return out;
}

std::vector<Section> sections_of(const Study& study) {
  std::string findings = "<ul class=\"headline\">";
  for (const auto& sentence : headline(study)) findings += "<li>" + escape(sentence) + "</li>\n";
  findings += "</ul>\n";
  if (study.unreadable_lines > 0)
    findings +=
        fmt::format("<p class=\"warning\">{} line(s) of results.jsonl could not be read and are missing here.</p>\n",
                    study.unreadable_lines);
  std::string knobs;
  for (const auto& group : knob_groups(study))
    knobs += join(error_against_knob(study, group), iterations_against_knob(study, group));
  return {
      {"findings", "What came out", findings},
      {"reading", "How to read this", how_to_read(study)},
      {"responses", "Accuracy against cost: responses",
       join(work_precision(study, Against::same_mesh, Of::responses),
            work_precision(study, Against::closed_form, Of::responses), mesh_convergence(study))},
      {"sensitivities", "Accuracy against cost: sensitivities",
       join(work_precision(study, Against::same_mesh, Of::sensitivities),
            work_precision(study, Against::closed_form, Of::sensitivities))},
      {"knobs", "Turning the knobs", knobs},
      {"solution", "The solution", draw_picture(study.picture) + join(tractions(study))},
      {"solver", "The solver at work",
       join(convergence_histories(study), work_precision(study, Against::coulomb, Of::responses))},
      {"results", "All results",
       study.cells.empty() ? std::string() : results_table(study) + values_table(study) + robustness(study)},
      {"study", "What was simulated", the_study(study)},
      {"provenance", "Provenance",
       provenance(study) + folded("Licences of the chart library in this file",
                                  "<pre>" + escape(embedded::third_party_notices()) + "</pre>\n")},
  };
}

std::string intro(const Study& study) {
  std::string out;
  if (const std::string scene = text_at(study.description, "scene_title"); !scene.empty())
    out += "<p>Scene: " + escape(scene) + "</p>\n";
  std::string methods;
  for (const auto& family : study.families) methods += (methods.empty() ? "" : ", ") + family_name(family);
  if (!study.cells.empty())
    out += fmt::format("<p class=\"note\">Runs: {}. Methods: {}. Scene variants: {}.</p>\n", study.cells.size(),
                       escape(methods), study.variants.size());
  return out;
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

std::string page_of(const Study& study) {
  const std::string title = text_at(study.description, "title");
  std::string navigation, content;
  for (const auto& section : sections_of(study)) {
    if (section.content.empty()) continue;
    navigation += fmt::format("<a href=\"#{}\">{}</a>\n", section.id, section.title);
    content +=
        fmt::format("<section><h2 id=\"{}\">{}</h2>\n{}</section>\n", section.id, section.title, section.content);
  }
  return fill(embedded::page_html(), {{"title", escape(title.empty() ? "Frictional contact study" : title)},
                                      {"css", std::string(embedded::page_css())},
                                      {"intro", intro(study)},
                                      {"navigation", navigation},
                                      {"content", content},
                                      {"vega", embed_script(embedded::vega_js())},
                                      {"vega_lite", embed_script(embedded::vega_lite_js())},
                                      {"vega_embed", embed_script(embedded::vega_embed_js())},
                                      {"js", embed_script(embedded::page_js())}});
}

}  // namespace

void write_report(const std::filesystem::path& directory) {
  write_file_atomically(directory / "report.html", page_of(read_study(directory)));
}

}  // namespace stickslip
