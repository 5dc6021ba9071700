#include "studies/sweep/study_reading.hpp"

namespace stickslip {
namespace {

constexpr const char* study_text = R"json({

"reference": {"title": "one of the following", "properties": {
    "method": {"description": "that method on the same mesh: the enforcement error", "$ref": "#/$defs/method",
      "examples": [{"monolithic_al": {}}]},
    "overkill": {
      "description": "monolithic_al on a finer mesh, with the same steps: like the next two the discretisation error",
      "examples": [{"refine": 2}], "$object": "overkill"},
    "analytic": {"description": "a closed form, derivatives included; with map", "examples": ["belt"]},
    "map": {"description": "of analytic: an input that a response measures, an output that is held against it",
      "title": "{RESPONSE: QUANTITY, ...}", "type": "object", "additionalProperties": {"type": "string"},
      "examples": [{"tight": "tight"}]},
    "inputs": {"description": "of analytic: what no response gives; numbers, or names of parameters",
      "title": "{QUANTITY: number or PARAMETER, ...}", "type": "object",
      "additionalProperties": {"type": ["number", "string"]}, "examples": [{"friction": "mu"}]},
    "values": {"description": "given numbers, of responses and of RESPONSE/PARAMETER", "type": "object",
      "title": "{RESULT: number, ...}", "additionalProperties": {"type": "number"},
      "examples": [{"u": 0.07, "u/mu": -0.1}]}},
  "oneOf": [{"required": ["analytic", "map"]}, {"required": ["values"]}, {"required": ["method"]},
    {"required": ["overkill"]}]},

"overkill": {"anyOf": [{"required": ["refine"]}, {"required": ["vary"]}], "properties": {
  "refine": {"description": "levels finer than the cell or, with vary, than the meshes named there; up to 10",
    "title": "whole number >= 1", "type": "integer", "minimum": 1, "maximum": 10, "examples": [2]},
  "vary": {"description": "meshes of one reference for all cells: values below /bodies/NAME/mesh",
    "title": "{pointer: value, ...}", "type": "object", "minProperties": 1,
    "examples": [{"/bodies/foot/mesh/gmsh": "fine.msh"}]}}},

"solution": {"required": ["name", "file"], "properties": {
  "name": {"description": "of the curve", "type": "string", "minLength": 1, "examples": ["GetFEM"]},
  "file": {"description": "beside the study; docs/verify.md has its keys", "type": "string",
    "examples": ["getfem.json"]},
  "scene": {"description": "which of the study's scenes it is of; needed if there are several", "type": "string",
    "examples": ["slider.json"]},
  "vary": {"description": "which values of the study's `vary` it is of; needed where there are several",
    "title": "{pointer: value, ...}", "type": "object", "examples": [{"/contacts/touch/friction": 0.1}]},
  "refine": {"description": "which mesh level it is of; needed where there are several",
    "title": "whole number >= 0", "type": "integer", "minimum": 0, "maximum": 10, "examples": [1]}}},

"study": {"oneOf": [{"required": ["scene"]}, {"required": ["scenes"]}], "properties": {
  "scene": {"description": "file of the scene, beside the study", "type": "string", "examples": ["slider.json"]},
  "scenes": {"description": "in place of scene: files of several, each of which is run with all that follows",
    "title": "list of texts", "type": "array", "minItems": 2, "uniqueItems": true, "items": {"type": "string"},
    "examples": [["slider.json", "stop.json"]]},
  "$schema": {"description": "for editors: where the schema of this file is; not read", "type": "string",
    "examples": ["study.schema.json"]},
  "title": {"description": "head of the report", "type": "string", "examples": ["What accuracy costs"]},
  "methods": {"description": "methods that are compared; a list as an option's value is swept; left out: the scene's",
    "title": "list of methods", "type": "array", "minItems": 1, "items": {"$ref": "#/$defs/swept_method"},
    "examples": [[{"penalty": {"stiffness": [1, 1e3]}}, {"monolithic_al": {}}]]},
  "vary": {"description": "what is varied, in all combinations; pointers may not overlap",
    "title": "object", "type": "object", "examples": [{"/contacts/touch/friction": [0.1, 0.2]}],
    "patternProperties": {"^/": {
      "title": "list", "description": "values of a number, a text or an array of the scene, by JSON pointer",
      "type": "array", "minItems": 1, "examples": [[0.1, 0.2]]}},
    "additionalProperties": {
      "title": "{pointer: list, ...}", "type": "object", "minProperties": 2,
      "description": "linked lists under a name of your choice: the i-th values of all go together",
      "examples": [{"/bodies/foot/mesh/gmsh": ["coarse.msh", "fine.msh"], "/bodies/base/mesh/box/cells": [[8, 4], [16, 8]]}],
      "additionalProperties": {"type": "array", "minItems": 1}}},
  "refine": {"description": "mesh levels: all cells are doubled so many times", "title": "list of whole numbers >= 0",
    "type": "array", "minItems": 1, "items": {"type": "integer", "minimum": 0, "maximum": 10}, "default": [0],
    "examples": [[0, 1, 2]]},
  "reference": {"description": "what errors are against, any number of entries; left out: no error is measured",
    "title": "list of objects", "type": "array", "examples": [[{"method": {"monolithic_al": {}}}]],
    "items": {"$object": "reference"}},
  "errors": {"description": "which are recorded: kkt, response:NAME, sensitivity:NAME/PARAMETER, field:NAME; * for all",
    "title": "list of patterns", "type": "array", "default": ["response:*", "sensitivity:*", "kkt"],
    "examples": [["response:*", "kkt"]],
    "items": {"type": "string", "pattern": "^kkt$|^response:|^sensitivity:|^field:"}},
  "accuracy": {"description": "relative errors at which the report names the cheapest setting of each method",
    "title": "list of up to six numbers > 0 and < 1", "type": "array", "default": [1e-2, 1e-4, 1e-6],
    "examples": [[1e-2, 1e-5]],
    "minItems": 1, "maxItems": 6, "items": {"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1}},
  "timing": null,
  "error_budget": {"description": "measure what each error is made of, by some ten more runs a cell; left out: no",
    "title": "true, false or object", "default": false, "examples": [true], "anyOf": [{"type": "boolean"},
    {"type": "object", "additionalProperties": false}]},
  "solutions": {"description": "solutions of other programs, each one more curve under the same certificate",
    "title": "list of objects", "type": "array", "examples": [[{"name": "GetFEM", "file": "getfem.json"}]],
    "items": {"$object": "solution"}}}}

})json";

}  // namespace

const nlohmann::ordered_json& study_objects() {
  static const auto all = nlohmann::ordered_json::parse(study_text);
  return all;
}

}  // namespace stickslip
