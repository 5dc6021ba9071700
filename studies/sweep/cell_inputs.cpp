#include "studies/sweep/cell_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "studies/input/method_options.hpp"
#include "studies/io/json_node.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

/// Calls f with a place in each of lists of these sizes, the last list's fastest.
template <class F>
void for_each_combination(const std::vector<std::size_t>& sizes, F&& f) {
  std::vector<std::size_t> chosen(sizes.size());
  auto choose = [&](auto&& self, std::size_t i) -> void {
    if (i == sizes.size()) return f(chosen);
    for (chosen[i] = 0; chosen[i] < sizes[i]; ++chosen[i]) self(self, i + 1);
  };
  choose(choose, 0);
}

std::vector<std::size_t> sizes_of(const std::vector<Knob>& sweeps) {
  std::vector<std::size_t> sizes;
  for (const Knob& sweep : sweeps) sizes.push_back(sweep.values.size());
  return sizes;
}

std::vector<std::size_t> sizes_of(const std::vector<Variation>& variations) {
  std::vector<std::size_t> sizes;
  for (const Variation& variation : variations) sizes.push_back(variation.size());
  return sizes;
}

/// Gives a scene the values that a variation has in this place.
void set_varied(JsonDocument& scene, const Variation& variation, std::size_t place) {
  for (const Knob& knob : variation.knobs) scene.set(knob.pointer, knob.values[place].value, knob.values[place].place);
}

/// "/newton/tolerance" as "newton.tolerance".
std::string option_name(const std::string& pointer) {
  std::string name = pointer.substr(1);
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

/// Puts a method with its options into the cell. The faults that follow are left to complete().
void set_method(CellInput& cell, const MethodSweep& method, const std::vector<std::size_t>& chosen) {
  const std::string base = child_pointer("/method", method.method);
  cell.document.set("/method", {{method.method, json::object()}}, method.place);
  cell.label = method.method;
  cell.knobs = json::object();
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const Knob& option = method.options[i];
    const auto& [value, place] = option.values[chosen[i]];
    // an option within an object, as /scale/absolute, needs the object
    for (auto slash = option.pointer.find('/', 1); slash != std::string::npos;
         slash = option.pointer.find('/', slash + 1))
      if (const std::string outer = base + option.pointer.substr(0, slash); !value_at(cell.document.root(), outer))
        cell.document.set(outer, json::object(), place);
    cell.document.set(base + option.pointer, value, place);
    const std::string name = option_name(option.pointer);
    cell.label += " " + name + "=" + (value.is_string() ? value.get<std::string>() : shown(value));
    if (option.values.size() > 1) cell.knobs[name] = value;
  }
}

/// Calls f with a cell of each scene, mesh level and combination of what is varied; it has no method yet.
template <class F>
void for_each_variant(const Study& study, F&& f) {
  for (const StudyScene& scene : study.scenes)
    for (const auto& refined : study.refine)
      for_each_combination(sizes_of(study.vary), [&](const std::vector<std::size_t>& places) {
        CellInput variant;
        variant.document = scene.document;
        variant.scene = scene.file;
        variant.refine = refined.value.template get<int>();
        for (std::size_t i = 0; i < places.size(); ++i) {
          set_varied(variant.document, study.vary[i], places[i]);
          for (const Knob& knob : study.vary[i].knobs) variant.vary[knob.pointer] = knob.values[places[i]].value;
        }
        refine_meshes(variant.document, variant.refine, refined.place);
        f(variant);
      });
}

/// A cell of the finest mesh of each scene, which a finer one may be too large for.
std::vector<CellInput> finest_of_scenes(const std::vector<CellInput>& cells) {
  std::map<std::string, CellInput> finest;
  for (const CellInput& cell : cells)
    if (const auto found = finest.find(cell.scene); found == finest.end() || found->second.refine < cell.refine)
      finest[cell.scene] = cell;
  std::vector<CellInput> out;
  for (auto& [scene, cell] : finest) out.push_back(std::move(cell));
  return out;
}

/// Puts the method of a reference into the cell, and its mesh.
void set_reference(CellInput& cell, const Reference& reference) {
  set_method(cell, reference.method, std::vector<std::size_t>(reference.method.options.size(), 0));
  if (!reference.meshes.empty()) refine_meshes(cell.document, -cell.refine, reference.method.place);
  for (const Knob& mesh : reference.meshes)
    cell.document.set(mesh.pointer, mesh.values.front().value, mesh.values.front().place);
  refine_meshes(cell.document, reference.refine, reference.method.place);
}

/// Reads the cell's document and fills in what follows from it; false where it is at fault.
bool complete(CellInput& cell, const std::string& method, const std::string& program_version, Diagnostics& diagnostics,
              MeshFiles& mesh_files) {
  // Each of a study's methods drops the parameters that belong to another one; notes on that would be one a cell.
  Diagnostics own;
  auto input = read_scene(cell.document, method, own, mesh_files);
  for (const Diagnostic& error : own.errors()) diagnostics.error(error);
  if (!input) return false;
  cell.method = input->method;
  cell.canonical = canonical_text(*input);
  cell.id = cell_id(cell.canonical, program_version);
  return true;
}

/// Each value of each option by itself.
void check_option_values(const MethodSweep& method, Diagnostics& diagnostics) {
  for (const Knob& option : method.options)
    for (std::size_t i = 0; i < option.values.size(); ++i) {
      CellInput cell;
      cell.document = JsonDocument::of(json::object(), method.place.source);
      set_method(cell, {method.method, method.place, {option}}, {i});
      check_option_values(*JsonNode(cell.document, diagnostics).find("method")->find(method.method), method.method,
                          diagnostics);
    }
}

/// Whether a cell has all that the solution of another program says of its variant.
bool is_of_variant(const PeerSolution& peer, const CellInput& cell) {
  const auto has = [&](const auto& given) {
    const auto own = cell.vary.find(given.first);
    return own != cell.vary.end() && own->second == given.second;
  };
  return std::ranges::all_of(peer.vary, has) && peer.scene.value_or(cell.scene) == cell.scene &&
         peer.refine.value_or(cell.refine) == cell.refine;
}

/// Puts the solutions of other programs behind the cells of their variants.
void add_solutions(const Study& study, const std::string& program_version, std::vector<CellInput>& cells,
                   Diagnostics& diagnostics) {
  for (const auto& peer : study.solutions) {
    std::set<std::string> variants;
    auto end = cells.end();  // of the variant's cells
    for (auto cell = cells.begin(); cell != cells.end(); ++cell)
      if (is_of_variant(*peer, *cell)) {
        variants.insert(variant_key(*cell));
        end = cell + 1;
      }
    if (variants.size() != 1) {
      diagnostics.error({peer->place, peer->place.pointer,
                         R"(is of no one variant; "scene", "vary" and "refine" must say of which, in values of the )"
                         R"(study's)"});
      continue;
    }
    CellInput cell = *(end - 1);
    cell.peer = peer;
    cell.label = peer->name;
    cell.knobs = json::object();
    cell.canonical += "\n" + peer->name + "\n" + peer->solution.dump();
    cell.id = cell_id(cell.canonical, program_version);
    cells.insert(end, std::move(cell));
  }
}

/// Whether a fault follows from the method that a scene is read with, which is not the one of any cell.
bool is_of_method(const Diagnostic& fault, const JsonDocument& scene) {
  const auto names_method = [](const std::string& pointer) { return pointer.starts_with("/method"); };
  if (names_method(fault.pointer)) return true;
  const json* parameter = fault.pointer.starts_with("/parameters/") ? value_at(scene.root(), fault.pointer) : nullptr;
  return parameter && parameter->dump().find("/method/") != std::string::npos;
}

}  // namespace

std::string variant_key(const CellInput& cell) {
  return json{{"scene", cell.scene}, {"vary", cell.vary}, {"refine", cell.refine}}.dump();
}

std::string cell_id(const std::string& canonical, const std::string& program_version) {
  return fingerprint(canonical + "\n" + program_version);
}

void refine_meshes(JsonDocument& scene, int level, const Place& origin) {
  auto finer = [&](json& count) {
    if (!count.is_number()) return;
    const double cells = std::ldexp(count.get<double>(), level);
    constexpr double most = 1e15;  // beyond, the scene's reader has something to say; here only overflow matters
    if (cells == std::floor(cells) && std::abs(cells) < most)
      count = static_cast<long long>(cells);
    else
      count = cells;
  };
  JsonDocument result = scene;
  const json bodies = level != 0 ? scene.root().value("bodies", json::object()) : json::object();
  for (const auto& [name, body] : bodies.items()) {
    const json* mesh = value_at(body, "/mesh");
    if (!mesh || !mesh->is_object()) continue;
    const std::string pointer = child_pointer("/bodies", name) + "/mesh";
    if (mesh->contains("gmsh")) {
      const json splits = mesh->value("split", json(0));
      if (splits.is_number_integer()) result.set(pointer + "/split", splits.get<long long>() + level, origin);
    }
    for (const auto& [kind, generator] : mesh->items()) {
      if (!generator.is_object() || !generator.contains("cells")) continue;
      json cells = generator["cells"];
      if (cells.is_array())
        for (json& count : cells) finer(count);
      else
        finer(cells);
      result.set(child_pointer(pointer, kind) + "/cells", std::move(cells), origin);
    }
  }
  scene = std::move(result);
}

Diagnostic in_study(const Study& study, Diagnostic fault) {
  if (fault.place.source != study.document.file()) return fault;
  fault.pointer = fault.place.pointer;  // a value may be deeper in the cell's scene than in the list that it comes from
  while (!fault.pointer.empty() && !value_at(study.document.root(), fault.pointer))
    fault.pointer.erase(fault.pointer.rfind('/'));
  return fault;
}

void check_parts(const Study& study, Diagnostics& all_faults, MeshFiles& mesh_files) {
  Diagnostics diagnostics;
  for (const MethodSweep& method : study.methods) check_option_values(method, diagnostics);
  for (const Reference& reference : study.references) check_option_values(reference.method, diagnostics);
  const auto check_scene = [&](const JsonDocument& scene) {
    Diagnostics own;
    read_scene(scene, std::string(method_names().front()), own, mesh_files);
    for (const Diagnostic& fault : own.errors())
      if (!is_of_method(fault, scene)) diagnostics.error(fault);
  };
  for (const StudyScene& given : study.scenes) {
    check_scene(given.document);
    const auto has = [&](const Knob& knob) { return value_at(given.document.root(), knob.pointer) != nullptr; };
    for (const Variation& variation : study.vary)
      for (std::size_t i = 0; std::ranges::all_of(variation.knobs, has) && i < variation.size(); ++i) {
        JsonDocument scene = given.document;
        set_varied(scene, variation, i);
        check_scene(scene);
      }
  }
  for (const Diagnostic& fault : diagnostics.errors()) all_faults.error(in_study(study, fault));
}

std::vector<CellInput> expand(const Study& study, const std::string& program_version, Diagnostics& all_faults,
                              MeshFiles& mesh_files) {
  Diagnostics diagnostics;
  std::vector<CellInput> cells;
  std::set<std::string> ids;
  std::size_t again = 0;
  for_each_variant(study, [&](const CellInput& variant) {
    for (const MethodSweep& method : study.methods)
      for_each_combination(sizes_of(method.options), [&](const std::vector<std::size_t>& chosen) {
        CellInput cell = variant;
        set_method(cell, method, chosen);
        if (!complete(cell, method.method, program_version, diagnostics, mesh_files)) return;
        if (ids.insert(cell.id).second)
          cells.push_back(std::move(cell));
        else
          ++again;
      });
  });
  if (!diagnostics.has_errors()) add_solutions(study, program_version, cells, diagnostics);
  // a reference with faulty options would be found only when it is run
  for (const Reference& reference : study.references)
    if (reference.kind == Reference::Kind::method || reference.kind == Reference::Kind::overkill)
      for (CellInput& cell : finest_of_scenes(cells)) {
        set_reference(cell, reference);
        complete(cell, reference.method.method, program_version, diagnostics, mesh_files);
      }
  for (const Diagnostic& fault : diagnostics.errors()) all_faults.error(in_study(study, fault));
  if (diagnostics.has_errors()) check_parts(study, all_faults, mesh_files);
  if (again > 0)
    all_faults.note(
        {{study.document.file()},
         "",
         fmt::format(
             "{} of the {} cells that its lists make {} another and {} "
             "left out (the same method and options, scenes that differ in their title alone, or a mesh that has no "
             "levels)",
             again, again + cells.size(), again == 1 ? "equals" : "equal", again == 1 ? "is" : "are")});
  if (diagnostics.has_errors()) cells.clear();
  return cells;
}

CellInput reference_cell(const CellInput& cell, const Reference& reference, const std::string& program_version,
                         MeshFiles& mesh_files) {
  CellInput other = cell;
  Diagnostics none;
  set_reference(other, reference);
  complete(other, reference.method.method, program_version, none, mesh_files);
  return other;
}

}  // namespace stickslip
