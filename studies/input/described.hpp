/// Reader and schema of a struct of the scene, made from what it says of its keys (core/algebra/described.hpp).
#pragma once

#include <nlohmann/json.hpp>
#include <tuple>

#include "core/algebra/described.hpp"
#include "studies/input/ranges.hpp"
#include "studies/input/scene_reading.hpp"

namespace stickslip {

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
inline nlohmann::ordered_json as_json(const std::array<double, 2>& x) { return {as_json(x[0]), as_json(x[1])}; }

template <class How>
concept HasExample = requires(const How& how) {
  how.example;
};

inline void read_key(const JsonNode& object, SceneReading& reading, const char* key, Number& to, const InRange& how) {
  to = reading.required(object, key, rule_of(how.range));
}
inline void read_key(const JsonNode& object, SceneReading& reading, const char* key, std::vector<Number>& to,
                     const Place2D&) {
  to = reading.required_vector(object, key, reading.dimension());
}
inline void read_key(const JsonNode& object, SceneReading& reading, const char* key, std::array<Number, 2>& to,
                     const Place2D&) {
  const auto place = reading.required_vector(object, key, 2);
  to = {place[0], place[1]};
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

inline nlohmann::ordered_json kind_of(const Number&, const InRange& how) { return schema_of(how.range); }
inline nlohmann::ordered_json kind_of(const std::array<Number, 2>&, const Place2D&) {
  return {{"$ref", "#/$defs/pair"}};
}
template <class How>
nlohmann::ordered_json kind_of(const std::vector<Number>&, const How&) {
  return {{"$ref", "#/$defs/vector"}};
}
inline nlohmann::ordered_json kind_of(bool standard, const Flag&) {
  return {{"type", "boolean"}, {"default", standard}};
}
template <class E, std::size_t n>
nlohmann::ordered_json kind_of(E standard, const std::array<const char*, n>& words) {
  return {{"enum", words}, {"default", words[static_cast<std::size_t>(standard)]}};
}

template <class S, class F>
void for_each_key(F&& f) {
  std::apply([&](const auto&... key) { (f(key), ...); }, S::keys());
}

}  // namespace detail

/// None where it is no object with these keys. Faults of its values are reported.
template <Described S>
std::optional<S> read_described(const JsonNode& node, SceneReading& reading) {
  Keys keys;
  keys.required.reserve(std::tuple_size_v<decltype(S::keys())>);
  detail::for_each_key<S>([&]<class O, class M, class How>(const Key<O, M, How>& key) {
    (detail::HasExample<How> ? keys.required : keys.optional).push_back(key.key);
  });
  if (!node.is_object(keys)) return std::nullopt;
  S read;
  detail::for_each_key<S>(
      [&](const auto& key) { detail::read_key(node, reading, key.key, read.*key.member, key.how); });
  return read;
}

template <Described S>
ObjectSchema schema_of_keys() {
  ObjectSchema of;
  const S standard{};
  detail::for_each_key<S>([&]<class O, class M, class How>(const Key<O, M, How>& key) {
    auto& own = of.properties[key.key] = {{"description", key.about}};
    own.update(detail::kind_of(standard.*key.member, key.how));
    if constexpr (detail::HasExample<How>) {
      of.required.push_back(key.key);
      of.example[key.key] = detail::as_json(key.how.example);
      own["examples"] = nlohmann::ordered_json::array({of.example[key.key]});
    }
  });
  return of;
}

}  // namespace stickslip
