/// Whether a run that says it converged has: its method-blind error (studies/run/metrics.hpp) held against what its
/// method and rounding explain, whatever its own residuals say.
///
///   penalty      contact with a layer of compliance 1/stiffness: penetration and elastic slip of traction / stiffness,
///                point by point, and nothing else
///   Uzawa        `tolerance`, of gaps, slips and tractions
///   monolithic   Newton's `tolerance`
///   all          Newton's `tolerance` of the equilibrium, and rounding: u = 1e-16 times what it rounds,
///                of lengths      u R                        R: largest displacement and relative displacement
///                                8 u (h + L)                where an initial gap is not exactly 0: of the given
///                                                           coordinates, at L from the origin (tie_length())
///                of tractions    u rho R                    rho: stiffness or scale
///                of forces       u (k + rho A) R            k: stiffness of an element
///                but never more than `most_rounding` of the run's largest length, traction or force; a hundred times
///                that where nothing presses and these are next to nothing themselves (KktScales)
#pragma once

#include <string>

#include "studies/run/metrics.hpp"

namespace stickslip {

/// Relative error that rounding may leave in a run that passes as solved, whatever stiffness or scale it has.
inline constexpr double most_rounding = 1e-4;

/// The method-blind errors of all increments of a run, and where one of them is not explained.
struct Accuracy {
  std::vector<KktError> errors;
  std::vector<std::string> faults;  ///< per increment: empty, or what is off, where, by how much, and what to try
  KktScales scales;                 ///< of the last increment
};

/// Assesses the increments of a run one after the other.
class AccuracyReader {
 public:
  AccuracyReader(const Model& model, const Slots<double>& slots, const Method& method);
  /// `before`: the state before the increment, of which contact alone is read.
  void read(const State<double>& before, const Increment<double>& increment);
  const Accuracy& accuracy() const { return accuracy_; }

 private:
  const Model& model_;
  const Slots<double>& slots_;
  const Method& method_;
  RegularisationField<double> initial_;
  DefectReader defects_;
  Accuracy accuracy_;
};

/// Assesses a trajectory of the method on the model.
Accuracy assess(const Model& model, const Slots<double>& slots, const Method& method,
                const Trajectory<double>& trajectory);

/// Gives increments that say they converged, but did not, the status `inaccurate` (`not_finite` where an error is no
/// number), and the trajectory that of the first of them.
void mark_inaccurate(const Accuracy& accuracy, Trajectory<double>& trajectory);
/// The same, assessed. Returns the errors, as kkt_errors() does.
std::vector<KktError> check_accuracy(const Model& model, const Slots<double>& slots, const Method& method,
                                     Trajectory<double>& trajectory);

}  // namespace stickslip
