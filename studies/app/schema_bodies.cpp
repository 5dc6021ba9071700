#include "studies/app/schema_texts.hpp"

namespace stickslip::schema_texts {

const char* const mesh = R"json({"type": "object", "title": "one of the following",
  "additionalProperties": false, "properties": {
    "box": {"description": "a rectangle; sides left, right, bottom, top", "type": "object",
      "examples": [{"min": [0, 0], "max": [4, 2], "cells": [16, 8]}], "required": ["min", "max", "cells"],
      "additionalProperties": false, "properties": {
        "min": {"description": "lower left corner (length)", "$ref": "#/$defs/pair", "examples": [[0, 0]]},
        "max": {"description": "upper right corner (length)", "$ref": "#/$defs/pair", "examples": [[4, 2]]},
        "cells": {"description": "along x, along y", "$ref": "#/$defs/cells", "examples": [[16, 8]]},
        "grade": {"$ref": "#/$defs/box_grade",
          "description": "largest cell over smallest, smallest at the side that is named (left out: all alike)"}}},
    "quad": {"description": "a quadrilateral; sides bottom (from its first corner to the second), right, top, left",
      "type": "object", "examples": [{"corners": [[0, 0], [4, 0], [3, 2], [1, 2]], "cells": [16, 8]}],
      "required": ["corners", "cells"], "additionalProperties": false, "properties": {
        "corners": {"description": "counter-clockwise (length)", "title": "four [x, y]", "type": "array",
          "items": {"$ref": "#/$defs/pair"}, "minItems": 4, "maxItems": 4,
          "examples": [[[0, 0], [4, 0], [3, 2], [1, 2]]]},
        "cells": {"description": "along bottom and top, along left and right", "$ref": "#/$defs/cells",
          "examples": [[16, 8]]},
        "grade": {"$ref": "#/$defs/box_grade", "description": "as of a box"}}},
    "ring": {"description": "between two circles; sides inner, outer, of an open ring also start, end",
      "type": "object", "examples": [{"center": [0, 0], "inner": 1, "outer": 2, "cells": [8, 100]}],
      "required": ["center", "inner", "outer", "cells"], "additionalProperties": false, "properties": {
        "center": {"description": "of both circles (length)", "$ref": "#/$defs/pair", "examples": [[0, 0]]},
        "inner": {"description": "radius (length)", "$ref": "#/$defs/positive", "examples": [1]},
        "outer": {"description": "radius (length), greater than inner", "$ref": "#/$defs/positive", "examples": [2]},
        "cells": {"description": "along the radius, around", "$ref": "#/$defs/cells", "examples": [[8, 25]]},
        "from_angle": {"description": "where an open ring starts, in degrees from the x axis, counter-clockwise",
          "type": "number", "default": 0, "examples": [0]},
        "to_angle": {"description": "where it ends, in degrees; 360 further than from_angle: closed",
          "type": "number", "default": 360, "examples": [90]},
        "grade": {
          "description": "largest cell over smallest, smallest at the side that is named (left out: all alike)",
          "type": "object", "title": "one of the following", "examples": [{"inner": 3}], "minProperties": 1,
          "maxProperties": 1, "additionalProperties": false, "properties": {
            "inner": {"description": "ratio", "$ref": "#/$defs/positive", "examples": [3]},
            "outer": {"description": "ratio", "$ref": "#/$defs/positive", "examples": [3]}}}}},
    "disk": {"description": "rings around a square core; side arc", "type": "object",
      "examples": [{"center": [0, 0], "radius": 1, "cells": [8, 6]}], "required": ["center", "radius", "cells"],
      "additionalProperties": false, "properties": {
        "center": {"description": "of the circle (length)", "$ref": "#/$defs/pair", "examples": [[0, 0]]},
        "radius": {"description": "of the circle (length)", "$ref": "#/$defs/positive", "examples": [1]},
        "cells": {"description": "along a quarter of the arc, rings around the core", "$ref": "#/$defs/cells",
          "examples": [[8, 6]]},
        "grade": {"description": "innermost ring over outermost", "$ref": "#/$defs/positive", "default": 1,
          "examples": [4]}}},
    "half_disk": {"description": "fine at the pole of its arc; sides arc, flat", "type": "object",
      "examples": [{"center": [0, 1], "radius": 1, "cells": [20, 20], "grade": 10}],
      "required": ["center", "radius", "cells"], "additionalProperties": false, "properties": {
        "center": {"description": "middle of the flat side (length)", "$ref": "#/$defs/pair", "examples": [[0, 1]]},
        "radius": {"description": "of the circle (length)", "$ref": "#/$defs/positive", "examples": [1]},
        "cells": {"description": "along a quarter of the arc, from the arc to the centre", "$ref": "#/$defs/cells",
          "examples": [[20, 20]]},
        "grade": {"description": "largest cell over smallest along the arc, smallest at the pole",
          "$ref": "#/$defs/positive", "default": 1, "examples": [10]},
        "facing": {"description": "where the arc points to", "enum": ["down", "up"], "default": "down"}}},
    "point": {"description": "one node on a spring; sides node, anchor", "type": "object",
      "examples": [{"at": [0, 0]}], "required": ["at"], "additionalProperties": false, "properties": {
        "at": {"description": "of the node, and of its anchor (length)", "$ref": "#/$defs/vector",
          "examples": [[0, 0]]}}},
    "line": {
      "description": "a straight chain of bars; sides start, end, nodes (all), interior (all but the two ends)",
      "type": "object", "examples": [{"from": [0, 0], "to": [1, 0], "cells": 30}],
      "required": ["from", "to", "cells"], "additionalProperties": false, "properties": {
        "from": {"description": "first node (length)", "$ref": "#/$defs/vector", "examples": [[0, 0]]},
        "to": {"description": "last node (length)", "$ref": "#/$defs/vector", "examples": [[1, 0]]},
        "cells": {"description": "number of bars", "$ref": "#/$defs/count", "examples": [30]}}},
    "arc": {"description": "a chain of bars along a circle; sides as of a line", "type": "object",
      "examples": [{"center": [0, 0], "radius": 1, "from_angle": 0, "to_angle": 180, "cells": 9}],
      "required": ["center", "radius", "from_angle", "to_angle", "cells"],
      "additionalProperties": false, "properties": {
        "center": {"description": "of the circle (length)", "$ref": "#/$defs/pair", "examples": [[0, 0]]},
        "radius": {"description": "of the circle, on which the nodes are (length)", "$ref": "#/$defs/positive",
          "examples": [1]},
        "from_angle": {"description": "of the first node, in degrees from the x axis, counter-clockwise",
          "type": "number", "examples": [-11.25]},
        "to_angle": {"description": "of the last node, in degrees", "type": "number", "examples": [191.25]},
        "cells": {"description": "number of bars", "$ref": "#/$defs/count", "examples": [9]}}},
    "gmsh": {
      "description": "file of gmsh beside the scene, MSH 2.2 or 4.1 ASCII; sides: its physical curves; with body",
      "type": "string", "examples": ["two_half_disks.msh"]},
    "body": {"description": "beside gmsh: the physical name of a surface in the file", "type": "string",
      "examples": ["upper"]}},
  "oneOf": [{"required": ["box"]}, {"required": ["quad"]}, {"required": ["ring"]}, {"required": ["disk"]},
    {"required": ["half_disk"]}, {"required": ["point"]}, {"required": ["line"]}, {"required": ["arc"]},
    {"required": ["gmsh", "body"]}]})json";

}  // namespace stickslip::schema_texts
