/// Definitions of the templates in condensed_engine.hpp.
#pragma once

#include "core/engine/condensation_impl.hpp"
#include "core/engine/condensed_engine.hpp"
#include "core/engine/contact_system_impl.hpp"
#include "core/model/loading.hpp"

namespace stickslip {

template <class T>
CondensedEngine<T>::CondensedEngine(const Model& model, const Slots<T>& slots, bool unknown_multipliers,
                                    ConeRadius cone, std::shared_ptr<Condensation<T>> condensation)
    : model_(model),
      slots_(slots),
      unknown_multipliers_(unknown_multipliers),
      condensation_(std::move(condensation)),
      system_(model, slots, unknown_multipliers, detail::symmetry_of(model, unknown_multipliers, cone)) {}

template <class T>
Vector<T> CondensedEngine<T>::begin(double time, const Vector<T>& displacement, const Vector<T>& /*before*/) {
  time_ = time;
  Vector<T> u = displacement;
  prescribe(model_, slots_, time, u);
  u = into_frames(model_, slots_.frames, Layout::all, std::move(u));
  const Vector<T> external = dead_forces(model_, slots_, time);
  largest_external_ = largest_nodal_norm(external, model_.dimension);
  auto reduced = reduce_loads(*condensation_, model_, slots_, u, external, rest_);
  load_ = reduced.kept;
  others_ = std::move(reduced.others);
  return to_compact(model_, u);
}

template <class T>
Vector<T> CondensedEngine<T>::load_rate(const Vector<T>& /*u*/) {
  if (load_rate_.kept.size() == 0) {
    const double end = model_.times.back();
    const Vector<T> change = dead_forces(model_, slots_, end) - dead_forces(model_, slots_, 0);
    load_rate_ = condensation_->reduce(into_frames(model_, slots_.frames, Layout::all, Vector<T>(change / T(end))));
  }
  return load_rate_.kept.col(0);
}

template <class T>
Vector<T> CondensedEngine<T>::increment(const Vector<T>& u, double time) {
  load_rate({});
  return expand(u, T(time) * load_rate_.others).col(0);
}

template <class T>
void CondensedEngine<T>::move_loads(double time) {
  load_ += T(time - time_) * load_rate({});
  if (others_.size() > 0) others_ += T(time - time_) * load_rate_.others;
  time_ = time;
  largest_external_ = largest_nodal_norm(dead_forces(model_, slots_, time), model_.dimension);
}

template <class T>
Vector<T> CondensedEngine<T>::all(const Vector<T>& u) {
  return out_of_frames(model_, slots_.frames, Layout::all, Vector<T>(rest_ + condensation_->expand(u, others_).col(0)));
}

template <class T>
Matrix<T> CondensedEngine<T>::spread(const Matrix<T>& u) const {
  const Matrix<T> compact = out_of_frames(model_, slots_.frames, Layout::compact, u);
  Matrix<T> all = Matrix<T>::Constant(model_.dof_count(), u.cols(), T(0));
  detail::put_rows(compact, condensation_->contact(), all);
  return all;
}

template <class T>
Vector<T> CondensedEngine<T>::tangent_times(const BodyMotion<T>&, const Vector<T>& motion) const {
  return spread(Vector<T>(condensation_->schur() *
                          into_frames(model_, slots_.frames, Layout::compact, to_compact(model_, motion))));
}

template <class T>
Vector<T> CondensedEngine<T>::residual(const Vector<T>& u, const Vector<T>& contact, ForceScale& scale) const {
  const int D = model_.dimension;
  Vector<T> rows = condensation_->schur() * u;
  const double carried = std::max(largest_nodal_norm(rows, D), largest_nodal_norm(load_, D));
  double stiffest = 0;
  for (Eigen::Index i = 0; i < u.size(); ++i) stiffest = std::max(stiffest, value(condensation_->schur()(i, i)));
  scale.rounding = unit_roundoff * stiffest * largest_nodal_norm(u, D);
  rows -= load_;
  scale.force = std::max({scale.force, largest_external_, largest_nodal_norm(rows, D), largest_nodal_norm(contact, D),
                          cancelling_forces * carried});
  rows += into_frames(model_, slots_.frames, Layout::compact, contact);
  return rows;
}

template <class T>
bool CondensedEngine<T>::factorise(const std::vector<PointTangent<T>>& tangents, Counters& counters,
                                   const Vector<double>& hold) {
  system_.drop_update();
  if (system_.is_factor_of(tangents, hold)) return true;
  ++counters.assemblies;
  return system_.factorise(condensation_->schur(), tangents, hold, counters.factorizations);
}

template <class T>
EngineHoldings CondensedEngine<T>::holdings() const {
  EngineHoldings held;
  held.condensed = static_cast<long>(condensation_->schur().size() * sizeof(T));
  held.bodies_factor = condensation_->factor_bytes();
  held.matrix_entries = held.factor_entries = system_.entries();
  held.matrix = static_cast<long>(system_.entries() * sizeof(T));
  held.factor = system_.factor_bytes();
  held.body_solves = condensation_->backsolves();
  held.unsymmetric = system_.symmetry() == Symmetry::general;
  return held;
}

template <class T>
std::string CondensedEngine<T>::name() const {
  const std::string of_bodies = condensation_->name();  // empty where no body has an inside
  return std::string("condensed, dense ") + (system_.symmetry() == Symmetry::positive_definite ? "LL^T" : "LU") +
         (of_bodies.empty() ? "" : " on " + of_bodies);
}

}  // namespace stickslip
