/// One case: a scene run through one method, with its derivatives and the method-blind measures of what came out.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sensitivity/adjoint.hpp"
#include "sensitivity/one_sided.hpp"
#include "studies/run/metrics.hpp"

namespace stickslip {

/// Model and slots of one scene: shared, immutable, by all methods that run on it.
struct Problem {
  Model model;
  Slots<double> slots;
  Seconds seconds;  ///< `setup`: to make them, but for the contact search
  explicit Problem(const Scene& scene);
};

/// What warnings measure of a body at a step.
struct BodyMeasures {
  double strain = 0, rotation = 0;  ///< largest component in an element; radians
  double spurious_pressure = 0;     ///< spurious_pressure()
  double parasitic_shear = 0;       ///< parasitic_shear()
  std::string free_motion;          ///< free_motion() that nothing which presses holds; empty: none
};

/// What warnings measure of a contact at a step.
struct ContactMeasures {
  double inside = 0;       ///< depth, length, of a node of the master in the slave, deeper than the slave's points are
  double missing = 0;      ///< that depth as a force, by the stiffness of the points, over the force of the contact
  std::vector<double> at;  ///< where that node is now
  double moment = 0;       ///< of the forces on both sides, which balance; 0 unless a response is a moment
};

/// Whether the one-sided derivatives of a value by a parameter differ by more than their rounding, or than their scheme
/// is off by, or are no numbers.
bool are_apart(double below, double above, double value, const Parameter& by, const Method& method);

/// A step that the scene asked for, gathered from its sub-steps.
struct StepResult {
  const Increment<double>* increment;  ///< the last of its sub-steps
  int newton = 0, augmentations = 0;
  std::vector<IterationRecord> history;
  KktError kkt;
  Margins margins;
  Vector<double> responses;
  std::vector<BodyMeasures> bodies;            ///< where its state may have been let go; else empty
  std::vector<ContactMeasures> contacts = {};  ///< likewise
  /// As in a StepReading (studies/run/step_reader.hpp).
  std::vector<char> undetermined, at_vertex, at_end, open_responses;
  std::optional<SchemeRecord> scheme;  ///< of the increment; only where the scheme iterates
  /// Responses x parameters; empty where there are none. No numbers of responses that are not determined.
  Matrix<double> sensitivities;
  bool differentiable = true;        ///< both one-sided derivatives agree
  Matrix<double> backward, forward;  ///< one-sided sensitivities, where they are known; else empty
  /// How far the nearest change of a branch is, parameters x (below, above), in their units, the least of its
  /// sub-steps; empty where there are no derivatives of it (Gradients::nearest_change).
  Matrix<double> nearest_change = {};
  /// Whether the one-sided derivatives of a response by a parameter are_apart(). pre: there are some.
  bool has_kink(const Scene& scene, const Method& method, std::size_t response, std::size_t parameter) const;
};

struct CaseResult {
  std::shared_ptr<const Problem> problem;
  Method method;
  Trajectory<double> trajectory;
  Gradients gradients;
  std::optional<OneSided> one_sided;  ///< where a point was about to change state
  std::vector<StepResult> steps;
  KktScales scales;           ///< of the last increment
  Vector<double> objectives;  ///< their values
  /// One-sided derivatives of the objectives, objectives x parameters; empty where all steps have one derivative.
  Matrix<double> objectives_below, objectives_above;
  double condition_estimate = 0;
  long nonzeros = 0;
  EngineReport engine;  ///< at the end of the solution, before its derivatives
  Counters condensing;  ///< of trajectory.counters, what made the condensation
  /// Right-hand sides solved with the bodies' factor, one way or back counting half: of the solution, of derivatives.
  double body_solves = 0, sensitivity_body_solves = 0;
  double one_sided_seconds = 0;  ///< of gradients.seconds, for one_sided
  Status status() const;  ///< of the trajectory, or of the derivatives where only they failed; both by what came out
  std::string message() const;
};

/// The condensation that a run with these options shares with others on the same numbers; null where it takes none. It
/// refers to the problem, which must outlive it.
std::shared_ptr<Condensation<double>> condense(const Problem& problem, const RunOptions& options);

/// Runs a method. `condensation` may hold one of the same problem and is filled otherwise (see Workspace).
CaseResult run_case(std::shared_ptr<const Problem> problem, const Method& method, const RunOptions& options,
                    std::shared_ptr<Condensation<double>>& condensation);

/// result.json (docs/results.md). `scene_text`: what the hash is of.
nlohmann::json result_json(const CaseResult& result, const std::string& scene_text);
/// The size that the kind of a response has in a run: the largest force, length or traction, or what these make of an
/// energy or a moment; none if there is no such size.
std::optional<double> scale_of(const CaseResult& result, const Response& response);
/// {response: scale_of()}. What is small beside it may be rounding. Without responses of no such size.
nlohmann::json scales_json(const CaseResult& result);
/// Parts of it that a study's row has too.
nlohmann::json cost_json(const CaseResult& result);
nlohmann::json steps_json(const CaseResult& result);
/// {objective: {"value", "gradient": {parameter: derivative}}}.
nlohmann::json objectives_json(const CaseResult& result);
/// Penalty or scale of the contact points as used at the end (`auto` resolved, adaption included): smallest and
/// largest, absolute (force per length cubed) and as multiples of the local nodal stiffness.
nlohmann::json regularisation_json(const CaseResult& result);
nlohmann::json size_json(const CaseResult& result);
nlohmann::json kkt_json(const KktError& error);
/// Contact points of the last step by contact: position, arc length, tractions, gap, slip, state.
nlohmann::json interface_json(const CaseResult& result);

/// The steps that were solved: all of a run, or of one that failed those before. The last iterate of a step that failed
/// is no answer: what reports a run reports these.
std::span<const StepResult> solved_steps(const CaseResult& result);
/// Whether these are all.
bool has_ended(const CaseResult& result);

}  // namespace stickslip
