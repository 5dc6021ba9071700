#include <algorithm>
#include <set>

#include "studies/input/scene_reading.hpp"

namespace stickslip {
namespace {

bool is_in(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::optional<Plane> read_plane(const JsonNode& node, SceneReading& reading) {
  if (!node.is_object({{"point", "normal"}})) return std::nullopt;
  Plane plane{reading.required_vector(node, "point", reading.dimension()), {}};
  if (const auto normal = node.find("normal"))
    plane.normal = reading.direction(*normal, "a vector that is not zero; it points out of the obstacle");
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

std::optional<Polyline> read_polyline(const JsonNode& node, SceneReading& reading) {
  constexpr const char* allowed = "an array of two points [x, y] or more, the solid on the right of the way along them";
  if (!node.is_object({{"points"}})) return std::nullopt;
  const auto points = node.find("points");
  if (!points) return std::nullopt;
  if (!points->value().is_array() || points->value().size() < 2) {
    points->must_be(allowed);
    return std::nullopt;
  }
  Polyline polyline;
  auto same = [](const auto& a, const auto& b) { return a[0].value == b[0].value && a[1].value == b[1].value; };
  for (const JsonNode& element : points->elements()) {
    const bool last = polyline.points.size() + 1 == points->value().size();
    const bool again = last && polyline.points.size() > 2 && element.value() == points->value().front();
    if (again) {
      polyline.closed = true;
      for (int i = 0; i < 2; ++i)
        reading.constants[child_pointer(element.pointer(), std::to_string(i))] =
            "of the point that closes the polyline; its first point is the parameter";
      break;
    }
    const auto x = reading.vector(element, 2);
    polyline.points.push_back({x[0], x[1]});
    if (const auto n = polyline.points.size(); n > 1 && same(polyline.points[n - 1], polyline.points[n - 2]))
      element.error("is the point before it once more; two points in a row must differ");
  }
  return polyline;
}

void read_obstacle(const std::string& name, const JsonNode& node, SceneReading& reading) {
  check_name(node, name);
  if (is_in(reading.body_names, name)) node.error_at_key("a body has the name " + in_quotes(name) + " already");
  const auto kind = node.kind({"plane", "circle", "polyline"}, {"cylinder", "sphere"}, {"move", "rotate"});
  if (!kind) return;
  Obstacle obstacle;
  obstacle.name = name;
  if (const auto move = node.find("move")) obstacle.move = reading.move(*move);
  if (const auto rotate = node.find("rotate")) obstacle.rotate = reading.rotation(*rotate);
  if (kind->first == "plane") {
    if (auto plane = read_plane(kind->second, reading)) obstacle.shape = *std::move(plane);
  } else if (reading.dimension() == 3) {
    kind->second.error_at_key("a " + kind->first + " needs a plane space; allowed in the space solid: plane");
  } else if (kind->first == "polyline") {
    reading.only_at_small_strain(kind->second);
    if (auto polyline = read_polyline(kind->second, reading)) obstacle.shape = *std::move(polyline);
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
