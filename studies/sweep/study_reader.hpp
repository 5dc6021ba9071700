/// Study files (JSON): one scene, methods with the options to sweep, numbers to vary, mesh levels. The format is
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

struct MethodSweep {
  std::string method;
  Place place;
  std::vector<Knob> options;  ///< pointers below the method: "/stiffness", "/newton/tolerance"
};

struct Reference {
  enum class Kind { analytic, values, method, overkill };
  Kind kind = Kind::analytic;
  nlohmann::json entry;  ///< as given
  MethodSweep method;    ///< method, overkill (then monolithic_al): one value each
  int refine = 0;        ///< overkill: levels finer than the cell
};

/// What another program found for the scene, or for one of its variants (docs/verify.md).
struct PeerSolution {
  std::string name;
  std::string file;  ///< as given
  nlohmann::json solution;
  std::map<std::string, nlohmann::json> vary;  ///< of its variant, by pointer
  std::optional<int> refine;                   ///< of its variant
  Place place;
};

struct Study {
  std::string title;
  JsonDocument scene;                ///< as the file gives it
  JsonDocument document;             ///< the study itself
  std::vector<MethodSweep> methods;  ///< at least one
  std::vector<Knob> vary;
  std::vector<PlacedValue> refine;  ///< levels, at least one
  std::vector<Reference> references;
  std::vector<std::shared_ptr<const PeerSolution>> solutions;
  std::vector<std::string> errors;  ///< patterns: "response:*", "sensitivity:NAME/PARAMETER", "kkt"
  int repeat = 0;                   ///< rounds of the timing pass; 0: there is none
  int budget_copies = 0;            ///< perturbed copies of each run of the error budget; 0: there is none
};

/// Reads a study, and its scene, which is looked for beside it. None where there is a fault in either.
std::optional<Study> read_study(const std::string& file, Diagnostics&);

}  // namespace stickslip
