#include <algorithm>
#include <array>

#include "studies/input/file_objects.hpp"
#include "studies/input/response_kinds.hpp"

namespace stickslip {
namespace {

void read_contact_name(const JsonNode& node, const ResponseKind& kind, Response& response, SceneReading& reading) {
  const auto name = node.text();
  if (!name) return;
  response.on = *name;
  const auto& names = reading.contact_names;
  if (std::find(names.begin(), names.end(), *name) == names.end())
    return node.error("is " + in_quotes(*name) + ": there is no such contact;" + suggestion(*name, names) +
                      " allowed: " + listed(names));
  if (kind.kind != Response::Kind::slip) return;
  for (const Contact& contact : reading.scene.contacts)
    if ((contact.name == *name || contact.group == *name) && !contact.friction)
      node.error("is " + in_quotes(*name) + ", a contact without friction, whose slip is not followed; give it a " +
                 "friction, which may be 0");
}

/// "on" of a displacement or a reaction: a side; beside "at", the body that the point is in.
void read_on(const JsonNode& node, bool beside_at, Response& response, SceneReading& reading) {
  if (node.value().is_string()) response.on = node.value();
  const auto& names = reading.body_names;
  if (!beside_at)
    reading.side(node);
  else if (std::find(names.begin(), names.end(), response.on) == names.end())
    node.error(R"(must be a body beside "at": a point is taken, and not a side; allowed: )" + listed(names));
}

/// "on" of a plastic strain: a body that flows.
void read_flowing_body(const JsonNode& node, Response& response, SceneReading& reading) {
  const auto name = node.text();
  if (!name) return;
  response.on = *name;
  std::vector<std::string> flowing;
  for (const Body& body : reading.scene.bodies)
    if (flows(body.material)) flowing.push_back(body.name);
  if (std::find(flowing.begin(), flowing.end(), *name) != flowing.end()) return;
  const auto& names = reading.body_names;
  if (flowing.empty())
    node.error("is " + in_quotes(*name) + ": no body flows; give one the material j2_plastic");
  else
    node.error("is " + in_quotes(*name) + ": " +
               (std::find(names.begin(), names.end(), *name) == names.end() ? "there is no such body"
                                                                            : "that body does not flow") +
               "; allowed: " + listed(flowing));
}

/// Coordinates that say where a response is taken: they are no parameters.
std::vector<Number> read_place(const JsonNode& node, SceneReading& reading) {
  std::vector<Number> place;
  const auto point = node.array(reading.dimension(), "an array of " + std::to_string(reading.dimension()) + " numbers");
  if (!point) return place;
  for (const JsonNode& coordinate : *point) {
    reading.constants[coordinate.pointer()] = "where a response is taken, not a part of the scene";
    place.emplace_back(coordinate.number(any_number).value_or(0));
  }
  return place;
}

Response::Component component_of(const std::string& word) {
  constexpr std::array words{"", "x", "y", "z", "normal", "moment"};  // in the order of Component
  return static_cast<Response::Component>(std::find(words.begin(), words.end(), word) - words.begin());
}

void read_component(const JsonNode& node, const JsonNode& component, const ResponseKind& kind, Response& response,
                    SceneReading& reading) {
  auto allowed = reading.axes();
  if (kind.component == ResponseKind::Component::axis_or_normal) allowed.insert(allowed.begin(), "normal");
  const bool moment = has_moment(kind);
  if (moment) allowed.emplace_back("moment");
  response.component = component_of(component.choice(allowed).value_or(allowed.front()));
  if (!moment) return;
  const bool in_space = reading.dimension() == 3, is_moment = response.component == Response::Component::moment;
  const auto read = [&](const char* key, std::vector<Number>& into, const char* what) {
    const auto found = node.find(key);
    if (found) into = read_place(*found, reading);
    if (found && !is_moment) found->error_at_key(in_quotes(key) + R"( belongs to the component "moment")");
    if (!found && is_moment) node.error("the key " + in_quotes(key) + " is missing: " + what);
  };
  read("about", response.about,
       in_space ? "a point [x, y, z] of the axis of the moment" : "the point [x, y] that the moment is about");
  if (!in_space) {
    if (const auto axis = node.find("axis"))
      axis->error_at_key("an axis needs the space solid; in a plane space a moment is about a point");
    return;
  }
  read("axis", response.moment_axis, "the direction [x, y, z] of the axis of the moment");
  const auto& axis = response.moment_axis;
  if (!axis.empty() && std::all_of(axis.begin(), axis.end(), [](const Number& n) { return n.value == 0; }))
    node.find("axis")->must_be("a vector that is not zero");
}

void read_response(const std::string& name, const JsonNode& outer, SceneReading& reading) {
  check_characters(outer, name);
  std::vector<std::string> names;
  const auto kinds = response_kinds();
  for (const ResponseKind& each : kinds) names.emplace_back(each.name);
  const auto found = outer.kind(names);
  if (!found) return;
  const JsonNode& node = found->second;
  const ResponseKind& kind =
      *std::find_if(kinds.begin(), kinds.end(), [&](const ResponseKind& k) { return k.name == found->first; });
  if (!node.is_object(keys_of(kind, reading.dimension()))) return;
  if (kind.kind == Response::Kind::contact_half_width && reading.dimension() == 3)
    node.error_at_key("a half width needs a plane space");

  Response response;
  response.name = name;
  response.kind = kind.kind;
  const auto on = node.find("on"), at = node.find("at"), take = node.find("take"), component = node.find("component");
  if (const auto contact = node.find("contact"); contact && kind.of_contact)
    read_contact_name(*contact, kind, response, reading);
  if (on && kind.kind == Response::Kind::plastic_strain)
    read_flowing_body(*on, response, reading);
  else if (on && !kind.of_contact)
    read_on(*on, at.has_value(), response, reading);
  if (kind.kind == Response::Kind::displacement && !on && !at)
    node.error(R"(one of the keys is missing: "on", a side BODY.SIDE, or "at", a point)");
  if (component && kind.component != ResponseKind::Component::none)
    read_component(node, *component, kind, response, reading);
  if (take && kind.sampled) {
    take->word(response.take, std::array{"mean", "max", "min"});
    if (at) take->error_at_key(R"("take" has no meaning beside "at", which is a single point)");
  }
  if (at && kind.sampled) response.at = read_place(*at, reading);
  if (const auto about = node.find("about"); about && kind.kind == Response::Kind::contact_half_width) {
    response.about = read_place(*about, reading);
    if (reading.scene.space == Space::axisymmetric)
      about->error_at_key("a half width around an axis is a radius, which is measured from the axis");
  }
  reading.scene.responses.push_back(std::move(response));
}

/// The time of "at": within the run, whose end is known where "time" is right.
void read_instant(const JsonNode& node, Objective& objective, SceneReading& reading) {
  objective.at = reading.time(node, positive);
  const auto& legs = reading.scene.legs;
  if (objective.at && reading.scene.arc_length && *objective.at != legs.back().end)
    node.must_be("the end of the run, " + shown(legs.back().end) +
                 R"(: along a path the times of other steps are found (/time/control))");
  else if (objective.at && !legs.empty() && *objective.at > legs.back().end)
    node.error("is " + shown(node.value()) + ", after the end of the run at " + shown(legs.back().end));
}

void read_objective(const std::string& name, const JsonNode& node, SceneReading& reading) {
  check_characters(node, name);
  if (!node.is_object(keys_of(scene_object("objective")))) return;
  Objective objective;
  objective.name = name;
  const auto& responses = reading.scene.responses;
  if (std::any_of(responses.begin(), responses.end(), [&](const Response& each) { return each.name == name; }))
    node.error_at_key("a response has the name " + in_quotes(name) + " already");
  const auto of = node.find("of"), sum = node.find("sum"), at = node.find("at"), target = node.find("target");
  std::vector<std::string> names;
  for (const auto& response : reading.scene.responses) names.push_back(response.name);
  if (const auto response = of ? of->text() : std::nullopt) {
    const auto found = std::find(names.begin(), names.end(), *response);
    objective.response = static_cast<int>(found - names.begin());
    if (found == names.end() && !reading.diagnostics.has_error_in("/responses"))
      of->error("is " + in_quotes(*response) + ": there is no such response;" + suggestion(*response, names) +
                " allowed: " + listed(names));
  }
  if (sum && at) at->error_at_key(R"("at" is a single time, and "sum" adds up all steps: one of the two)");
  if (!sum && !at) node.error(R"(one of the keys is missing: "sum": true, or "at": a time)");
  if (sum && sum->value() != true) sum->must_be("true");
  if (at) read_instant(*at, objective, reading);
  if (target) objective.target = reading.table(*target);
  reading.scene.objectives.push_back(std::move(objective));
}

}  // namespace

void read_responses(const JsonNode& node, SceneReading& reading) {
  if (!node.is_map("responses by name")) return;
  for (const auto& [name, response] : node.members()) read_response(name, response, reading);
}

void read_objectives(const JsonNode& node, SceneReading& reading) {
  if (!node.is_map("objectives by name")) return;
  for (const auto& [name, objective] : node.members()) read_objective(name, objective, reading);
}

}  // namespace stickslip
