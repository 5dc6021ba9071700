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
#include "methods/options.hpp"
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

// How keys are written that hold no quantity of a scene; left out, what the struct begins with.

/// A whole number; left out of a std::optional, none.
struct WholeNumber {
  const char* title;
  int least, most, example;
};
/// A number that is never a parameter.
struct PlainNumber {
  Range range;
  double example;
};

/// The parts of a schema that say the keys of an object.
struct ObjectSchema {
  using Schema = nlohmann::ordered_json;
  Schema required = Schema::array(), example = Schema::object(), properties = Schema::object();
};
template <class S>
ObjectSchema schema_of_keys();

namespace detail {

using Schema = nlohmann::ordered_json;

inline Schema as_json(double x) {
  const auto whole = static_cast<long>(x);
  if (x == static_cast<double>(whole)) return whole;
  return x;
}
template <class X, std::size_t n>
Schema as_json(const std::array<X, n>& list) {
  auto json = Schema::array();
  for (const X& x : list) json.push_back(as_json(x));
  return json;
}

inline Schema as_json(const char* text) { return Schema::parse(text); }

template <class How>
concept HasExample = requires(const How& how) {
  how.example;
};

template <class How, class... Others>
inline constexpr bool is_one_of = (std::is_same_v<How, Others> || ...);
/// Whether a key that is written so must be there.
template <class How>
inline constexpr bool must_be_there =
    HasExample<How> && !is_one_of<How, IfGiven, AutoOrSetting, WholeNumber, PlainNumber>;
template <class S>
inline constexpr bool must_be_there<EndOfTurn<S>> = false;
template <std::size_t n>
inline constexpr bool must_be_there<Grade<n>> = false;

/// A key of an object that is read.
struct KeyAt {
  const JsonNode& object;
  SceneReading& reading;
  const char* key;
  std::optional<JsonNode> find() const { return object.find(key); }
};

inline void read_key(const KeyAt& at, Number& to, const InRange& how) {
  to = at.reading.required(at.object, at.key, rule_of(how.range));
}
inline void read_key(const KeyAt& at, Number& to, const IfGiven& how) {
  to = at.reading.optional(at.object, at.key, to.value, rule_of(how.range));
}
inline void read_key(const KeyAt& at, std::vector<Number>& to, const Place2D&) {
  to = at.reading.required_vector(at.object, at.key, at.reading.dimension());
}
inline void read_key(const KeyAt& at, std::vector<Number>& to, const Place3D&) {
  to = at.reading.required_vector(at.object, at.key, 3);
}
/// (Defined beside the list of meshes: mesh_kinds.cpp.)
void read_key(const KeyAt&, PlaneMesh& to, const MeshInPlane&);
inline void read_key(const KeyAt& at, std::vector<Number>& to, const Direction3D& how) {
  if (const auto given = at.find()) to = at.reading.direction(*given, how.what);
}
inline void read_key(const KeyAt& at, std::array<Number, 2>& to, const Place2D&) {
  const auto place = at.reading.required_vector(at.object, at.key, 2);
  to = {place[0], place[1]};
}
inline void read_key(const KeyAt& at, std::array<std::array<Number, 2>, 4>& to, const Corners2D&) {
  const auto given = at.find();
  const auto corners = given ? given->array(4, "four corners [x, y], counter-clockwise") : std::nullopt;
  for (int k = 0; k < 4; ++k) {
    const auto place = corners ? at.reading.vector((*corners)[k], 2)
                               : std::vector<Number>(2, std::numeric_limits<double>::quiet_NaN());
    to[k] = {place[0], place[1]};
  }
}
inline void read_key(const KeyAt& at, int& to, const Count&) {
  if (const auto given = at.find()) to = at.reading.count(*given, 1).value_or(to);
}
/// As many counts as there are in `to`.
template <class Cells>
void read_cells(const KeyAt& at, Cells& to) {
  for (int& count : to) count = 1;
  const auto given = at.find();
  const auto all = given ? given->array(to.size(), "an array of " + std::to_string(to.size()) + " whole numbers >= 1")
                         : std::nullopt;
  for (std::size_t i = 0; all && i < to.size(); ++i) to[i] = at.reading.count((*all)[i], 1).value_or(1);
  constexpr double most = std::numeric_limits<int>::max() / 4.0;  // nodes of a quadrilateral are numbered by an int
  if (product(to) > most) given->must_be("fewer cells than 5e8 in all");
}
inline void read_key(const KeyAt& at, std::array<int, 2>& to, const Counts&) { read_cells(at, to); }
inline void read_key(const KeyAt& at, std::vector<int>& to, const Counts&) {
  to.resize(at.reading.dimension());
  read_cells(at, to);
}
inline void read_key(const KeyAt& at, std::vector<Number>& to, const Direction2D& how) {
  if (const auto given = at.find()) to = at.reading.direction(*given, how.what);
}
inline void read_key(const KeyAt& at, bool& to, const Flag&) {
  if (const auto given = at.find()) to = given->boolean().value_or(to);
}
template <class E, std::size_t n>
void read_key(const KeyAt& at, E& to, const std::array<const char*, n>& words) {
  if (const auto given = at.find()) given->word(to, words);
}

template <class N>
void read_key(const KeyAt& at, N& to, const WholeNumber& how) {
  const auto given = at.find();
  if (const auto number = given ? given->count(how.least, how.most) : std::nullopt) to = *number;
}
inline void read_key(const KeyAt& at, double& to, const PlainNumber& how) {
  if (const auto given = at.find()) to = given->number(rule_of(how.range)).value_or(to);
}

// Options of methods (methods/options.hpp).

inline void read_key(const KeyAt& at, Regularisation& to, const RhoOption&) {
  const auto given = at.find();
  if (!given || given->value() == "auto") return;
  if (given->value().is_object()) {
    to.kind = Regularisation::Kind::absolute;
    given->is_object({{"absolute"}});
    to.value = at.reading.required(*given, "absolute", positive);
  } else if (given->value().is_number()) {
    to.kind = Regularisation::Kind::relative;
    to.value = at.reading.number(*given, positive);
  } else {
    given->must_be(R"("auto", a number > 0 or {"absolute": a number > 0})");
  }
}
inline void read_key(const KeyAt& at, double& to, const Setting& how) {
  if (const auto given = at.find()) to = at.reading.setting(*given, rule_of(how.range)).value_or(to);
}
inline void read_key(const KeyAt& at, std::optional<double>& to, const AutoOrSetting& how) {
  const auto given = at.find();
  if (!given || given->value() == "auto") return;
  const Rule rule = rule_of(how.range);
  if (given->value().is_number())
    to = at.reading.setting(*given, rule);
  else
    given->must_be("\"auto\" or " + std::string(rule.text));
}
inline void read_key(const KeyAt& at, int& to, const AtLeastOne&) { read_key(at, to, Count{}); }
template <class S>
Keys allowed_keys();
template <class S>
void read_keys(const JsonNode& object, SceneReading& reading, S& to);
template <class S>
void read_key(const KeyAt& at, S& to, const Nested&) {
  const auto given = at.find();
  if (given && given->is_object(allowed_keys<S>())) read_keys(*given, at.reading, to);
}

// Keys that are about another member of their struct too.

template <class S>
void read_key(const KeyAt& at, Number& to, const EndOfTurn<S>& how, S& whole) {
  const auto given = at.find();
  const double end = given ? given->number(any_number).value_or(std::numeric_limits<double>::quiet_NaN()) : to.value;
  if (!is_full_turn((whole.*how.start).value, end)) {
    to = at.reading.optional(at.object, at.key, to.value, any_number);
    return;
  }
  to = end;
  at.reading.constants[child_pointer(at.object.pointer(), at.key)] =
      "where a closed ring ends, which is where it starts: from_angle is the number that turns it";
}
template <std::size_t n>
void read_key(const KeyAt& at, std::vector<Grading>& to, const Grade<n>& how) {
  const auto given = at.find();
  if (!given || !given->is_object({{}, {how.sides.begin(), how.sides.end()}})) return;
  for (const char* side : how.sides)
    if (const auto ratio = given->find(side)) to.push_back({side, at.reading.number(*ratio, positive)});
  if (given->value().empty())
    given->error("is empty; must name a side: " + listed({how.sides.begin(), how.sides.end()}));
}

inline Schema kind_of(const Number&, const InRange& how) { return schema_of(how.range); }
inline Schema kind_of(const Number& standard, const IfGiven& how) {
  auto kind = schema_of(how.range);
  kind["default"] = standard.value;
  return kind;
}
template <class S>
Schema kind_of(const Number& standard, const EndOfTurn<S>&) {
  return kind_of(standard, IfGiven{Range::any, 0});
}
inline Schema kind_of(int, const Count&) { return {{"$ref", "#/$defs/count"}}; }
inline Schema kind_of(const std::array<int, 2>&, const Counts&) { return {{"$ref", "#/$defs/cells"}}; }
inline Schema kind_of(const PlaneMesh&, const MeshInPlane&) { return {{"$ref", "#/$defs/plane_mesh"}}; }
inline Schema kind_of(const std::vector<int>&, const Counts&) { return {{"$ref", "#/$defs/cells_of_axes"}}; }
inline Schema kind_of(const std::array<std::array<Number, 2>, 4>&, const Corners2D&) {
  return {{"title", "four [x, y]"},
          {"type", "array"},
          {"items", {{"$ref", "#/$defs/pair"}}},
          {"minItems", 4},
          {"maxItems", 4}};
}
inline Schema kind_of(const std::array<Number, 2>&, const Place2D&) { return {{"$ref", "#/$defs/pair"}}; }
template <class How>
Schema kind_of(const std::vector<Number>&, const How&) {
  return {{"$ref", "#/$defs/vector"}};
}
inline Schema three_numbers() {
  return {{"title", "[x, y, z]"}, {"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 3}, {"maxItems", 3}};
}
inline Schema kind_of(const std::vector<Number>&, const Place3D&) { return three_numbers(); }
inline Schema kind_of(const std::vector<Number>&, const Direction3D&) { return three_numbers(); }
inline Schema kind_of(bool standard, const Flag&) { return {{"type", "boolean"}, {"default", standard}}; }
template <class E, std::size_t n>
Schema kind_of(E standard, const std::array<const char*, n>& words) {
  return {{"enum", words}, {"default", words[static_cast<std::size_t>(standard)]}};
}

template <class N>
Schema kind_of(const N& standard, const WholeNumber& how) {
  Schema kind{{"title", how.title}, {"type", "integer"}, {"minimum", how.least}, {"maximum", how.most}};
  if constexpr (std::is_same_v<N, int>) kind["default"] = standard;
  return kind;
}
inline Schema kind_of(double standard, const PlainNumber& how) {
  return kind_of(Number(standard), IfGiven{how.range, how.example});
}
inline Schema kind_of(const Regularisation&, const RhoOption&) {
  return as_json(R"json({"title": "\"auto\", number > 0 or object", "default": "auto",
    "examples": ["auto", 100, {"absolute": 2400}], "anyOf": [{"const": "auto"}, {"$ref": "#/$defs/positive"},
      {"type": "object", "required": ["absolute"], "additionalProperties": false, "properties": {
        "absolute": {"description": "rho itself (force per length cubed)", "$ref": "#/$defs/positive",
          "examples": [2400]}}}]})json");
}
inline Schema kind_of(double standard, const Setting& how) {
  Schema kind{{"title", rule_of(how.range).text}, {"default", standard}};
  kind.update(schema_of(how.range));
  return kind;
}
inline Schema kind_of(const std::optional<double>&, const AutoOrSetting& how) {
  return {{"title", R"("auto" or )" + std::string(rule_of(how.range).text)},
          {"anyOf", {{{"const", "auto"}}, schema_of(how.range)}},
          {"default", "auto"},
          {"examples", {"auto", how.example}}};
}
inline Schema kind_of(int standard, const AtLeastOne&) {
  return {{"title", "whole number >= 1"}, {"type", "integer"}, {"minimum", 1}, {"default", standard}};
}
template <class S>
Schema kind_of(const S&, const Nested&) {
  return {{"type", "object"},
          {"examples", {{{"max_iterations", 50}}}},
          {"additionalProperties", false},
          {"properties", schema_of_keys<S>().properties}};
}

template <class S, class Member, class How>
Schema schema_of_key(const Key<S, Member, How>& key, const S& standard) {
  Schema own{{"description", key.about}};
  if constexpr (HasExample<How>) own["examples"] = Schema::array({as_json(key.how.example)});
  own.update(kind_of(standard.*key.member, key.how));
  return own;
}
template <class S, std::size_t n>
Schema schema_of_key(const Key<S, std::vector<Grading>, Grade<n>>& key, const S&) {
  const Schema example = as_json(key.how.example);
  Schema sides = Schema::object();
  for (const char* side : key.how.sides)
    sides[side] = {{"description", "ratio"}, {"$ref", "#/$defs/positive"}, {"examples", Schema::array({example})}};
  return {{"description", key.about}, {"examples", Schema::array({{{key.how.sides[0], example}}})},
          {"type", "object"},         {"minProperties", 1},
          {"properties", sides},      {"additionalProperties", false}};
}

template <class S, class F>
void for_each_key(F&& f) {
  std::apply([&](const auto&... key) { (f(key), ...); }, S::keys());
}

/// The keys that the object of a struct must have and may have.
template <class S>
Keys allowed_keys() {
  Keys keys;
  for_each_key<S>([&]<class O, class M, class How>(const Key<O, M, How>& key) {
    (must_be_there<How> ? keys.required : keys.optional).push_back(key.key);
  });
  return keys;
}

/// Reads what there is of the keys; faults of the values are reported.
template <class S>
void read_keys(const JsonNode& object, SceneReading& reading, S& to) {
  for_each_key<S>([&](const auto& key) {
    const KeyAt at{object, reading, key.key};
    auto& member = to.*key.member;
    if constexpr (requires { read_key(at, member, key.how, to); })
      read_key(at, member, key.how, to);
    else
      read_key(at, member, key.how);
  });
}

}  // namespace detail

/// None where it is no object with these keys. Faults of its values are reported.
template <class S>
std::optional<S> read_described(const JsonNode& node, SceneReading& reading) {
  if (!node.is_object(detail::allowed_keys<S>())) return std::nullopt;
  S read;
  detail::read_keys(node, reading, read);
  return read;
}
/// The same of an object that stands in no scene.
template <class S>
std::optional<S> read_described(const JsonNode& node, Diagnostics& diagnostics) {
  MeshFiles none;
  SceneReading reading(diagnostics, {}, none);
  return read_described<S>(node, reading);
}

/// The same as one of the alternatives of a variant.
template <class Variant, Described S>
std::optional<Variant> read_as(const JsonNode& node, SceneReading& reading) {
  return read_described<S>(node, reading);
}

template <class S>
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
  nlohmann::ordered_json schema{{"description", S::about},
                                {"type", "object"},
                                {"examples", nlohmann::ordered_json::array({keys.example})},
                                {"additionalProperties", false},
                                {"properties", keys.properties}};
  if (!keys.required.empty()) schema["required"] = keys.required;
  return schema;
}

}  // namespace stickslip
