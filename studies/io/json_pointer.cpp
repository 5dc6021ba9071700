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

/// The keys of a pointer; none where it is no pointer.
std::optional<std::vector<std::string>> keys_of(const std::string& pointer) {
  std::vector<std::string> keys;
  if (!pointer.empty() && pointer[0] != '/') return std::nullopt;
  for (std::size_t i = 0; i < pointer.size(); ++i) {
    if (pointer[i] == '/') {
      keys.emplace_back();
    } else if (pointer[i] == '~') {
      if (++i == pointer.size() || (pointer[i] != '0' && pointer[i] != '1')) return std::nullopt;
      keys.back() += pointer[i] == '0' ? '~' : '/';
    } else {
      keys.back() += pointer[i];
    }
  }
  return keys;
}

const json* member(const json& parent, const std::string& key) {
  if (parent.is_object()) {
    const auto found = parent.find(key);
    return found == parent.end() ? nullptr : &*found;
  }
  const bool index = !key.empty() && key.size() < 10 && key.find_first_not_of("0123456789") == std::string::npos &&
                     (key == "0" || key[0] != '0');
  if (!parent.is_array() || !index || std::stoul(key) >= parent.size()) return nullptr;
  return &parent[std::stoul(key)];
}

std::vector<std::string> names_in(const json& object) {
  std::vector<std::string> names;
  for (const auto& [name, unused] : object.items()) names.push_back(name);
  return names;
}

}  // namespace

bool is_pointer(const std::string& text) { return !text.empty() && keys_of(text); }

const json* value_at(const json& root, const std::string& pointer) {
  const auto keys = keys_of(pointer);
  const json* value = keys ? &root : nullptr;
  for (std::size_t i = 0; value && i < keys->size(); ++i) value = member(*value, (*keys)[i]);
  return value;
}

std::string pointer_fault(const json& root, const std::string& pointer) {
  const auto keys = keys_of(pointer);
  if (pointer.starts_with('/') && !keys)
    return in_quotes(pointer) + " is no JSON pointer; in a name ~ is written ~0 and / is written ~1";
  if (!keys || keys->empty())
    return in_quotes(pointer) + " is no JSON pointer; must begin with / and name a value, such as /time/steps";
  const json* value = &root;
  std::string reached;
  for (const std::string& key : *keys) {
    const json* next = member(*value, key);
    if (!next) {
      std::string message = pointer + " names nothing: " + (reached.empty() ? "the file" : reached);
      if (value->is_array() && value->empty()) return message + " is empty";
      if (value->is_array()) return message + " has elements 0 to " + std::to_string(value->size() - 1);
      if (!value->is_object()) return message + " is " + shown(*value) + " and holds no " + in_quotes(key);
      const auto names = names_in(*value);
      return message + " has no " + in_quotes(key) + ";" + suggestion(key, names) + " it has " + listed(names);
    }
    value = next;
    reached = child_pointer(reached, key);
  }
  return "";
}

}  // namespace stickslip
