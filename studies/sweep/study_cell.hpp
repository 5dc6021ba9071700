/// One cell of a study run and measured: cell to row.
#pragma once

#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "studies/run/case.hpp"
#include "studies/sweep/budget_runs.hpp"
#include "studies/sweep/cell_inputs.hpp"
#include "studies/sweep/references.hpp"

namespace stickslip {

/// What a cell's id says of the program: a build of another commit does not take its results for its own.
std::string program_version();

/// The parts of a row that say where its cell stands in the study. The id does not know them: another study may have
/// the same cell elsewhere.
nlohmann::json place_of(const CellInput& cell);

/// 16 digits over what the errors of a study are against, and which are recorded: of these the id does not know either.
std::string reference_hash(const Study& study);

/// A valid cell as input, and its problem. pre: read_study and expand found no fault.
Input input_of(const CellInput& cell, MeshFiles& meshes);
/// Options of a method may hold slots of the scene, so each method has a scene of its own. Throws ModelError.
std::shared_ptr<const Problem> problem_of(const Input& input);

/// Runs cells, keeping what the cells of one variant share until a cell of another variant comes. Everything it gives
/// but seconds is a function of the cell alone, whatever ran before.
class CellRunner {
 public:
  CellRunner(const Study& study, const std::vector<CellInput>& cells, MeshFiles& meshes)
      : study_(study),
        cells_(cells),
        meshes_(meshes),
        budgets_(study, meshes, [this](const CaseResult& result) { return reference_of(result); }) {}
  CellRunner(const CellRunner&) = delete;
  CellRunner& operator=(const CellRunner&) = delete;

  /// The line of results.jsonl (docs/results.md). Whatever the cell throws is a row too: of status `cap`
  /// where there was not enough memory, `failed` where the program broke down, with the reason as its message.
  nlohmann::json row(std::size_t cell);
  /// The row of a cell that left nothing.
  nlohmann::json failed_row(std::size_t cell, const std::string& status, const std::string& message) const;
  /// Seconds of one more run, as in cost.seconds.
  nlohmann::json seconds(std::size_t cell);
  /// The run that the report draws: the first reference on the cell's mesh, or else the cell itself.
  CaseResult showcase(std::size_t cell);
  /// How often a method was run so far, for cells, references and error budgets.
  long runs() const { return runs_ + budgets_.runs(); }

 private:
  struct Variant {
    std::string key;
    std::shared_ptr<const Problem> problem;  ///< the condensation refers to its model
    std::shared_ptr<Condensation<double>> condensation;
    double setup_seconds = 0;
    std::vector<std::optional<CaseResult>> same_mesh;  ///< of Reference::Kind::method, in order; none: it threw
    std::vector<ReferenceValues> overkill;  ///< of Reference::Kind::overkill, in order; empty values: did not converge
    std::string fault;                      ///< what a reference threw
  };

  void enter(const CellInput& cell);
  void run_references(const CellInput& cell);
  nlohmann::json measured_row(const CellInput& cell);
  nlohmann::json peer_row(const CellInput& cell);
  CaseResult run(const CellInput& cell);
  nlohmann::json errors(const CaseResult& result) const;
  ReferenceValues reference_of(const CaseResult& result) const;
  nlohmann::json seconds_of(const CaseResult& result) const;
  bool normals_turn(const CellInput& cell) const;

  const Study& study_;
  const std::vector<CellInput>& cells_;
  MeshFiles& meshes_;
  Variant variant_;
  std::map<std::string, ReferenceValues> overkill_;  ///< what variants may share, by the id of the reference's cell
  BudgetRunner budgets_;
  long runs_ = 0;
};

}  // namespace stickslip
