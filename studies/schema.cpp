#include "studies/schema.hpp"

#include <nlohmann/json.hpp>

#include "studies/closed_forms.hpp"
#include "studies/method_options.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

constexpr const char* draft = "https://json-schema.org/draft/2020-12/schema";

/// What both files use.
constexpr const char* common = R"({
  "positive": {"type": "number", "exclusiveMinimum": 0},
  "count": {"type": "integer", "minimum": 1},
  "vector": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 3},
  "pair": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
  "cells": {"type": "array", "items": {"$ref": "#/$defs/count"}, "minItems": 2, "maxItems": 2},
  "table": {"description": "[[t, value], ...] with increasing t, linear in between", "type": "array", "minItems": 1,
            "items": {"$ref": "#/$defs/pair"}},
  "value": {"description": "a number, or its values in time", "anyOf": [
    {"type": "number"}, {"$ref": "#/$defs/table"},
    {"type": "object", "required": ["table"], "additionalProperties": false, "properties": {
      "table": {"$ref": "#/$defs/table"},
      "repeat": {"description": "how often the table is run through", "$ref": "#/$defs/count"}}}]},
  "side": {"description": "BODY.SIDE, or \"body.a & body.b\", \"body.a - body.b\"", "type": "string"}
})";

constexpr const char* bodies = R"({
  "type": "object", "minProperties": 1, "additionalProperties": {
    "type": "object", "required": ["mesh", "material"], "additionalProperties": false, "properties": {
      "mesh": {"$ref": "#/$defs/mesh"},
      "material": {"$ref": "#/$defs/material"},
      "element": {"enum": ["T3", "T6", "Q4", "Q4_mean_dilatation", "Q8", "bar", "point"]},
      "thickness": {"description": "of a plane continuum", "$ref": "#/$defs/positive"},
      "area": {"description": "of the cross-section of bars", "$ref": "#/$defs/positive"}}}
})";

constexpr const char* mesh = R"({
  "type": "object", "additionalProperties": false, "properties": {
    "box": {"type": "object", "required": ["min", "max", "cells"], "additionalProperties": false, "properties": {
      "min": {"$ref": "#/$defs/pair"}, "max": {"$ref": "#/$defs/pair"}, "cells": {"$ref": "#/$defs/cells"},
      "grade": {"description": "largest cell over smallest, smallest at the side that is named", "type": "object",
        "minProperties": 1, "maxProperties": 1, "additionalProperties": false, "properties": {
        "left": {"$ref": "#/$defs/positive"}, "right": {"$ref": "#/$defs/positive"},
        "bottom": {"$ref": "#/$defs/positive"}, "top": {"$ref": "#/$defs/positive"}}}}},
    "quad": {"type": "object", "required": ["corners", "cells"], "additionalProperties": false, "properties": {
      "corners": {"description": "counter-clockwise", "type": "array", "items": {"$ref": "#/$defs/pair"}, "minItems": 4,
        "maxItems": 4}, "cells": {"$ref": "#/$defs/cells"},
      "grade": {"description": "as of a box", "type": "object",
        "minProperties": 1, "maxProperties": 1, "additionalProperties": false, "properties": {
        "left": {"$ref": "#/$defs/positive"}, "right": {"$ref": "#/$defs/positive"},
        "bottom": {"$ref": "#/$defs/positive"}, "top": {"$ref": "#/$defs/positive"}}}}},
    "ring": {"type": "object", "required": ["center", "inner", "outer", "cells"], "additionalProperties": false,
      "properties": {
      "center": {"$ref": "#/$defs/pair"}, "inner": {"$ref": "#/$defs/positive"}, "outer": {"$ref": "#/$defs/positive"},
      "cells": {"description": "radial, around", "$ref": "#/$defs/cells"},
      "from_angle": {"type": "number", "default": 0}, "to_angle": {"type": "number", "default": 360},
      "grade": {"type": "object",
        "minProperties": 1, "maxProperties": 1, "additionalProperties": false, "properties": {
        "inner": {"$ref": "#/$defs/positive"}, "outer": {"$ref": "#/$defs/positive"}}}}},
    "disk": {"type": "object", "required": ["center", "radius", "cells"], "additionalProperties": false,
      "properties": {
      "center": {"$ref": "#/$defs/pair"}, "radius": {"$ref": "#/$defs/positive"}, "cells": {"$ref": "#/$defs/cells"},
      "grade": {"$ref": "#/$defs/positive"}}},
    "half_disk": {"type": "object", "required": ["center", "radius", "cells"], "additionalProperties": false,
      "properties": {
      "center": {"$ref": "#/$defs/pair"}, "radius": {"$ref": "#/$defs/positive"}, "cells": {"$ref": "#/$defs/cells"},
      "grade": {"$ref": "#/$defs/positive"}, "facing": {"enum": ["down", "up"]}}},
    "point": {"type": "object", "required": ["at"], "additionalProperties": false, "properties": {
      "at": {"$ref": "#/$defs/vector"}}},
    "line": {"type": "object", "required": ["from", "to", "cells"], "additionalProperties": false, "properties": {
      "from": {"$ref": "#/$defs/vector"}, "to": {"$ref": "#/$defs/vector"}, "cells": {"$ref": "#/$defs/count"}}},
    "arc": {"type": "object", "required": ["center", "radius", "from_angle", "to_angle", "cells"],
      "additionalProperties": false, "properties": {
      "center": {"$ref": "#/$defs/pair"}, "radius": {"$ref": "#/$defs/positive"},
      "from_angle": {"type": "number"}, "to_angle": {"type": "number"}, "cells": {"$ref": "#/$defs/count"}}},
    "gmsh": {"description": "an MSH file, beside the scene", "type": "string"},
    "body": {"description": "of gmsh: a physical name", "type": "string"}},
  "oneOf": [{"required": ["box"]}, {"required": ["quad"]}, {"required": ["ring"]}, {"required": ["disk"]},
            {"required": ["half_disk"]}, {"required": ["point"]}, {"required": ["line"]},
            {"required": ["arc"]}, {"required": ["gmsh", "body"]}]
})";

constexpr const char* material = R"({
  "type": "object", "minProperties": 1, "maxProperties": 1, "additionalProperties": false, "properties": {
    "linear_elastic": {"type": "object", "required": ["E", "nu"], "additionalProperties": false, "properties": {
      "E": {"$ref": "#/$defs/positive"},
      "nu": {"type": "number", "exclusiveMinimum": -1, "exclusiveMaximum": 0.5}}},
    "grounded_spring": {"type": "object", "required": ["stiffness"], "additionalProperties": false, "properties": {
      "stiffness": {"type": "array", "items": {"$ref": "#/$defs/vector"}, "minItems": 2, "maxItems": 3}}}}
})";

constexpr const char* motion = R"({
  "move": {"description": "displacement by axis", "type": "object", "minProperties": 1, "additionalProperties": false,
    "properties": {
    "x": {"$ref": "#/$defs/value"}, "y": {"$ref": "#/$defs/value"}, "z": {"$ref": "#/$defs/value"}}},
  "rotate": {"description": "angle in degrees, counter-clockwise", "type": "object", "required": ["center", "angle"],
    "additionalProperties": false, "properties": {
    "center": {"$ref": "#/$defs/vector"}, "axis": {"description": "in space", "$ref": "#/$defs/vector"},
    "angle": {"$ref": "#/$defs/value"}}}
})";

constexpr const char* scene_parts = R"({
  "$schema": {"type": "string"},
  "title": {"type": "string"},
  "space": {"enum": ["plane_strain", "plane_stress", "axisymmetric", "solid"], "default": "plane_strain"},
  "strain": {"enum": ["small"], "default": "small"},
  "bodies": {"$ref": "#/$defs/bodies"},
  "obstacles": {"type": "object", "additionalProperties": {
    "type": "object", "additionalProperties": false, "properties": {
      "plane": {"type": "object", "required": ["point", "normal"], "additionalProperties": false, "properties": {
        "point": {"$ref": "#/$defs/vector"},
        "normal": {"description": "out of the obstacle", "$ref": "#/$defs/vector"}}},
      "circle": {"type": "object", "required": ["center", "radius"], "additionalProperties": false, "properties": {
        "center": {"$ref": "#/$defs/pair"}, "radius": {"$ref": "#/$defs/positive"},
        "inside": {"description": "a cup", "type": "boolean"}}},
      "polyline": {"type": "object", "required": ["points"], "additionalProperties": false, "properties": {
        "points": {"description": "the solid is on the right of the way along them", "type": "array", "minItems": 2,
          "items": {"$ref": "#/$defs/pair"}}}},
      "move": {"$ref": "#/$defs/move"}, "rotate": {"$ref": "#/$defs/rotate"}},
    "oneOf": [{"required": ["plane"]}, {"required": ["circle"]}, {"required": ["polyline"]}]}},
  "contacts": {"type": "object", "additionalProperties": {
    "type": "object", "required": ["slave", "master"], "additionalProperties": false, "properties": {
      "slave": {"$ref": "#/$defs/side"},
      "master": {"description": "an obstacle, or a side", "type": "string"},
      "friction": {"description": "left out: frictionless", "type": "number", "minimum": 0},
      "offset": {"description": "added to the gap", "type": "number", "default": 0},
      "surface": {"enum": ["faceted"]}, "discretization": {"enum": ["node", "segment"]}}}},
  "supports": {"type": "array", "items": {
    "type": "object", "required": ["on"], "additionalProperties": false, "properties": {
      "on": {"$ref": "#/$defs/side"}, "move": {"$ref": "#/$defs/move"}, "rotate": {"$ref": "#/$defs/rotate"},
      "along": {"description": "the direction that is held; free across it", "$ref": "#/$defs/vector"},
      "value": {"$ref": "#/$defs/value"}},
    "if": {"required": ["along"]},
    "then": {"required": ["value"], "properties": {"move": false, "rotate": false}},
    "else": {"anyOf": [{"required": ["move"]}, {"required": ["rotate"]}], "properties": {"value": false}}}},
  "loads": {"type": "array", "items": {
    "type": "object", "required": ["on"], "additionalProperties": false, "properties": {
      "on": {"description": "a side; of body_force a body", "type": "string"},
      "traction": {"description": "per area", "$ref": "#/$defs/vector"},
      "pressure": {"description": "per area, into the body", "type": "number"},
      "force": {"description": "in all", "$ref": "#/$defs/vector"},
      "body_force": {"description": "per volume", "$ref": "#/$defs/vector"},
      "history": {"description": "scales it", "$ref": "#/$defs/value"}},
    "oneOf": [{"required": ["traction"]}, {"required": ["pressure"]}, {"required": ["force"]},
              {"required": ["body_force"]}]}},
  "time": {"type": "object", "additionalProperties": false, "properties": {
    "end": {"$ref": "#/$defs/positive"}, "steps": {"$ref": "#/$defs/count"},
    "legs": {"type": "array", "minItems": 1, "items": {"type": "array", "minItems": 2, "maxItems": 2,
      "prefixItems": [{"$ref": "#/$defs/positive"}, {"$ref": "#/$defs/count"}]}}},
    "oneOf": [{"required": ["end", "steps"], "properties": {"legs": false}},
              {"required": ["legs"], "properties": {"end": false, "steps": false}}]},
  "responses": {"type": "object", "additionalProperties": {"$ref": "#/$defs/response"}},
  "objectives": {"description": "scalars over time", "type": "object", "additionalProperties": {
    "type": "object", "required": ["of"], "additionalProperties": false, "properties": {
      "of": {"description": "a response", "type": "string"},
      "sum": {"description": "over the steps", "const": true},
      "at": {"description": "a time, which becomes the end of a step", "$ref": "#/$defs/positive"},
      "target": {"description": "the squared distance to it is taken", "$ref": "#/$defs/value"}},
    "oneOf": [{"required": ["sum"]}, {"required": ["at"]}]}},
  "parameters": {"description": "JSON pointers of numbers of the scene", "type": "object", "additionalProperties": {
    "anyOf": [{"type": "string"},
      {"type": "object", "minProperties": 1, "additionalProperties": {"type": "number"}, "properties": {
        "shape": {"description": "a side moves, the body follows", "type": "object",
          "required": ["side", "direction"], "additionalProperties": false, "properties": {
          "side": {"$ref": "#/$defs/side"}, "direction": {"$ref": "#/$defs/vector"},
          "fixed": {"description": "what stays; left out: all other sides", "$ref": "#/$defs/side"},
          "each": {"description": "one parameter a node", "enum": ["node"]}}}},
        "dependentSchemas": {"shape": {"maxProperties": 1}}}]}},
  "method": {"$ref": "#/$defs/method"},
  "linear_solver": {"type": "object", "additionalProperties": false, "properties": {
    "engine": {"enum": ["auto", "sparse", "condensed"]},
    "backend": {"enum": ["auto", "cholmod", "mumps", "umfpack", "eigen"]}}},
  "output": {"type": "object", "additionalProperties": false, "properties": {
    "fields": {"anyOf": [{"enum": ["last", "all"]}, {"$ref": "#/$defs/count"}]}}},
  "sensitivity": {"type": "object", "additionalProperties": false, "properties": {
    "mode": {"enum": ["direct", "adjoint"]}}}
})";

/// Keys of each kind of response.
constexpr const char* response_parts = R"({
  "reaction": {"required": ["on", "component"], "optional": ["about"]},
  "contact_force": {"required": ["contact", "component"], "optional": ["about"]},
  "displacement": {"required": ["component"], "optional": ["on", "take", "at"]},
  "contact_pressure": {"required": ["contact"], "optional": ["take", "at"]},
  "gap": {"required": ["contact"], "optional": ["take", "at"]},
  "slip": {"required": ["contact"], "optional": ["component", "take", "at"]},
  "dissipation": {"required": ["contact"], "optional": []},
  "strain_energy": {"required": [], "optional": []},
  "contact_half_width": {"required": ["contact"], "optional": []}
})";

constexpr const char* study_parts = R"({
  "$schema": {"type": "string"},
  "title": {"type": "string"},
  "scene": {"description": "file of the scene, beside the study", "type": "string"},
  "methods": {"type": "array", "minItems": 1, "items": {"$ref": "#/$defs/swept_method"}},
  "vary": {"description": "values by JSON pointer of the scene", "type": "object",
    "additionalProperties": {"type": "array", "minItems": 1}},
  "refine": {"type": "array", "minItems": 1, "items": {"type": "integer", "minimum": 0, "maximum": 10}},
  "reference": {"type": "array", "items": {
    "type": "object", "additionalProperties": false, "properties": {
      "method": {"$ref": "#/$defs/method"},
      "map": {"type": "object", "additionalProperties": {"type": "string"}},
      "inputs": {"description": "of the closed form: numbers, or names of parameters", "type": "object",
        "additionalProperties": {"type": ["number", "string"]}},
      "overkill": {"description": "the same cell on a mesh so many levels finer", "type": "object",
        "required": ["refine"], "additionalProperties": false, "properties": {
        "refine": {"type": "integer", "minimum": 1, "maximum": 10}}},
      "values": {"type": "object", "additionalProperties": {"type": "number"}}},
    "oneOf": [{"required": ["method"]}, {"required": ["analytic", "map"]}, {"required": ["values"]},
              {"required": ["overkill"]}]}},
  "errors": {"type": "array", "items": {"type": "string", "pattern": "^kkt$|^response:|^sensitivity:|^field:"}},
  "accuracy": {"description": "relative errors at which the report names the cheapest method", "type": "array",
    "minItems": 1, "maxItems": 6, "items": {"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1}},
  "timing": {"type": "object", "additionalProperties": false, "properties": {
    "repeat": {"$ref": "#/$defs/count", "maximum": 1000}}}
})";

/// {"KIND": {...}}, one of the kinds.
json response_schema() {
  json kinds = json::object();
  const json keys{{"on", {{"$ref", "#/$defs/side"}}},
                  {"contact", {{"type", "string"}}},
                  {"take", {{"enum", {"mean", "max", "min"}}}},
                  {"at", {{"$ref", "#/$defs/vector"}}},
                  {"about", {{"$ref", "#/$defs/pair"}}}};
  const json all_parts = json::parse(response_parts);
  for (const auto& [kind, parts] : all_parts.items()) {
    json properties = json::object();
    for (const char* list : {"required", "optional"})
      for (const std::string key : parts.at(list)) properties[key] = keys.value(key, json());
    if (properties.contains("component")) {
      json components = {"x", "y", "z"};
      if (kind == "contact_force") components.push_back("normal");
      if (properties.contains("about")) components.push_back("moment");
      properties["component"] = {{"enum", components}};
    }
    kinds[kind] = {{"type", "object"},
                   {"required", parts.at("required")},
                   {"additionalProperties", false},
                   {"properties", properties}};
    if (properties.contains("about")) {  // the two go together
      kinds[kind]["if"] = {{"properties", {{"component", {{"const", "moment"}}}}}};
      kinds[kind]["then"] = {{"required", {"about"}}};
      kinds[kind]["else"] = {{"properties", {{"about", false}}}};
    }
  }
  return {{"type", "object"},
          {"minProperties", 1},
          {"maxProperties", 1},
          {"additionalProperties", false},
          {"properties", kinds}};
}

json document(const char* title, const char* parts, const json& required, const json& definitions) {
  return {{"$schema", draft},
          {"title", title},
          {"type", "object"},
          {"required", required},
          {"additionalProperties", false},
          {"properties", json::parse(parts)},
          {"$defs", definitions}};
}

}  // namespace

json scene_schema() {
  json definitions = json::parse(common);
  definitions.update(json::parse(motion));
  definitions["bodies"] = json::parse(bodies);
  definitions["mesh"] = json::parse(mesh);
  definitions["material"] = json::parse(material);
  definitions["response"] = response_schema();
  definitions["method"] = method_schema(OptionLists::refused);
  return document("stickslip scene", scene_parts, {"bodies", "time"}, definitions);
}

json study_schema() {
  json definitions = json::parse(common);
  definitions["method"] = method_schema(OptionLists::refused);
  definitions["swept_method"] = method_schema(OptionLists::swept);
  json schema = document("stickslip study", study_parts, {"scene"}, definitions);
  schema["properties"]["reference"]["items"]["properties"]["analytic"] = {{"enum", analytic_names()}};
  return schema;
}

}  // namespace stickslip
