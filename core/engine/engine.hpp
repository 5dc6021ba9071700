/// Linear algebra of a Newton iteration. A method sees residual, factorise and solve; it does not see whether the
/// bodies are there in full (SparseEngine) or as their Schur complement on the contact dofs (CondensedEngine: small
/// strain and linear materials; 20-200 times cheaper an iteration).
///
/// An engine owns a displacement vector layout ("engine dofs"): all dofs, or the compact contact dofs, in the frames of
/// the nodes (model/frames.hpp). Rows and increments are in that layout; entries of prescribed dofs are zero in
/// increments and ignored in rows. What `compact`, `all` and `expand` return and `residual` is given is in the axes.
#pragma once

#include <string>
#include <vector>

#include "core/engine/engine_parts.hpp"
#include "core/model/flow_points.hpp"

namespace stickslip {

/// What solves hang on beside what they are given: the pattern's places, the tangents of a factor that may be used
/// again or updated, and the displacement of a condensed tangent that may be used again.
template <class T>
struct EngineMemory {
  std::vector<std::vector<int>> places = {};
  FactorRecipe<T> factor = {};
  Vector<T> condensed_at = {};    ///< all dofs; empty: no such tangent
  std::vector<int> touched = {};  ///< contact dofs of its dense system
  long bytes() const {
    return factor.bytes() + static_cast<long>(condensed_at.size() * sizeof(T) + touched.size() * sizeof(int));
  }
};

template <class T>
class Engine {
 public:
  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  // ---- an increment: its loads, and what they move

  /// Displacement in engine dofs, prescribed values at `time` set. `before`: what bodies remember of the last
  /// increment.
  virtual Vector<T> begin(double time, const Vector<T>& displacement, const Vector<T>& before) = 0;
  /// Takes the loads of another time; of what is prescribed that of begin() stays.
  virtual void move_loads(double time) = 0;
  /// What the loads change by in a unit of time, engine rows. pre: they are linear in it.
  virtual Vector<T> load_rate(const Vector<T>& u) = 0;

  // ---- layouts

  /// The increment over all dofs, in the axes, that belongs to one of the engine and of the loads' time.
  virtual Vector<T> increment(const Vector<T>& u, double time) = 0;
  virtual Vector<T> compact(const Vector<T>& u) const = 0;
  virtual Vector<T> all(const Vector<T>& u) = 0;
  /// Engine displacements or increments over all dofs, in the axes, without those inside condensed bodies.
  virtual Matrix<T> spread(const Matrix<T>& u) const = 0;
  virtual Vector<T> spread(const Vector<T>& u) const = 0;
  virtual bool is_free(Eigen::Index row) const = 0;
  virtual Matrix<T> scatter(const Matrix<T>& compact) const = 0;  ///< compact rows -> engine rows
  /// Rows over all dofs, in the frames -> engine rows, `kept`.
  virtual Reduction<T> reduce(const Matrix<T>& rows) = 0;
  /// The increment over all dofs, in the axes, that belongs to an engine increment and to the rows that were reduced,
  /// of whose reduction `others` is. `wanted`: dofs that are read, ascending, where not all are.
  virtual Matrix<T> expand(const Matrix<T>& u, Matrix<T> others, const std::vector<int>* wanted = nullptr) = 0;

  // ---- bodies

  /// f_int - f_ext + contact.
  virtual Vector<T> residual(const Vector<T>& u, const Vector<T>& contact, ForceScale& scale) const = 0;
  /// Takes the bodies' tangent at a motion, for all that follows; nothing where it does not depend on that.
  virtual void linearise(const BodyMotion<T>& at) = 0;
  /// Takes the bodies for linear, in residuals too, until release_bodies(): as linearise(at), with the forces at that
  /// motion. `u`: engine displacement that has the prescribed values. (Where their tangent is constant they are so.)
  virtual void hold_bodies(const BodyMotion<T>& at, const Vector<T>& u,
                           HeldTangent tangent = HeldTangent::at_motion) = 0;
  virtual void release_bodies() = 0;
  /// Whether the last tangent that was condensed is nearly that at a motion: nodes have moved by a ten-thousandth of
  /// the smallest facet since. Never for bodies with a memory, nor under loads that follow them.
  virtual bool has_tangent_near(const BodyMotion<T>& at) const = 0;
  /// The tangent of what is inside and on the bodies at a motion times another, all dofs in the axes, as
  /// model/loading.hpp has it; of condensed bodies, that of their contact dofs.
  virtual Vector<T> tangent_times(const BodyMotion<T>& at, const Vector<T>& motion) const = 0;
  /// The bodies' stiffness times engine increments (engine rows), or its transpose.
  virtual Matrix<T> apply_stiffness(const Matrix<T>& u, bool transposed = false) const = 0;

  // ---- systems

  /// Whether points that change while bodies are held cost no sparse factor.
  virtual bool condenses_tangents() const = 0;
  /// Whether a factorisation costs as much as many solves.
  virtual bool has_costly_factors() const = 0;
  /// `hold`: stiffness against motion of each contact node, the same in all directions, force per length; empty: none.
  virtual bool factorise(const std::vector<PointTangent<T>>& tangents, Counters& counters,
                         const Vector<double>& hold = {}) = 0;
  /// In place of factorise(), where few points changed since (engine/tangent_update.hpp). Until the next factorise()
  /// all solves are with these tangents. False, and nothing changed, where an update does not pay or cannot be made.
  virtual bool update(const std::vector<PointTangent<T>>& tangents, Counters& counters,
                      const Vector<double>& hold = {}) = 0;
  /// Whether the determinant of the tangent has another sign than where all points stick. A problem with such a tangent
  /// has several solutions, or none, under some load.
  virtual bool reversed() const = 0;
  virtual BlockVector<T> solve(const BlockVector<T>& rows, Solving how = Solving::refined) = 0;
  /// Solves by the factor that one refined right-hand side takes.
  virtual int solves() const = 0;
  virtual double condition_estimate() = 0;

  // ---- what it is, holds and carries on

  virtual std::string name() const = 0;
  virtual const std::string& message() const = 0;  ///< why the last factorisation failed
  virtual int unknowns() const = 0;
  virtual long nonzeros() const = 0;
  virtual EngineHoldings holdings() const = 0;
  virtual EngineMemory<T> memory() const = 0;
  /// Goes back to it, by a factorisation where it had a factor: later solves have the same bits as they had then.
  virtual void restore(const EngineMemory<T>& memory, Counters& counters) = 0;
};

}  // namespace stickslip
