/// Kinds of responses as files name them: the keys of each, which reader and schema are made from.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "core/model/scene.hpp"
#include "studies/io/json_node.hpp"

namespace stickslip {

/// What a kind of response is taken of, and which keys it has besides.
struct ResponseKind {
  enum class Component { none, axis, axis_or_normal, axis_in_space };
  struct Description {
    const char *key = nullptr, *text = nullptr;
  };
  const char* name;  ///< of {"NAME": {...}}
  Response::Kind kind;
  bool of_contact = false;  ///< key "contact"; otherwise "on", if the kind has any
  Component component = Component::none;
  bool sampled = false;                              ///< keys "take" and "at"
  const char *about, *example;                       ///< what it is; its object, as JSON
  std::array<Description, 2> own_descriptions = {};  ///< of keys that mean something else than with other kinds
};

/// All, in the order of Response::Kind.
std::span<const ResponseKind> response_kinds();

/// The key of a kind of response in a scene file: "reaction", "contact_force", ...
std::string_view name_of(Response::Kind kind);

/// Whether it may be a moment.
bool has_moment(const ResponseKind& kind);
Keys keys_of(const ResponseKind& kind, int dimension);

/// JSON Schema of {"KIND": {...}}.
nlohmann::ordered_json response_schema();

}  // namespace stickslip
