#include "studies/sweep/study_reader.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <set>
#include <system_error>

#include "studies/input/small_objects.hpp"
#include "studies/sweep/cell_inputs.hpp"
#include "studies/sweep/study_reading.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

constexpr double most_cells = 100'000;  ///< of a study

/// A scene that the study names, by its path from the study's file. None where it cannot be read.
std::optional<JsonDocument> scene_beside(const std::string& file, const JsonNode& node, Diagnostics& diagnostics) {
  const auto name = node.text();
  if (!name) return std::nullopt;
  const std::filesystem::path path = (std::filesystem::path(file).parent_path() / *name).lexically_normal();
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(path, unreadable)) {
    node.error("the scene file " + path.string() + " cannot be read: it " +
               (std::filesystem::exists(path, unreadable) ? "is no file" : "is not there"));
    return std::nullopt;
  }
  auto scene = JsonDocument::read(path.string(), diagnostics);
  if (!scene || scene->root().is_object()) return scene;
  diagnostics.error({scene->place(""), "", "is " + shown(scene->root()) + "; must be an object"});
  return std::nullopt;
}

/// The scenes that can be read of those that the study names.
std::vector<StudyScene> read_scenes(const std::string& file, const JsonNode& study, Diagnostics& diagnostics) {
  std::vector<StudyScene> scenes;
  const auto one = study.find("scene"), several = study.find("scenes");
  if (one && several) several->error_at_key(R"(goes in place of "scene"; give one of the two)");
  if (one)
    if (auto scene = scene_beside(file, *one, diagnostics)) scenes.push_back({"", *std::move(scene)});
  if (!one && !several) study.error(R"(the key "scene" is missing; required: scene, or scenes, a list)");
  if (one || !several) return scenes;
  const bool is_list = several->value().is_array() && several->value().size() > 1;
  if (!is_list) several->must_be(R"(a list of two or more scene files, as in ["coarse.json", "fine.json"])");
  std::set<json> before;
  for (const JsonNode& node : is_list ? several->elements() : std::vector<JsonNode>{})
    if (!before.insert(node.value()).second)
      node.error("is " + shown(node.value()) + ", which the list has already");
    else if (auto scene = scene_beside(file, node, diagnostics))
      scenes.push_back({node.value().get<std::string>(), *std::move(scene)});
  return scenes;
}

/// What is swept, and what the results are held against; each has its default where the study says nothing of it.
void read_lists(const JsonNode& root, const std::optional<JsonNode>& scene, Study& study) {
  const json& known = scene ? scene->value() : json();
  const bool several = root.find("scenes").has_value();
  if (several && !root.find("methods"))
    root.error(R"(the key "methods" is missing; a study of several scenes needs it)");
  else
    study.methods = read_methods(root, scene);
  if (const auto vary = root.find("vary")) study.vary = read_vary(*vary, known);
  const auto refine = root.find("refine");
  study.refine = refine ? read_levels(*refine) : std::vector<PlacedValue>{{0, root.place()}};
  if (const auto references = root.find("reference")) study.references = read_references(*references, known);
  const auto errors = root.find("errors");
  study.errors = errors ? read_errors(*errors, known) : std::vector<std::string>{"response:*", "sensitivity:*", "kkt"};
}

/// read_lists() for each scene. A fault that not all scenes have says whose it is.
void read_lists_of_all(Study& study, Diagnostics& diagnostics) {
  std::vector<std::pair<std::string, std::vector<Diagnostic>>> faults;  // by scene
  const auto read = [&](const std::string& name, const JsonDocument* document) {
    Diagnostics own;
    read_lists(JsonNode(study.document, own),
               document ? std::optional<JsonNode>(std::in_place, *document, own) : std::nullopt, study);
    faults.emplace_back(name, own.errors());
  };
  if (study.scenes.empty()) read("", nullptr);
  for (const StudyScene& scene : study.scenes) read(scene.file, &scene.document);
  std::map<std::string, std::size_t> scenes_of;  // how many have a fault, by its text
  for (const auto& [name, own] : faults)
    for (const Diagnostic& fault : own) ++scenes_of[fault.text()];
  for (auto& [name, own] : faults)
    for (Diagnostic& fault : own) {
      if (scenes_of[fault.text()] < faults.size()) fault.message += " (of " + name + ")";
      diagnostics.error(fault);
    }
}

/// The accuracies of the page's verdict; they stay in the study as given.
void check_accuracies(const JsonNode& node) {
  constexpr std::size_t most_columns = 6;
  const bool is_list = node.value().is_array() && !node.value().empty() && node.value().size() <= most_columns;
  if (!is_list) return node.must_be("a list of up to six relative errors, as in [1e-2, 1e-4, 1e-6]");
  constexpr Rule relative_error{"a number > 0 and < 1", [](double x) { return x > 0 && x < 1; }};
  for (const JsonNode& error : node.elements()) error.number(relative_error);
}

/// Rounds of the timing pass; 0: there is none.
int read_rounds(const JsonNode& node, Diagnostics& diagnostics) {
  return read_described<TimingObject>(node, diagnostics).value_or(TimingObject()).repeat.value_or(0);
}

/// How many copies the error budget takes; 0: none is asked for.
int read_budget(const JsonNode& node, Diagnostics& diagnostics) {
  if (node.value().is_boolean()) return node.value().get<bool>() ? ErrorBudgetObject().copies : 0;
  if (!node.value().is_object()) {
    node.must_be(R"(true, false, or {"copies": n})");
    return 0;
  }
  return read_described<ErrorBudgetObject>(node, diagnostics).value_or(ErrorBudgetObject()).copies;
}

/// How many combinations there are, in a double, which does not overflow.
double combinations(const std::vector<Knob>& sweeps) {
  double count = 1;
  for (const Knob& sweep : sweeps) count *= static_cast<double>(sweep.values.size());
  return count;
}

double cell_count(const Study& study) {
  double methods = 0, variants = static_cast<double>(study.refine.size());
  for (const MethodSweep& method : study.methods) methods += combinations(method.options);
  for (const Variation& variation : study.vary) variants *= static_cast<double>(variation.size());
  return static_cast<double>(study.scenes.size()) * variants * methods;
}

}  // namespace

std::optional<Study> read_study(const std::string& file, Diagnostics& diagnostics) {
  const std::size_t faults = diagnostics.error_count();
  auto document = JsonDocument::read(file, diagnostics);
  if (!document) return std::nullopt;
  Study study;
  study.document = *std::move(document);
  const JsonNode root(study.document, diagnostics);
  if (root.value().is_object() && root.value().contains("bodies") && !root.value().contains("scene") &&
      !root.value().contains("scenes")) {
    root.error("is a scene, not a study; `stickslip run` runs it, and a study names it: \"scene\": \"" +
               std::filesystem::path(file).filename().string() + "\"");
    return std::nullopt;
  }
  if (!root.is_object(keys_of(study_object("study")))) return std::nullopt;
  if (const auto schema = root.find("$schema")) schema->text();
  if (const auto title = root.find("title")) study.title = title->text().value_or("");
  study.scenes = read_scenes(file, root, diagnostics);
  read_lists_of_all(study, diagnostics);
  if (const auto solutions = root.find("solutions")) study.solutions = read_solutions(*solutions, file);
  if (const auto accuracy = root.find("accuracy")) check_accuracies(*accuracy);
  if (const auto timing = root.find("timing")) study.repeat = read_rounds(*timing, diagnostics);
  if (const auto budget = root.find("error_budget")) study.budget_copies = read_budget(*budget, diagnostics);
  if (const double count = cell_count(study); count > most_cells) {  // too many to look at each of their values
    root.error(fmt::format("makes {:.0f} cells of all its lists; allowed: {:.0f} at most", count, most_cells));
    return std::nullopt;
  }
  if (diagnostics.error_count() == faults) return study;
  MeshFiles meshes;
  check_parts(study, diagnostics, meshes);
  return std::nullopt;
}

}  // namespace stickslip
