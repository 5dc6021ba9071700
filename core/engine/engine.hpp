/// Linear algebra of a Newton iteration. A method sees residual, factorise and solve; it does not see whether the
/// bodies are there in full or as their Schur complement on the contact dofs (small strain and linear materials; 20-200
/// times cheaper an iteration).
///
/// Two parts decide that, and the engine asks neither which it is:
///
///   Elimination     which displacements there are ("engine dofs"), and the bodies' forces and tangent on them
///   TangentSystem   how rows of bodies and contact points are solved for
///
/// Rows and increments are over the engine dofs, in the frames of the nodes (model/frames.hpp); entries of prescribed
/// dofs are zero in increments and ignored in rows. What `compact`, `all`, `spread` and `expand` return and `residual`
/// is given is in the axes.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/engine/elimination.hpp"

namespace stickslip {

template <class T>
class Condensation;  // core/engine/condensation.hpp

/// Tangent of bodies that are taken for linear: that at the motion, or the last one, however far from there.
enum class FixedTangent { at_motion, last };

template <class T>
class Engine {
 public:
  /// `system` solves, in each increment until it meets a tangent that it cannot take; then `instead` does. Both may
  /// refer to `bodies`.
  Engine(const Model& model, const Slots<T>& slots, std::unique_ptr<Elimination<T>> bodies,
         std::unique_ptr<TangentSystem<T>> system, std::unique_ptr<TangentSystem<T>> instead = nullptr)
      : model_(model), slots_(slots), bodies_(std::move(bodies)), systems_{std::move(system), std::move(instead)} {
    this->system().take_over();
    stiffness_ = this->system().stiffness();
  }

  // ---- an increment: its loads, and what they move

  /// Displacement in engine dofs, prescribed values at `time` set. `before`: what bodies remember of the last
  /// increment.
  Vector<T> begin(double time, const Vector<T>& displacement, const Vector<T>& before);
  /// Takes the loads of another time; of what is prescribed that of begin() stays.
  void move_loads(double time) { bodies_->move_loads(time); }
  /// What the loads change by in a unit of time, engine rows. pre: they are linear in it.
  Vector<T> load_rate(const Vector<T>& u) { return bodies_->load_rate(u); }

  // ---- layouts

  /// The increment over all dofs, in the axes, that belongs to one of the engine and of the loads' time.
  Vector<T> increment(const Vector<T>& u, double time) { return bodies_->increment(u, time); }
  Vector<T> compact(const Vector<T>& u) const { return bodies_->compact(u); }
  Vector<T> all(const Vector<T>& u) const { return bodies_->all(u); }
  /// Engine displacements or increments over all dofs, in the axes, without those inside condensed bodies.
  Matrix<T> spread(const Matrix<T>& u) const { return bodies_->spread(u); }
  Vector<T> spread(const Vector<T>& u) const { return bodies_->spread(u); }
  bool is_free(Eigen::Index row) const { return system().is_free(row); }
  Matrix<T> scatter(const Matrix<T>& compact) const { return bodies_->scatter(compact); }  ///< compact rows -> engine's
  /// Rows over all dofs, in the frames -> engine rows, `kept`.
  Reduction<T> reduce(const Matrix<T>& rows) const { return bodies_->reduce(rows); }
  /// The increment over all dofs, in the axes, that belongs to an engine increment and to the rows that were reduced,
  /// of whose reduction `others` is. `wanted`: dofs that are read, ascending, where not all are.
  Matrix<T> expand(const Matrix<T>& u, Matrix<T> others, const std::vector<int>* wanted = nullptr) const {
    return bodies_->expand(u, std::move(others), wanted);
  }

  // ---- bodies

  /// f_int - f_ext + contact.
  Vector<T> residual(const Vector<T>& u, const Vector<T>& contact, ForceScale& scale) const;
  /// Takes the bodies' tangent at a motion, for all that follows; nothing where it does not depend on that.
  void linearise(const BodyMotion<T>& at);
  /// Takes the bodies for linear, in residuals too, until release_linearisation(): as linearise(at), with the forces at
  /// that motion. `u`: engine displacement that has the prescribed values. (Bodies whose tangent is constant are so.)
  void fix_linearisation(const BodyMotion<T>& at, const Vector<T>& u, FixedTangent tangent = FixedTangent::at_motion);
  void release_linearisation() { bodies_->release(); }
  /// Whether the last tangent that was condensed is nearly that at a motion: nodes have moved by a ten-thousandth of
  /// the smallest facet since. Never for bodies with a memory, nor under loads that follow them.
  bool has_tangent_near(const BodyMotion<T>& at) const;
  /// The tangent of what is inside and on the bodies at a motion times another, all dofs in the axes, as
  /// model/loading.hpp has it; of condensed bodies, that of their contact dofs.
  Vector<T> tangent_times(const BodyMotion<T>& at, const Vector<T>& motion) const {
    return bodies_->tangent_times(at, motion);
  }
  /// The bodies' stiffness times engine increments (engine rows), or its transpose.
  Matrix<T> apply_stiffness(const Matrix<T>& u, Taken taken = Taken::as_is) const { return system().times(u, taken); }

  // ---- systems

  /// Whether points that change while the linearisation is fixed cost no sparse factor.
  bool condenses_tangents() const { return system().condenses_tangents(); }
  /// Whether a factorisation costs as much as many solves.
  bool has_costly_factors() const { return system().has_costly_factors(); }
  /// `anchor`: stiffness against motion of each contact node, the same in all directions, force per length; empty:
  /// none. False where the tangent is singular: message() says why.
  bool factorise(const std::vector<PointTangent<T>>& tangents, Counters& counters, const Vector<double>& anchor = {});
  /// In place of factorise(), where few points changed since (engine/tangent_update.hpp). Until the next factorise()
  /// all solves are with these tangents. False, and nothing changed, where an update does not pay or cannot be made.
  bool update(const std::vector<PointTangent<T>>& tangents, Counters& counters, const Vector<double>& anchor = {}) {
    return system().update(tangents, anchor, counters);
  }
  /// Whether the determinant of the tangent has another sign than where all points stick. A problem with such a tangent
  /// has several solutions, or none, under some load.
  bool reversed() const { return system().reversed(); }
  /// Number of motions that nothing resists: of negative eigenvalues of the bodies' last tangent with that of the
  /// points' `springs`, a symmetric matrix. Nothing where it is not known.
  std::optional<int> motions_unresisted(const std::vector<PointTangent<T>>& springs, Counters& counters) {
    return system().motions_unresisted(springs, counters);
  }
  BlockVector<T> solve(const BlockVector<T>& rows, Solving how = Solving::refined) { return system().solve(rows, how); }
  /// Solves by the factor that one refined right-hand side takes.
  int solves() const { return system().solves(); }
  double condition_estimate() { return system().condition_estimate(); }

  // ---- what it is, holds and carries on

  std::string name() const { return system().name() + bodies_->name(); }
  const std::string& message() const { return system().message(); }  ///< why the last factorisation failed
  int unknowns() const { return system().unknowns(); }
  long nonzeros() const { return system().nonzeros(); }
  EngineReport report() const;
  EngineMemory<T> memory() const { return system().memory(); }
  /// Goes back to it, by a factorisation where it had a factor: later solves have the same bits as they had then.
  void restore(const EngineMemory<T>& memory, Counters& counters);

 private:
  TangentSystem<T>& system() { return *systems_[solving_]; }
  const TangentSystem<T>& system() const { return *systems_[solving_]; }
  void let_solve(std::size_t system);

  const Model& model_;
  const Slots<T>& slots_;
  std::unique_ptr<Elimination<T>> bodies_;
  std::array<std::unique_ptr<TangentSystem<T>>, 2> systems_;
  std::size_t solving_ = 0;  ///< the system that solves now
  double stiffness_ = 0;     ///< largest diagonal entry at the start, for the rounding of a residual
};

/// Nothing eliminated, one sparse system.
template <class T>
Engine<T> sparse_engine(const Model& model, const Slots<T>& slots, const SystemKind& kind);
/// The bodies of constant stiffness condensed: all of them, and a dense system; or, in a mixed scene
/// (engine/body_rows.hpp), some, and a sparse system. pre: `condensation` is valid.
template <class T>
Engine<T> condensed_engine(const Model& model, const Slots<T>& slots, const SystemKind& kind,
                           std::shared_ptr<Condensation<T>> condensation);

/// Of a scalar that is solved in: as STICKSLIP_SLOTS.
#define STICKSLIP_ENGINES(EXTERN, T)                                                           \
  EXTERN template class Engine<T>;                                                             \
  EXTERN template Engine<T> sparse_engine(const Model&, const Slots<T>&, const SystemKind&);   \
  EXTERN template Engine<T> condensed_engine(const Model&, const Slots<T>&, const SystemKind&, \
                                             std::shared_ptr<Condensation<T>>)

STICKSLIP_ENGINES(extern, double);

}  // namespace stickslip
