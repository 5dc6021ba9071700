#include "studies/input/friction_laws.hpp"

#include <algorithm>
#include <type_traits>

#include "studies/input/described.hpp"

namespace stickslip {
namespace {

using Schema = nlohmann::ordered_json;

/// Calls f(number) with the description of each number of a law.
template <class Law, class F>
void for_each_description(F&& f) {
  std::apply([&](const auto&... number) { (f(number), ...); }, Law::numbers());
}

/// {"coulomb": mu, "limit": force per area}
template <class Law>
std::string form_of() {
  std::string form;
  for_each_description<Law>(
      [&](const auto& number) { form += (form.empty() ? "{" : ", ") + in_quotes(number.key) + ": " + number.symbol; });
  return form + "}";
}

template <class Law>
FrictionLaw<Number> read_law(const JsonNode& node, SceneReading& reading) {
  Keys keys;
  Law law;
  for_each_description<Law>(
      [&](const auto& number) { (number.is_required ? keys.required : keys.optional).push_back(number.key); });
  node.is_object(keys);
  for_each_description<Law>([&](const auto& number) {
    const Rule rule = rule_of(number.range);
    if (number.is_required)
      law.*number.member = reading.required(node, number.key, rule);
    else if (const auto given = node.find(number.key))
      law.*number.member = reading.number(*given, rule);
  });
  return law;
}

template <class Law>
Schema schema_of() {
  Schema required = Schema::array(), properties = Schema::object();
  for_each_description<Law>([&](const auto& number) {
    const std::string unit = number.unit == FrictionUnit::stress ? " (force per area)" : "";
    if (number.is_required) required.push_back(number.key);
    Schema& own = properties[number.key] = {{"description", number.description + unit}};
    own.update(schema_of(number.range));
    own["examples"] = Schema::array({detail::as_json(number.example)});
  });
  return {{"type", "object"}, {"required", required}, {"additionalProperties", false}, {"properties", properties}};
}

/// A law without its type.
struct FrictionKind {
  const char* key;
  std::string (*form)();
  Schema (*schema)();
  FrictionLaw<Number> (*read)(const JsonNode&, SceneReading&);
};

const std::vector<FrictionKind>& friction_kinds() {
  static const auto kinds = list_of<FrictionLaws<Number>>([]<class Law>(std::type_identity<Law>) {
    return FrictionKind{std::get<0>(Law::numbers()).key, form_of<Law>, schema_of<Law>, read_law<Law>};
  });
  return kinds;
}

/// a number >= 0, FORM, ... or FORM
std::string all_forms() {
  std::string text = "a number >= 0";
  for (const auto& kind : friction_kinds()) text += (&kind == &friction_kinds().back() ? " or " : ", ") + kind.form();
  return text;
}

}  // namespace

FrictionLaw<Number> read_friction(const JsonNode& node, SceneReading& reading) {
  if (node.value().is_number()) return reading.number(node, not_negative);
  if (!node.value().is_object()) {
    node.must_be(all_forms());
    return {};
  }
  const auto& kinds = friction_kinds();  // (of several keys the last decides the law, of none the first)
  const auto named = std::find_if(kinds.rbegin(), kinds.rend(), [&](const auto& kind) { return node.find(kind.key); });
  return (named == kinds.rend() ? kinds.front() : *named).read(node, reading);
}

std::vector<Schema> friction_schemas() {
  std::vector<Schema> schemas;
  for (const auto& kind : friction_kinds()) schemas.push_back(kind.schema());
  return schemas;
}

}  // namespace stickslip
