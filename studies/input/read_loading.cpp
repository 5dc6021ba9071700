#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "core/model/model.hpp"
#include "studies/input/file_objects.hpp"

namespace stickslip {
namespace {

bool same_motion(const Table& a, const Table& b) {
  return a.repeat == b.repeat && std::equal(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(),
                                            [](const auto& p, const auto& q) {
                                              return p.first == q.first && p.second.value == q.second.value;
                                            });
}

/// Which support holds what: body, node, axis.
using Held = std::map<std::tuple<std::string, int, char>, std::size_t>;

void read_inclined(const JsonNode& node, Support& support, SceneReading& reading) {
  for (const char* other : {"move", "rotate"})
    if (const auto beside = node.find(other))
      beside->error_at_key(in_quotes(other) + " stands beside \"along\"; a support is either inclined or not");
  Inclined inclined;
  inclined.along =
      reading.direction(*node.find("along"), "a vector that is not zero; it is the direction that is held");
  inclined.value.points = {{0, Number()}};
  if (const auto value = node.find("value"))
    inclined.value = reading.table(*value);
  else
    node.error(R"(the key "value" is missing: the displacement along the direction)");
  support.inclined = std::move(inclined);
}

/// Reports where two supports move a node along an axis by different tables; what else two supports may disagree in
/// depends on the mesh, and is found when the model is made.
void check_agreement(const JsonNode& move, const NamedSide& side, std::size_t index, const SceneReading& reading,
                     Held& held) {
  const Support& support = reading.scene.supports[index];
  for (const auto& [axis, table] : support.move)
    for (int body_node : side.side.nodes) {
      const auto [holder, is_new] = held.emplace(std::make_tuple(side.body, body_node, axis), index);
      const Support& other = reading.scene.supports[holder->second];
      if (is_new || same_motion(other.move.at(axis), table)) continue;
      move.find(std::string(1, axis))
          ->error("differs from /supports/" + std::to_string(holder->second) + "/move/" + axis + ", which is on " +
                  in_quotes(other.on) + " and holds a node of " + in_quotes(support.on) +
                  " too; leave it out of one, as in " + in_quotes("block.left - block.bottom"));
      break;
    }
}

void read_support(const JsonNode& node, SceneReading& reading, Held& held) {
  if (!node.is_object(keys_of(scene_object("support")))) return;
  Support support;
  const auto on = node.find("on"), move = node.find("move"), rotate = node.find("rotate"), value = node.find("value");
  const auto side = on ? reading.side(*on) : std::nullopt;
  if (on && on->value().is_string()) support.on = on->value();
  if (node.find("along")) {
    read_inclined(node, support, reading);
  } else {
    if (value) value->error_at_key(R"("value" belongs to "along", which is missing)");
    if (!move && !rotate && !value) node.error("one of the keys is missing: move, rotate, along");
    if (move) support.move = reading.move(*move);
    if (rotate) support.rotate = reading.rotation(*rotate);
  }
  reading.scene.supports.push_back(support);
  if (side && move && !support.rotate && !support.inclined)
    check_agreement(*move, *side, reading.scene.supports.size() - 1, reading, held);
}

/// The side of a load that acts on one.
void read_loaded_side(const JsonNode& on, const std::string& kind, SceneReading& reading) {
  const auto side = reading.side(on);
  if (!side) return;
  const bool point = side->mesh->shape == ElementShape::point;
  if (kind == "pressure" && (point || side->mesh->shape == ElementShape::bar2))
    on.error("is " + shown(on.value()) + ", which has no inside that a pressure could push to; use traction or force");
  else if (point && side->side.nodes != std::vector<int>{0})
    on.must_be(in_quotes(side->body + ".node") + "; a load on the anchor of a spring does nothing");
  else if (!point && kind != "force" && side->side.facets.empty())
    on.error("is " + shown(on.value()) + ", single nodes without an area; use force instead of " + kind);
  else if (kind == "pressure")
    for (const Body& body : reading.scene.bodies)
      if (const auto fault = pressure_fault(reading.scene, body); body.name == side->body && !fault.empty())
        on.error("is " + shown(on.value()) + ", of a body that " + fault);
}

void read_loaded_body(const JsonNode& on, SceneReading& reading) {
  const auto name = on.text();
  if (!name) return;
  const auto& names = reading.body_names;
  if (std::find(names.begin(), names.end(), *name) == names.end())
    return on.error("is " + in_quotes(*name) + ": there is no such body;" + suggestion(*name, names) +
                    " a body force acts on a body: " + listed(names));
  const auto mesh = reading.meshes.find(*name);
  if (mesh != reading.meshes.end() && mesh->second.shape == ElementShape::point)
    on.error("is " + in_quotes(*name) + ", a point without a volume; use force on " + in_quotes(*name + ".node"));
}

/// Whether the amount of a load is written as a table in time, which its "history" is for; reported where it is.
bool varies_in_time(const JsonNode& amount, Load::Kind kind, const SceneReading& reading) {
  const auto& value = amount.value();
  const bool one_number = kind == Load::Kind::pressure;
  const bool table =
      value.is_object() ||
      (value.is_array() &&
       (one_number || std::any_of(value.begin(), value.end(), [](const auto& each) { return each.is_structured(); })));
  if (table)
    amount.must_be((one_number ? "a number" : "an array of " + std::to_string(reading.dimension()) + " numbers") +
                   R"(, which "history" scales in time: "history": [[0, 0], [1, 1]])");
  return table;
}

void read_load(const JsonNode& node, SceneReading& reading) {
  constexpr std::array kinds{"traction", "pressure", "force", "body_force"};  // in the order of Load::Kind
  const auto kind = read_kind(node, scene_object("load"));
  if (!kind) return;
  Load load;
  load.kind = static_cast<Load::Kind>(std::find(kinds.begin(), kinds.end(), kind->first) - kinds.begin());
  if (varies_in_time(kind->second, load.kind, reading))
    load.vector.clear();
  else if (load.kind == Load::Kind::pressure)
    load.vector = {reading.number(kind->second, any_number)};
  else
    load.vector = reading.vector(kind->second, reading.dimension());
  const auto on = node.find("on");
  const bool of_body = load.kind == Load::Kind::body_force;
  if (!on)
    node.error(std::string(R"(the key "on" is missing: the )") + (of_body ? "body" : "side BODY.SIDE") +
               " that the load acts on");
  else if (of_body)
    read_loaded_body(*on, reading);
  else
    read_loaded_side(*on, kind->first, reading);
  if (on && on->value().is_string()) load.on = on->value();
  if (const auto history = node.find("history")) load.history = reading.table(*history);
  reading.scene.loads.push_back(std::move(load));
}

void read_legs(const JsonNode& node, SceneReading& reading) {
  if (!node.value().is_array() || node.value().empty()) return node.must_be("an array of legs [t_end, steps]");
  double start = 0;
  for (const JsonNode& leg : node.elements()) {
    const auto pair = leg.array(2, "a leg [t_end, steps]");
    if (!pair) continue;
    const auto end = reading.time((*pair)[0], positive);
    const auto steps = reading.count((*pair)[1], 1);
    if (end && !(*end > start)) (*pair)[0].must_be("a time later than the end of the leg before, " + shown(start));
    if (end && steps) reading.scene.legs.push_back({*end, *steps});
    if (end) start = *end;
  }
}

/// The first entry of the scene that changes in time beside a load; "" where none does.
std::string other_change(const Scene& scene, int load) {
  const auto changes = [](const auto& moved) {
    bool any = false;
    const auto take = [&](const Table& table) { any |= table.points.size() > 1; };
    for (const auto& [axis, table] : moved.move) take(table);
    if (moved.rotate) take(moved.rotate->angle);
    if constexpr (requires { moved.inclined; })
      if (moved.inclined) take(moved.inclined->value);
    return any;
  };
  for (std::size_t s = 0; s < scene.supports.size(); ++s)
    if (changes(scene.supports[s])) return "/supports/" + std::to_string(s);
  for (const auto& obstacle : scene.obstacles)
    if (changes(obstacle)) return "/obstacles/" + obstacle.name;
  for (std::size_t l = 0; l < scene.loads.size(); ++l)
    if (static_cast<int>(l) != load && scene.loads[l].history && scene.loads[l].history->points.size() > 1)
      return "/loads/" + std::to_string(l) + "/history";
  return "";
}

/// "control": "arc_length", or {"arc_length": {"load": i, "length": l, "max": n}}. pre: the leg was read.
void read_control(const JsonNode& node, SceneReading& reading) {
  Scene& scene = reading.scene;
  const Leg& leg = scene.legs.back();
  ArcLength arc;
  arc.max = 10 * leg.steps;
  const int loads = static_cast<int>(scene.loads.size());
  if (node.value().is_object()) {
    if (!node.is_object(keys_of(scene_object("control")))) return;
    const auto options = node.find("arc_length");
    if (!options || !options->is_object(keys_of(scene_object("arc_length")))) return;
    if (const auto load = options->find("load")) {
      arc.load = reading.count(*load, 0).value_or(0);
      if (arc.load >= loads)
        return load->must_be("the index of one of the scene's loads, counted from 0; there are " +
                             std::to_string(loads));
    } else if (loads != 1) {
      return options->error(R"(the key "load" is missing: the index of the load that is found, counted from 0)");
    }
    if (const auto length = options->find("length")) arc.length = reading.setting(*length, positive).value_or(0);
    if (const auto max = options->find("max")) arc.max = reading.count(*max, 1).value_or(1);
  } else if (!node.choice({"arc_length"})) {
    return;
  } else if (loads != 1) {
    return node.error(R"(is "arc_length", which finds the factor of one load, and the scene has )" +
                      std::to_string(loads) + R"(; write {"arc_length": {"load": i}})");
  }
  if (reading.diagnostics.has_error_in("/loads") || reading.diagnostics.has_error_in(node.pointer())) return;
  if (const std::string other = other_change(scene, arc.load); !other.empty())
    return node.error("finds the times of its steps, and " + other +
                      " changes in time: along a path only the load may; give it one value");
  auto& history = scene.loads[arc.load].history;
  if (!history) history = Table{{{0.0, Number(0.0)}, {leg.end, Number(1.0)}}};
  if (history->points.size() != 2 || history->repeat != 1 || history->points[0].first != 0 ||
      history->points[1].first != leg.end || history->points[0].second.value != 0)
    return node.error("needs a load that grows from 0 in proportion to the time: leave /loads/" +
                      std::to_string(arc.load) + "/history out, or make it [[0, 0], [" + shown(leg.end) + ", 1]]");
  history->goes_on = true;
  scene.arc_length = arc;
}

}  // namespace

void read_supports(const JsonNode& node, SceneReading& reading) {
  if (!node.value().is_array()) return node.must_be("an array of supports");
  Held held;
  for (const JsonNode& support : node.elements()) read_support(support, reading, held);
}

void read_loads(const JsonNode& node, SceneReading& reading) {
  if (!node.value().is_array()) return node.must_be("an array of loads");
  for (const JsonNode& load : node.elements()) read_load(load, reading);
}

void read_time(const JsonNode& node, SceneReading& reading) {
  if (!node.value().is_object()) return node.must_be(R"({"end": t, "steps": n} or {"legs": [[t_end, steps], ...]})");
  if (const auto legs = node.find("legs")) {
    node.is_object({{"legs"}, {"control"}});
    if (const auto control = node.find("control"))
      control->error_at_key(R"("control" stands beside "legs"; a path has one leg: "end" and "steps")");
    return read_legs(*legs, reading);
  }
  node.is_object(keys_of(scene_object("time"), {"end", "steps"}));
  const auto end = node.find("end"), steps = node.find("steps");
  Leg leg;
  if (end) leg.end = reading.time(*end, positive).value_or(1);
  if (steps) leg.steps = reading.count(*steps, 1).value_or(1);
  reading.scene.legs.push_back(leg);
  if (const auto control = node.find("control")) read_control(*control, reading);
}

}  // namespace stickslip
