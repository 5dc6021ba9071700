#include "studies/input/scene_reader.hpp"

#include <algorithm>
#include <filesystem>

#include "studies/input/file_objects.hpp"
#include "studies/input/method_options.hpp"
#include "studies/input/small_objects.hpp"

namespace stickslip {
namespace {

void read_linear_solver(const JsonNode& node, SceneReading& reading, Input& input) {
  const Scene& scene = reading.scene;
  const auto given = read_described<LinearSolverObject>(node, reading);
  if (!given) return;
  input.linear_algebra.engine = given->engine;
  input.backend = given->backend;
  const auto remembers = [](const Body& body) { return flows(body.material); };
  const bool none_constant = scene.finite_strain || (!scene.bodies.empty() &&
                                                     std::all_of(scene.bodies.begin(), scene.bodies.end(), remembers));
  if (given->engine == LinearAlgebra::Engine::condensed && none_constant)
    node.find("engine")->error(
        R"(is "condensed", which needs a body of a constant stiffness; allowed where strains are finite or all bodies flow: auto, sparse)");
  if (input.backend != Backend::automatic && !has_backend(input.backend)) {
    const JsonNode backend = *node.find("backend");
    backend.error("is " + in_quotes(*backend.text()) + ", which is not part of this build");
  }
}

/// Input::fields_every.
int read_output(const JsonNode& node) {
  const auto fields = node.is_object(keys_of(scene_object("output"))) ? node.find("fields") : std::nullopt;
  if (!fields || fields->value() == "last") return 0;
  if (fields->value() == "all") return 1;
  if (fields->value().is_number()) return fields->count(1).value_or(1);
  fields->must_be(R"("last", "all" or a whole number >= 1)");
  return 0;
}

/// Notes on obstacles that no contact names.
void note_idle_obstacles(const JsonNode& node, SceneReading& reading) {
  const auto& contacts = reading.scene.contacts;
  for (const auto& [name, obstacle] : node.value().is_object() ? node.members() : decltype(node.members()){}) {
    const bool used = std::any_of(contacts.begin(), contacts.end(),
                                  [&, &name = name](const Contact& contact) { return contact.master == name; });
    if (!used)
      reading.diagnostics.note(
          {obstacle.place(), obstacle.pointer(), "is an obstacle that no contact names as master"});
  }
}

void read_sensitivity(const JsonNode& node, SceneReading& reading, Input& input) {
  const auto given = read_described<SensitivityObject>(node, reading);
  if (!given) return;
  input.state_memory = given->memory * megabyte;
  const auto mode = node.find("mode"), memory = node.find("memory");
  if (memory && (!mode || mode->value() == "direct")) memory->error_at_key(R"(belongs to "mode": "adjoint")");
  if (given->mode == SensitivityMode::direct) return;
  reading.scene.sensitivity_mode = SensitivityMode::adjoint;
  if (reading.scene.objectives.empty() && !reading.diagnostics.has_error_in("/objectives"))
    mode->error(R"(is "adjoint", which differentiates the objectives, and the scene has none; add "objectives", )"
                R"(or use "direct")");
}

/// Another method than the scene's: what the scene says of its own is checked, then replaced by the other's defaults.
void select_method(JsonDocument& document, const std::optional<std::string>& name, Diagnostics& diagnostics,
                   MeshFiles& mesh_files) {
  if (!name || !document.root().is_object()) return;
  if (!default_method(*name)) {
    diagnostics.error({{diagnostics.caller().method + *name},
                       "",
                       "there is no method " + in_quotes(*name) + ";" + suggestion(*name, method_names()) +
                           " allowed: " + listed(method_names())});
    return;
  }
  const auto own = JsonNode(document, diagnostics).find("method");
  if (own && own->value().is_object() && own->find(*name)) return;
  SceneReading apart(diagnostics, std::filesystem::path(document.file()).parent_path(), mesh_files);
  if (own) read_method(*own, apart);
  document.set("/method", {{*name, nlohmann::json::object()}}, {diagnostics.caller().method + *name});
}

/// What an assignment to an option of a method lacks, that this is the method to run or its name; "" of all others.
std::string fault_of_option(const nlohmann::json& scene, const std::string& pointer, const Caller& caller) {
  const std::string within = "/method/";
  const nlohmann::json* own = value_at(scene, "/method");
  if (!own || !own->is_object() || own->size() != 1 || !pointer.starts_with(within)) return "";
  const std::string method = own->begin().key(), rest = pointer.substr(within.size()),
                    name = rest.substr(0, rest.find('/'));
  if (own->contains(name)) return "";
  if (default_method(name)) return "the scene runs " + method + "; add " + caller.method + name;
  const auto known = default_method(method);
  return known && to_json(*known).at(method).contains(name)
             ? "names no method; did you mean " + in_quotes(within + method + "/" + rest) + "?"
             : "";
}

/// Whether a document is an object with the keys of a scene.
bool is_scene(const JsonDocument& given, Diagnostics& diagnostics) {
  const JsonNode root(given, diagnostics);
  if (given.root().is_object() && given.root().contains("scene") && !given.root().contains("bodies")) {
    root.error("is a study, not a scene; `stickslip study` runs it");
    return false;
  }
  return root.is_object(keys_of(scene_object("scene")));
}

/// All of a scene but its method and its parameters; each part goes on from those before it.
void read_parts(const JsonNode& root, SceneReading& reading, Input& input) {
  const auto part = [&](const char* key, auto&& read) {
    if (const auto node = root.find(key)) read(*node, reading);
  };
  if (const auto schema = root.find("$schema")) schema->text();
  if (const auto title = root.find("title")) reading.scene.title = title->text().value_or("");
  read_word(root, scene_object("scene"), "space", reading.scene.space);
  read_word(root, scene_object("scene"), "strain", reading.scene.finite_strain);
  part("bodies", read_bodies);
  part("obstacles", read_obstacles);
  part("contacts", read_contacts);
  part("obstacles", note_idle_obstacles);
  part("supports", read_supports);
  part("loads", read_loads);
  part("time", read_time);
  part("responses", read_responses);
  part("objectives", read_objectives);
  if (const auto node = root.find("linear_solver")) read_linear_solver(*node, reading, input);
  if (const auto node = root.find("output")) input.fields_every = read_output(*node);
  if (const auto node = root.find("sensitivity")) read_sensitivity(*node, reading, input);
}

/// The parameters of a scene, whose mode may ask for some. Returns the pointers of those that were dropped
/// (read_parameters).
std::vector<std::string> read_parameters_of(const JsonNode& root, const std::string& method, bool drop_others,
                                            SceneReading& reading) {
  const auto given = root.find("parameters");
  const auto dropped =
      given ? read_parameters(*given, root.value(), method, drop_others, reading) : std::vector<std::string>();
  if (reading.scene.sensitivity_mode == SensitivityMode::adjoint && (!given || given->value().empty()))
    root.find("sensitivity")
        ->error(R"(asks for derivatives by the parameters, and the scene has none; add "parameters")");
  return dropped;
}

}  // namespace

std::optional<Input> read_scene(const JsonDocument& given, const std::optional<std::string>& method_name,
                                Diagnostics& diagnostics, MeshFiles& mesh_files) {
  const std::size_t faults = diagnostics.error_count();
  if (!is_scene(given, diagnostics)) return std::nullopt;
  JsonDocument document = given;
  select_method(document, method_name, diagnostics, mesh_files);

  Input input;
  input.file = document.file();
  const JsonNode root(document, diagnostics);
  SceneReading reading(diagnostics, std::filesystem::path(given.file()).parent_path(), mesh_files);
  read_parts(root, reading, input);
  const auto method_node = root.find("method");
  const bool known = !method_name || default_method(*method_name);
  if (!method_node && known) root.error(R"(the key "method" is missing; allowed: )" + listed(method_names()));
  const auto method = method_node ? read_method(*method_node, reading) : std::nullopt;
  const auto dropped =
      read_parameters_of(root, method ? std::string(name_of(*method)) : "", method_name.has_value(), reading);
  if (diagnostics.error_count() > faults) return std::nullopt;

  for (const std::string& pointer : dropped) document.remove(pointer);
  input.scene = std::move(reading.scene);
  input.method = *method;
  input.document = document.root();
  input.mesh_fingerprints = std::move(reading.mesh_fingerprints);
  return input;
}

std::optional<Input> read_scene(JsonDocument document, const Overrides& overrides,
                                const std::optional<std::string>& method_name, Diagnostics& diagnostics) {
  MeshFiles mesh_files;
  if (method_name && default_method(*method_name)) select_method(document, method_name, diagnostics, mesh_files);
  for (const std::string& assignment : overrides)
    if (const std::string fault =
            fault_of_option(document.root(), assignment.substr(0, assignment.find('=')), diagnostics.caller());
        fault.empty())
      document.override_value(assignment, diagnostics);
    else
      diagnostics.error({{diagnostics.caller().set + assignment}, "", fault});
  auto input = read_scene(document, method_name, diagnostics, mesh_files);
  return diagnostics.has_errors() ? std::nullopt : std::move(input);
}

std::optional<Input> read_scene(const std::string& file, const Overrides& overrides,
                                const std::optional<std::string>& method_name, Diagnostics& diagnostics) {
  const auto document = JsonDocument::read(file, diagnostics);
  return document ? read_scene(*document, overrides, method_name, diagnostics) : std::nullopt;
}

std::string canonical_text(const Input& input) {
  nlohmann::json canonical = input.document;
  canonical.erase("title");
  canonical.erase("$schema");
  canonical["method"] = to_json(input.method);
  return nlohmann::json{{"scene", canonical}, {"meshes", input.mesh_fingerprints}}.dump();
}

}  // namespace stickslip
