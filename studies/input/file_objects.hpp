/// The objects of scenes and studies that code reads key by key. Each is described once, in JSON Schema: of every key
/// its meaning with its unit, its type, its default and an example. From that come the keys that its reader allows, the
/// schema that editors read by `stickslip schema`, and the tables of docs/, which are printed from it
/// (tools/key_tables.py). What keys ask of one another is code of the reader; the schema says it too, as far as it can.
///
/// "title" is the name of a type in the tables; "default" is what holds where the key is left out; {"$object": NAME}
/// stands for the object of that name. Keys stand in the order in which messages name them. What is null here says its
/// keys itself, as meshes, materials, obstacles, laws of friction, methods and small_objects.hpp do.
#pragma once

#include <nlohmann/json.hpp>

#include "studies/input/scene_reading.hpp"

namespace stickslip {

/// All objects of a scene by name; those of studies are study_objects() (studies/sweep/study_reading.hpp).
const nlohmann::ordered_json& scene_objects();
inline const nlohmann::ordered_json& scene_object(const char* name) { return scene_objects().at(name); }

/// One of these objects, with those that it names put in their places.
nlohmann::ordered_json whole_object(const nlohmann::ordered_json& objects, const char* name);

/// The keys that an object must have and may have; the same where it must have these.
Keys keys_of(const nlohmann::ordered_json& object);
Keys keys_of(const nlohmann::ordered_json& object, const std::vector<std::string>& required);
/// The one key that the object has of those that begin the alternatives of its "oneOf". None, reported, where it is not
/// just one.
std::optional<std::pair<std::string, JsonNode>> read_kind(const JsonNode&, const nlohmann::ordered_json& object);
/// The object with more kinds, each of which has a key and a schema: just one of all must be there.
template <class Kinds>
nlohmann::ordered_json with_kinds(nlohmann::ordered_json object, const Kinds& kinds) {
  auto properties = nlohmann::ordered_json::object(), one = nlohmann::ordered_json::array();
  for (const auto& kind : kinds) {
    properties[kind.key] = kind.schema();
    one.push_back({{"required", {kind.key}}});
  }
  properties.update(object["properties"]);
  for (const auto& kind : object["oneOf"]) one.push_back(kind);
  object["properties"] = properties;
  object["oneOf"] = one;
  return object;
}
/// The words that a key may have.
std::vector<std::string> choices_of(const nlohmann::ordered_json& object, const char* key);
/// The number at a key, within its range, or its default.
Number read_number(const JsonNode&, const nlohmann::ordered_json& object, const char* key, SceneReading&);

/// Sets an enumerator by the word at a key, if it is there; words are in the order of the enumeration.
template <class E>
void read_word(const JsonNode& node, const nlohmann::ordered_json& object, const char* key, E& to) {
  const auto words = choices_of(object, key);
  const auto given = node.find(key);
  const auto word = given ? given->choice(words) : std::nullopt;
  for (std::size_t i = 0; i < words.size(); ++i)
    if (word == words[i]) to = static_cast<E>(i);
}

}  // namespace stickslip
