/// Two scenes as files hold them, for tests that read them as they are or with an edit.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "studies/input/scene_reader.hpp"

namespace stickslip::scene_texts {

inline constexpr const char* block_scene = R"({
  "title": "block pushed over a floor",
  "space": "plane_strain",
  "bodies": {
    "block": {
      "mesh": {"box": {"min": [0, 0], "max": [4, 2], "cells": [4, 2]}},
      "material": {"linear_elastic": {"E": 1000, "nu": 0.25}},
      "element": "Q4"
    }
  },
  "obstacles": {"floor": {"plane": {"point": [0, -1], "normal": [0, 2]}}},
  "contacts": {"sole": {"slave": "block.bottom", "master": "floor", "friction": 0.3}},
  "supports": [{"on": "block.left", "move": {"x": [[0, 0], [1, 0.2]]}}],
  "loads": [{"on": "block.top", "traction": [0, -5], "history": [[0, 0], [1, 1]]}],
  "time": {"end": 2, "steps": 10},
  "responses": {
    "pull": {"reaction": {"on": "block.left", "component": "x"}},
    "press": {"contact_force": {"contact": "sole", "component": "normal"}},
    "tip": {"displacement": {"on": "block.right", "component": "y", "take": "max"}}
  },
  "parameters": {"mu": "/contacts/sole/friction"},
  "method": {"monolithic_al": {"scale": 2}}
})";

inline constexpr const char* lumped_scene = R"({
  "bodies": {
    "mass": {
      "mesh": {"point": {"at": [0, 0]}},
      "material": {"grounded_spring": {"stiffness": [[3, 1], [1, 2]]}}
    },
    "belt": {
      "mesh": {"arc": {"center": [0, 0], "radius": 1, "from_angle": 0, "to_angle": 90, "cells": 4}},
      "material": {"linear_elastic": {"E": 10, "nu": 0}},
      "area": 0.5
    },
    "rod": {
      "mesh": {"line": {"from": [2, 0], "to": [3, 0], "cells": 3}},
      "material": {"linear_elastic": {"E": 10, "nu": 0}}
    }
  },
  "obstacles": {"drum": {"circle": {"center": [0, 0], "radius": 0.5}, "move": {"y": -0.1}}},
  "contacts": {"wrap": {"slave": "belt.interior", "master": "drum"}},
  "supports": [{"on": "mass.anchor", "move": {"x": 0, "y": [[0, 1], [2, 3]]}}],
  "loads": [{"on": "mass.node", "force": [1, 0]}],
  "time": {"legs": [[1, 2], [3, 5]]},
  "method": {"penalty": {"stiffness": {"absolute": 50}}},
  "output": {"fields": "all"}
})";

inline std::optional<Input> read_text(const std::string& text, Diagnostics& diagnostics,
                                      const std::optional<std::string>& method = std::nullopt) {
  const auto document = JsonDocument::parse(text, STICKSLIP_SOURCE_DIR "/tests/studies/scene.json", diagnostics);
  if (!document) return std::nullopt;
  MeshFiles mesh_files;
  return read_scene(*document, method, diagnostics, mesh_files);
}

/// The text with `from`, which it has once, replaced.
inline std::string edited(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  EXPECT_EQ(text.find(from, at + 1), std::string::npos) << from << " is not unique";
  return text.replace(at, from.size(), to);
}

}  // namespace stickslip::scene_texts
