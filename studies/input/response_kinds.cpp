#include "studies/input/response_kinds.hpp"

#include <algorithm>

#include "studies/input/described.hpp"

namespace stickslip {
namespace {

using Schema = nlohmann::ordered_json;

using Component = ResponseKind::Component;

constexpr std::array kinds{
    ResponseKind{.name = "reaction",
                 .kind = Response::Kind::reaction,
                 .component = Component::axis,
                 .about = "force of the support on the body, summed over the side",
                 .example = R"({"on": "block.left", "component": "x"})",
                 .own_descriptions = {{{"component", "an axis, or the moment about a point, in space about an axis"}}}},
    ResponseKind{
        .name = "contact_force",
        .kind = Response::Kind::contact_force,
        .of_contact = true,
        .component = Component::axis_or_normal,
        .about = "force on the slave",
        .example = R"({"contact": "sole", "component": "normal"})",
        .own_descriptions = {{{"component",
                               "an axis; normal: positive in compression; moment: about a point, in space about an "
                               "axis"}}}},
    ResponseKind{.name = "displacement",
                 .kind = Response::Kind::displacement,
                 .component = Component::axis,
                 .sampled = true,
                 .about = "of a side, or of a point (length)",
                 .example = R"({"on": "block.right", "component": "x"})",
                 .own_descriptions = {{{"on", "where; beside at: the body that the point is in"}}}},
    ResponseKind{.name = "contact_pressure",
                 .kind = Response::Kind::contact_pressure,
                 .of_contact = true,
                 .sampled = true,
                 .about = "force per area of the start",
                 .example = R"({"contact": "sole", "take": "max"})"},
    ResponseKind{.name = "gap",
                 .kind = Response::Kind::gap,
                 .of_contact = true,
                 .sampled = true,
                 .about = "negative: penetration (length)",
                 .example = R"({"contact": "sole", "take": "min"})"},
    ResponseKind{.name = "slip",
                 .kind = Response::Kind::slip,
                 .of_contact = true,
                 .component = Component::axis_in_space,
                 .sampled = true,
                 .about = "since the start, of a contact with friction (length)",
                 .example = R"({"contact": "sole"})",
                 .own_descriptions = {{{"component", "in space: an axis"}}}},
    ResponseKind{.name = "dissipation",
                 .kind = Response::Kind::dissipation,
                 .of_contact = true,
                 .about = "work of friction since the start",
                 .example = R"({"contact": "sole"})"},
    ResponseKind{
        .name = "strain_energy", .kind = Response::Kind::strain_energy, .about = "of all bodies", .example = "{}"},
    ResponseKind{.name = "plastic_strain",
                 .kind = Response::Kind::plastic_strain,
                 .sampled = true,
                 .about = "equivalent plastic strain of a body of j2_plastic",
                 .example = R"({"on": "block", "take": "max"})",
                 .own_descriptions = {{{"on", "a body"}, {"take", "of its points, mean by volume"}}}},
    ResponseKind{.name = "contact_half_width",
                 .kind = Response::Kind::contact_half_width,
                 .of_contact = true,
                 .about = "2 sqrt(sum of p x^2 A / P), Hertz's a; around an axis the radius",
                 .example = R"({"contact": "sole"})",
                 .own_descriptions = {{{"about",
                                        "in a plane space: the middle of the contact, where it is no end held by "
                                        "symmetry (length)"}}}}};

/// Schema of each key, but of what is of a kind.
constexpr const char* key_schemas = R"json({
  "on": {"description": "where", "$ref": "#/$defs/side",
    "examples": ["block.left"]},
  "contact": {"description": "name of a contact", "type": "string", "examples": ["sole"]},
  "component": {"description": "an axis"},
  "take": {"description": "of the nodes of the side, or of the contact", "enum": ["mean", "max", "min"],
    "default": "mean"},
  "at": {"description": "in place of take: a point of the initial configuration (length)",
    "$ref": "#/$defs/vector", "examples": [[4, 0]]},
  "about": {"description": "of the component moment: the point that it is about, in space a point of the axis (length)",
    "$ref": "#/$defs/vector", "examples": [[0, 0]]},
  "axis": {"description": "of the component moment, in space: direction of the axis, right-handed",
    "$ref": "#/$defs/vector", "examples": [[0, 0, 1]]}
})json";

/// Schema of one kind of response, with the keys that it has in the plane.
Schema kind_schema(const ResponseKind& kind, const Schema& schemas) {
  const Keys keys = keys_of(kind, 2);
  const bool moment = has_moment(kind);
  Schema properties = Schema::object();
  for (const auto* list : {&keys.required, &keys.optional})
    for (const auto& key : *list) properties[key] = schemas.at(key);
  for (const auto& [key, text] : kind.own_descriptions)
    if (key) properties[key]["description"] = text;
  if (properties.contains("component")) {
    const bool normal = kind.component == ResponseKind::Component::axis_or_normal;
    Schema components = {"x", "y", "z"};
    if (normal) components.push_back("normal");
    if (moment) components.push_back("moment");
    properties["component"]["enum"] = components;
    properties["component"]["examples"] = Schema::array({normal ? "normal" : "x"});
  }
  Schema schema{
      {"type", "object"},          {"description", kind.about},     {"examples", {Schema::parse(kind.example)}},
      {"required", keys.required}, {"additionalProperties", false}, {"properties", properties}};
  if (kind.kind == Response::Kind::displacement)  // of one of the two
    for (const char* key : {"on", "at"}) schema["anyOf"].push_back({{"required", {key}}});
  if (moment) {  // the two go together
    schema["if"] = {{"properties", {{"component", {{"const", "moment"}}}}}};
    schema["then"] = {{"required", {"about"}}};
    schema["else"] = {{"properties", {{"about", false}, {"axis", false}}}};
  }
  return schema;
}

}  // namespace

std::span<const ResponseKind> response_kinds() { return kinds; }

std::string_view name_of(Response::Kind kind) { return response_kinds()[static_cast<std::size_t>(kind)].name; }

bool has_moment(const ResponseKind& kind) {
  return kind.kind == Response::Kind::reaction || kind.kind == Response::Kind::contact_force;
}

Keys keys_of(const ResponseKind& kind, int dimension) {
  Keys keys;
  if (kind.of_contact) keys.required.emplace_back("contact");
  if (kind.kind == Response::Kind::reaction) keys.required.emplace_back("on");
  if (kind.kind == Response::Kind::displacement) keys.optional.emplace_back("on");
  if (kind.component == ResponseKind::Component::axis_in_space)
    (dimension == 3 ? keys.required : keys.optional).emplace_back("component");
  else if (kind.component != ResponseKind::Component::none)
    keys.required.emplace_back("component");
  if (kind.sampled) keys.optional.emplace_back("take");
  if (kind.kind == Response::Kind::plastic_strain)
    keys.required.emplace_back("on");
  else if (kind.sampled)
    keys.optional.emplace_back("at");
  if (has_moment(kind) || kind.kind == Response::Kind::contact_half_width) keys.optional.emplace_back("about");
  if (has_moment(kind)) keys.optional.emplace_back("axis");
  return keys;
}

Schema response_schema() {
  const Schema schemas = Schema::parse(key_schemas);
  Schema kinds = Schema::object();
  for (const auto& kind : response_kinds()) kinds[kind.name] = kind_schema(kind, schemas);
  return one_of(kinds);
}

}  // namespace stickslip
