/// Task and result of one equilibrium.
#pragma once

#include <optional>
#include <span>

#include "core/engine/engine.hpp"
#include "core/model/contact_assembly.hpp"
#include "methods/newton/trace.hpp"
#include "methods/options.hpp"

namespace stickslip {

/// Largest force, length and traction among the equilibria of the run so far. Iterates do not count, because a first
/// iterate may overshoot by any factor.
struct RunScales {
  double force = 0, length = 0, traction = 0;
};

/// What a run carries from equilibrium to equilibrium. The caller owns it.
struct Account {
  RunScales scales;
  Counters counters;
  Seconds seconds;
  Trace* trace = nullptr;   ///< not owned; nullptr: iterates are not recorded
  bool sequential = false;  ///< whether equilibria are first sought in sequence (methods/rescue/sequential.hpp)
};

/// Springs from the contact nodes to given displacements. Their forces are part of the equilibrium.
template <class T>
struct Anchor {
  Vector<double> stiffness;  ///< of each contact node, the same in all directions, force per length; empty: none
  Vector<T> place;           ///< compact displacements
  /// Forces of the springs at compact displacements, compact.
  Vector<T> force(const Vector<T>& compact, int dimension) const {
    Vector<T> f = compact - place;
    for (Eigen::Index i = 0; i < f.size(); ++i) f[i] *= stiffness[i / dimension];
    return f;
  }
};

/// Tractions as unknowns although multipliers are given. Why: at a stiff point a curvature changes the gap by many
/// tractions over the stiffness, so the traction of an iterate must come from the linear step and not from the gap.
/// With
///
///   t = P_mu(lambda + rho g~),   g~ = g - (lambda - given) / stiffness,   A (t - lambda) = 0
///
/// the solution is lambda = P_mu(given + stiffness g) for any rho.
template <class T>
struct Compliance {
  Vector<T> given;  ///< the multipliers that are given
  Vector<T> share;  ///< per component: rho over the stiffness of the method; 1: the traction is no unknown
  /// The part of the trial lambda + rho g~ that does not depend on the gap.
  Vector<T> seen(const Vector<T>& lambda) const { return lambda + share.cwiseProduct(given - lambda); }
};

/// End of a step of a path (methods/stepping/path.hpp), at an arc length from its beginning:
///
///   |u - u'|^2 / length^2 + (t - t')^2 / span^2 = 1        |u|: root mean square over the free nodes
struct Arc {
  const Vector<double>& start;  ///< u', all dofs
  double time = 0;              ///< t'
  double length = 0, span = 0;
  double nodes = 0;
  bool begins = false;  ///< whether the start values are u' and t'
};

/// One equilibrium to be found. Its references must outlive it.
template <class T>
struct EquilibriumTask {
  const ContactInput<T>& contact;
  Multipliers multipliers = Multipliers::given;
  const Anchor<T>& anchor;  ///< may be empty
  /// States of the last increment, for points that start on their cone (methods/newton/assumed_branches.hpp); empty:
  /// for none.
  std::span<const ContactState> resumed = {};
  /// Share of the first residual at which an inner solve may end, even while states change; 0: it may not.
  double forcing = 0;
  /// The last state; nullptr: the prescribed displacements do not change.
  const State<T>* last = nullptr;
  /// Tractions as unknowns at given multipliers; nullptr: there are none.
  const Compliance<T>* compliance = nullptr;
  /// Arc of a step whose time is an unknown; nullptr: the time is given.
  const Arc* arc = nullptr;
  /// True if the start values are where the overdamped motion came to rest. They are accepted at once if their
  /// residuals are only rounding, since iterating would move a free body by rounding. Otherwise Newton's method goes on
  /// as usual.
  bool rests = false;
  /// Whether a tangent is made of start values that count as solved, of bodies whose tangent changes: its determinant
  /// tells whether they are stable.
  bool tells_stability = false;
  /// Whether lambda is an unknown of the engine's systems.
  bool solves_for_multipliers() const { return multipliers == Multipliers::unknown; }
  /// Whether the rows A (t - lambda) are part of the residual.
  bool has_multiplier_rows() const { return solves_for_multipliers() || compliance; }
};

/// Displacement in engine dofs, lambda, and along a path the time.
template <class T>
struct Unknowns {
  Vector<T> u, multiplier;
  double time = 0;
};

/// A Newton step of the engine's unknowns, and along a path of the time.
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
  bool inexact = false;    ///< ended by `forcing`, short of the tolerance
  bool forceless = false;  ///< contact closes without a force: all tractions are zero, and nothing moved
  /// Some tangent had a determinant of the other sign (Engine::reversed), so there may be other solutions: of bodies of
  /// constant tangent.
  bool reversed = false;
  /// The last one had: of bodies whose tangent changes; none: no tangent was made, and none was asked for.
  std::optional<bool> unstable;
  std::vector<IterationRecord> history;
};

/// Solves one equilibrium from start values, in up to three attempts: Newton's method; if bodies or geometry are
/// nonlinear and it does not converge in 15 iterations, the sequence; if that fails, Newton's method with all its
/// iterations. After an equilibrium by the sequence, the run begins the next ones with it, until it fails. If tangents
/// are condensed, changing branches costs only a dense factor: then an increment of the monolithic method tries the
/// sequence first, and later solves of an increment begin with Newton's method.
template <class T>
Equilibrium<T> find_equilibrium(Engine<T>& engine, const EquilibriumTask<T>& task, Unknowns<T> start,
                                const NewtonOptions& options, Account& account);

extern template Equilibrium<double> find_equilibrium(Engine<double>&, const EquilibriumTask<double>&, Unknowns<double>,
                                                     const NewtonOptions&, Account&);

}  // namespace stickslip
