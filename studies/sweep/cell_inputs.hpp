/// The cells of a study: each is one complete scene, with one value of each list of the study.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "methods/options.hpp"
#include "studies/input/scene_reader.hpp"
#include "studies/sweep/study_reader.hpp"

namespace stickslip {

/// One run of a study.
struct CellInput {
  JsonDocument document;  ///< complete scene; read_scene() of it, with the method's name, has no faults
  Method method;
  std::string label;                           ///< "penalty stiffness=100 newton.tolerance=1e-08"
  nlohmann::json knobs;                        ///< swept options: {"stiffness": 100, "newton.tolerance": 1e-08}
  std::string scene;                           ///< StudyScene::file
  std::map<std::string, nlohmann::json> vary;  ///< by pointer
  int refine = 0;
  /// Then nothing is run, and the method is that of another cell; null: a run.
  std::shared_ptr<const PeerSolution> peer;
  std::string canonical;  ///< canonical_text() of the input; nothing of references, errors or timing
  std::string id;         ///< cell_id() of it
};

/// Cells with the same key share a variant of a scene: its problem, condensation and references.
std::string variant_key(const CellInput& cell);

/// The cells, all valid: scene by scene, in it mesh level by level, then each combination of `vary`, then the methods
/// with each combination of their options, the last varying fastest. Inputs that are the same come once, and a note
/// says how many were left out. Empty where there is a fault.
std::vector<CellInput> expand(const Study&, const std::string& program_version, Diagnostics&, MeshFiles&);

/// Reports what else is at fault where the study, or the file of its scene, is already, and so has no cells: values of
/// methods' options, the scene, and each value that it takes in turn, one at a time.
void check_parts(const Study&, Diagnostics&, MeshFiles&);

/// A fault of a cell's scene as one of the study, where the study gives the value: with the pointer that it has there.
Diagnostic in_study(const Study&, Diagnostic fault);

/// The cell with the method of a reference instead of its own, on its own mesh or a finer one: what its enforcement or
/// its discretisation error is measured against. pre: the reference is a method, or overkill.
CellInput reference_cell(const CellInput&, const Reference&, const std::string& program_version, MeshFiles&);

/// 16 hexadecimal digits that name the result of this input by this version of the program.
std::string cell_id(const std::string& canonical, const std::string& program_version);

/// Makes the scene's meshes finer: twice as many cells each way a level, of generators; of an imported mesh as many
/// more splits. A level below zero takes back what as many above have made.
void refine_meshes(JsonDocument& scene, int level, const Place& origin);

}  // namespace stickslip
