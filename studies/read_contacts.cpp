#include <algorithm>
#include <set>

#include "studies/scene_reading.hpp"

namespace stickslip {
namespace {

bool is_in(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::optional<Plane> read_plane(const JsonNode& node, SceneReading& reading) {
  if (!node.is_object({{"point", "normal"}})) return std::nullopt;
  Plane plane{reading.required_vector(node, "point", reading.dimension()),
              reading.required_vector(node, "normal", reading.dimension())};
  if (std::all_of(plane.normal.begin(), plane.normal.end(), [](const Number& n) { return n.value == 0; }))
    node.find("normal")->must_be("a vector that is not zero; it points out of the obstacle");
  return plane;
}

std::optional<Circle> read_circle(const JsonNode& node, SceneReading& reading) {
  if (!node.is_object({{"center", "radius"}, {"inside"}})) return std::nullopt;
  Circle circle;
  const auto center = reading.required_vector(node, "center", 2);
  circle.center = {center[0], center[1]};
  circle.radius = reading.required(node, "radius", positive);
  if (const auto inside = node.find("inside")) circle.inside = inside->boolean().value_or(false);
  return circle;
}

void read_obstacle(const std::string& name, const JsonNode& node, SceneReading& reading) {
  check_name(node, name);
  if (is_in(reading.body_names, name)) node.error_at_key("a body has the name " + in_quotes(name) + " already");
  if (const auto rotate = node.value().is_object() ? node.find("rotate") : std::nullopt)
    rotate->error_at_key(unavailable("rotate", {"move"}));
  const auto kind = node.kind({"plane", "circle"}, {"cylinder", "sphere", "polyline"}, {"move", "rotate"});
  if (!kind) return;
  Obstacle obstacle;
  obstacle.name = name;
  if (const auto move = node.find("move")) obstacle.move = reading.move(*move);
  if (kind->first == "plane") {
    if (auto plane = read_plane(kind->second, reading)) obstacle.shape = *std::move(plane);
  } else if (reading.dimension() == 3) {
    kind->second.error_at_key("a circle needs a plane space; allowed in the space solid: plane");
  } else if (auto circle = read_circle(kind->second, reading)) {
    obstacle.shape = *circle;
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
  if (const auto friction = node.find("friction")) contact.friction = reading.number(*friction, not_negative);
  contact.offset = reading.optional(node, "offset", 0, any_number);
  if (const auto surface = node.find("surface")) surface->choice({"faceted"}, {"smooth"});
  if (const auto discretization = node.find("discretization")) {
    contact.segment = discretization->choice({"node", "segment"}) == "segment";
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
    read_contact(name, contact, reading);
  }
}

}  // namespace stickslip
