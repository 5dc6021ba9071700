#include <algorithm>

#include "studies/input/file_objects.hpp"
#include "studies/input/method_options.hpp"

namespace stickslip {
namespace {

/// Name of the method whose options a pointer leads into; "" where it leads elsewhere.
std::string method_of(const std::string& pointer) {
  const std::string start = "/method/";
  if (pointer.rfind(start, 0) != 0) return "";
  return pointer.substr(start.size(), pointer.find('/', start.size()) - start.size());
}

/// Why a pointer names no number of the scene, as the end of a sentence that begins with it.
std::string reason(const std::string& pointer, const nlohmann::json& root, const SceneReading& reading) {
  if (const auto constant = reading.constants.find(pointer); constant != reading.constants.end())
    return pointer + " is " + constant->second;
  if (std::string fault = pointer_fault(root, pointer); !fault.empty()) return fault;
  const auto& value = *value_at(root, pointer);
  if (value.is_array()) return pointer + " is an array; a parameter is one number of it, such as " + pointer + "/0";
  if (value.is_object()) return pointer + " is an object; a parameter is one number in it";
  if (!value.is_number()) return pointer + " is " + shown(value) + "; a parameter must be a number";
  return pointer + " is neither a physical nor a geometric number";
}

struct ParameterReader {
  const nlohmann::json& root;
  std::string method;
  bool drop_others;
  SceneReading& reading;
  std::vector<std::string> dropped = {};

  /// Adds a term to the parameter. `node`: what names it; `place`: its pointer in the file.
  void add(const JsonNode& node, const std::string& pointer, double weight, Parameter& parameter) {
    const auto slot = reading.slots.find(pointer);
    if (slot != reading.slots.end()) {
      if (parameter.slots.empty()) {
        parameter.pointer = pointer;
        parameter.value = reading.scene.numbers[slot->second];
      }
      parameter.slots.emplace_back(slot->second, weight);
      return;
    }
    const std::string of = method_of(pointer);
    const auto names = method_names();
    const bool other = !of.empty() && of != method && std::find(names.begin(), names.end(), of) != names.end();
    if (other && drop_others) {
      reading.diagnostics.note(
          {node.place(), node.pointer(), pointer + " is an option of " + of + ", and " + method + " runs: left out"});
      dropped.push_back(node.pointer());
    } else if (other) {
      node.error_at_key(pointer + " is an option of " + of + ", and the scene's method is " + method);
    } else if (!in_a_fault(pointer)) {
      node.error_at_key(reason(pointer, root, reading));
    }
  }

  /// Whether what keeps the pointer from a number has been said: a fault of the value, or of an unknown key beside it.
  bool in_a_fault(const std::string& pointer) const {
    const bool there = value_at(root, pointer) != nullptr;
    return reading.diagnostics.has_error_in(there ? pointer : pointer.substr(0, pointer.rfind('/')));
  }

  /// One parameter, or where `each` one a node of the side: NAME/0, NAME/1, ... along it.
  /// `values`: of each.
  void add_shapes(const std::string& name, const JsonNode& node, ShapeMotion motion, bool each,
                  const std::vector<double>& values) {
    for (std::size_t n = 0; n < values.size(); ++n) {
      motion.node = each ? static_cast<int>(n) : -1;
      const std::string suffix = each ? "/" + std::to_string(n) : "";
      motion.slot = reading.extra_slot(node.pointer() + suffix);
      reading.scene.numbers[motion.slot] = values[n];
      Parameter parameter;
      parameter.name = name + suffix;
      parameter.slots = {{motion.slot, 1.0}};
      parameter.pointer = node.pointer() + suffix;
      parameter.value = values[n];
      reading.scene.parameters.push_back(std::move(parameter));
      reading.scene.shapes.push_back(motion);
    }
  }

  /// How far the side, or where `each` every node of it, has moved; none where that is at fault.
  std::optional<std::vector<double>> shape_values(const JsonNode& node, bool each, std::size_t nodes) {
    const auto given = node.find("value");
    if (!given) return std::vector<double>(each ? nodes : 1, 0.0);
    std::vector<JsonNode> parts{*given};
    if (each) {
      const auto list =
          given->array(nodes, "an array of " + std::to_string(nodes) + " numbers, one a node of the side");
      if (!list) return std::nullopt;
      parts = *list;
    }
    std::vector<double> values;
    for (const JsonNode& part : parts) {
      const auto value = part.number(any_number);
      if (!value) return std::nullopt;
      values.push_back(*value);
    }
    return values;
  }

  /// A side that has moved by a value moves along a field that depends on the mesh: no other parameter may move that.
  void check_moved_meshes(const JsonNode& node) const {
    const Scene& scene = reading.scene;
    for (const auto& motion : scene.shapes) {
      if (scene.numbers[motion.slot] == 0) continue;
      const std::string mesh = child_pointer("/bodies", scene.bodies[motion.body].name) + "/mesh/";
      for (const auto& parameter : scene.parameters)
        for (const auto& [slot, weight] : parameter.slots)
          if (scene.pointers[slot].starts_with(mesh))
            return node.find(parameter.name)
                ->error("is a number of the mesh of " + scene.bodies[motion.body].name +
                        ", a side of which has moved by the value of a shape parameter; "
                        "leave out the value, or this parameter");
    }
  }

  /// {"side", "direction"}, "fixed", "each", "value".
  void read_shape(const std::string& name, const JsonNode& node) {
    const auto& described = scene_object("shape");
    if (!node.is_object(keys_of(described))) return;
    const auto side_node = node.find("side"), direction = node.find("direction"), fixed = node.find("fixed"),
               each = node.find("each");
    const auto side = side_node ? reading.side(*side_node) : std::nullopt;
    const auto stays = fixed ? reading.side(*fixed) : std::nullopt;
    if (each) each->choice(choices_of(described, "each"));
    ShapeMotion motion;
    const auto components =
        direction ? direction->array(reading.dimension(),
                                     "a direction of " + std::to_string(reading.dimension()) + " numbers, not all zero")
                  : std::nullopt;
    if (components)
      for (const JsonNode& component : *components) {
        reading.constants[component.pointer()] = "the direction of a shape parameter, not a part of the scene";
        motion.direction.push_back(component.number(any_number).value_or(1));
      }
    if (components && std::all_of(motion.direction.begin(), motion.direction.end(), [](double x) { return x == 0; }))
      direction->must_be("a direction, not all zero");
    if (!side || !components || (fixed && !stays)) return;
    if (!is_continuum(side->mesh->shape))
      return side_node->error(
          "is a side of a body without elements that fill it; its coordinates are parameters "
          "themselves, by their pointers");
    if (stays && stays->body != side->body) return fixed->must_be("a side of the same body, " + side->body);
    const auto stays_put = [&](int node) {
      return std::find(stays->side.nodes.begin(), stays->side.nodes.end(), node) != stays->side.nodes.end();
    };
    if (stays && std::all_of(side->side.nodes.begin(), side->side.nodes.end(), stays_put))
      return fixed->error("is " + shown(fixed->value()) + ", which holds all nodes of the side that is to move");
    motion.side = side_node->value();
    if (fixed) motion.fixed = fixed->value();
    const auto& bodies = reading.scene.bodies;
    const auto found =
        std::find_if(bodies.begin(), bodies.end(), [&](const Body& body) { return body.name == side->body; });
    if (found == bodies.end()) return;  // the body is at fault, which is said
    motion.body = static_cast<int>(found - bodies.begin());
    if (const auto values = shape_values(node, each.has_value(), side->side.nodes.size()))
      add_shapes(name, node, std::move(motion), each.has_value(), *values);
  }

  void read(const std::string& name, const JsonNode& node) {
    constexpr const char* allowed =
        R"(a JSON pointer such as /contacts/sole/friction, {pointer: weight, ...}, or {"shape": {...}})";
    check_characters(node, name);
    Parameter parameter;
    parameter.name = name;
    if (node.value().is_string()) {
      add(node, node.value(), 1, parameter);
    } else if (!node.value().is_object() || node.value().empty()) {
      return node.must_be(allowed);
    } else if (const auto shape = node.find("shape")) {
      if (node.is_object(keys_of(scene_object("parameter")))) read_shape(name, *shape);
      return;
    } else {
      for (const auto& [pointer, weight] : node.members()) {
        static constexpr Rule not_zero{"a number other than 0", [](double w) { return w != 0; }};
        if (const auto value = weight.number(not_zero)) add(weight, pointer, *value, parameter);
      }
    }
    check_equals(node, parameter);
    if (!parameter.slots.empty()) reading.scene.parameters.push_back(std::move(parameter));
  }

  /// A parameter may not part numbers that must be equal.
  void check_equals(const JsonNode& node, const Parameter& parameter) const {
    auto weight_of = [&](int slot) {
      double weight = 0;
      for (const auto& [each, w] : parameter.slots) weight += each == slot ? w : 0;
      return weight;
    };
    for (const auto& [slot, weight] : parameter.slots) {
      const auto partner = reading.equal.find(slot);
      if (partner == reading.equal.end() || weight_of(partner->second) == weight_of(slot)) continue;
      return node.error("changes one of two numbers that must stay equal; " + reading.scene.pointers[partner->second] +
                        " must have the weight of " + reading.scene.pointers[slot]);
    }
  }
};

}  // namespace

std::vector<std::string> read_parameters(const JsonNode& node, const nlohmann::json& root, const std::string& method,
                                         bool drop_others, SceneReading& reading) {
  if (!node.is_map("parameters by name")) return {};
  ParameterReader reader{root, method, drop_others, reading};
  for (const auto& [name, parameter] : node.members()) reader.read(name, parameter);
  reader.check_moved_meshes(node);
  return reader.dropped;
}

}  // namespace stickslip
