#include <set>

#include "studies/io/json_pointer.hpp"
#include "studies/sweep/study_reading.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

/// The values of a list, each once.
std::vector<PlacedValue> values_of(const JsonNode& list) {
  std::vector<PlacedValue> values;
  if (!list.value().is_array() || list.value().empty()) {
    list.must_be("a list of values");
    return values;
  }
  std::set<json> before;
  for (const JsonNode& element : list.elements()) {
    if (!before.insert(element.value()).second)
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

std::vector<Knob> read_vary(const JsonNode& node, const json& scene) {
  std::vector<Knob> knobs;
  std::set<std::string> known;
  if (!node.is_map("lists of values by JSON pointer of the scene")) return knobs;
  for (const auto& [pointer, list] : node.members()) {
    if (pointer == "/method" || pointer.rfind("/method/", 0) == 0)
      list.error_at_key(R"(an option of a method is swept as a list in "methods")");
    else if (const std::string fault = scene.is_null() ? "" : pointer_fault(scene, pointer); !fault.empty())
      list.error_at_key(fault);
    else if (!scene.is_null() && value_at(scene, pointer)->is_object())
      list.error_at_key("names an object; must name a number, a text or an array");
    else if (const std::string other = overlapping(known, pointer); !other.empty())
      list.error_at_key("overlaps " + other + ", which is varied too: one would overwrite the other");
    else if (known.insert(pointer).second)
      knobs.push_back({pointer, values_of(list)});
  }
  return knobs;
}

std::vector<PlacedValue> read_levels(const JsonNode& list) {
  std::vector<PlacedValue> levels = values_of(list);
  for (const JsonNode& level : list.value().is_array() ? list.elements() : std::vector<JsonNode>{})
    level.count(0, finest_level);
  return levels;
}

}  // namespace stickslip
