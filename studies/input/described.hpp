/// Reader and schema of a struct of the scene, made from what it says of its keys (core/algebra/described.hpp).
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <tuple>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/algebra/described.hpp"
#include "core/mesh/extruded.hpp"
#include "studies/input/ranges.hpp"
#include "studies/input/scene_reading.hpp"

namespace stickslip {

/// Calls f(std::type_identity<X>()) for each alternative X of a variant.
template <class Variant, class F>
void for_each_alternative(F&& f) {
  [&]<class... X>(std::type_identity<std::variant<X...>>) {
    (f(std::type_identity<X>()), ...);
  }(std::type_identity<Variant>());
}

/// What `make` makes of each alternative of a variant, in their order.
template <class Variant, class Make>
auto list_of(Make make) {
  return [&]<class... X>(std::type_identity<std::variant<X...>>) {
    return std::vector{make(std::type_identity<X>())...};
  }(std::type_identity<Variant>());
}

/// JSON Schema of {"KEY": ...} with one of the keys.
inline nlohmann::ordered_json one_of(const nlohmann::ordered_json& properties) {
  return {{"type", "object"},   {"title", "one of the following"}, {"minProperties", 1},
          {"maxProperties", 1}, {"additionalProperties", false},   {"properties", properties}};
}

/// The parts of a schema that say the keys of an object.
struct ObjectSchema {
  using Schema = nlohmann::ordered_json;
  Schema required = Schema::array(), example = Schema::object(), properties = Schema::object();
};

namespace detail {

inline nlohmann::ordered_json as_json(double x) {
  const auto whole = static_cast<long>(x);
  if (x == static_cast<double>(whole)) return whole;
  return x;
}
template <class X, std::size_t n>
nlohmann::ordered_json as_json(const std::array<X, n>& list) {
  auto json = nlohmann::ordered_json::array();
  for (const X& x : list) json.push_back(as_json(x));
  return json;
}

inline nlohmann::ordered_json as_json(const char* text) { return nlohmann::ordered_json::parse(text); }

template <class How>
concept HasExample = requires(const How& how) {
  how.example;
};

/// Whether a key that is written so must be there.
template <class How>
inline constexpr bool must_be_there = HasExample<How>;
template <>
inline constexpr bool must_be_there<IfGiven> = false;
template <class S>
inline constexpr bool must_be_there<EndOfTurn<S>> = false;
template <class S, std::size_t n>
inline constexpr bool must_be_there<Grade<S, n>> = false;

inline void read_key(const JsonNode& object, SceneReading& reading, const char* key, Number& to, const InRange& how) {
  to = reading.required(object, key, rule_of(how.range));
}
inline void read_key(const JsonNode& object, SceneReading& reading, const char* key, Number& to, const IfGiven& how) {
  to = reading.optional(object, key, to.value, rule_of(how.range));
}
inline void read_key(const JsonNode& object, SceneReading& reading, const char* key, std::vector<Number>& to,
                     const Place2D&) {
  to = reading.required_vector(object, key, reading.dimension());
}
inline void read_key(const JsonNode& object, SceneReading& reading, const char* key, std::vector<Number>& to,
                     const Place3D&) {
  to = reading.required_vector(object, key, 3);
}
/// (Defined beside the list of meshes: mesh_kinds.cpp.)
void read_key(const JsonNode& object, SceneReading& reading, const char* key, PlaneMesh& to, const MeshInPlane&);
inline void read_key(const JsonNode& object, SceneReading& reading, const char* key, std::vector<Number>& to,
                     const Direction3D& how) {
  if (const auto given = object.find(key)) to = reading.direction(*given, how.what);
}
inline void read_key(const JsonNode& object, SceneReading& reading, const char* key, std::array<Number, 2>& to,
                     const Place2D&) {
  const auto place = reading.required_vector(object, key, 2);
  to = {place[0], place[1]};
}
inline void read_key(const JsonNode& object, SceneReading& reading, const char* key,
                     std::array<std::array<Number, 2>, 4>& to, const Corners2D&) {
  const auto given = object.find(key);
  const auto corners = given ? given->array(4, "four corners [x, y], counter-clockwise") : std::nullopt;
  for (int k = 0; k < 4; ++k) {
    const auto place =
        corners ? reading.vector((*corners)[k], 2) : std::vector<Number>(2, std::numeric_limits<double>::quiet_NaN());
    to[k] = {place[0], place[1]};
  }
}
inline void read_key(const JsonNode& object, SceneReading& reading, const char* key, int& to, const Count&) {
  if (const auto given = object.find(key)) to = reading.count(*given, 1).value_or(to);
}
/// As many counts as there are in `to`.
template <class Cells>
void read_cells(const JsonNode& object, SceneReading& reading, const char* key, Cells& to) {
  for (int& count : to) count = 1;
  const auto given = object.find(key);
  const auto all = given ? given->array(to.size(), "an array of " + std::to_string(to.size()) + " whole numbers >= 1")
                         : std::nullopt;
  for (std::size_t i = 0; all && i < to.size(); ++i) to[i] = reading.count((*all)[i], 1).value_or(1);
  constexpr double most = std::numeric_limits<int>::max() / 4.0;  // nodes of a quadrilateral are numbered by an int
  if (product(to) > most) given->must_be("fewer cells than 5e8 in all");
}
inline void read_key(const JsonNode& object, SceneReading& reading, const char* key, std::array<int, 2>& to,
                     const Counts&) {
  read_cells(object, reading, key, to);
}
inline void read_key(const JsonNode& object, SceneReading& reading, const char* key, std::vector<int>& to,
                     const Counts&) {
  to.resize(reading.dimension());
  read_cells(object, reading, key, to);
}
inline void read_key(const JsonNode& object, SceneReading& reading, const char* key, std::vector<Number>& to,
                     const Direction2D& how) {
  if (const auto given = object.find(key)) to = reading.direction(*given, how.what);
}
inline void read_key(const JsonNode& object, SceneReading&, const char* key, bool& to, const Flag&) {
  if (const auto given = object.find(key)) to = given->boolean().value_or(to);
}
template <class E, std::size_t n>
void read_key(const JsonNode& object, SceneReading&, const char* key, E& to, const std::array<const char*, n>& words) {
  const auto given = object.find(key);
  const auto word = given ? given->choice({words.begin(), words.end()}) : std::nullopt;
  for (std::size_t i = 0; i < n; ++i)
    if (word == words[i]) to = static_cast<E>(i);
}

// Keys that are about another member of their struct too.

template <class S>
void read_key(const JsonNode& object, SceneReading& reading, const char* key, Number& to, const EndOfTurn<S>& how,
              S& whole) {
  const auto given = object.find(key);
  const double end = given ? given->number(any_number).value_or(std::numeric_limits<double>::quiet_NaN()) : to.value;
  if (!is_full_turn((whole.*how.start).value, end)) {
    to = reading.optional(object, key, to.value, any_number);
    return;
  }
  to = end;
  reading.constants[child_pointer(object.pointer(), key)] =
      "where a closed ring ends, which is where it starts: from_angle is the number that turns it";
}
template <class S, std::size_t n>
void read_key(const JsonNode& object, SceneReading& reading, const char* key, Number& to, const Grade<S, n>& how,
              S& whole) {
  const auto given = object.find(key);
  const auto towards = given ? given->kind({how.sides.begin(), how.sides.end()}) : std::nullopt;
  if (!towards) return;
  whole.*how.towards = towards->first;
  to = reading.number(towards->second, positive);
}

inline nlohmann::ordered_json kind_of(const Number&, const InRange& how) { return schema_of(how.range); }
inline nlohmann::ordered_json kind_of(const Number& standard, const IfGiven& how) {
  auto kind = schema_of(how.range);
  kind["default"] = as_json(standard.value);
  return kind;
}
template <class S>
nlohmann::ordered_json kind_of(const Number& standard, const EndOfTurn<S>&) {
  return kind_of(standard, IfGiven{Range::any, 0});
}
inline nlohmann::ordered_json kind_of(int, const Count&) { return {{"$ref", "#/$defs/count"}}; }
inline nlohmann::ordered_json kind_of(const std::array<int, 2>&, const Counts&) { return {{"$ref", "#/$defs/cells"}}; }
inline nlohmann::ordered_json kind_of(const PlaneMesh&, const MeshInPlane&) { return {{"$ref", "#/$defs/plane_mesh"}}; }
inline nlohmann::ordered_json kind_of(const std::vector<int>&, const Counts&) {
  return {{"$ref", "#/$defs/cells_of_axes"}};
}
inline nlohmann::ordered_json kind_of(const std::array<std::array<Number, 2>, 4>&, const Corners2D&) {
  return {{"title", "four [x, y]"},
          {"type", "array"},
          {"items", {{"$ref", "#/$defs/pair"}}},
          {"minItems", 4},
          {"maxItems", 4}};
}
inline nlohmann::ordered_json kind_of(const std::array<Number, 2>&, const Place2D&) {
  return {{"$ref", "#/$defs/pair"}};
}
template <class How>
nlohmann::ordered_json kind_of(const std::vector<Number>&, const How&) {
  return {{"$ref", "#/$defs/vector"}};
}
inline nlohmann::ordered_json three_numbers() {
  return {{"title", "[x, y, z]"}, {"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 3}, {"maxItems", 3}};
}
inline nlohmann::ordered_json kind_of(const std::vector<Number>&, const Place3D&) { return three_numbers(); }
inline nlohmann::ordered_json kind_of(const std::vector<Number>&, const Direction3D&) { return three_numbers(); }
inline nlohmann::ordered_json kind_of(bool standard, const Flag&) {
  return {{"type", "boolean"}, {"default", standard}};
}
template <class E, std::size_t n>
nlohmann::ordered_json kind_of(E standard, const std::array<const char*, n>& words) {
  return {{"enum", words}, {"default", words[static_cast<std::size_t>(standard)]}};
}

template <class S, class Member, class How>
nlohmann::ordered_json schema_of_key(const Key<S, Member, How>& key, const S& standard) {
  nlohmann::ordered_json own{{"description", key.about}};
  own.update(kind_of(standard.*key.member, key.how));
  if constexpr (HasExample<How>) own["examples"] = nlohmann::ordered_json::array({as_json(key.how.example)});
  return own;
}
template <class S, std::size_t n>
nlohmann::ordered_json schema_of_key(const Key<S, Number, Grade<S, n>>& key, const S&) {
  using Schema = nlohmann::ordered_json;
  const Schema example = as_json(key.how.example);
  Schema sides = Schema::object();
  for (const char* side : key.how.sides)
    sides[side] = {{"description", "ratio"}, {"$ref", "#/$defs/positive"}, {"examples", Schema::array({example})}};
  Schema own{{"description", key.about}, {"examples", Schema::array({{{key.how.sides[0], example}}})}};
  own.update(one_of(sides));
  return own;
}

template <class S, class F>
void for_each_key(F&& f) {
  std::apply([&](const auto&... key) { (f(key), ...); }, S::keys());
}

}  // namespace detail

/// None where it is no object with these keys. Faults of its values are reported.
template <Described S>
std::optional<S> read_described(const JsonNode& node, SceneReading& reading) {
  std::size_t required = 0;
  detail::for_each_key<S>(
      [&]<class O, class M, class How>(const Key<O, M, How>&) { required += detail::must_be_there<How>; });
  Keys keys;
  keys.required.reserve(required);
  keys.optional.reserve(std::tuple_size_v<decltype(S::keys())> - required);
  detail::for_each_key<S>([&]<class O, class M, class How>(const Key<O, M, How>& key) {
    (detail::must_be_there<How> ? keys.required : keys.optional).push_back(key.key);
  });
  if (!node.is_object(keys)) return std::nullopt;
  S read;
  detail::for_each_key<S>([&](const auto& key) {
    auto& member = read.*key.member;
    if constexpr (requires { detail::read_key(node, reading, key.key, member, key.how, read); })
      detail::read_key(node, reading, key.key, member, key.how, read);
    else
      detail::read_key(node, reading, key.key, member, key.how);
  });
  return read;
}

/// The same as one of the alternatives of a variant.
template <class Variant, Described S>
std::optional<Variant> read_as(const JsonNode& node, SceneReading& reading) {
  return read_described<S>(node, reading);
}

template <Described S>
ObjectSchema schema_of_keys() {
  ObjectSchema of;
  const S standard{};
  detail::for_each_key<S>([&]<class O, class M, class How>(const Key<O, M, How>& key) {
    of.properties[key.key] = detail::schema_of_key(key, standard);
    if constexpr (detail::must_be_there<How>) {
      of.required.push_back(key.key);
      of.example[key.key] = detail::as_json(key.how.example);
    }
  });
  if constexpr (requires { S::example; }) of.example = nlohmann::ordered_json::parse(S::example);
  return of;
}

/// JSON Schema of the object that the key of the struct names.
template <Described S>
nlohmann::ordered_json schema_of_object() {
  const auto keys = schema_of_keys<S>();
  return {{"description", S::about},
          {"type", "object"},
          {"examples", nlohmann::ordered_json::array({keys.example})},
          {"required", keys.required},
          {"additionalProperties", false},
          {"properties", keys.properties}};
}

}  // namespace stickslip
