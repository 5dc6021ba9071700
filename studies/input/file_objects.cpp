#include "studies/input/file_objects.hpp"

#include <algorithm>
#include <stdexcept>

#include "studies/input/ranges.hpp"

namespace stickslip {
namespace {

using Schema = nlohmann::ordered_json;

/// Puts the objects that a description names in their places.
void make_whole(Schema& part, const Schema& objects) {
  if (!part.is_structured()) return;
  if (part.is_object() && part.contains("$object")) {
    Schema made{{"type", "object"}, {"additionalProperties", false}};
    made.update(objects.at(part["$object"].get<std::string>()));
    for (auto& [key, own] : part.items())
      if (key != "$object") made[key] = std::move(own);
    part = std::move(made);
  }
  for (Schema& inner : part) make_whole(inner, objects);
}

}  // namespace

Schema whole_object(const Schema& objects, const char* name) {
  Schema whole = objects.at(name);
  make_whole(whole, objects);
  return whole;
}

Keys keys_of(const Schema& object) { return keys_of(object, object.value("required", std::vector<std::string>())); }

Keys keys_of(const Schema& object, const std::vector<std::string>& required) {
  Keys keys{required};
  for (const auto& [key, unused] : object.at("properties").items())
    if (std::count(required.begin(), required.end(), key) == 0) keys.optional.push_back(key);
  return keys;
}

std::optional<std::pair<std::string, JsonNode>> read_kind(const JsonNode& node, const Schema& object) {
  std::vector<std::string> kinds;
  for (const Schema& kind : object.at("oneOf")) kinds.push_back(kind.at("required").front());
  return node.kind(kinds, {}, keys_of(object, kinds).optional);
}

std::vector<std::string> choices_of(const Schema& object, const char* key) {
  return object.at("properties").at(key).at("enum");
}

Number read_number(const JsonNode& node, const Schema& object, const char* key, SceneReading& reading) {
  const Schema& own = object.at("properties").at(key);
  for (const Range range : {Range::positive, Range::not_negative, Range::any}) {
    Schema within = own;
    within.update(schema_of(range));
    if (within == own) return reading.optional(node, key, own.at("default"), rule_of(range));
  }
  throw std::logic_error(std::string("the range of ") + key + " has no rule");
}

}  // namespace stickslip
