/// The engine that has the bodies in full, but for those of constant stiffness among others, which it may condense.
#pragma once

#include <optional>

#include "core/engine/condensed_part.hpp"
#include "core/engine/condensed_tangent.hpp"
#include "core/engine/engine.hpp"
#include "core/engine/sparse_system.hpp"

namespace stickslip {

/// Rows of the tangent that each element, and after them each contact point, has entries in. A point's: its nodes'
/// dofs, and its multipliers where these are unknown; -1: prescribed. `mixed`: of a scene that is condensed in part;
/// the blocks of its condensed bodies come before the points.
RowLists tangent_rows(const Model& model, bool unknown_multipliers, const MixedRows* mixed = nullptr);

/// The bodies in full: their matrix, assembled once where it is constant, and one system that takes it with the contact
/// points. That is the sparse one (core/engine/sparse_system.hpp); or, where tangents change and each may be condensed
/// (core/engine/condensed_tangent.hpp), the condensed one, in each increment until one is not positive definite inside.
///
/// Where some bodies are of constant stiffness and others are not, the former may be condensed: a dense block each on
/// their contact dofs. Entries of dofs inside them mean nothing in its vectors.
template <class T>
class SparseEngine : public Engine<T> {
 public:
  /// `unknown_multipliers`: the monolithic method's layout, [free dofs; multipliers]. `cone`: of all its systems.
  /// `condensation`: of the bodies of constant stiffness among others (has_mixed_bodies); null: none is condensed.
  /// `tangent`: what condenses the tangents; null: nothing does.
  SparseEngine(const Model& model, const Slots<T>& slots, bool unknown_multipliers, ConeRadius cone, Backend backend,
               std::shared_ptr<Condensation<T>> condensation = nullptr,
               std::shared_ptr<CondensedTangent<T>> tangent = nullptr);

  /// All dofs.
  Vector<T> begin(double time, const Vector<T>& displacement, const Vector<T>& before) override;
  void move_loads(double time) override;
  Vector<T> load_rate(const Vector<T>& u) override;

  Vector<T> increment(const Vector<T>& u, double /*time*/) override { return all(u); }
  Vector<T> compact(const Vector<T>& u) const override {
    return out_of_frames(model_, slots_.frames, Layout::compact, to_compact(model_, u));
  }
  Vector<T> all(const Vector<T>& u) override;
  Matrix<T> spread(const Matrix<T>& u) const override { return out_of_frames(model_, slots_.frames, Layout::all, u); }
  Vector<T> spread(const Vector<T>& u) const override { return out_of_frames(model_, slots_.frames, Layout::all, u); }
  bool is_free(Eigen::Index row) const override { return system().row_of_dof()[row] >= 0; }
  Matrix<T> scatter(const Matrix<T>& compact) const override;
  Reduction<T> reduce(const Matrix<T>& rows) override {
    return part_ ? part_->reduce(rows) : Reduction<T>{rows, Matrix<T>(0, rows.cols())};
  }
  Matrix<T> expand(const Matrix<T>& u, Matrix<T> others, const std::vector<int>* wanted = nullptr) override;

  Vector<T> residual(const Vector<T>& u, const Vector<T>& contact, ForceScale& scale) const override;
  void linearise(const BodyMotion<T>& at) override;
  void hold_bodies(const BodyMotion<T>& at, const Vector<T>& u, HeldTangent tangent = HeldTangent::at_motion) override;
  void release_bodies() override { held_bodies_.reset(); }
  bool has_tangent_near(const BodyMotion<T>& at) const override;
  Vector<T> tangent_times(const BodyMotion<T>& at, const Vector<T>& motion) const override;
  Matrix<T> apply_stiffness(const Matrix<T>& u, bool transposed = false) const override;

  bool condenses_tangents() const override { return condenses_; }
  bool has_costly_factors() const override { return true; }
  bool factorise(const std::vector<PointTangent<T>>& tangents, Counters& counters,
                 const Vector<double>& hold = {}) override;
  bool update(const std::vector<PointTangent<T>>& tangents, Counters& counters,
              const Vector<double>& hold = {}) override;
  bool reversed() const override { return system().reversed(); }
  BlockVector<T> solve(const BlockVector<T>& rows, Solving how = Solving::refined) override {
    return system().solve(rows, how);
  }
  int solves() const override { return sparse_.solves(); }
  double condition_estimate() override { return system().condition_estimate(); }

  std::string name() const override;
  const std::string& message() const override { return system().message(); }
  int unknowns() const override { return sparse_.size(); }
  long nonzeros() const override { return system().pattern().nonzeros(); }
  EngineHoldings holdings() const override;
  EngineMemory<T> memory() const override;
  void restore(const EngineMemory<T>& memory, Counters& counters) override;

 private:
  /// The system that solves now.
  TangentSystem<T>& system() { return condenses_ ? static_cast<TangentSystem<T>&>(*tangent_) : sparse_; }
  const TangentSystem<T>& system() const {
    return condenses_ ? static_cast<const TangentSystem<T>&>(*tangent_) : sparse_;
  }
  BodyKind own() const { return part_ ? BodyKind::changing : BodyKind::all; }  ///< bodies that are there in full
  /// Lays the matrix of the bodies out for the system, of points with these places, and assembles it.
  void lay_out(const typename SparseSystem<T>::Places& places);
  void assemble(const RowLists& lists, const BodyMotion<T>* at);
  /// Condenses the last tangent; where it cannot be condensed, none until the next begin().
  void condense(Counters& counters);
  /// Whether the last tangent is condensed, and hangs on the displacement alone.
  bool keeps_tangent() const {
    return condensed_ && linearised_ && model_.memory_count == 0 && model_.followers.empty();
  }
  Vector<T> body_rows(const Vector<T>& moved) const;

  const Model& model_;
  const Slots<T>& slots_;
  std::optional<CondensedPart<T>> part_;
  std::shared_ptr<CondensedTangent<T>> tangent_;
  Symmetry symmetry_;
  SparseSystem<T> sparse_;
  bool condenses_ = false;  ///< tangents
  bool condensed_ = false;  ///< the last one
  double time_ = 0;
  Vector<T> external_;             ///< in the frames, of what does not depend on displacements
  Vector<T> before_;               ///< what bodies remember of the last increment
  std::optional<RowLists> lists_;  ///< of the tangent; none where the bodies' is constant
  std::vector<T> bulk_;            ///< matrix of the bodies, on the system's pattern
  double stiffness_ = 0;           ///< largest diagonal entry, for the rounding of a residual
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
};

extern template class SparseEngine<double>;

}  // namespace stickslip
