/// From a trajectory to the derivatives of all responses with respect to all parameters of the scene, by the scheme
/// that matches the method that ran.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "methods/method.hpp"

namespace stickslip {

/// Right-hand sides of several increments that are solved at once: more save little time and take much memory.
inline constexpr int columns_together = 16;

/// What a scheme did in one increment, where it iterates; Uzawa's do.
struct SchemeRecord {
  int passes = 0;          ///< back-solves a parameter
  double oversize = 1;     ///< kappa_s, the factor on rho in the factorised tangent
  double contraction = 0;  ///< largest last ratio of the changes of D lambda from pass to pass; 0: not measured
};

/// Memory that derivatives took, in bytes, each kind at its most.
struct DerivativeStorage {
  long slots = 0;      ///< of dual numbers, or of reverse ones
  long stiffness = 0;  ///< direct: of linear bodies, with its derivatives
  long states = 0;     ///< direct: those of the increments solved together; adjoint: of those solved again together
  long loads = 0;      ///< direct: their pseudo-loads, and the solutions
  long tape = 0;       ///< adjoint
  long adjoints = 0;   ///< adjoint: derivatives by the tape's entries, the bodies' pairs that wait, and of checkpoints
                       ///< what they keep of a factor
};

struct Gradients {
  Status status = Status::converged;  ///< singular: the tangent of an increment; cap: an iterated scheme did not settle
  std::string message;
  /// Per increment of the trajectory: responses x parameters. Ends where the scheme failed.
  std::vector<Matrix<double>> of_responses;
  /// The same from below and from above, for responses that are the largest or smallest of values that tie; empty where
  /// there is none.
  std::vector<Matrix<double>> from_below, from_above;
  Matrix<double> of_objectives;       ///< objectives x parameters; empty where it failed
  std::vector<SchemeRecord> records;  ///< per increment; empty but for Uzawa
  Matrix<double> last_displacement;   ///< of the last increment: all dofs x parameters; empty where the scheme failed
  Counters counters;
  Counters search;    ///< of these, what it took to find the branches of ties (sensitivity/one_sided.hpp)
  long repeated = 0;  ///< increments that were solved again (sensitivity/whole_states.hpp)
  double seconds = 0;
  double search_seconds = 0;  ///< of these, for `search`
  DerivativeStorage storage;
};

/// Derivatives of a run: all at its end, or as it goes, where having a step's last factor saves more than solving for
/// many steps at once.
class Derivatives {
 public:
  /// All must outlive it; the workspace is that of the run (its engine is used, and left with another factor).
  Derivatives(const Model& model, const Slots<double>& slots, const Method& method, Workspace<double>& workspace);
  ~Derivatives();

  /// Takes in what a run has reached, after each of its steps, while the engine holds the last increment's factor.
  void follow(const Trajectory<double>& trajectory);
  /// The derivatives of the whole run, which follow() may have had parts of.
  Gradients finish(const Trajectory<double>& trajectory);

 private:
  struct Progress;
  std::unique_ptr<Progress> progress_;
};

/// The derivatives of a run that has ended. `workspace`: that of the run (its engine is used and left with another
/// factor). The trajectory is not changed.
Gradients differentiate(const Model& model, const Slots<double>& slots, const Method& method,
                        const Trajectory<double>& trajectory, Workspace<double>& workspace);

}  // namespace stickslip
