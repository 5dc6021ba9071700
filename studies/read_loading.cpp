#include <algorithm>
#include <map>
#include <tuple>

#include "studies/scene_reading.hpp"

namespace stickslip {
namespace {

bool same_motion(const Table& a, const Table& b) {
  return std::equal(
      a.points.begin(), a.points.end(), b.points.begin(), b.points.end(),
      [](const auto& p, const auto& q) { return p.first == q.first && p.second.value == q.second.value; });
}

/// Which support holds what: body, node, axis.
using Held = std::map<std::tuple<std::string, int, char>, std::size_t>;

void read_support(const JsonNode& node, SceneReading& reading, Held& held) {
  if (!node.is_object({{"on", "move"}, {}, {"along", "rotate"}})) return;
  Support support;
  const auto on = node.find("on"), move = node.find("move");
  const auto side = on ? reading.side(*on) : std::nullopt;
  if (on && on->value().is_string()) support.on = on->value();
  if (move) support.move = reading.move(*move);
  const std::size_t index = reading.scene.supports.size();
  reading.scene.supports.push_back(support);
  if (!side) return;
  for (const auto& [axis, table] : support.move)
    for (int body_node : side->side.nodes) {
      const auto [holder, is_new] = held.emplace(std::make_tuple(side->body, body_node, axis), index);
      const Support& other = reading.scene.supports[holder->second];
      if (is_new || same_motion(other.move.at(axis), table)) continue;
      move->find(std::string(1, axis))
          ->error("differs from /supports/" + std::to_string(holder->second) + "/move/" + axis + ", which is on " +
                  in_quotes(other.on) + " and holds a node of " + in_quotes(support.on) +
                  " too; leave it out of one, as in " + in_quotes("block.left - block.bottom"));
      break;
    }
}

void read_load(const JsonNode& node, SceneReading& reading) {
  const auto kind = node.kind({"traction", "force"}, {"pressure", "body_force"}, {"on", "history"});
  if (!kind) return;
  Load load;
  load.kind = kind->first == "force" ? Load::Kind::force : Load::Kind::traction;
  load.vector = reading.vector(kind->second, reading.dimension());
  const auto on = node.find("on");
  if (!on) node.error(R"(the key "on" is missing: the side BODY.SIDE that the load acts on)");
  if (const auto side = on ? reading.side(*on) : std::nullopt) {
    const bool point = side->mesh->shape == ElementShape::point;
    if (point && side->side.nodes != std::vector<int>{0})
      on->must_be(in_quotes(side->body + ".node") + "; a load on the anchor of a spring does nothing");
    else if (!point && load.kind == Load::Kind::traction && side->side.facets.empty())
      on->error("is " + shown(on->value()) + ", single nodes without an area; use force instead of traction");
  }
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
    node.is_object({{"legs"}, {}, {"control"}});
    return read_legs(*legs, reading);
  }
  node.is_object({{"end", "steps"}, {"legs"}, {"control"}});
  const auto end = node.find("end"), steps = node.find("steps");
  Leg leg;
  if (end) leg.end = reading.time(*end, positive).value_or(1);
  if (steps) leg.steps = reading.count(*steps, 1).value_or(1);
  reading.scene.legs.push_back(leg);
}

}  // namespace stickslip
