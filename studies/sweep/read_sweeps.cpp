#include <fmt/format.h>

#include <set>

#include "studies/io/json_pointer.hpp"
#include "studies/io/wording.hpp"
#include "studies/sweep/study_reading.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

enum class Repeats { refused, allowed };

/// The values of a list.
std::vector<PlacedValue> values_of(const JsonNode& list, Repeats repeats = Repeats::refused) {
  std::vector<PlacedValue> values;
  if (!list.value().is_array() || list.value().empty()) {
    list.must_be("a list of values");
    return values;
  }
  std::set<json> before;
  for (const JsonNode& element : list.elements()) {
    if (!before.insert(element.value()).second && repeats == Repeats::refused)
      element.error("is " + shown(element.value()) + ", which the list has already");
    else
      values.push_back({element.value(), element.place()});
  }
  return values;
}

/// Options below a node, each with its values.
void collect_options(const JsonNode& node, const std::string& pointer, OptionLists lists, std::vector<Knob>& options) {
  for (const auto& [name, option] : node.members()) {
    const std::string below = child_pointer(pointer, name);
    const bool list = option.value().is_array();
    if (option.value().is_object() && !option.value().empty())
      collect_options(option, below, lists, options);
    else if (list && lists == OptionLists::swept)
      options.push_back({below, values_of(option)});
    else if (list)
      option.must_be(R"(one value; only lists in the "methods" of a study are swept)");
    else
      options.push_back({below, {{option.value(), option.place()}}});
  }
}

/// The one of the pointers that names a part of what `pointer` names, or what that is a part of; "" where none does.
std::string overlapping(const std::set<std::string>& pointers, const std::string& pointer) {
  for (std::string around = pointer; around.find('/') != std::string::npos; around.erase(around.rfind('/')))
    if (pointers.count(around) > 0) return around;
  const auto inside = pointers.lower_bound(pointer + "/");
  return inside != pointers.end() && inside->starts_with(pointer + "/") ? *inside : "";
}

/// Whether a pointer is below /bodies/NAME/mesh.
bool is_of_mesh(const std::string& pointer) {
  const auto name = pointer.starts_with("/bodies/") ? pointer.find('/', 8) : std::string::npos;
  return name != std::string::npos && pointer.compare(name, 6, "/mesh/") == 0;
}

/// Whether a pointer names what a study may vary, and is not among the `known`, to which it is added; else that is
/// reported.
bool can_be_varied(const std::string& pointer, const JsonNode& list, const json& scene, std::set<std::string>& known) {
  std::string fault;
  if (pointer == "/method" || pointer.rfind("/method/", 0) == 0)
    fault = R"(an option of a method is swept as a list in "methods")";
  else if (!scene.is_null())
    fault = pointer_fault(scene, pointer);
  if (fault.empty() && !scene.is_null() && value_at(scene, pointer)->is_object())
    fault = "names an object; must name a number, a text or an array";
  if (const std::string other = overlapping(known, pointer); fault.empty() && !other.empty())
    fault = "overlaps " + other + ", which is varied too: one would overwrite the other";
  if (!fault.empty()) list.error_at_key(fault);
  return fault.empty() && known.insert(pointer).second;
}

/// Lists whose values go together; none where there is a fault.
std::optional<Variation> read_linked(const std::string& name, const JsonNode& node, const json& scene,
                                     std::set<std::string>& known) {
  Variation linked{name, {}};
  const auto lists = node.members();
  if (lists.size() < 2) {
    node.must_be("two or more lists of values by JSON pointer of the scene, whose values go together");
    return std::nullopt;
  }
  for (const auto& [pointer, list] : lists) {
    if (!can_be_varied(pointer, list, scene, known)) return std::nullopt;
    Knob knob{pointer, values_of(list, Repeats::allowed)};
    if (knob.values.empty()) return std::nullopt;
    if (!linked.knobs.empty() && knob.values.size() != linked.size()) {
      list.error(fmt::format("has {}, but {} has {}; lists that are linked must have as many values",
                             counted(std::ssize(knob.values), "value"), linked.knobs.front().pointer, linked.size()));
      return std::nullopt;
    }
    linked.knobs.push_back(std::move(knob));
  }
  return linked;
}

}  // namespace

std::optional<MethodSweep> read_method_sweep(const JsonNode& node, OptionLists lists) {
  const auto kind = node.kind(method_names());
  if (!kind || !kind->second.is_map("the options of " + kind->first)) return std::nullopt;
  check_option_names(kind->second, kind->first);
  MethodSweep sweep{kind->first, kind->second.place(), {}};
  collect_options(kind->second, "", lists, sweep.options);
  return sweep;
}

std::vector<MethodSweep> read_methods(const JsonNode& study, const std::optional<JsonNode>& scene) {
  std::vector<MethodSweep> methods;
  const auto add = [&](const JsonNode& method, OptionLists lists) {
    if (auto sweep = read_method_sweep(method, lists)) methods.push_back(*std::move(sweep));
  };
  if (const auto list = study.find("methods")) {
    if (!list->value().is_array() || list->value().empty())
      list->must_be("a list of methods, as in [{\"penalty\": {\"stiffness\": [10, 100]}}]");
    else
      for (const JsonNode& method : list->elements()) add(method, OptionLists::swept);
  } else if (const auto method = scene ? scene->find("method") : std::nullopt) {
    add(*method, OptionLists::refused);
  } else if (scene) {
    study.error(R"(the key "methods" is missing, and the scene names no method)");
  }
  return methods;
}

std::vector<Variation> read_vary(const JsonNode& node, const json& scene) {
  std::vector<Variation> variations;
  std::set<std::string> known;
  if (!node.is_map("lists of values by JSON pointer of the scene")) return variations;
  for (const auto& [key, entry] : node.members())
    if (entry.value().is_object() && !key.starts_with('/')) {
      if (auto linked = read_linked(key, entry, scene, known)) variations.push_back(*std::move(linked));
    } else if (can_be_varied(key, entry, scene, known)) {
      variations.push_back({"", {{key, values_of(entry)}}});
    }
  return variations;
}

std::vector<Knob> read_meshes(const JsonNode& node, const json& scene) {
  std::vector<Knob> meshes;
  std::set<std::string> known;
  if (!node.is_map("values of meshes by JSON pointer of the scene")) return meshes;
  if (node.members().empty()) node.error(R"(is empty; must name a mesh, as in {"/bodies/foot/mesh/gmsh": "fine.msh"})");
  for (const auto& [pointer, value] : node.members())
    if (!is_of_mesh(pointer))
      value.error_at_key("must be of a mesh, /bodies/NAME/mesh/...: the reference is the same problem on another mesh");
    else if (can_be_varied(pointer, value, scene, known))
      meshes.push_back({pointer, {{value.value(), value.place()}}});
  return meshes;
}

std::vector<PlacedValue> read_levels(const JsonNode& list) {
  std::vector<PlacedValue> levels = values_of(list);
  for (const JsonNode& level : list.value().is_array() ? list.elements() : std::vector<JsonNode>{})
    level.count(0, finest_level);
  return levels;
}

}  // namespace stickslip
