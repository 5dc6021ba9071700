/// How a solve ended and what it cost: the words shared by every method.
#pragma once

#include <string_view>

namespace stickslip {

/// The whole set (docs/results.md).
enum class Status {
  converged,
  converged_at_roundoff,  ///< the tolerance lies below the rounding of the residual itself
  cap,                    ///< an iteration limit was reached
  cycle,                  ///< the active set repeats
  stagnated,
  infeasible,
  no_equilibrium,
  inaccurate,  ///< the method-blind error exceeds what method and rounding explain (studies/run/accuracy.hpp)
  singular,
  inverted_element,
  not_finite
};
std::string_view name_of(Status);
/// converged, or converged_at_roundoff.
bool is_converged(Status);

/// Counts, equal on every machine; `cost.counts` of a result.
struct Counters {
  long assemblies = 0;
  long factorizations = 0;  ///< numeric, of any matrix: tangents and the condensation's
  long analyses = 0;
  long backsolves = 0;                  ///< right-hand sides solved for the response
  long sensitivity_backsolves = 0;      ///< right-hand sides solved for derivatives
  long sensitivity_factorizations = 0;  ///< of `factorizations`, those the derivatives asked for
  long newton = 0;
  long augmentations = 0;
  long cutbacks = 0;
  long contact_evaluations = 0;  ///< contact points evaluated, in any scalar
  Counters& operator+=(const Counters&);
};

/// One Newton iteration: the convergence history of result.json.
struct IterationRecord {
  double residual = 0;  ///< largest of the three below, each relative to its own scale and tolerance-free
  double equilibrium = 0, normal = 0, tangential = 0;
  int open = 0, stick = 0, slip = 0;
  int changed = 0;         ///< contact points whose state changed since the previous iteration
  double step_length = 1;  ///< line search
  int augmentation = 0;    ///< Uzawa sweep it belongs to
};

}  // namespace stickslip
