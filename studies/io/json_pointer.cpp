#include "studies/io/json_pointer.hpp"

#include <optional>
#include <vector>

#include "studies/io/wording.hpp"

namespace stickslip {

using nlohmann::json;

namespace {

/// None where the text is no pointer.
std::optional<json::json_pointer> pointer_in(const std::string& text) try {
  return json::json_pointer(text);
} catch (const json::parse_error&) {
  return std::nullopt;
}

/// The value of a pointer; null where there is none.
const json* named(const json& root, const json::json_pointer& pointer) try {
  return root.contains(pointer) ? &root.at(pointer) : nullptr;
} catch (const json::out_of_range&) {  // an index beyond all numbers
  return nullptr;
}

std::vector<std::string> names_in(const json& object) {
  std::vector<std::string> names;
  for (const auto& [name, unused] : object.items()) names.push_back(name);
  return names;
}

}  // namespace

std::string child_pointer(const std::string& parent, std::string_view key) {
  return parent + (json::json_pointer() / std::string(key)).to_string();
}

bool is_pointer(const std::string& text) { return !text.empty() && pointer_in(text); }

const json* value_at(const json& root, const std::string& pointer) {
  const auto place = pointer_in(pointer);
  return place ? named(root, *place) : nullptr;
}

std::string pointer_fault(const json& root, const std::string& text) {
  const auto pointer = pointer_in(text);
  if (text.starts_with('/') && !pointer)
    return in_quotes(text) + " is no JSON pointer; in a name ~ is written ~0 and / is written ~1";
  if (!pointer || pointer->empty())
    return in_quotes(text) + " is no JSON pointer; must begin with / and name a value, such as /time/steps";
  if (named(root, *pointer)) return "";
  auto missing = *pointer;  // the first part of it that names nothing
  while (!named(root, missing.parent_pointer())) missing.pop_back();
  const json& parent = *named(root, missing.parent_pointer());
  const std::string reached = missing.parent_pointer().to_string(), &key = missing.back();
  const std::string message = text + " names nothing: " + (reached.empty() ? "the file" : reached);
  if (parent.is_array() && parent.empty()) return message + " is empty";
  if (parent.is_array()) return message + " has elements 0 to " + std::to_string(parent.size() - 1);
  if (!parent.is_object()) return message + " is " + shown(parent) + " and holds no " + in_quotes(key);
  const auto names = names_in(parent);
  return message + " has no " + in_quotes(key) + ";" + suggestion(key, names) + " it has " + listed(names);
}

}  // namespace stickslip
