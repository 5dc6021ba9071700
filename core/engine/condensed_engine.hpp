/// The engine that has linear bodies condensed to their contact dofs.
#pragma once

#include "core/engine/condensation.hpp"
#include "core/engine/contact_system.hpp"
#include "core/engine/engine.hpp"

namespace stickslip {

template <class T>
class CondensedEngine : public Engine<T> {
 public:
  CondensedEngine(const Model& model, const Slots<T>& slots, bool unknown_multipliers, ConeRadius cone,
                  std::shared_ptr<Condensation<T>> condensation);

  /// The compact contact dofs.
  Vector<T> begin(double time, const Vector<T>& displacement, const Vector<T>& before) override;
  void move_loads(double time) override;
  Vector<T> load_rate(const Vector<T>& u) override;

  Vector<T> increment(const Vector<T>& u, double time) override;
  Vector<T> compact(const Vector<T>& u) const override {
    return out_of_frames(model_, slots_.frames, Layout::compact, u);
  }
  Vector<T> all(const Vector<T>& u) override;
  Matrix<T> spread(const Matrix<T>& u) const override;
  Vector<T> spread(const Vector<T>& u) const override { return spread(Matrix<T>(u)); }
  bool is_free(Eigen::Index row) const override { return system_.is_free(row); }
  Matrix<T> scatter(const Matrix<T>& compact) const override { return compact; }
  Reduction<T> reduce(const Matrix<T>& rows) override { return condensation_->reduce(rows); }
  Matrix<T> expand(const Matrix<T>& u, Matrix<T> others, const std::vector<int>* wanted = nullptr) override {
    return out_of_frames(model_, slots_.frames, Layout::all, condensation_->expand(u, std::move(others), wanted));
  }

  Vector<T> residual(const Vector<T>& u, const Vector<T>& contact, ForceScale& scale) const override;
  // (the bodies are linear, and their tangent constant)
  void linearise(const BodyMotion<T>&) override {}
  void hold_bodies(const BodyMotion<T>&, const Vector<T>&, HeldTangent = HeldTangent::at_motion) override {}
  void release_bodies() override {}
  bool has_tangent_near(const BodyMotion<T>&) const override { return false; }
  Vector<T> tangent_times(const BodyMotion<T>&, const Vector<T>& motion) const override;
  Matrix<T> apply_stiffness(const Matrix<T>& u, bool /*transposed*/ = false) const override {
    return condensation_->schur() * u;  // (symmetric)
  }

  bool condenses_tangents() const override { return false; }
  bool has_costly_factors() const override { return false; }
  bool factorise(const std::vector<PointTangent<T>>& tangents, Counters& counters,
                 const Vector<double>& hold = {}) override;
  bool update(const std::vector<PointTangent<T>>& tangents, Counters& counters,
              const Vector<double>& hold = {}) override {
    return system_.update(tangents, hold, counters);
  }
  bool reversed() const override { return system_.reversed(); }
  BlockVector<T> solve(const BlockVector<T>& rows, Solving how = Solving::refined) override {
    return system_.solve(rows, how);
  }
  int solves() const override { return system_.solves(); }
  double condition_estimate() override { return system_.condition_estimate(); }

  std::string name() const override;
  const std::string& message() const override { return system_.message(); }
  int unknowns() const override {
    return system_.displacements() + (unknown_multipliers_ ? model_.multiplier_count : 0);
  }
  long nonzeros() const override { return static_cast<long>(unknowns()) * unknowns(); }
  EngineHoldings holdings() const override;
  EngineMemory<T> memory() const override { return {.factor = system_.recipe()}; }
  void restore(const EngineMemory<T>& memory, Counters& counters) override {
    if (memory.factor.valid) ++counters.assemblies;
    system_.restore(memory.factor, condensation_->schur(), counters.factorizations);
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
