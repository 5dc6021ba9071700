#include "studies/app/schema.hpp"

#include <nlohmann/json.hpp>

#include "studies/input/file_objects.hpp"
#include "studies/input/friction_laws.hpp"
#include "studies/input/materials.hpp"
#include "studies/input/mesh_kinds.hpp"
#include "studies/input/method_options.hpp"
#include "studies/input/obstacle_kinds.hpp"
#include "studies/input/response_kinds.hpp"
#include "studies/input/small_objects.hpp"
#include "studies/sweep/closed_forms.hpp"
#include "studies/sweep/study_reading.hpp"

namespace stickslip {
namespace {

using Schema = nlohmann::ordered_json;

constexpr const char* draft = "https://json-schema.org/draft/2020-12/schema";

Schema document(const char* title, const Schema& object, const Schema& definitions) {
  Schema whole{{"$schema", draft}, {"title", title}, {"type", "object"}, {"additionalProperties", false}};
  whole.update(object);
  whole["$defs"] = definitions;
  return whole;
}

}  // namespace

Schema scene_schema() {
  Schema definitions = whole_object(scene_objects(), "common definitions");
  definitions.update(whole_object(scene_objects(), "definitions of scenes"));
  definitions["mesh"] = mesh_schema();
  definitions["plane_mesh"] = plane_mesh_schema();
  Schema materials;
  for (const auto& kind : material_kinds()) materials[kind.key] = kind.schema();
  definitions["material"] = one_of(materials);
  definitions["response"] = response_schema();
  definitions["method"] = method_schema(OptionLists::refused);
  Schema schema = document("stickslip scene", whole_object(scene_objects(), "scene"), definitions);
  Schema& obstacle = schema["properties"]["obstacles"]["additionalProperties"];
  obstacle = with_kinds(obstacle, obstacle_kinds());
  Schema& contact = schema["properties"]["contacts"]["additionalProperties"]["properties"];
  schema["properties"][LinearSolverObject::key] = schema_of_object<LinearSolverObject>();
  schema["properties"][SensitivityObject::key] = schema_of_object<SensitivityObject>();
  for (Schema& law : friction_schemas()) contact["friction"]["anyOf"].push_back(std::move(law));
  return schema;
}

Schema study_schema() {
  Schema definitions = whole_object(scene_objects(), "common definitions");
  definitions["method"] = method_schema(OptionLists::refused);
  definitions["swept_method"] = method_schema(OptionLists::swept);
  Schema schema = document("stickslip study", whole_object(study_objects(), "study"), definitions);
  schema["properties"]["reference"]["items"]["properties"]["analytic"]["enum"] = analytic_names();
  schema["properties"][TimingObject::key] = schema_of_object<TimingObject>();
  schema["properties"]["error_budget"]["anyOf"][1]["properties"] = schema_of_keys<ErrorBudgetObject>().properties;
  return schema;
}

}  // namespace stickslip
