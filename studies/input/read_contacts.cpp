#include <algorithm>
#include <set>

#include "core/mesh/generators.hpp"
#include "core/mesh/sides.hpp"
#include "studies/input/file_objects.hpp"
#include "studies/input/friction_laws.hpp"
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
  std::vector<std::string> keys, in_plane, in_space;
  for (const auto& kind : kinds) {
    keys.push_back(kind.key);
    if (kind.is_in_plane) in_plane.push_back(kind.key);
    if (kind.is_in_space) in_space.push_back(kind.key);
  }
  const auto chosen = node.kind(keys, {}, keys_of(scene_object("obstacle")).optional);
  if (!chosen) return;
  const auto& [key, shape] = *chosen;
  Obstacle obstacle;
  obstacle.name = name;
  if (const auto move = node.find("move")) obstacle.move = reading.move(*move);
  if (const auto rotate = node.find("rotate")) obstacle.rotate = reading.rotation(*rotate);
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&key = key](const auto& k) { return key == k.key; });
  if (reading.dimension() == 3 && !kind->is_in_space) {
    shape.error_at_key("a " + key + " needs a plane space; allowed in the space solid: " + listed(in_space));
  } else if (reading.dimension() == 2 && !kind->is_in_plane) {
    shape.error_at_key("a " + key + " needs the space solid; allowed in a plane space: " + listed(in_plane));
  } else {
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

/// `of_itself`: it is the slave too.
void check_master(const JsonNode& node, const std::optional<NamedSide>& slave, bool of_itself, SceneReading& reading) {
  const auto master = touching_side(node, reading);
  if (!master) return;
  if (master->side.facets.empty()) node.error("is " + shown(node.value()) + ", single nodes; a master needs facets");
  if (!slave || slave->body != master->body || of_itself) return;
  const std::set<int> nodes(slave->side.nodes.begin(), slave->side.nodes.end());
  if (std::any_of(master->side.nodes.begin(), master->side.nodes.end(), [&](int n) { return nodes.count(n) > 0; }))
    node.error("is " + shown(node.value()) +
               ", which shares nodes with the slave; a side that touches itself is both, the same expression");
}

/// How the facets of the master are smoothed.
void read_surface(const JsonNode& node, Contact& contact, const SceneReading& reading) {
  if (node.value() == "faceted") return;
  const auto is_master = [&](const Obstacle& obstacle) {
    return obstacle.name == contact.master && !has_facets(obstacle.shape);
  };
  const auto& obstacles = reading.scene.obstacles;
  if (std::any_of(obstacles.begin(), obstacles.end(), is_master)) {
    node.error("smooths facets, and the master " + in_quotes(contact.master) + " has none; allowed: \"faceted\"");
    return;
  }
  contact.smoothing = Smoothing::catmull_rom;
  if (!node.value().is_object()) {
    if (node.value() != "smooth")
      node.must_be(R"("faceted", "smooth" or {"smooth": "catmull_rom" or "b_spline", "corner": degrees})");
    return;
  }
  const auto& described = scene_object("surface");
  if (!node.is_object(keys_of(described))) return;
  if (const auto kind = node.find("smooth"))
    if (kind->choice(choices_of(described, "smooth")) == "b_spline") contact.smoothing = Smoothing::b_spline;
  constexpr Rule angle{"an angle > 0 and <= 180, in degrees", [](double x) { return x > 0 && x <= 180; }};
  if (const auto corner = node.find("corner")) contact.corner = corner->number(angle).value_or(contact.corner);
}

/// Mean length of the facets around a body at the start, in space of their edges. pre: it has a mesh; what else it has
/// may be at fault.
double facet_length(const std::string& body, const Side& boundary, const SceneReading& reading) {
  const auto points =
      make_points<double>(reading.described.at(body), reading.meshes.at(body), reading.scene.as<double>());
  double length = 0;
  std::size_t count = 0;  // of edges: a facet of the plane is one itself
  for (const auto& facet : boundary.facets)
    for (std::size_t k = facet.size() == 2 ? 1 : 0; k < facet.size(); ++k, ++count)
      length += (points.col(facet[k]) - points.col(facet[(k + 1) % facet.size()])).norm();
  return length / static_cast<double>(count);
}

/// The bodies that {"between": ...} names; empty where it is at fault. `self`: one is enough.
std::vector<std::string> bodies_between(const JsonNode& node, bool self, const SceneReading& reading) {
  const std::size_t least = self ? 1 : 2;
  const auto is_solid = [&](const std::string& name) {
    const auto mesh = reading.meshes.find(name);
    return mesh != reading.meshes.end() && is_continuum(mesh->second.shape);
  };
  if (node.value() == "all") {
    std::vector<std::string> all = reading.body_names;
    std::erase_if(all, [&](const std::string& name) { return !is_solid(name); });
    if (all.size() < least)
      node.error(self ? R"(is "all", and the scene has no solid body)"
                      : R"(is "all", and the scene has less than two solid bodies)");
    return all.size() < least ? std::vector<std::string>() : all;
  }
  if (!node.value().is_array() || node.value().size() < least) {
    node.must_be((self ? "\"all\" or an array of bodies: " : "\"all\" or an array of two bodies or more: ") +
                 listed(reading.body_names));
    return {};
  }
  std::vector<std::string> names;
  bool valid = true;
  for (const JsonNode& element : node.elements()) {
    const auto name = element.text();
    valid &= name.has_value();
    if (!name) continue;
    const bool is_new = !is_in(names, *name);
    if (!is_in(reading.body_names, *name))
      element.error("is " + in_quotes(*name) + ": there is no such body;" + suggestion(*name, reading.body_names) +
                    " allowed: " + listed(reading.body_names));
    else if (!is_new)
      element.error("is " + in_quotes(*name) + R"( once more; a body touches itself where "self" is true)");
    else if (reading.meshes.count(*name) && !is_solid(*name))
      element.error("is " + in_quotes(*name) +
                    ", which has no boundary of facets: solid bodies alone may be named here");
    valid &= is_new && is_solid(*name);
    names.push_back(*name);
  }
  return valid ? names : std::vector<std::string>();
}

/// One contact for each pair of bodies, along their whole boundaries. The slave is the body of the shorter facets, or
/// of two alike the one named first. `self`: each also touches itself.
void read_pairs(const Contact& common, const JsonNode& between, bool self, SceneReading& reading) {
  constexpr double alike = 1e-9;
  std::vector<std::pair<std::string, double>> bodies;
  for (const std::string& body : bodies_between(between, self, reading)) {
    const Side boundary = evaluate_side(reading.meshes.at(body), "boundary");
    bodies.emplace_back(body, facet_length(body, boundary, reading));
  }
  for (std::size_t a = 0; a < bodies.size(); ++a)
    for (std::size_t b = self ? a : a + 1; b < bodies.size(); ++b) {
      const bool second = bodies[b].second < bodies[a].second * (1 - alike);
      const std::string &slave = bodies[second ? b : a].first, &master = bodies[second ? a : b].first;
      Contact pair = common;
      pair.group = common.name;
      pair.name = common.name + "/" + slave + "~" + master;
      pair.slave = slave + ".boundary";
      pair.master = master + ".boundary";
      reading.contact_names.push_back(pair.name);
      reading.scene.contacts.push_back(std::move(pair));
    }
}

/// Whether a master is a side of a body, or an obstacle that has facets.
bool is_surface(const std::string& master, const SceneReading& reading) {
  const auto& obstacles = reading.scene.obstacles;
  const auto found = std::find_if(obstacles.begin(), obstacles.end(), [&](const auto& o) { return o.name == master; });
  return found == obstacles.end() || has_facets(found->shape);
}

/// What integration over segments does not go with. `is_solid`: the slave is a side of a solid body.
void check_segments(const JsonNode& node, const Contact& contact, bool is_solid, bool of_itself,
                    SceneReading& reading) {
  if (reading.dimension() == 3 && reading.scene.finite_strain)
    node.error(R"(is "segment", which in the space solid needs small strain; allowed at finite strain: "node")");
  if (of_itself && !reading.scene.finite_strain)
    node.error(R"(is "segment", which a side takes against itself at finite strain alone; allowed: "node")");
  if (contact.smoothing != Smoothing::none)
    node.error(R"(is "segment", which integrates along straight facets; with a smooth surface: "node")");
  if (!is_solid)
    node.error("is \"segment\", which integrates along the facets of a solid body; the slave " +
               in_quotes(contact.slave) + " has none; allowed: \"node\"");
}

void read_contact(const std::string& name, const JsonNode& node, SceneReading& reading) {
  const auto& described = scene_object("contact");
  const auto between = node.value().is_object() ? node.find("between") : std::nullopt;
  using Names = std::vector<std::string>;
  if (!node.is_object(keys_of(described, between ? Names{"between"} : Names{"slave", "master"}))) return;
  for (const std::string& key : between ? Names{"slave", "master"} : Names{"self"})
    if (const auto other = node.find(key))
      other->error_at_key(between ? R"(does not go with "between", which names bodies)" : R"(belongs to "between")");
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
        check_master(*master, slave_side, *text == contact.slave, reading);
      else
        master->error("is " + in_quotes(*text) + ", which is neither an obstacle nor a side BODY.SIDE;" +
                      suggestion(*text, reading.obstacle_names) + " obstacles: " + listed(reading.obstacle_names));
    }
    contact.master = text.value_or("");
  }
  if (const auto friction = node.find("friction")) contact.friction = read_friction(*friction, reading);
  contact.offset = read_number(node, described, "offset", reading);
  if (const auto surface = node.find("surface")) read_surface(*surface, contact, reading);
  const bool is_solid =
      between || !slave_side || (is_continuum(slave_side->mesh->shape) && !slave_side->side.facets.empty());
  // Why the defaults: the geometry of integrated contact is continuous, from facet to facet and over ends; so is the
  // normal of a smooth surface. A point that slides over facets has no equilibrium at some of their vertices.
  const bool is_free = reading.scene.finite_strain && !node.find("surface") && is_surface(contact.master, reading);
  contact.segment = is_solid && is_free && reading.dimension() == 2;
  const auto touches_itself = between ? node.find("self") : std::nullopt;
  const bool self = touches_itself && touches_itself->boolean().value_or(false);
  if (const auto discretization = node.find("discretization")) {
    contact.segment = discretization->choice(choices_of(described, "discretization")) == "segment";
    const bool of_itself = between ? self : contact.is_of_itself();
    if (contact.segment) check_segments(*discretization, contact, is_solid, of_itself, reading);
  }
  if (is_free && !contact.segment) contact.smoothing = Smoothing::catmull_rom;
  if (between) return read_pairs(contact, *between, self, reading);
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
