/// Bodies of constant stiffness, eliminated once but for their contact dofs; here all bodies are. Some among others:
/// core/engine/mixed_bodies.hpp.
#pragma once

#include <memory>

#include "core/engine/condensation_impl.hpp"
#include "core/engine/elimination.hpp"
#include "core/model/loading.hpp"

namespace stickslip {

/// Condensed bodies under the loads of an increment. Compact vectors: over their contact dofs, in the frames.
template <class T>
class CondensedBodies {
 public:
  /// `own`: the elements of these bodies; empty: all elements are theirs.
  CondensedBodies(const Model& model, const Slots<T>& slots, std::shared_ptr<Condensation<T>> condensation,
                  ElementLists own = {})
      : model_(model), slots_(slots), condensation_(std::move(condensation)), own_(std::move(own)) {}

  Condensation<T>& condensation() const { return *condensation_; }
  const Matrix<T>& schur() const { return condensation_->schur(); }

  /// Takes their loads out of `external`, all dofs in the axes, and reduces them, less the forces of what is prescribed
  /// outside the contact. `u`: prescribed displacements, all dofs in the frames.
  void begin(const Vector<T>& u, Vector<T>& external) {
    rest_ = Vector<T>::Constant(model_.dof_count(), T(0));
    for (const auto& constraint : model_.constraints) rest_[constraint.dof] = u[constraint.dof];
    for (int node : model_.contact_nodes)
      for (int i = 0; i < model_.dimension; ++i) rest_[node * model_.dimension + i] = T(0);
    const Vector<T> moved = out_of_frames(model_, slots_.frames, NodalLayout::all, rest_);
    const auto* only = own_.empty() ? nullptr : &own_;
    auto reduced = condensation_->reduce(into_frames(
        model_, slots_.frames, NodalLayout::all, Vector<T>(external - bulk_forces(model_, slots_, moved, {}, only))));
    load_ = reduced.kept;
    others_ = std::move(reduced.others);
    take_own(external);
  }
  /// Adds to the loads `duration` times what they change by in a unit of time; `external`: as of begin().
  void move(const Reduction<T>& rate, T duration, Vector<T> external) {
    load_ += duration * rate.kept.col(0);
    if (others_.size() > 0) others_ += duration * rate.others;
    take_own(external);
  }

  /// Largest nodal force that residuals are measured by. Of a body that supports carry along, S u and the load cancel.
  /// With tolerances of 1e-10, a ten-thousandth of these forces (`carried`) is rounding.
  double force(double carried) const {
    return std::max(largest_external_, 1e-4 * std::max(carried, largest_nodal_norm(load_, model_.dimension)));
  }
  const Vector<T>& load() const { return load_; }
  /// Displacements of all dofs that belong to a compact displacement and the loads, less what is prescribed outside the
  /// contact; zero in other bodies.
  Matrix<T> all(const Matrix<T>& u) const { return condensation_->expand(u, others_); }
  /// What is prescribed outside the contact, all dofs; zero elsewhere.
  const Vector<T>& rest() const { return rest_; }

  void add_to_report(EngineReport& report) const {
    report.condensed = static_cast<long>(schur().size() * sizeof(T));
    report.bodies_factor = condensation_->factor_bytes();
    report.body_solves = condensation_->backsolves();
  }

 private:
  void take_own(Vector<T>& external) {
    const int D = model_.dimension;
    largest_external_ = 0;
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) {
      if (!is_among(model_, b, BodyKind::constant)) continue;
      auto own = external.segment(model_.bodies[b].first_node * D, model_.bodies[b].mesh.node_count * D);
      largest_external_ = std::max(largest_external_, largest_nodal_norm(own, D));
      own.setConstant(T(0));
    }
  }

  const Model& model_;
  const Slots<T>& slots_;
  std::shared_ptr<Condensation<T>> condensation_;
  ElementLists own_;
  Vector<T> rest_;
  Vector<T> load_;               ///< f_ext - K rest, reduced to the contact dofs
  Matrix<T> others_;             ///< of that reduction
  double largest_external_ = 0;  ///< nodal force of the loads
};

/// All bodies condensed. Engine rows and displacements are over the contact dofs.
template <class T>
class AllBodiesCondensed : public Elimination<T> {
 public:
  AllBodiesCondensed(const Model& model, const Slots<T>& slots, std::shared_ptr<Condensation<T>> condensation)
      : Elimination<T>(model, slots), condensed_(model, slots, std::move(condensation)) {}

  Vector<T> begin(double time, Vector<T> u, const Vector<T>& /*before*/) override {
    time_ = time;
    Vector<T> external = dead_forces(model_, slots_, time);
    condensed_.begin(u, external);
    return to_compact(model_, u);
  }
  void move_loads(double time) override {
    condensed_.move(rate(), T(time - time_), dead_forces(model_, slots_, time));
    time_ = time;
  }
  Vector<T> load_rate(const Vector<T>& /*u*/) override { return rate().kept.col(0); }
  Vector<T> increment(const Vector<T>& u, double time) override {
    return expand(u, T(time) * rate().others, nullptr).col(0);
  }

  Vector<T> compact(const Vector<T>& u) const override {
    return out_of_frames(model_, slots_.frames, NodalLayout::compact, u);
  }
  Vector<T> all(const Vector<T>& u) const override {
    return out_of_frames(model_, slots_.frames, NodalLayout::all,
                         Vector<T>(condensed_.rest() + condensed_.all(u).col(0)));
  }
  Matrix<T> spread(const Matrix<T>& u) const override {
    const Matrix<T> compact = out_of_frames(model_, slots_.frames, NodalLayout::compact, u);
    Matrix<T> all = Matrix<T>::Constant(model_.dof_count(), u.cols(), T(0));
    detail::put_rows(compact, condensed_.condensation().contact(), all);
    return all;
  }
  Vector<T> spread(const Vector<T>& u) const override { return spread(Matrix<T>(u)); }
  Matrix<T> scatter(const Matrix<T>& compact) const override { return compact; }
  Reduction<T> reduce(const Matrix<T>& rows) const override { return condensed_.condensation().reduce(rows); }
  Matrix<T> expand(const Matrix<T>& u, Matrix<T> others, const std::vector<int>* wanted) const override {
    return out_of_frames(model_, slots_.frames, NodalLayout::all,
                         condensed_.condensation().expand(u, std::move(others), wanted));
  }
  void add_contact(const Vector<T>& forces, Vector<T>& rows) const override { rows += forces; }

  Vector<T> residual(const Vector<T>& u, const TangentSystem<T>& /*system*/, ForceScale& scale) const override {
    Vector<T> rows = condensed_.schur() * u;
    const double carried = largest_nodal_norm(rows, model_.dimension);
    rows -= condensed_.load();
    scale.force = std::max({scale.force, largest_nodal_norm(rows, model_.dimension), condensed_.force(carried)});
    return rows;
  }
  Vector<T> tangent_times(const BodyMotion<T>& /*at*/, const Vector<T>& motion) const override {
    return spread(Vector<T>(condensed_.schur() *
                            into_frames(model_, slots_.frames, NodalLayout::compact, to_compact(model_, motion))));
  }

  std::string name() const override {
    const std::string by = condensed_.condensation().name();  // empty where no body has an inside
    return by.empty() ? "" : " on " + by;
  }
  void add_to_report(EngineReport& report) const override { condensed_.add_to_report(report); }

 private:
  using Elimination<T>::model_, Elimination<T>::slots_;

  /// Change of the loads in a unit of time, reduced; made on demand. pre: they are linear in it.
  const Reduction<T>& rate() {
    if (rate_.kept.size() == 0) {
      const double end = model_.times.back();
      const Vector<T> change = dead_forces(model_, slots_, end) - dead_forces(model_, slots_, 0);
      rate_ = condensed_.condensation().reduce(
          into_frames(model_, slots_.frames, NodalLayout::all, Vector<T>(change / T(end))));
    }
    return rate_;
  }

  CondensedBodies<T> condensed_;
  double time_ = 0;  ///< of the loads
  Reduction<T> rate_;
};

}  // namespace stickslip
