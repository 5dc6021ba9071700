/// The schemas against the readers, in what is not made from one description: the default of a key is what the reader
/// takes where it is left out, and a validator not ours takes what the reader takes and refuses what it refuses.
/// Every key is described, with an example that is valid.
#include "studies/app/schema.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "studies/input/scene_reader.hpp"
#include "studies/run/simulation.hpp"
#include "studies/sweep/study_reader.hpp"
#include "tests/studies/cases.hpp"
#include "tests/studies/temporary_folder.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

std::vector<fs::path> shipped_files(bool studies) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(cases::shipped)) {
    const std::string name = entry.path().filename().string();
    const bool study = name.find(".study.json") != std::string::npos;
    if (entry.path().extension() == ".json" && study == studies) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Scenes that have, between them, every object that code reads key by key.
std::vector<json> rich_scenes() {
  const char* plane = R"({
    "bodies": {
      "block": {"mesh": {"box": {"min": [0, 0], "max": [4, 2], "cells": [4, 2], "grade": {"top": 2}}},
                "material": {"linear_elastic": {"E": 1000, "nu": 0.25}}, "element": "Q4"},
      "disk": {"mesh": {"half_disk": {"center": [9, 0], "radius": 1, "cells": [4, 4]}},
               "material": {"linear_elastic": {"E": 1000, "nu": 0.25}}},
      "rod": {"mesh": {"line": {"from": [0, 9], "to": [1, 9], "cells": 2}},
              "material": {"linear_elastic": {"E": 1, "nu": 0}}, "area": 2},
      "belt": {"mesh": {"arc": {"center": [0, 0], "radius": 1, "from_angle": 0, "to_angle": 90, "cells": 4}},
               "material": {"linear_elastic": {"E": 10, "nu": 0}}},
      "mass": {"mesh": {"point": {"at": [5, 5]}}, "material": {"grounded_spring": {"stiffness": [[1, 0], [0, 1]]}}}
    },
    "obstacles": {"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}, "move": {"x": 1},
                            "rotate": {"center": [0, 0], "angle": 3}},
                  "drum": {"circle": {"center": [0, 0], "radius": 1, "inside": true}},
                  "step": {"polyline": {"points": [[0, 0], [1, 0], [1, 1]]}}},
    "contacts": {"sole": {"slave": "block.bottom", "master": "floor", "friction": 0.3},
                 "rim": {"slave": "disk.arc", "master": "floor", "friction": {"coulomb": 0.3, "limit": 5}}},
    "supports": [{"on": "block.left", "move": {"y": {"table": [[0, 0], [1, 1], [2, 0]], "repeat": 4}}},
                 {"on": "block.right", "along": [1, 1], "value": [[0, 0], [1, 1]]},
                 {"on": "disk.flat", "rotate": {"center": [9, 0], "angle": [[0, 0], [1, 1]]}}],
    "loads": [{"on": "block.top", "traction": [0, -5], "history": [[0, 0], [1, 1]]},
              {"on": "disk.arc", "pressure": 2}, {"on": "mass.node", "force": [0, 1]},
              {"on": "block", "body_force": [0, -1]}],
    "time": {"end": 1, "steps": 10},
    "responses": {"a": {"reaction": {"on": "block.left", "component": "moment", "about": [0, 0]}},
      "b": {"contact_force": {"contact": "sole", "component": "normal"}},
      "c": {"displacement": {"on": "block.right", "component": "x", "take": "max"}},
      "d": {"contact_pressure": {"contact": "sole"}}, "e": {"gap": {"contact": "sole", "at": [0, 0]}},
      "f": {"slip": {"contact": "sole"}}, "g": {"dissipation": {"contact": "sole"}}, "h": {"strain_energy": {}},
      "i": {"contact_half_width": {"contact": "sole"}}},
    "parameters": {"top": {"shape": {"side": "block.top", "direction": [0, 1], "fixed": "block.bottom", "each": "node"}},
      "mu": "/contacts/sole/friction", "E": {"/bodies/block/material/linear_elastic/E": 2}},
    "method": {"penalty": {"stiffness": {"absolute": 3}, "newton": {"tolerance": 1e-9}}},
    "linear_solver": {"engine": "sparse"}, "output": {"fields": 2}, "sensitivity": {"mode": "adjoint"},
    "objectives": {"J": {"of": "a", "sum": true}, "K": {"of": "a", "at": 0.5, "target": [[0, 0], [1, 2]]}}
  })";
  const char* space = R"({
    "space": "solid",
    "bodies": {"mass": {"mesh": {"point": {"at": [0, 0, 0]}},
                        "material": {"grounded_spring": {"stiffness": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}}}},
    "supports": [{"on": "mass.anchor", "rotate": {"center": [1, 0, 0], "axis": [0, 0, 1], "angle": 3},
                  "move": {"z": 1}}],
    "time": {"legs": [[1, 2]]},
    "method": {"uzawa_al": {"newton": {}}}
  })";
  return {json::parse(plane), json::parse(space)};
}

/// Faults of a scene as the reader finds them.
std::vector<Diagnostic> faults(const json& scene) {
  Diagnostics diagnostics;
  MeshFiles files;
  const auto document = JsonDocument::parse(scene.dump(), (cases::shipped / "scene.json").string(), diagnostics);
  if (document) read_scene(*document, std::nullopt, diagnostics, files);
  return diagnostics.errors();
}

/// What stands behind references.
const json& resolved(const json& root, const json& schema) {
  if (!schema.contains("$ref")) return schema;
  return resolved(root, root.at(json::json_pointer(schema["$ref"].get<std::string>().substr(1))));
}

/// Schema of a member or element; among alternatives the one that has such a thing.
const json* below(const json& root, const json& schema, const std::string& key, bool of_array) {
  const json& here = resolved(root, schema);
  if (here.contains("anyOf"))
    for (const json& alternative : here["anyOf"])
      if (const json* found = below(root, alternative, key, of_array)) return found;
  if (of_array) return here.contains("items") && here["items"].is_object() ? &here["items"] : nullptr;
  if (here.contains("properties") && here["properties"].contains(key)) return &here["properties"][key];
  const auto others = here.find("additionalProperties");
  return others != here.end() && others->is_object() ? &*others : nullptr;
}

/// Calls f(pointer, schema) for each object of a document.
template <class F>
void for_each_object(const json& root, const json& schema, const json& value, const std::string& pointer, F&& f) {
  if (value.is_object()) f(pointer, schema);
  if (!value.is_structured()) return;
  for (const auto& [key, child] : value.items()) {
    const json* of_child = below(root, schema, key, value.is_array());
    if (of_child && child.is_structured()) for_each_object(root, *of_child, child, pointer + "/" + key, f);
  }
}

/// Calls f(name, property) for every property, wherever it stands; conditions ("if", "then", "else") have none.
template <class F>
void for_each_property(const json& node, F&& f) {
  if (!node.is_structured()) return;
  for (const auto& [key, inner] : node.items()) {
    if (node.is_object() && (key == "if" || key == "then" || key == "else" || key == "oneOf" || key == "examples"))
      continue;
    if (node.is_object() && key == "properties")
      for (const auto& [name, property] : inner.items()) f(name, property);
    for_each_property(inner, f);
  }
}

TEST(Schema, DescribesEveryKeyAndShowsAnExample) {
  for (const json& schema : {json(scene_schema()), json(study_schema())}) {
    int count = 0;
    for_each_property(schema, [&](const std::string& name, const json& property) {
      ++count;
      EXPECT_GT(property.value("description", "").size(), 3u) << name << ": " << property;
      const json& whole = resolved(schema, property);
      const bool shown = property.contains("examples") || whole.contains("examples") || whole.contains("enum") ||
                         whole.value("type", "") == "boolean";
      EXPECT_TRUE(shown) << name << ": " << property;
    });
    EXPECT_GT(count, 40) << "keys were found";
  }
}

TEST(Schema, DescribesNoKeyThatTheReaderPassesOver) {
  const json schema = scene_schema();
  for (const json& scene : rich_scenes()) {
    ASSERT_TRUE(faults(scene).empty()) << faults(scene).front().text();
    for_each_object(schema, schema, scene, "", [&](const std::string& pointer, const json& at) {
      const json properties = resolved(schema, at).value("properties", json::object());
      for (const auto& [key, unused] : properties.items()) {
        json changed = scene;
        changed[json::json_pointer(pointer + "/" + key)] = nullptr;
        EXPECT_FALSE(faults(changed).empty()) << pointer << "/" << key;
      }
    });
  }
}

/// All that the solver makes of a scene; its faults where it has any.
json outcome(const json& scene) {
  Diagnostics diagnostics;
  const auto document = JsonDocument::parse(scene.dump(), (cases::shipped / "scene.json").string(), diagnostics);
  const auto simulation = document ? prepare(*document, {}, std::nullopt, diagnostics) : std::nullopt;
  if (!simulation) return {{"faults", diagnostics.text()}};
  const json result = result_json(simulate(*simulation), "");
  return {{"method", result.at("method")}, {"steps", result.at("steps")}, {"fields", simulation->input.fields_every}};
}

TEST(Schema, NamesTheDefaultsOfTheReader) {
  const json schema = scene_schema();
  int compared = 0;
  for (const json& scene : rich_scenes()) {
    const json expected = outcome(scene);
    EXPECT_FALSE(expected.contains("faults")) << expected;
    for_each_object(schema, schema, scene, "", [&](const std::string& pointer, const json& at) {
      const json properties = resolved(schema, at).value("properties", json::object());
      for (const auto& [key, property] : properties.items()) {
        const json::json_pointer place(pointer + "/" + key);
        if (!property.contains("default") || scene.contains(place)) continue;
        json changed = scene;
        changed[place] = property["default"];
        const json found = outcome(changed);
        if (found.contains("faults")) continue;  // the key does not go with what is there
        EXPECT_EQ(found, expected) << place << " = " << property["default"];
        ++compared;
      }
    });
  }
  EXPECT_GT(compared, 25) << "defaults were found and compared";
}

#ifdef STICKSLIP_PYTHON_WITH_JSONSCHEMA
/// Runs Python's jsonschema: every document of `valid` must pass, every one of `invalid` must not.
void validate(const json& schema, const json& valid, const json& invalid) {
  const TemporaryFolder own;
  const fs::path& folder = own.path;
  std::ofstream(folder / "all.json") << json{{"schema", schema}, {"valid", valid}, {"invalid", invalid}};
  std::ofstream(folder / "check.py") << R"(
import json, sys
from jsonschema import Draft202012Validator
of = json.load(open(sys.argv[1]))
Draft202012Validator.check_schema(of["schema"])
check = Draft202012Validator(of["schema"])
wrong = [f"refused: {name}: {next(check.iter_errors(d)).message}" for name, d in of["valid"] if not check.is_valid(d)]
wrong += [f"taken: {name}" for name, d in of["invalid"] if check.is_valid(d)]
sys.exit("\n".join(wrong) if wrong else 0)
)";
  const std::string command = std::string("\"") + STICKSLIP_PYTHON_WITH_JSONSCHEMA + "\" \"" +
                              (folder / "check.py").string() + "\" \"" + (folder / "all.json").string() + "\"";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST(Schema, TakesEveryShippedFile) {
  for (bool studies : {false, true}) {
    json valid = json::array();
    for (const auto& path : shipped_files(studies)) valid.push_back({path.filename().string(), cases::load(path)});
    ASSERT_GE(valid.size(), 7u);
    if (!studies)
      for (const json& scene : rich_scenes()) valid.push_back({"rich", scene});
    validate(studies ? study_schema() : scene_schema(), valid, json::array());
  }
}

TEST(Schema, ShowsExamplesThatAreValid) {
  for (const json& schema : {json(scene_schema()), json(study_schema())}) {
    json properties = json::object(), documents = json::array();
    for_each_property(schema, [&](const std::string& name, const json& property) {
      const std::string key = name + " " + std::to_string(properties.size());
      properties[key] = property;
      for (const json& example : property.value("examples", json::array()))
        documents.push_back({key + ": " + example.dump(), {{key, example}}});
    });
    ASSERT_GT(documents.size(), 40u);
    const json all{{"type", "object"}, {"properties", properties}, {"$defs", schema["$defs"]}};
    validate(all, documents, json::array({{"an example of nothing", json::array({1})}}));
  }
}

TEST(Schema, RefusesASampleOfWhatTheReaderRefuses) {
  const json scene = rich_scenes().front();
  const std::vector<std::pair<std::string, const char*>> changes{
      {"/bodies", "{}"},
      {"/obstacles/step/polyline/points", "[[0, 0]]"},
      {"/contacts/sole/friction", "-0.1"},
      {"/contacts/sole", R"({"slave": "block.bottom"})"},
      {"/contacts/sole/surface", R"("rough")"},
      {"/contacts/sole", R"({"between": ["block"]})"},
      {"/supports/0", R"({"on": "block.left"})"},
      {"/supports/0/move", "{}"},
      {"/supports/0/move/y", "[]"},
      {"/supports/0/move/y/repeat", "0"},
      {"/supports/1", R"({"on": "block.right", "along": [1, 1]})"},
      {"/supports/1/move", R"({"x": 1})"},
      {"/loads/0/pressure", "1"},
      {"/loads/1/pressure", "[1, 2]"},
      {"/loads/3", R"({"on": "block"})"},
      {"/time", R"({"end": 1})"},
      {"/time/steps", "0"},
      {"/time", R"({"end": 1, "steps": 2, "legs": [[1, 2]]})"},
      {"/responses/b", R"({"reaction": {"on": "block.left", "component": "moment"}})"},
      {"/responses/b/contact_force/about", "[0, 0]"},
      {"/responses/c/displacement/take", R"("median")"},
      {"/output/fields", "0"},
  };
  json invalid = json::array();
  for (const auto& [pointer, text] : changes) {
    json changed = scene;
    changed[json::json_pointer(pointer)] = json::parse(text);
    EXPECT_FALSE(faults(changed).empty()) << pointer << ": the reader takes it";
    invalid.push_back({pointer, changed});
  }
  validate(scene_schema(), json::array(), invalid);
}
#endif

}  // namespace
}  // namespace stickslip
