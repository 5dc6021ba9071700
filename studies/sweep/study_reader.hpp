/// Study files (JSON): scenes, methods with the options to sweep, numbers to vary, mesh levels. The format is
/// described in docs/study.md.
#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "studies/io/json_document.hpp"

namespace stickslip {

/// A value with its place in the study file, which a fault of a cell then names.
struct PlacedValue {
  nlohmann::json value;
  Place place;
};

/// Some place in the scene, with the values it takes in turn; one value: it is set, not swept.
struct Knob {
  std::string pointer;
  std::vector<PlacedValue> values;
};

/// What a study varies: a list, or linked lists, of which the i-th values of all go together.
struct Variation {
  std::string name;         ///< of linked lists; "" of a list by itself
  std::vector<Knob> knobs;  ///< at least one; all with as many values
  std::size_t size() const { return knobs.front().values.size(); }
};

struct MethodSweep {
  std::string method;
  Place place;
  std::vector<Knob> options;  ///< pointers below the method: "/stiffness", "/newton/tolerance"
};

struct Reference {
  enum class Kind { analytic, values, method, overkill };
  Kind kind = Kind::analytic;
  nlohmann::json entry;           ///< as given
  MethodSweep method;             ///< method, overkill (then monolithic_al): one value each
  int refine = 0;                 ///< overkill: levels finer than the cell or, with `meshes`, than these
  std::vector<Knob> meshes = {};  ///< overkill: values of meshes, one each, that all cells have in place of their own
};

/// What another program found for a scene, or for one of its variants (docs/verify.md).
struct PeerSolution {
  std::string name;
  std::string file;  ///< as given
  nlohmann::json solution;
  std::optional<std::string> scene;            ///< file of its scene
  std::map<std::string, nlohmann::json> vary;  ///< of its variant, by pointer
  std::optional<int> refine;                   ///< of its variant
  Place place;
};

struct StudyScene {
  std::string file;       ///< as a study of several names it; "" of one alone
  JsonDocument document;  ///< as the file gives it
};

struct Study {
  std::string title;
  std::vector<StudyScene> scenes;    ///< at least one; in a study at fault those that can be read
  JsonDocument document;             ///< the study itself
  std::vector<MethodSweep> methods;  ///< at least one
  std::vector<Variation> vary;
  std::vector<PlacedValue> refine;  ///< levels, at least one
  std::vector<Reference> references;
  std::vector<std::shared_ptr<const PeerSolution>> solutions;
  std::vector<std::string> errors;  ///< patterns: "response:*", "sensitivity:NAME/PARAMETER", "kkt"
  int repeat = 0;                   ///< rounds of the timing pass; 0: there is none
  int budget_copies = 0;            ///< perturbed copies of each run of the error budget; 0: there is none
};

/// Reads a study, and its scenes, which are looked for beside it. None where there is a fault in any of them.
std::optional<Study> read_study(const std::string& file, Diagnostics&);

}  // namespace stickslip
