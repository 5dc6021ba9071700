/// A study as its file holds it, with its scene, for tests that read them as they are or with an edit.
#pragma once

#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "studies/sweep/cell_inputs.hpp"
#include "tests/studies/scene_texts.hpp"
#include "tests/studies/temporary_folder.hpp"

namespace stickslip::study_texts {

using scene_texts::edited;

inline constexpr const char* scene_text = R"({
  "title": "block",
  "bodies": {
    "block": {
      "mesh": {"box": {"min": [0, 0], "max": [4, 2], "cells": [4, 2]}},
      "material": {"linear_elastic": {"E": 1000, "nu": 0.25}}
    },
    "rod": {
      "mesh": {"line": {"from": [5, 0], "to": [6, 0], "cells": 3}},
      "material": {"linear_elastic": {"E": 1000, "nu": 0}}
    },
    "mass": {
      "mesh": {"point": {"at": [9, 0]}},
      "material": {"grounded_spring": {"stiffness": [[1, 0], [0, 1]]}}
    }
  },
  "obstacles": {"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
  "contacts": {"sole": {"slave": "block.bottom", "master": "floor", "friction": 0.3}},
  "time": {"end": 1, "steps": 2},
  "responses": {"press": {"contact_force": {"contact": "sole", "component": "normal"}}},
  "parameters": {"mu": "/contacts/sole/friction", "eps": "/method/penalty/stiffness"},
  "method": {"monolithic_al": {}}
})";

inline constexpr const char* study_text = R"({
  "title": "cost",
  "scene": "scene.json",
  "methods": [{"penalty": {"stiffness": [10, 1000]}},
              {"uzawa_al": {"scale": [1, 10], "newton": {"tolerance": [1e-8, 1e-10]}, "adapt": false}},
              {"monolithic_al": {}}],
  "vary": {"/contacts/sole/friction": [0, 0.3]},
  "refine": [0, 1],
  "reference": [{"analytic": "hertz_line", "map": {"press": "force"}, "inputs": {"radius": 2}},
                {"values": {"press": 1.5, "press/mu": 0}},
                {"method": {"monolithic_al": {"scale": 5}}}],
  "errors": ["response:*", "kkt"],
  "accuracy": [0.05, 1e-3],
  "timing": {"repeat": 4}
})";

/// A folder with a scene and a study, gone with the test.
class StudyFolder : public InOwnFolder {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::optional<Study> read(const std::string& text, const std::string& scene = scene_text) {
    write("scene.json", scene);
    return read_study(write("cost.study.json", text), diagnostics_);
  }
  std::vector<CellInput> cells(const std::string& text, const std::string& scene = scene_text) {
    const auto study = read(text, scene);
    EXPECT_TRUE(study.has_value()) << diagnostics_.text();
    return study ? expand(*study, "1.0", diagnostics_, mesh_files_) : std::vector<CellInput>{};
  }

  Diagnostics diagnostics_;
  MeshFiles mesh_files_;
};

/// The scene without the parameter on penalty's stiffness, which has to be a number there.
inline std::string without_stiffness_parameter() {
  return edited(scene_text, R"(, "eps": "/method/penalty/stiffness")", "");
}

}  // namespace stickslip::study_texts
