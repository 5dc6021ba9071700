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
  Trace* trace = nullptr;   ///< not owned; gathers every iterate where it is there
  bool sequential = false;  ///< whether equilibria are first sought in sequence (methods/sequential.hpp)
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

/// Given multipliers, with tractions that are solved for, point by point. Why: of a stiff point any curvature changes
/// the gap by many tractions over the stiffness, so an iterate of the traction is taken from the step and not from the
/// gap. With
///
///   t = P_mu(lambda + rho g~),   g~ = g - (lambda - given) / stiffness,   A (t - lambda) = 0
///
/// the solution has lambda = P_mu(given + stiffness g), whatever rho is.
template <class T>
struct Compliance {
  Vector<T> given;  ///< the multipliers that are given
  Vector<T> share;  ///< rho over the stiffness of the method, each component; 1: no traction is solved for
  /// The part of the trial lambda + rho g~ that does not depend on the gap.
  Vector<T> seen(const Vector<T>& lambda) const { return lambda + share.cwiseProduct(given - lambda); }
};

/// Where a step of a path ends (methods/path.hpp): at an arc length from the state at its beginning,
///
///   |u - u'|^2 / length^2 + (t - t')^2 / span^2 = 1        |u|: root mean square over the nodes that are free
struct Arc {
  const Vector<double>& start;  ///< u', all dofs
  double time = 0;              ///< t'
  double length = 0, span = 0;
  double nodes = 0;
  bool begins = false;  ///< whether the start values are u' and t'
};

/// One equilibrium that is to be found. It refers to what its caller holds.
template <class T>
struct EquilibriumTask {
  const ContactInput<T>& contact;
  Multipliers multipliers = Multipliers::given;
  const Anchor<T>& anchor;  ///< may be empty
  /// States of the last increment, for points that start on their cone (methods/assumed_branches.hpp); empty: for none.
  std::span<const ContactState> resumed = {};
  /// Of a solve that is one of many: it may also end at this share of its first residual, while states still change. 0:
  /// it does not.
  double forcing = 0;
  /// Displacement of the last state, all dofs; nullptr: what supports prescribe stays what it is.
  const Vector<T>* last_displacement = nullptr;
  /// Tractions that are solved for in place of given multipliers; nullptr: none are.
  const Compliance<T>* compliance = nullptr;
  /// The arc that ends a step whose time is unknown; nullptr: the time is given.
  const Arc* arc = nullptr;
  /// Whether lambda is an unknown of the engine's systems.
  bool solves_for_multipliers() const { return multipliers == Multipliers::unknown; }
  /// Whether an iterate has tractions that differ from those of its displacements.
  bool has_multiplier_rows() const { return solves_for_multipliers() || compliance; }
};

/// Displacement in engine dofs, and lambda; along a path the time too.
template <class T>
struct Unknowns {
  Vector<T> u, multiplier;
  double time = 0;
};

/// A step of Newton's method: of the engine's unknowns, and along a path of the time.
template <class T>
struct NewtonStep : BlockVector<T> {
  double time = 0;
};

template <class T>
struct Equilibrium {
  Status status = Status::converged;
  std::string message;
  Unknowns<T> unknowns;
  ContactField<T> field;
  int iterations = 0;
  bool inexact = false;  ///< ended by `forcing`, short of the tolerance
  /// Some tangent of the iterations had a determinant of the other sign (Engine::reversed): there may be other
  /// solutions. It tells nothing of bodies whose tangent is not constant.
  bool reversed = false;
  std::vector<IterationRecord> history;
};

}  // namespace stickslip
