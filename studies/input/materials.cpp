#include "studies/input/materials.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <type_traits>

#include "core/solids/materials.hpp"
#include "studies/input/described.hpp"
#include "studies/input/file_objects.hpp"

namespace stickslip {
namespace {

using Schema = nlohmann::ordered_json;

Schema j2_schema() {
  return Schema::parse(R"json({
  "description": "elastoplastic, of all but points: J2 (von Mises) with isotropic hardening", "type": "object",
  "examples": [{"E": 1000, "nu": 0.3, "yield": 10, "hardening": 100}],
  "required": ["E", "nu", "hardening"], "if": {"properties": {"hardening": {"type": "number"}}},
  "then": {"required": ["yield"]}, "additionalProperties": false, "properties": {
    "E": {"description": "Young's modulus (force per area)", "$ref": "#/$defs/positive", "examples": [1000]},
    "nu": {"description": "Poisson's ratio", "title": "number > -1 and < 0.5", "type": "number",
      "exclusiveMinimum": -1, "exclusiveMaximum": 0.5, "examples": [0.3]},
    "yield": {"description": "stress at which it begins to flow (force per area); may be left out where a table of hardening begins at 0",
      "$ref": "#/$defs/positive", "examples": [10]},
    "hardening": {"description": "rise of that stress with the equivalent plastic strain, 0: perfect plasticity (force per area); or a table [[plastic strain, stress], ...], straight between its rows and constant behind the last",
      "title": "number >= 0, or [[plastic strain, stress], ...]", "examples": [100, [[0, 10], [0.02, 14], [0.1, 18]]],
      "anyOf": [{"type": "number", "minimum": 0}, {"type": "array", "minItems": 1, "items": {"type": "array",
        "minItems": 2, "maxItems": 2, "items": {"type": "number", "minimum": 0}}}]}}})json");
}

Schema spring_schema() {
  return Schema::parse(R"json({
  "description": "of a point: the spring to its anchor", "type": "object",
  "examples": [{"stiffness": [[100, 0], [0, 100]]}], "required": ["stiffness"],
  "additionalProperties": false, "properties": {
    "stiffness": {"description": "symmetric and positive definite (force per length)",
      "title": "2 x 2 matrix (3 x 3 in space)", "type": "array", "items": {"$ref": "#/$defs/vector"},
      "minItems": 2, "maxItems": 3, "examples": [[[100, 0], [0, 100]]]}}})json");
}

/// [[plastic strain, stress], ...]; a first row at strain 0 is the yield stress.
void read_hardening_table(const JsonNode& node, J2Plastic& material, bool yields, SceneReading& reading) {
  const auto rows = node.elements();
  if (rows.empty()) return node.must_be("a number >= 0, or a table [[plastic strain, stress], ...]");
  HardeningRow last{0.0, material.yield};
  for (const JsonNode& row : rows) {
    const auto pair = row.array(2, "a pair [plastic strain, stress]");
    if (!pair) return;
    const auto &strain = (*pair)[0], &stress = (*pair)[1];
    const bool at_start = &row == &rows.front() && strain.value().is_number() && strain.value() == 0;
    if (at_start) {
      reading.constants[strain.pointer()] = "the start of the table, 0";
      if (!yields) {
        material.yield = last.stress = reading.number(stress, positive);
      } else {
        reading.constants[stress.pointer()] = R"(the yield stress once more; "yield" may be a parameter)";
        const auto given = stress.number(positive);
        if (given && std::isfinite(material.yield.value) && *given != material.yield.value)
          stress.must_be(shown(material.yield.value) + R"(, as "yield" is)");
      }
      continue;
    }
    const HardeningRow next{reading.number(strain, positive), reading.number(stress, positive)};
    if (next.strain.value <= last.strain.value)
      strain.must_be("more than " + shown(last.strain.value) + ", the plastic strain of the row before");
    if (next.stress.value < last.stress.value)
      stress.must_be("at least " + shown(last.stress.value) + ", the stress before it: metal does not soften here");
    material.table.push_back(last = next);
  }
  if (!yields && material.table.size() == rows.size())
    node.error(R"(lacks the stress at which flow begins: give a first row [0, stress], or "yield")");
}

std::optional<Material> read_j2(const JsonNode& node, SceneReading& reading) {
  static const Keys keys = keys_of(j2_schema());
  if (!node.is_object(keys)) return std::nullopt;
  J2Plastic material{reading.required(node, "E", positive), reading.required(node, "nu", poisson_ratio), 0.0, 0.0};
  const auto yield = node.find("yield"), hardening = node.find("hardening");
  if (yield) material.yield = reading.number(*yield, positive);
  if (hardening && hardening->value().is_array())
    read_hardening_table(*hardening, material, yield.has_value(), reading);
  else if (hardening)
    material.hardening = reading.number(*hardening, not_negative);
  if (!yield && hardening && !hardening->value().is_array())
    node.error(R"(the key "yield" is missing: the stress at which it begins to flow)");
  return material;
}

std::optional<Material> read_spring(const JsonNode& node, SceneReading& reading) {
  static const Keys keys = keys_of(spring_schema());
  if (!node.is_object(keys)) return std::nullopt;
  const auto matrix = node.find("stiffness");
  if (!matrix) return std::nullopt;
  const int d = reading.dimension();
  const std::string size = std::to_string(d) + " x " + std::to_string(d);
  const auto rows = matrix->array(d, "a " + size + " matrix, [[...], ...]");
  if (!rows) return std::nullopt;
  GroundedSpring spring;
  Eigen::MatrixXd values(d, d);
  for (int i = 0; i < d; ++i) {
    spring.stiffness.push_back(reading.vector((*rows)[i], d));
    for (int j = 0; j < d; ++j) values(i, j) = spring.stiffness[i][j].value;
  }
  if (!values.allFinite()) return std::nullopt;
  for (int i = 0; i < d; ++i)
    for (int j = 0; j < i; ++j) {
      const int below = spring.stiffness[i][j].slot, above = spring.stiffness[j][i].slot;
      reading.equal[below] = above;
      reading.equal[above] = below;
      if (values(i, j) != values(j, i)) {
        (*rows)[i].elements()[j].must_be(shown(values(j, i)) + ", so that the stiffness is symmetric");
        return std::nullopt;
      }
    }
  if (Eigen::LLT<Eigen::MatrixXd>(values).info() != Eigen::Success) {
    matrix->must_be("positive definite, or nothing would hold the point");
    return std::nullopt;
  }
  return spring;
}

// Materials that say no keys(), for what they hold are not numbers and words alone.

MaterialKind entry_of(std::type_identity<J2Plastic>) {
  return {"j2_plastic", j2_schema, "fills all but points", read_j2};
}
MaterialKind entry_of(std::type_identity<GroundedSpring>) {
  return {"grounded_spring", spring_schema, "holds a point", read_spring};
}

template <class M>
bool goes_with(Filling filling, bool finite_strain) {
  if (filling == Filling::point) return HoldsPoint<M>;
  if (filling == Filling::bars) return FillsBars<M>;
  if constexpr (FillsContinuum<M>) return LawOf<M>::is_made_for(Kinematics::plane, strains_of(finite_strain));
  return false;
}

template <class M>
MaterialKind material_kind(std::type_identity<M>) {
  static_assert(
      Described<M> || requires { entry_of(std::type_identity<M>()); },
      "a material of core/solids/materials.hpp lacks its keys(), or entry_of() in studies/input/materials.cpp");
  MaterialKind kind;
  if constexpr (Described<M>)
    kind = {M::key, schema_of_object<M>, M::place, read_as<Material, M>};
  else
    kind = entry_of(std::type_identity<M>());
  kind.goes_with = goes_with<M>;
  return kind;
}

}  // namespace

const std::vector<MaterialKind>& material_kinds() {
  static const auto kinds = list_of<Material>([](auto material) { return material_kind(material); });
  return kinds;
}

}  // namespace stickslip
