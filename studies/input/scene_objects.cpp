#include "studies/input/file_objects.hpp"

namespace stickslip {
namespace {

constexpr const char* scene_text = R"json({

"common definitions": {
  "positive": {"title": "number > 0", "type": "number", "exclusiveMinimum": 0},
  "not_negative": {"title": "number >= 0", "type": "number", "minimum": 0},
  "count": {"title": "whole number >= 1", "type": "integer", "minimum": 1},
  "vector": {"title": "[x, y], in space [x, y, z]", "type": "array", "items": {"type": "number"}, "minItems": 2,
    "maxItems": 3},
  "pair": {"title": "[x, y]", "type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
  "cells": {"title": "two whole numbers >= 1", "type": "array", "items": {"$ref": "#/$defs/count"}, "minItems": 2,
    "maxItems": 2},
  "cells_of_axes": {"title": "as many whole numbers >= 1 as axes", "type": "array", "items": {"$ref": "#/$defs/count"},
    "minItems": 2, "maxItems": 3},
  "table": {"title": "[[t, value], ...]", "type": "array", "minItems": 1, "items": {"$ref": "#/$defs/pair"}},
  "value": {"title": "VALUE",
    "anyOf": [{"type": "number"}, {"$ref": "#/$defs/table"},
      {"$object": "table"}]},
  "side": {"title": "SIDE", "type": "string"}},

"definitions of scenes": {
  "move": {"title": "MOVE", "minProperties": 1, "examples": [{"x": [[0, 0], [1, 0.1]], "y": 0}], "$object": "move"},
  "rotate": {"title": "ROTATE", "examples": [{"center": [0, 0], "angle": [[0, 0], [1, 5]]}], "$object": "rotate"}},

"table": {"required": ["table"], "properties": {
  "table": {"description": "times increase; linear in between, held before the first and after the last",
    "$ref": "#/$defs/table", "examples": [[[0, 0], [1, 0.1]]]},
  "repeat": {"description": "how often the table is run through, one time right after the other",
    "$ref": "#/$defs/count", "default": 1, "examples": [1000]}}},

"move": {"properties": {
  "x": {"description": "displacement (length)", "$ref": "#/$defs/value", "examples": [[[0, 0], [1, 0.1]]]},
  "y": {"description": "displacement (length)", "$ref": "#/$defs/value", "examples": [0]},
  "z": {"description": "displacement (length), in space", "$ref": "#/$defs/value", "examples": [0]}}},

"rotate": {"required": ["center", "angle"], "properties": {
  "center": {"description": "what it turns about (length)", "$ref": "#/$defs/vector", "examples": [[0, 0]]},
  "axis": {"description": "in space: the direction that it turns about", "title": "[x, y, z]",
    "$ref": "#/$defs/vector", "examples": [[0, 0, 1]]},
  "angle": {"description": "in degrees, counter-clockwise; at small strain displacements are linear in it",
    "$ref": "#/$defs/value", "examples": [[[0, 0], [1, 5]]]}}},

"body": {"required": ["mesh", "material"], "properties": {
  "mesh": {"description": "shape, elements and names of sides", "$ref": "#/$defs/mesh",
    "examples": [{"box": {"min": [0, 0], "max": [4, 2], "cells": [16, 8]}}]},
  "material": {"description": "what it is made of", "$ref": "#/$defs/material",
    "examples": [{"linear_elastic": {"E": 1000, "nu": 0.3}}]},
  "element": {
    "description": "Default: Q4 (space: H8); mean dilatation for j2_plastic, also good for nu near 1/2; gmsh: the file's",
    "enum": ["Q4", "Q4_mean_dilatation", "Q8", "T3", "T6", "H8", "H8_mean_dilatation", "H20", "H27", "T4", "T10", "bar",
      "point"], "examples": ["Q8"]},
  "area": {"description": "cross-section of bars (length squared)", "$ref": "#/$defs/positive", "default": 1,
    "examples": [0.01]},
  "thickness": {"description": "of a body of plane_strain or plane_stress, at the start (length)",
    "$ref": "#/$defs/positive", "default": 1, "examples": [0.5]}}},

"mesh": {"type": "object", "title": "one of the following", "additionalProperties": false, "properties": {
    "gmsh": {
      "description": "file of gmsh beside the scene, MSH 2.2 or 4.1 ASCII; sides: its physical curves, in space surfaces; with body",
      "type": "string", "examples": ["two_half_disks.msh"]},
    "body": {"description": "beside gmsh: the physical name of a surface, in space of a volume, in the file",
      "type": "string", "examples": ["upper"]},
    "split": {
      "description": "beside gmsh: how often every element is split into four, in space eight; corners stay, sides keep the shape that their elements give them",
      "title": "a whole number >= 0", "type": "integer", "minimum": 0, "default": 0, "examples": [1]}},
  "oneOf": [{"required": ["gmsh", "body"]}]},

"obstacle": {"title": "one of the following", "properties": {
  "move": {"description": "displacement by axis", "$ref": "#/$defs/move"},
  "rotate": {"description": "as a rigid body, added to move", "$ref": "#/$defs/rotate"}}},

"contact": {
  "oneOf": [{"required": ["slave", "master"]}, {"required": ["between"]}],
  "if": {"properties": {"self": {"const": true}}, "required": ["self"]},
  "else": {"properties": {"between": {"anyOf": [{"enum": ["all"]}, {"type": "array", "minItems": 2}]}}},
  "properties": {
    "between": {
      "description": "in place of slave and master: solid bodies, each against each, along all of their boundaries",
      "title": "all, or list of bodies", "examples": [["a", "b", "c"]],
      "anyOf": [{"enum": ["all"]}, {"type": "array", "minItems": 1, "items": {"type": "string"}}]},
    "slave": {"description": "the side whose nodes are kept out of the master", "$ref": "#/$defs/side",
      "examples": ["block.bottom"]},
    "master": {
      "description": "what the slave may not enter: SIDE or an obstacle; the slave's own SIDE: it touches itself",
      "type": "string", "examples": ["floor"]},
    "self": {"description": "of between: whether each body may touch itself too", "type": "boolean", "default": false},
    "friction": {
      "description": "Coulomb's coefficient mu, or another law; left out: frictionless, without tangential unknowns",
      "title": "number >= 0, or a law", "examples": [0.3], "anyOf": [{"type": "number", "minimum": 0}]},
    "offset": {"description": "added to the gap (length); negative: an interference", "type": "number", "default": 0,
      "examples": [-0.01]},
    "surface": {
      "description": "of a master of facets, in space faces: plain, or smooth through their nodes (Catmull-Rom, normals go on). Left out: smooth at finite strain, of contact at nodes; else faceted",
      "title": "faceted, smooth or object", "examples": ["smooth"],
      "anyOf": [{"enum": ["faceted", "smooth"]}, {"$object": "surface"}]},
    "discretization": {
      "description": "node: node-to-segment; segment: mortar, gap and slip integrated along both sides (in space at small strain). Left out: segment at finite strain, of solid bodies against one another and obstacles of facets (polyline, mesh_side), if no surface is given; else node",
      "enum": ["node", "segment"], "examples": ["segment"]}}},

"surface": {"required": ["smooth"], "properties": {
  "smooth": {"description": "b_spline: curvatures go on too, a little inside of the facets' ends",
    "enum": ["catmull_rom", "b_spline"], "examples": ["b_spline"]},
  "corner": {"description": "facets that turn by more stay a corner (degrees)", "type": "number",
    "exclusiveMinimum": 0, "maximum": 180, "default": 30, "examples": [60]}}},

"support": {"required": ["on"], "properties": {
    "on": {"description": "what is held", "$ref": "#/$defs/side", "examples": ["block.left"]},
    "move": {"description": "displacement by axis; an axis that is left out is free", "$ref": "#/$defs/move"},
    "rotate": {"description": "of all axes, added to move", "$ref": "#/$defs/rotate"},
    "along": {"description": "alone, in place of move and rotate: the direction that is held, free across it",
      "$ref": "#/$defs/vector", "examples": [[1, 1]]},
    "value": {"description": "of along: displacement in that direction (length)", "$ref": "#/$defs/value",
      "examples": [0]}},
  "if": {"required": ["along"]},
  "then": {"required": ["value"], "properties": {"move": false, "rotate": false}},
  "else": {"anyOf": [{"required": ["move"]}, {"required": ["rotate"]}], "properties": {"value": false}}},

"load": {"required": ["on"], "properties": {
    "on": {"description": "SIDE; of body_force a body", "type": "string", "examples": ["block.top"]},
    "traction": {"description": "one of the four kinds: force per area", "$ref": "#/$defs/vector",
      "examples": [[0.5, -5]]},
    "pressure": {
      "description": "one of the four kinds: force per area, into the body; at finite strain of present areas",
      "type": "number", "examples": [2]},
    "force": {"description": "one of the four kinds: force in all, shared by tributary area",
      "$ref": "#/$defs/vector", "examples": [[0, -10]]},
    "body_force": {"description": "one of the four kinds: force per volume", "$ref": "#/$defs/vector",
      "examples": [[0, -9.81]]},
    "history": {"description": "scales it in time", "$ref": "#/$defs/value", "default": 1,
      "examples": [[[0, 0], [1, 1]]]}},
  "oneOf": [{"required": ["traction"]}, {"required": ["pressure"]}, {"required": ["force"]},
    {"required": ["body_force"]}]},

"time": {"properties": {
    "end": {"description": "of the run, which begins at 0 (time)", "$ref": "#/$defs/positive", "examples": [1]},
    "steps": {"description": "how many equal increments", "$ref": "#/$defs/count", "examples": [10]},
    "legs": {"description": "in place of end and steps: where each leg ends, and its increments",
      "title": "[[t_end, steps], ...]", "type": "array", "minItems": 1, "examples": [[[1, 12], [2, 24]]],
      "items": {"type": "array", "minItems": 2, "maxItems": 2,
        "prefixItems": [{"$ref": "#/$defs/positive"}, {"$ref": "#/$defs/count"}]}},
    "control": {
      "description": "how the times of steps are found: by the arc length along the path of equilibria, past limit points of the load, whose factor is t / end; all else is held. The last step ends at the full load",
      "title": "\"arc_length\" or {\"arc_length\": {...}}", "examples": ["arc_length"],
      "anyOf": [{"const": "arc_length"}, {"$object": "control"}]}},
  "oneOf": [{"required": ["end", "steps"], "properties": {"legs": false}},
    {"required": ["legs"], "properties": {"end": false, "steps": false, "control": false}}]},

"control": {"required": ["arc_length"], "properties": {
  "arc_length": {"description": "options of the path", "examples": [{"load": 0, "length": 0.1, "max": 60}],
    "$object": "arc_length"}}},

"arc_length": {"properties": {
  "load": {"description": "the load that is found; needed where there are several (index, from 0)",
    "type": "integer", "minimum": 0, "examples": [0]},
  "length": {
    "description": "of a step in which the load stands still: root mean square of the nodes' motion; by default a tenth of the diagonal of the scene over the steps (length)",
    "$ref": "#/$defs/positive", "examples": [0.1]},
  "max": {"description": "steps at most; by default ten times the steps", "$ref": "#/$defs/count", "examples": [60]}}},

"objective": {"required": ["of"], "properties": {
    "of": {"description": "the response that is taken", "type": "string", "examples": ["pull"]},
    "sum": {"description": "its sum over the increments; or at", "title": "true", "const": true, "examples": [true]},
    "at": {"description": "its value at a time, which becomes the end of an increment; or sum",
      "$ref": "#/$defs/positive", "examples": [0.5]},
    "target": {"description": "the squared distance to it is taken", "$ref": "#/$defs/value",
      "examples": [[[0, 0], [1, 2]]]}},
  "oneOf": [{"required": ["sum"]}, {"required": ["at"]}]},

"parameter": {"minProperties": 1, "additionalProperties": {"type": "number"}, "properties": {
    "shape": {
      "description": "a side moves by the parameter, whose value is value, times direction; the body follows smoothly; of any mesh",
      "examples": [{"side": "block.top", "direction": [0, 1]}], "$object": "shape"}},
  "dependentSchemas": {"shape": {"maxProperties": 1}}},

"shape": {"required": ["side", "direction"], "properties": {
  "side": {"description": "what moves", "$ref": "#/$defs/side", "examples": ["block.top"]},
  "direction": {"description": "where to", "$ref": "#/$defs/vector", "examples": [[0, 1]]},
  "fixed": {"description": "what stays; left out: all other sides with a name, but for their corners on side",
    "$ref": "#/$defs/side", "examples": ["block.bottom"]},
  "each": {"description": "a parameter NAME/0, NAME/1, ... of every node along the side", "enum": ["node"],
    "examples": ["node"]},
  "value": {"description": "how far it has moved; with each: of every node along the side", "default": 0,
    "title": "number, or [number, ...]", "examples": [0.1],
    "anyOf": [{"type": "number"}, {"type": "array", "items": {"type": "number"}}]}}},

"output": {"properties": {
  "fields": {"description": "increments with fields: the last, all, or every n-th and the last",
    "title": "last, all or whole number >= 1", "default": "last", "examples": [10],
    "anyOf": [{"enum": ["last", "all"]}, {"$ref": "#/$defs/count"}]}}},

"scene": {"required": ["bodies", "time"], "properties": {
  "$schema": {"description": "for editors: where the schema of this file is; not read", "type": "string",
    "examples": ["scene.schema.json"]},
  "title": {"description": "shown in reports", "type": "string", "examples": ["Block on a rough floor"]},
  "space": {"description": "solid: 3D", "enum": ["plane_strain", "plane_stress", "axisymmetric", "solid"],
    "default": "plane_strain"},
  "strain": {
    "description": "small: linear strain, and the contact geometry of the start; finite: everything is where it is now",
    "enum": ["small", "finite"], "default": "small"},
  "bodies": {"description": "what deforms, by names of your choice; one at least", "title": "object by name",
    "type": "object", "minProperties": 1, "additionalProperties": {"$object": "body"},
    "examples": [{"mass": {"mesh": {"point": {"at": [0, 0]}},
      "material": {"grounded_spring": {"stiffness": [[100, 0], [0, 100]]}}}}]},
  "obstacles": {"description": "what is rigid, by names of your choice", "title": "object by name", "type": "object",
    "examples": [{"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}}}],
    "additionalProperties": {"$object": "obstacle"}},
  "contacts": {"description": "which surfaces may touch, by names of your choice", "title": "object by name",
    "type": "object", "examples": [{"sole": {"slave": "block.bottom", "master": "floor", "friction": 0.3}}],
    "additionalProperties": {"$object": "contact"}},
  "supports": {"description": "what is held or moved; supports that share a node must agree on it",
    "title": "list of objects", "type": "array", "examples": [[{"on": "block.left", "move": {"x": 0, "y": 0}}]],
    "items": {"$object": "support"}},
  "loads": {"description": "what pulls and pushes", "title": "list of objects", "type": "array",
    "examples": [[{"on": "block.top", "traction": [0, -5]}]], "items": {"$object": "load"}},
  "time": {"description": "the increments; breakpoints of all tables are hit as well",
    "examples": [{"end": 1, "steps": 10}], "$object": "time"},
  "responses": {"description": "what is measured after each increment, by names of your choice",
    "title": "object by name", "type": "object", "additionalProperties": {"$ref": "#/$defs/response"},
    "examples": [{"pull": {"reaction": {"on": "block.left", "component": "x"}}}]},
  "objectives": {"description": "scalars over time, by names of your choice", "title": "object by name",
    "type": "object", "examples": [{"J": {"of": "pull", "sum": true}}],
    "additionalProperties": {"$object": "objective"}},
  "parameters": {"description": "what derivatives are with respect to, by names of your choice",
    "title": "object by name", "type": "object", "examples": [{"mu": "/contacts/sole/friction"}],
    "additionalProperties": {"anyOf": [
      {"description": "pointer of any physical or geometric number, a method's stiffness or scale included",
        "title": "JSON pointer", "type": "string", "examples": ["/contacts/sole/friction"]},
      {"description": "several numbers that change together, each at its weight", "title": "{pointer: weight, ...}",
        "examples": [{"/bodies/a/material/linear_elastic/E": 1, "/bodies/b/material/linear_elastic/E": 1}],
        "$object": "parameter"}]}},
  "method": {"description": "which method runs, with its options; needed unless -m names one", "$ref": "#/$defs/method",
    "examples": [{"monolithic_al": {}}]},
  "linear_solver": null,
  "output": {"description": "what is written", "examples": [{"fields": "all"}], "$object": "output"},
  "sensitivity": null}}

})json";

}  // namespace

const nlohmann::ordered_json& scene_objects() {
  static const auto all = nlohmann::ordered_json::parse(scene_text);
  return all;
}

}  // namespace stickslip
