#include "studies/app/schema.hpp"

#include <nlohmann/json.hpp>

#include "studies/app/schema_texts.hpp"
#include "studies/input/friction_laws.hpp"
#include "studies/input/materials.hpp"
#include "studies/input/mesh_kinds.hpp"
#include "studies/input/method_options.hpp"
#include "studies/input/obstacle_kinds.hpp"
#include "studies/input/response_kinds.hpp"
#include "studies/input/small_objects.hpp"
#include "studies/sweep/closed_forms.hpp"

namespace stickslip {
namespace {

using Schema = nlohmann::ordered_json;

constexpr const char* draft = "https://json-schema.org/draft/2020-12/schema";

/// The kinds of obstacles, one of which goes with what all of them may have.
void add_obstacle_kinds(Schema& obstacle) {
  Schema properties = Schema::object(), one = Schema::array();
  for (const auto& kind : obstacle_kinds()) {
    properties[kind.key] = kind.schema();
    one.push_back({{"required", {kind.key}}});
  }
  properties.update(obstacle["properties"]);
  obstacle["properties"] = properties;
  obstacle["oneOf"] = one;
}

Schema document(const char* title, const char* properties, const Schema& required, const Schema& definitions) {
  return {{"$schema", draft},
          {"title", title},
          {"type", "object"},
          {"required", required},
          {"additionalProperties", false},
          {"properties", Schema::parse(properties)},
          {"$defs", definitions}};
}

}  // namespace

Schema scene_schema() {
  Schema definitions = Schema::parse(schema_texts::common);
  definitions.update(Schema::parse(schema_texts::motion));
  definitions["mesh"] = mesh_schema();
  definitions["plane_mesh"] = plane_mesh_schema();
  Schema materials;
  for (const auto& kind : material_kinds()) materials[kind.key] = kind.schema();
  definitions["material"] = one_of(materials);
  definitions["response"] = response_schema();
  definitions["method"] = method_schema(OptionLists::refused);
  Schema schema = document("stickslip scene", schema_texts::scene, {"bodies", "time"}, definitions);
  add_obstacle_kinds(schema["properties"]["obstacles"]["additionalProperties"]);
  Schema& contact = schema["properties"]["contacts"]["additionalProperties"]["properties"];
  schema["properties"][LinearSolverObject::key] = schema_of_object<LinearSolverObject>();
  schema["properties"][SensitivityObject::key] = schema_of_object<SensitivityObject>();
  for (Schema& law : friction_schemas()) contact["friction"]["anyOf"].push_back(std::move(law));
  return schema;
}

Schema study_schema() {
  Schema definitions = Schema::parse(schema_texts::common);
  definitions["method"] = method_schema(OptionLists::refused);
  definitions["swept_method"] = method_schema(OptionLists::swept);
  Schema schema = document("stickslip study", schema_texts::study, Schema::array(), definitions);
  schema["oneOf"] = {{{"required", {"scene"}}}, {{"required", {"scenes"}}}};
  schema["properties"]["reference"]["items"]["properties"]["analytic"]["enum"] = analytic_names();
  schema["properties"][TimingObject::key] = schema_of_object<TimingObject>();
  schema["properties"]["error_budget"]["anyOf"][1]["properties"] = schema_of_keys<ErrorBudgetObject>().properties;
  return schema;
}

}  // namespace stickslip
