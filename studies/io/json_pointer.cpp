#include "studies/io/json_pointer.hpp"

#include <optional>
#include <vector>

#include "studies/io/wording.hpp"

namespace stickslip {

using nlohmann::json;

std::string child_pointer(const std::string& parent, std::string_view key) {
  std::string pointer = parent + "/";
  for (char c : key) {
    if (c == '~')
      pointer += "~0";
    else if (c == '/')
      pointer += "~1";
    else
      pointer += c;
  }
  return pointer;
}

namespace {

std::optional<json::json_pointer> parsed(const std::string& text) {
  try {
    return json::json_pointer(text);
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

/// The value of a pointer; null where there is none, as behind an index that is no number.
const json* value_of(const json& root, const json::json_pointer& pointer) {
  try {
    return root.contains(pointer) ? &root.at(pointer) : nullptr;
  } catch (const json::exception&) {
    return nullptr;
  }
}

}  // namespace

bool is_pointer(const std::string& text) { return !text.empty() && parsed(text); }

const json* value_at(const json& root, const std::string& pointer) {
  const auto keys = parsed(pointer);
  return keys ? value_of(root, *keys) : nullptr;
}

std::string pointer_fault(const json& root, const std::string& pointer) {
  const auto keys = parsed(pointer);
  if (pointer.starts_with('/') && !keys)
    return in_quotes(pointer) + " is no JSON pointer; in a name ~ is written ~0 and / is written ~1";
  if (!keys || keys->empty())
    return in_quotes(pointer) + " is no JSON pointer; must begin with / and name a value, such as /time/steps";
  const json* value = value_of(root, *keys);
  if (value) return "";
  json::json_pointer reached = *keys;
  std::string key;
  for (; !value; value = value_of(root, reached)) {
    key = reached.back();
    reached.pop_back();
  }
  std::string message = pointer + " names nothing: " + (reached.empty() ? "the file" : reached.to_string());
  if (value->is_array() && value->empty()) return message + " is empty";
  if (value->is_array()) return message + " has elements 0 to " + std::to_string(value->size() - 1);
  if (!value->is_object()) return message + " is " + shown(*value) + " and holds no " + in_quotes(key);
  std::vector<std::string> names;
  for (const auto& [name, unused] : value->items()) names.push_back(name);
  return message + " has no " + in_quotes(key) + ";" + suggestion(key, names) + " it has " + listed(names);
}

}  // namespace stickslip
