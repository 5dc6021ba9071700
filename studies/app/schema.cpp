#include "studies/app/schema.hpp"

#include <nlohmann/json.hpp>

#include "studies/app/schema_texts.hpp"
#include "studies/input/materials.hpp"
#include "studies/input/method_options.hpp"
#include "studies/input/obstacle_kinds.hpp"
#include "studies/sweep/closed_forms.hpp"

namespace stickslip {
namespace {

using json = nlohmann::ordered_json;

constexpr const char* draft = "https://json-schema.org/draft/2020-12/schema";

/// Schema of one kind of response, with the keys that it has.
json kind_schema(const std::string& kind, const json& parts, const json& keys) {
  json properties = json::object();
  for (const char* list : {"required", "optional"})
    for (const std::string key : parts.at(list)) properties[key] = keys.at(key);
  const json own = parts.value("descriptions", json::object());
  for (const auto& [key, text] : own.items()) properties[key]["description"] = text;
  const bool moment = properties.contains("about");
  if (properties.contains("component")) {
    json components = {"x", "y", "z"};
    if (kind == "contact_force") components.push_back("normal");
    if (moment) components.push_back("moment");
    properties["component"]["enum"] = components;
    properties["component"]["examples"] = json::array({kind == "contact_force" ? "normal" : "x"});
  }
  json schema{{"type", "object"},
              {"description", parts.at("description")},
              {"examples", {parts.at("example")}},
              {"required", parts.at("required")},
              {"additionalProperties", false},
              {"properties", properties}};
  if (moment) {  // the two go together
    schema["if"] = {{"properties", {{"component", {{"const", "moment"}}}}}};
    schema["then"] = {{"required", {"about"}}};
    schema["else"] = {{"properties", {{"about", false}}}};
  }
  return schema;
}

/// {"KEY": {...}} with one of the kinds' keys.
template <class Kinds>
json one_of(const Kinds& kinds) {
  json properties = json::object();
  for (const auto& kind : kinds) properties[kind.key] = json::parse(kind.schema);
  return {{"type", "object"},   {"title", "one of the following"}, {"minProperties", 1},
          {"maxProperties", 1}, {"additionalProperties", false},   {"properties", properties}};
}

/// The kinds of obstacles, one of which goes with what all of them may have.
void add_obstacle_kinds(json& obstacle) {
  json properties = json::object(), one = json::array();
  for (const auto& kind : obstacle_kinds()) {
    properties[kind.key] = json::parse(kind.schema);
    one.push_back({{"required", {kind.key}}});
  }
  properties.update(obstacle["properties"]);
  obstacle["properties"] = properties;
  obstacle["oneOf"] = one;
}

/// {"KIND": {...}}, one of the kinds.
json response_schema() {
  const json texts = json::parse(schema_texts::response);
  json kinds = json::object();
  for (const auto& [kind, parts] : texts.at("kinds").items()) kinds[kind] = kind_schema(kind, parts, texts.at("keys"));
  return {{"type", "object"},   {"title", "one of the following"}, {"minProperties", 1},
          {"maxProperties", 1}, {"additionalProperties", false},   {"properties", kinds}};
}

json document(const char* title, const char* properties, const json& required, const json& definitions) {
  return {{"$schema", draft},
          {"title", title},
          {"type", "object"},
          {"required", required},
          {"additionalProperties", false},
          {"properties", json::parse(properties)},
          {"$defs", definitions}};
}

}  // namespace

json scene_schema() {
  json definitions = json::parse(schema_texts::common);
  definitions.update(json::parse(schema_texts::motion));
  definitions["mesh"] = json::parse(schema_texts::mesh);
  definitions["material"] = one_of(material_kinds());
  definitions["response"] = response_schema();
  definitions["method"] = method_schema(OptionLists::refused);
  json schema = document("stickslip scene", schema_texts::scene, {"bodies", "time"}, definitions);
  add_obstacle_kinds(schema["properties"]["obstacles"]["additionalProperties"]);
  return schema;
}

json study_schema() {
  json definitions = json::parse(schema_texts::common);
  definitions["method"] = method_schema(OptionLists::refused);
  definitions["swept_method"] = method_schema(OptionLists::swept);
  json schema = document("stickslip study", schema_texts::study, {"scene"}, definitions);
  schema["properties"]["reference"]["items"]["properties"]["analytic"]["enum"] = analytic_names();
  return schema;
}

}  // namespace stickslip
