#include "studies/report/about.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "studies/input/method_options.hpp"
#include "studies/report/html.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/look_up.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

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
  for (const auto& [mesh, ratio] : study.ratio)
    values += fmt::format("{}{}{}", values.empty() ? "" : ", ", number(ratio, 2), mesh.empty() ? "" : " for " + mesh);
  return fmt::format(
      "Work is factorisations plus r times back-solves, those of derivatives included where derivatives are compared. "
      "r is the time of one back-solve over that of one factorisation, measured in this study over all its runs on a "
      "mesh: "
      "{}. Another study, or another run of this one, measures another r; its counts are the same.",
      values);
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
    out += folded("Its bodies, contacts, unknowns and effects, in words",
                  "<p class=\"note\">The scene of the study's last run; what varies, and the methods, are in the study "
                  "as given.</p>\n<pre class=\"wrap\">" +
                      escape(scene_in_words(explain)) + "</pre>\n");
  std::vector<std::pair<std::string, json>> entries;
  for (const char* group : {"mesh", "size"})
    for (const auto& [key, value] : object_at(d, group).items()) {
      entries.emplace_back(std::string(group) + ": " + in_plain_words(key), value);
    }
  out += definitions(entries);
  json given = d;
  for (const char* added : {"command", "scene_title", "analytic", "mesh", "size", "scene_hash", "explain"})
    given.erase(added);
  return out + folded("The study as given",
                      "<pre>" + escape(given.dump(2, ' ', false, json::error_handler_t::replace)) + "</pre>\n");
}

/// Scene, methods and options that tell no run from another.
std::string what_was_run(const Study& study) {
  std::string out;
  const json& scenes = object_at(study.description, "scene_titles");
  for (const auto& [file, title] : scenes.items())
    out += "<p>Scene " + escape(file) + ": " + escape(plain(title)) + "</p>\n";
  if (const std::string scene = text_at(study.description, "scene_title"); scenes.empty() && !scene.empty())
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
  if (const std::string words = understood(study); !words.empty())
    out += "<p class=\"note\">" + escape(words) + "</p>\n";
  return out;
}

}  // namespace

bool is_merged(const Study& study) { return text_at(study.description, "command").starts_with("stickslip merge "); }

std::string how_to_read(const Study& study) {
  std::string methods;
  for (const auto& name : method_names())
    methods += std::visit([](const auto& m) { return fmt::format("<li><b>{}</b> {}</li>", m.title, m.idea); },
                          *default_method(name));
  return "<p>Every dot is one complete run of one method with one setting. These methods make bodies keep apart" +
         std::string(is_frictionless(study) ? "" : " and obey Coulomb's friction") + ":</p><ul>" + methods +
         "</ul>"
         "<p>A <b>response</b> is a number the study asks for, such as a force. A <b>sensitivity</b> is the derivative "
         "of a response with respect to a parameter, computed the way that matches the method. The <b>enforcement "
         "error</b> compares with the exact contact conditions on the same mesh, so it blames the method alone; the "
         "<b>discretisation error</b> compares with a closed form, a finer mesh or given values and blames mesh and "
         "method together. All errors are "
         "relative. <b>Counts</b> (factorisations, back-solves) are equal on every machine; <b>seconds</b> are of the "
         "machine named at the end. Error and cost axes are logarithmic. Runs that failed stay, as crosses and as "
         "rows. " +
         escape(ratio_text(study)) + "</p>\n";
}

std::string what_was_simulated(const Study& study) { return what_was_run(study) + the_study(study); }

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
    if (key != "libraries" && key != "checksum") entries.emplace_back(in_plain_words(key), value);
  for (const auto& [name, version] : object_at(p, "libraries").items())
    entries.emplace_back("library " + name, version);
  entries.emplace_back("scene hash", at(study.description, "scene_hash"));
  return out + folded("Program, machine and libraries", definitions(entries));
}

}  // namespace stickslip::report
