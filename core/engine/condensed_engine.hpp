/// The engine that has linear bodies condensed to their contact dofs.
#pragma once

#include "core/engine/condensation.hpp"
#include "core/engine/contact_system.hpp"

namespace stickslip {

template <class T>
class CondensedEngine {
 public:
  CondensedEngine(const Model& model, const Slots<T>& slots, bool unknown_multipliers, ConeRadius cone,
                  std::shared_ptr<Condensation<T>> condensation);

  Vector<T> begin(double time, const Vector<T>& displacement, const Vector<T>& before);
  void move_loads(double time);
  Vector<T> load_rate(const Vector<T>& u);
  Vector<T> increment(const Vector<T>& u, double time);
  Vector<T> compact(const Vector<T>& u) const { return out_of_frames(model_, slots_.frames, Layout::compact, u); }
  Vector<T> all(const Vector<T>& u);
  /// Engine displacements or increments over all dofs, in the axes, inside condensed bodies zero.
  Matrix<T> spread(const Matrix<T>& u) const;
  Vector<T> residual(const Vector<T>& u, const Vector<T>& contact, ForceScale& scale) const;
  bool is_free(Eigen::Index row) const { return system_.is_free(row); }
  void linearise(const BodyMotion<T>&) {}  ///< (the bodies' tangent is constant)
  void hold_bodies(const BodyMotion<T>&, const Vector<T>&, HeldTangent = HeldTangent::at_motion) {}
  static constexpr bool has_tangent_near(const BodyMotion<T>&) { return false; }
  void release_bodies() {}
  static constexpr bool condenses_tangents() { return false; }
  /// The bodies' tangent times a motion, all dofs in the axes, that is zero inside.
  Vector<T> tangent_times(const BodyMotion<T>&, const Vector<T>& motion) const;
  /// `hold`: stiffness against motion of each contact node, the same in all directions, force per length; empty: none.
  bool factorise(const std::vector<PointTangent<T>>& tangents, Counters& counters, const Vector<double>& hold = {});
  /// In place of factorise(), where few points changed since (model/tangent_update.hpp). Until the next factorise() all
  /// solves are with these tangents. False, and nothing changed, where an update does not pay or cannot be made.
  bool update(const std::vector<PointTangent<T>>& tangents, Counters& counters, const Vector<double>& hold = {}) {
    return system_.update(tangents, hold, counters);
  }
  /// Whether the determinant of the tangent has another sign than where all points stick. A problem with such a tangent
  /// has several solutions, or none, under some load.
  bool reversed() const { return system_.reversed(); }
  BlockVector<T> solve(const BlockVector<T>& rows, Solving how = Solving::refined) { return system_.solve(rows, how); }
  /// Solves by the factor that one refined right-hand side takes.
  int solves() const { return system_.solves(); }
  Matrix<T> apply_stiffness(const Matrix<T>& u, bool /*transposed*/ = false) const {
    return condensation_->schur() * u;  // (symmetric)
  }
  Reduction<T> reduce(const Matrix<T>& rows) { return condensation_->reduce(rows); }
  Matrix<T> expand(const Matrix<T>& u, Matrix<T> others, const std::vector<int>* wanted = nullptr) {
    return out_of_frames(model_, slots_.frames, Layout::all, condensation_->expand(u, std::move(others), wanted));
  }
  Matrix<T> scatter(const Matrix<T>& compact) const { return compact; }
  double condition_estimate() const { return system_.condition_estimate(); }
  std::string name() const;
  const std::string& message() const { return system_.message(); }
  int unknowns() const { return system_.displacements() + (unknown_multipliers_ ? model_.multiplier_count : 0); }
  long nonzeros() const { return static_cast<long>(unknowns()) * unknowns(); }
  EngineHoldings holdings() const;

  /// The tangents of the factor, which may be used again or updated.
  using Carried = FactorRecipe<T>;
  Carried carried() const { return system_.recipe(); }
  /// Goes back to it, by a factorisation where it had a factor: later solves have the same bits as they had then.
  void carry(const Carried& carried, Counters& counters) {
    if (carried.valid) ++counters.assemblies;
    system_.restore(carried, condensation_->schur(), counters.factorizations);
  }

 private:
  const Model& model_;
  const Slots<T>& slots_;
  bool unknown_multipliers_;
  std::shared_ptr<Condensation<T>> condensation_;
  Vector<T> rest_;               ///< all dofs: prescribed values outside the contact, zero elsewhere
  Vector<T> load_;               ///< f_ext - K rest, reduced to the contact dofs
  Matrix<T> others_;             ///< of that reduction
  double time_ = 0;              ///< of the loads
  Reduction<T> load_rate_;       ///< change of the loads in a unit of time, reduced; made on demand
  double largest_external_ = 0;  ///< nodal force of the loads
  ContactSystem<T> system_;
};

extern template class CondensedEngine<double>;

}  // namespace stickslip
