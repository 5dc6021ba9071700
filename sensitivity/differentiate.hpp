/// Derivatives of all responses by all parameters of the scene, from a trajectory, by the scheme that belongs to the
/// method of the run.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "methods/method.hpp"

namespace stickslip {

/// Largest number of right-hand sides of several increments that are solved at once. More would save little time and
/// take much memory.
inline constexpr int columns_together = 16;

/// Iterations of a scheme in one increment. Only those of Uzawa iterate.
struct SchemeRecord {
  int passes = 0;          ///< back-solves per parameter
  double oversize = 1;     ///< kappa_s, the factor on rho in the factorised tangent
  double contraction = 0;  ///< largest ratio of two successive changes of D lambda; 0: not measured
};

/// Largest memory of each kind that derivatives took, bytes.
struct DerivativeStorage {
  long slots = 0;      ///< direct: dual numbers; adjoint: reverse numbers
  long stiffness = 0;  ///< direct: stiffness of linear bodies with its derivatives
  long states = 0;     ///< direct: of the increments solved together; adjoint: of those solved again together
  long loads = 0;      ///< direct: pseudo-loads and solutions
  long tape = 0;       ///< adjoint
  long adjoints = 0;   ///< adjoint: derivatives by the tape's entries, waiting pairs of the bodies, and factors of
                       ///< checkpoints
};

struct Gradients {
  Status status = Status::converged;  ///< singular: tangent of an increment; cap: an iterated scheme did not converge
  std::string message;
  /// Per increment of the trajectory: responses x parameters. It ends with the last increment before a failure.
  std::vector<Matrix<double>> of_responses;
  /// The same from below and from above, for a response that is the largest or smallest of several values that tie;
  /// empty if there is no such response.
  std::vector<Matrix<double>> from_below, from_above;
  /// Per increment: how far the nearest change of a branch is, parameters x (below, above), in their units; infinity
  /// where there is none (sensitivity/nearest_change.hpp). Empty in adjoint mode.
  std::vector<Matrix<double>> nearest_change;
  Matrix<double> of_objectives;       ///< objectives x parameters; empty after a failure
  std::vector<SchemeRecord> records;  ///< per increment; empty except for Uzawa
  Matrix<double> last_displacement;   ///< of the last increment: all dofs x parameters; empty after a failure
  Counters counters;
  Counters search;    ///< part of `counters` for the branches of ties (sensitivity/one_sided.hpp)
  long repeated = 0;  ///< number of increments solved again (sensitivity/whole_states.hpp)
  double seconds = 0;
  double search_seconds = 0;  ///< part of `seconds` for `search`
  DerivativeStorage storage;
};

/// Derivatives of a run, computed at its end or along with it. Along with it pays where the last factor of a step saves
/// more than solving for many steps at once.
class Derivatives {
 public:
  /// The arguments must outlive it. `workspace`: that of the run; its engine ends with another factor.
  Derivatives(const Model& model, const Slots<double>& slots, const Method& method, Workspace<double>& workspace);
  ~Derivatives();

  /// Call it after each step of the run, while the engine has the factor of the last increment.
  void follow(const Trajectory<double>& trajectory);
  /// The derivatives of the whole run, including those that follow() computed.
  Gradients finish(const Trajectory<double>& trajectory);

 private:
  struct SoFar;
  std::unique_ptr<SoFar> so_far_;
};

/// The derivatives of a run that has ended. `workspace`: that of the run; its engine ends with another factor.
Gradients differentiate(const Model& model, const Slots<double>& slots, const Method& method,
                        const Trajectory<double>& trajectory, Workspace<double>& workspace);

}  // namespace stickslip
