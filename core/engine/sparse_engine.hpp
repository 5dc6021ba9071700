/// The engine that has the bodies in full, but for those of constant stiffness among others, which it may condense.
#pragma once

#include <optional>

#include "core/engine/condensed_part.hpp"
#include "core/engine/condensed_tangent.hpp"

namespace stickslip {

/// Rows of the tangent that each element, and after them each contact point, has entries in. A point's: its nodes'
/// dofs, and its multipliers where these are unknown; -1: prescribed. `mixed`: of a scene that is condensed in part;
/// the blocks of its condensed bodies come before the points.
RowLists tangent_rows(const Model& model, bool unknown_multipliers, const MixedRows* mixed = nullptr);

/// The bodies in full: one sparse matrix over the free dofs and the multipliers, its pattern fixed for every contact
/// state, the bodies' part assembled once where it is constant. Where points slide along curves the pattern holds the
/// patches next to those that they face too, and is made anew when a point gets further.
///
/// Where some bodies are of constant stiffness and others are not, the former may be condensed: a dense block each on
/// their contact dofs. Entries of dofs inside them mean nothing in its vectors.
///
/// Where tangents change, each may be condensed (core/engine/condensed_tangent.hpp), in each increment until one is not
/// positive definite inside. The vectors are the same then, and the pattern is that of the bodies alone.
template <class T>
class SparseEngine {
 public:
  /// `unknown_multipliers`: the monolithic method's layout, [free dofs; multipliers]. `cone`: of all its systems.
  /// `condensation`: of the bodies of constant stiffness among others (has_mixed_bodies); null: none is condensed.
  /// `tangent`: what condenses the tangents; null: nothing does.
  SparseEngine(const Model& model, const Slots<T>& slots, bool unknown_multipliers, ConeRadius cone, Backend backend,
               std::shared_ptr<Condensation<T>> condensation = nullptr,
               std::shared_ptr<CondensedTangent<T>> tangent = nullptr);

  /// All dofs, prescribed values at `time` set. `before`: what bodies remember of the last increment.
  Vector<T> begin(double time, const Vector<T>& displacement, const Vector<T>& before);
  /// Takes the loads of another time; of what is prescribed that of begin() stays.
  void move_loads(double time);
  /// What the loads change by in a unit of time, engine rows. pre: they are linear in it.
  Vector<T> load_rate(const Vector<T>& u) const;
  /// The increment over all dofs, in the axes, that belongs to one of the engine and of the loads' time.
  Vector<T> increment(const Vector<T>& u, double /*time*/) const { return all(u); }
  Vector<T> compact(const Vector<T>& u) const {
    return out_of_frames(model_, slots_.frames, Layout::compact, to_compact(model_, u));
  }
  Vector<T> all(const Vector<T>& u) const;
  /// Engine displacements or increments over all dofs, in the axes, without those inside condensed bodies.
  Matrix<T> spread(const Matrix<T>& u) const { return out_of_frames(model_, slots_.frames, Layout::all, u); }
  Vector<T> spread(const Vector<T>& u) const { return out_of_frames(model_, slots_.frames, Layout::all, u); }
  /// f_int - f_ext + contact.
  Vector<T> residual(const Vector<T>& u, const Vector<T>& contact, ForceScale& scale) const;
  bool is_free(Eigen::Index row) const { return row_of_dof()[row] >= 0; }
  /// Takes the bodies' tangent at a motion, for all that follows. pre: it depends on that.
  void linearise(const BodyMotion<T>& at);
  /// Takes the bodies for linear, in residuals too, until release_bodies(): as linearise(at), with the forces at that
  /// motion. `u`: engine displacement that has the prescribed values. (Where their tangent is constant they are so.)
  void hold_bodies(const BodyMotion<T>& at, const Vector<T>& u, HeldTangent tangent = HeldTangent::at_motion);
  /// Whether the last tangent that was condensed is nearly that at a motion: nodes have moved by a ten-thousandth of
  /// the smallest facet since. Never for bodies with a memory, nor under loads that follow them.
  bool has_tangent_near(const BodyMotion<T>& at) const;
  void release_bodies() { held_bodies_.reset(); }
  /// Whether points that change while bodies are held cost no sparse factor.
  bool condenses_tangents() const { return condenses_; }
  /// The tangent of what is inside and on the bodies at a motion times another, all dofs in the axes, as
  /// model/loading.hpp has it; of condensed bodies, that of their contact dofs.
  Vector<T> tangent_times(const BodyMotion<T>& at, const Vector<T>& motion) const;
  /// `hold`: stiffness against motion of each contact node, the same in all directions, force per length; empty: none.
  bool factorise(const std::vector<PointTangent<T>>& tangents, Counters& counters, const Vector<double>& hold = {});
  /// In place of factorise(), where few points changed since (model/tangent_update.hpp). Until the next factorise() all
  /// solves are with these tangents. False, and nothing changed, where an update does not pay or cannot be made.
  bool update(const std::vector<PointTangent<T>>& tangents, Counters& counters, const Vector<double>& hold = {});
  /// Whether the determinant of the tangent has another sign than where all points stick. A problem with such a tangent
  /// has several solutions, or none, under some load.
  bool reversed() const;
  BlockVector<T> solve(const BlockVector<T>& rows, Solving how = Solving::refined);
  /// Solves by the factor that one refined right-hand side takes.
  int solves() const { return update_.empty() ? 1 : 2; }
  /// The bodies' stiffness times engine increments (engine rows), or its transpose.
  Matrix<T> apply_stiffness(const Matrix<T>& u, bool transposed = false) const;
  /// Rows over all dofs, in the frames -> engine rows, `kept`.
  Reduction<T> reduce(const Matrix<T>& rows) {
    return part_ ? part_->reduce(rows) : Reduction<T>{rows, Matrix<T>(0, rows.cols())};
  }
  /// The increment over all dofs, in the axes, that belongs to an engine increment and to the rows that were reduced,
  /// of whose reduction `others` is. `wanted`: dofs that are read, ascending, where not all are.
  Matrix<T> expand(const Matrix<T>& u, Matrix<T> others, const std::vector<int>* wanted = nullptr);
  Matrix<T> scatter(const Matrix<T>& compact) const;  ///< compact rows -> engine rows
  double condition_estimate() { return condenses_ ? tangent_->condition_estimate() : solver_.condition_estimate(); }
  std::string name() const;
  const std::string& message() const { return condenses_ ? tangent_->message() : solver_.message(); }
  int unknowns() const { return size_; }
  long nonzeros() const { return pattern_->nonzeros(); }
  EngineHoldings holdings() const;

  /// What solves hang on beside what they are given: the pattern's places, the tangents of a factor that may be used
  /// again or updated, and the displacement of a condensed tangent that may be used again.
  struct Carried {
    std::vector<std::vector<int>> places;
    FactorRecipe<T> factor;
    Vector<T> condensed_at;    ///< all dofs; empty: no such tangent
    std::vector<int> touched;  ///< contact dofs of its dense system
    long bytes() const {
      return factor.bytes() + static_cast<long>(condensed_at.size() * sizeof(T) + touched.size() * sizeof(int));
    }
  };
  Carried carried() const;
  /// Goes back to it, by a factorisation where it had a factor: later solves have the same bits as they had then.
  void carry(const Carried& carried, Counters& counters);

 private:
  FactorRecipe<T> recipe() const { return {valid_, factorised_, held_, update_}; }

  const Model& model_;
  const Slots<T>& slots_;
  bool unknown_multipliers_;
  std::optional<CondensedPart<T>> part_;
  std::shared_ptr<CondensedTangent<T>> tangent_;
  bool condenses_ = false;  ///< tangents
  bool condensed_ = false;  ///< the last one
  Symmetry symmetry_;
  int size_;
  double time_ = 0;
  Vector<T> external_;  ///< in the frames, of what does not depend on displacements
  Vector<T> before_;    ///< what bodies remember of the last increment
  std::shared_ptr<Pattern> pattern_;
  /// Makes the pattern of the bodies and of points with these places (Model::contact_nodes), and what hangs on it.
  void lay_out(const std::vector<std::vector<int>>& places);
  /// Those of the points where nothing has slid.
  std::vector<std::vector<int>> places_at_start() const;
  /// Places of a point whose tangent it is, with those of the patches around.
  std::vector<int> places_around(std::size_t p, const PointTangent<T>& tangent) const;
  /// Lays the pattern out anew where a tangent has places that it has not.
  void make_room(const std::vector<PointTangent<T>>& tangents);
  /// Row of each dof, -1: none, and the dofs of the rows.
  const std::vector<int>& row_of_dof() const {
    if (condenses_) return tangent_->rows().row_of_dof;
    return part_ ? part_->rows().row_of_dof : model_.free_index;
  }
  const std::vector<int>& dofs() const {
    if (condenses_) return tangent_->rows().dofs;
    return part_ ? part_->rows().dofs : model_.free_dofs;
  }
  /// Condenses the last tangent; where it cannot be condensed, none until the next begin().
  void condense(Counters& counters);
  /// Whether the last tangent is condensed, and hangs on the displacement alone.
  bool keeps_tangent() const {
    return condensed_ && linearised_ && model_.memory_count == 0 && model_.followers.empty();
  }
  /// Rows of a point's entries.
  std::vector<int> rows_of(std::size_t p, const std::vector<int>& places) const;

  std::optional<RowLists> lists_;         ///< of the tangent; none where the bodies' is constant
  std::vector<std::vector<int>> places_;  ///< per point: those that the pattern has, sorted; none slides: empty
  /// Motion that the bodies' tangent is taken at, kept where the pattern may change.
  struct Linearised {
    Vector<T> displacement, last_memory;
    double time;
    FlowBranches branches;
  };
  std::optional<Linearised> linearised_;
  /// Bodies that are linear for a while: their forces, less the loads that follow them, at a displacement of the free
  /// dofs.
  struct HeldBodies {
    Vector<T> u, rows;
  };
  std::optional<HeldBodies> held_bodies_;
  Vector<T> body_rows(const Vector<T>& moved) const;
  void assemble(const RowLists& lists, const BodyMotion<T>* at);
  std::vector<std::vector<int>> point_map_;  ///< per point: entry of each (row, column) pair of its rows, -1 if fixed
  std::vector<T> bulk_, values_;
  double stiffness_ = 0;  ///< largest diagonal entry, for the rounding of a residual
  LinearSolver<T> solver_;
  std::vector<PointTangent<T>> factorised_;
  TangentUpdate update_;
  Vector<double> held_;
  bool analysed_ = false, valid_ = false;
};

extern template class SparseEngine<double>;

}  // namespace stickslip
