#include <algorithm>
#include <set>

#include "studies/input/obstacle_kinds.hpp"

namespace stickslip {
namespace {

bool is_in(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void read_obstacle(const std::string& name, const JsonNode& node, SceneReading& reading) {
  check_name(node, name);
  if (is_in(reading.body_names, name)) node.error_at_key("a body has the name " + in_quotes(name) + " already");
  const auto& kinds = obstacle_kinds();
  std::vector<std::string> keys, in_space;
  for (const auto& kind : kinds) {
    keys.push_back(kind.key);
    if (kind.is_in_space) in_space.push_back(kind.key);
  }
  const auto chosen = node.kind(keys, {"cylinder", "sphere"}, {"move", "rotate"});
  if (!chosen) return;
  const auto& [key, shape] = *chosen;
  Obstacle obstacle;
  obstacle.name = name;
  if (const auto move = node.find("move")) obstacle.move = reading.move(*move);
  if (const auto rotate = node.find("rotate")) obstacle.rotate = reading.rotation(*rotate);
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return key == k.key; });
  if (reading.dimension() == 3 && !kind->is_in_space) {
    shape.error_at_key("a " + key + " needs a plane space; allowed in the space solid: " + listed(in_space));
  } else {
    if (!kind->at_finite_strain) reading.only_at_small_strain(shape);
    if (auto surface = kind->read(shape, reading)) obstacle.shape = *std::move(surface);
  }
  reading.scene.obstacles.push_back(std::move(obstacle));
}

/// The side of a contact; the anchor of a spring is a place, nothing that could touch.
std::optional<NamedSide> touching_side(const JsonNode& node, SceneReading& reading) {
  auto side = reading.side(node);
  if (side && side->mesh->shape == ElementShape::point && side->side.nodes != std::vector<int>{0}) {
    node.must_be(in_quotes(side->body + ".node") + "; the anchor of a spring touches nothing");
    return std::nullopt;
  }
  return side;
}

void check_master(const JsonNode& node, const std::optional<NamedSide>& slave, SceneReading& reading) {
  if (reading.dimension() == 3) {
    node.error("is " + shown(node.value()) +
               "; in the space solid the master must be an obstacle: " + listed(reading.obstacle_names));
    return;
  }
  if (reading.scene.finite_strain) {
    node.error("is " + shown(node.value()) +
               "; at finite strain the master must be an obstacle in this version: " + listed(reading.obstacle_names));
    return;
  }
  const auto master = touching_side(node, reading);
  if (!master) return;
  if (master->side.facets.empty()) node.error("is " + shown(node.value()) + ", single nodes; a master needs facets");
  if (!slave || slave->body != master->body) return;
  const std::set<int> nodes(slave->side.nodes.begin(), slave->side.nodes.end());
  if (std::any_of(master->side.nodes.begin(), master->side.nodes.end(), [&](int n) { return nodes.count(n) > 0; }))
    node.error("is " + shown(node.value()) +
               ", which shares nodes with the slave: a contact of a side with itself is " +
               "not available in this version");
}

/// A law of friction: a number, or an object that says which law it is.
FrictionLaw<Number> friction_law(const JsonNode& node, SceneReading& reading) {
  if (!node.value().is_object()) {
    if (node.value().is_number()) return reading.number(node, not_negative);
    node.must_be("a number >= 0, {\"coulomb\": mu, \"limit\": force per area} or {\"tresca\": force per area}");
    return {};
  }
  if (const auto limit = node.find("tresca")) {
    node.is_object({{"tresca"}});
    return {std::nullopt, reading.number(*limit, not_negative)};
  }
  node.is_object({{"coulomb"}, {"limit"}});
  FrictionLaw<Number> law = reading.required(node, "coulomb", not_negative);
  if (const auto limit = node.find("limit")) law.limit = reading.number(*limit, not_negative);
  return law;
}

void read_contact(const std::string& name, const JsonNode& node, SceneReading& reading) {
  if (!node.is_object({{"slave", "master"}, {"friction", "offset", "surface", "discretization"}, {"between", "self"}}))
    return;
  Contact contact;
  contact.name = name;
  std::optional<NamedSide> slave_side;
  if (const auto slave = node.find("slave")) {
    if (slave->value().is_string() && is_in(reading.obstacle_names, slave->value()))
      slave->must_be("a side BODY.SIDE: an obstacle is rigid and can be the master alone");
    else
      slave_side = touching_side(*slave, reading);
    if (slave->value().is_string()) contact.slave = slave->value();
  }
  if (const auto master = node.find("master")) {
    const auto text = master->text();
    if (text && !is_in(reading.obstacle_names, *text)) {
      if (text->find('.') != std::string::npos || is_in(reading.body_names, *text))
        check_master(*master, slave_side, reading);
      else
        master->error("is " + in_quotes(*text) + ", which is neither an obstacle nor a side BODY.SIDE;" +
                      suggestion(*text, reading.obstacle_names) + " obstacles: " + listed(reading.obstacle_names));
    }
    contact.master = text.value_or("");
  }
  if (const auto friction = node.find("friction")) contact.friction = friction_law(*friction, reading);
  contact.offset = reading.optional(node, "offset", 0, any_number);
  if (const auto surface = node.find("surface")) surface->choice({"faceted"}, {"smooth"});
  if (const auto discretization = node.find("discretization")) {
    contact.segment = discretization->choice({"node", "segment"}) == "segment";
    if (contact.segment) reading.only_at_small_strain(*discretization);
    const bool solid = !slave_side || (is_continuum(slave_side->mesh->shape) && !slave_side->side.facets.empty());
    if (contact.segment && !solid)
      discretization->error("is \"segment\", which integrates along the facets of a solid body; the slave " +
                            shown(node.value()["slave"]) + " has none; allowed: \"node\"");
  }
  reading.scene.contacts.push_back(std::move(contact));
}

}  // namespace

void read_obstacles(const JsonNode& node, SceneReading& reading) {
  if (!node.is_map("obstacles by name")) return;
  for (const auto& [name, obstacle] : node.members()) {
    reading.obstacle_names.push_back(name);
    read_obstacle(name, obstacle, reading);
  }
}

void read_contacts(const JsonNode& node, SceneReading& reading) {
  if (!node.is_map("contacts by name")) return;
  for (const auto& [name, contact] : node.members()) {
    reading.contact_names.push_back(name);
    check_characters(contact, name);
    read_contact(name, contact, reading);
  }
}

}  // namespace stickslip
