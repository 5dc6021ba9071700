/// Looking into JSON that may lack what is asked for. All return references that outlive the call, never throw, and
/// chain: at(at(record, "cost"), "seconds").
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace stickslip::report {

/// value[key] of an object; null where there is none.
inline const nlohmann::json& at(const nlohmann::json& value, const std::string& key) {
  static const nlohmann::json nothing;
  const auto found = value.find(key);  // end() where `value` is no object
  return found == value.end() ? nothing : *found;
}

/// The object at `key`; an empty one where there is none, or something else.
inline const nlohmann::json& object_at(const nlohmann::json& value, const std::string& key) {
  static const nlohmann::json empty = nlohmann::json::object();
  const auto& found = at(value, key);
  return found.is_object() ? found : empty;
}

/// The array at `key`; an empty one where there is none, or something else.
inline const nlohmann::json& array_at(const nlohmann::json& value, const std::string& key) {
  static const nlohmann::json empty = nlohmann::json::array();
  const auto& found = at(value, key);
  return found.is_array() ? found : empty;
}

/// The text at `key`; "" where there is none.
inline std::string text_at(const nlohmann::json& value, const std::string& key) {
  const auto& found = at(value, key);
  return found.is_string() ? found.get<std::string>() : std::string();
}

/// The number at `key`; 0 where there is none.
inline double number_at(const nlohmann::json& value, const std::string& key) {
  const auto& found = at(value, key);
  return found.is_number() ? found.get<double>() : 0;
}

}  // namespace stickslip::report
