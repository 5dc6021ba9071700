/// The runs of an error budget (study key "error_budget"). With A a cell's run, B the same with tolerances as tight as
/// they go, C the exact enforcement on the same mesh and steps (monolithic_al, as tight), and a bar for the mean over
/// perturbed copies of the scene:
///
///   rounding      A - mean A'            A': round_otherwise()
///   iteration     mean (A' - B')
///   enforcement   mean (B' - C')
///   step          C - lim C              as the steps are halved, on the same mesh
///   mesh          C - lim C              as the mesh is halved, with the same steps
///
/// The first three are apart from one another, since all are taken over the same copies: what rounding does to a run is
/// in none but the first. The mean of n copies is nearer to the answer without rounding by the root of n; how far it
/// may still be off is the noise of the parts.
///
/// A value is that of the response or derivative, less the study's reference for it (which may depend on what the run
/// measured), so that the parts are parts of the error against the reference.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "studies/run/case.hpp"
#include "studies/sweep/cell_inputs.hpp"
#include "studies/sweep/references.hpp"

namespace stickslip {

/// Moves each number of the scene to one of its two neighbours in double; which, `copy` and the number's pointer
/// decide. Zero stays. The same pointer moves alike in the scenes of all methods.
void round_otherwise(Scene& scene, int copy);

/// Multiplies the stiffness or scale of a method that runs on the scene. A neighbour in double of each number does not
/// move the tiny gap of a stiff penalty by a rounding of the displacements, so that all copies would round alike.
void multiply_stiffness(Method& method, Scene& scene, double factor);

/// The steps of a scene, each cut in 2^halvings.
void refine_steps(JsonDocument& scene, int halvings, const Place& origin);

/// "error_budget" of the row of a cell without an answer.
nlohmann::json no_budget(int copies);

/// Runs what a budget takes, keeping what the cells of one variant share until a cell of another variant comes. A
/// budget is a function of its cell alone.
class BudgetRunner {
 public:
  /// What a run is held against, of the references that the study names besides runs on the same mesh.
  using Against = std::function<ReferenceValues(const CaseResult&)>;
  BudgetRunner(const Study& study, MeshFiles& meshes, Against against)
      : study_(study), meshes_(meshes), against_(std::move(against)) {}

  /// "error_budget" of a row: {"copies", "runs": how many, "failed": [{"run", "status", "message"}], "quantities":
  /// {NAME: to_json(Budget)}}, or no_budget() where the cell did not converge. pre: `given` is the cell's run.
  nlohmann::json of(const CellInput& cell, const CaseResult& given);
  /// How often a method was run so far.
  long runs() const { return runs_; }

 private:
  /// One run as the budget sees it.
  struct Run {
    std::string name, status, message;
    bool usable = false;
    bool same = false;  ///< not run: its input is that of the exact run
    std::map<std::string, double> values;
  };
  /// A perturbed scene.
  struct Copy {
    std::shared_ptr<const Problem> problem;  ///< the condensation refers to its model
    std::shared_ptr<Condensation<double>> condensation;
    Run exact;
  };
  /// What does not depend on the method.
  struct Shared {
    std::string key;
    std::vector<Copy> copies;
    Run exact;
    std::array<Run, 2> steps, mesh;  ///< halved once and twice
  };

  void enter(const CellInput& cell);
  Run exact_run(const CellInput& cell, int mesh_halvings, int step_halvings);
  Run run(std::string name, const std::function<CaseResult()>& work);
  Run copied(const Copy& copy, int number, Input input, const std::string& name, double stretch = 0);
  double stretch_of(const CaseResult& given, const std::map<std::string, double>& own) const;
  std::map<std::string, double> values(const CaseResult& result) const;
  double noise_of(const std::string& quantity, double scale) const;

  const Study& study_;
  MeshFiles& meshes_;
  Against against_;
  Shared shared_;
  long runs_ = 0;
};

}  // namespace stickslip
