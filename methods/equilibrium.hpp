/// What one equilibrium is asked for, and what comes of it.
#pragma once

#include <span>

#include "core/model/engine.hpp"
#include "methods/options.hpp"
#include "methods/trace.hpp"

namespace stickslip {

/// Largest force, length and traction among the equilibria of the run so far. Iterates on the way do not count: a first
/// iterate may overshoot by any factor.
struct RunScales {
  double force = 0, length = 0, traction = 0;
};

/// What a run carries from solve to solve; owned by the caller.
struct Account {
  RunScales scales;
  Counters counters;
  Seconds seconds;
  Trace* trace = nullptr;  ///< not owned; gathers every iterate where it is there
};

/// Springs between the contact nodes and a place, which join the equilibrium with their forces.
template <class T>
struct Anchor {
  Vector<double> stiffness;  ///< of each contact node, the same in all directions, force per length; empty: none
  Vector<T> place;           ///< compact displacements
  /// Their forces at compact displacements.
  Vector<T> force(const Vector<T>& compact, int dimension) const {
    Vector<T> f = compact - place;
    for (Eigen::Index i = 0; i < f.size(); ++i) f[i] *= stiffness[i / dimension];
    return f;
  }
};

/// Whether lambda stays as it is given, or is solved for.
enum class Multipliers { given, unknown };

/// One equilibrium that is to be found. It refers to what its caller holds.
template <class T>
struct EquilibriumTask {
  const ContactInput<T>& contact;
  Multipliers multipliers = Multipliers::given;
  const Anchor<T>& anchor;  ///< may be empty
  /// States of the last increment, which points resume that start on their cone; empty where none is to.
  std::span<const ContactState> resumed = {};
  /// Share of its first residual at which a solve that is one of many may also end, while states still change; 0: it
  /// does not.
  double forcing = 0;
  /// Displacement of the state that is left, all dofs; nullptr: what supports prescribe stays what it is.
  const Vector<T>* from = nullptr;
  bool solves_for_multipliers() const { return multipliers == Multipliers::unknown; }
};

/// Displacement in engine dofs, and lambda.
template <class T>
struct Unknowns {
  Vector<T> u, multiplier;
};

template <class T>
struct Equilibrium {
  Status status = Status::converged;
  std::string message;
  Unknowns<T> at;
  ContactField<T> field;
  int iterations = 0;
  bool rough = false;  ///< ended by `forcing`, short of the tolerance
  /// A tangent on the way was (Engine::reversed): there may be other solutions. (Of bodies whose tangent is not
  /// constant it tells nothing.)
  bool reversed = false;
  std::vector<IterationRecord> history;
};

}  // namespace stickslip
