/// Definitions of the templates in condensed_engine.hpp.
#pragma once

#include "core/model/condensation_impl.hpp"
#include "core/model/condensed_engine.hpp"
#include "core/model/loading.hpp"

namespace stickslip {

template <class T>
CondensedEngine<T>::CondensedEngine(const Model& model, const Slots<T>& slots, bool unknown_multipliers,
                                    ConeRadius cone, std::shared_ptr<Condensation<T>> condensation)
    : model_(model),
      slots_(slots),
      unknown_multipliers_(unknown_multipliers),
      condensation_(std::move(condensation)),
      symmetry_(detail::symmetry_of(model, unknown_multipliers, cone)) {
  const int D = model.dimension;
  for (int node : model.contact_nodes)
    for (int i = 0; i < D; ++i) {
      free_.push_back(model.free_index[node * D + i] >= 0);
      free_place_.push_back(free_.back() ? static_cast<int>(free_list_.size()) : -1);
      if (free_.back()) free_list_.push_back(static_cast<int>(free_.size()) - 1);
    }
}

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
  return spread(condensation_->schur() *
                into_frames(model_, slots_.frames, Layout::compact, to_compact(model_, motion)));
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
std::vector<int> CondensedEngine<T>::point_rows(const ContactPoint& point) const {
  const int D = model_.dimension;
  std::vector<int> rows;
  for (int n : point.places)
    for (int i = 0; i < D; ++i) rows.push_back(free_place_[n * D + i]);
  if (unknown_multipliers_)
    for (int c = 0; c < point.components(); ++c) rows.push_back(place_[point.multiplier + c]);
  return rows;
}

template <class T>
bool CondensedEngine<T>::factorise(const std::vector<PointTangent<T>>& tangents, Counters& counters,
                                   const Vector<double>& hold) {
  update_.clear();
  if (valid_ && detail::same_values(hold, held_) && detail::same_tangents(tangents, factorised_)) return true;
  const int D = model_.dimension, free = static_cast<int>(free_list_.size());
  active_.clear();
  place_.assign(model_.multiplier_count, -1);
  open_diagonal_ = Vector<T>::Constant(model_.multiplier_count, T(1));
  if (unknown_multipliers_)
    for (std::size_t p = 0; p < tangents.size(); ++p) {
      const bool open = detail::is_open(tangents[p]);
      for (int c = 0; c < model_.points[p].components(); ++c) {
        const int k = model_.points[p].multiplier + c;
        if (open) {
          open_diagonal_[k] = tangents[p].row_l(c, c);
        } else {
          place_[k] = free + static_cast<int>(active_.size());
          active_.push_back(k);
        }
      }
    }
  Matrix<T>& K = matrix_;
  K = Matrix<T>::Zero(free + active_.size(), free + active_.size());
  const auto& S = condensation_->schur();
  for (int j = 0; j < free; ++j)
    for (int i = 0; i < free; ++i) K(i, j) = S(free_list_[i], free_list_[j]);
  if (hold.size() > 0)
    for (int i = 0; i < free; ++i) K(i, i) += T(hold[free_list_[i] / D]);
  for (std::size_t p = 0; p < tangents.size(); ++p) {
    const auto rows = point_rows(model_.points[p]);
    auto add = [&](int row, int column, const T& x) {
      if (rows[row] >= 0 && rows[column] >= 0) K(rows[row], rows[column]) += x;
    };
    detail::for_each_framed_entry(model_, slots_, static_cast<int>(p), tangents[p], unknown_multipliers_, add);
  }
  ++counters.assemblies;
  factorised_ = tangents;
  held_ = hold;
  return valid_ = factor_.factorise(K, symmetry_ == Symmetry::positive_definite, counters.factorizations);
}

template <class T>
bool CondensedEngine<T>::update(const std::vector<PointTangent<T>>& tangents, Counters& counters,
                                const Vector<double>& hold) {
  if (!valid_ || !detail::same_values(hold, held_)) return false;
  if (unknown_multipliers_)  // the factor has no rows for the multipliers of what was open then
    for (std::size_t p = 0; p < tangents.size(); ++p)
      if (detail::is_open(factorised_[p]) && !detail::same_tangent(factorised_[p], tangents[p])) return false;
  const auto rows = [&](std::size_t p) { return point_rows(model_.points[p]); };
  const auto solve = [&](const Matrix<T>& b) { return factor_.solve(b); };
  return detail::update_factor<T>(model_, slots_, factorised_, tangents, unknown_multipliers_, rows,
                                  static_cast<Eigen::Index>(free_list_.size() + active_.size()), counters, solve,
                                  update_);
}

template <class T>
void CondensedEngine<T>::carry(const Carried& carried, Counters& counters) {
  valid_ = false;
  if (carried.valid) factorise(carried.tangents, counters, carried.hold);
  update_ = carried.update;
}

template <class T>
bool CondensedEngine<T>::reversed() const {
  const int expected = active_.size() % 2 == 1 ? -1 : 1;  // each multiplier turns the sign
  return (factor_.determinant_sign() != expected) != update_.turns_sign();
}

template <class T>
BlockVector<T> CondensedEngine<T>::solve(const BlockVector<T>& rows, Solving how) {
  const bool transposed = how == Solving::transposed;
  const int free = static_cast<int>(free_list_.size());
  const Eigen::Index columns = rows.u.cols();
  Matrix<T> b(free + active_.size(), columns);
  for (int i = 0; i < free; ++i) b.row(i) = rows.u.row(free_list_[i]);
  for (std::size_t a = 0; a < active_.size(); ++a) b.row(free + a) = rows.l.row(active_[a]);
  const Matrix<T> x = detail::solve_updated<T>(
      update_, b, how, [&](const Matrix<T>& r) { return factor_.solve(r, transposed); },
      [&](const Matrix<T>& y) { return transposed ? Matrix<T>(matrix_.transpose() * y) : Matrix<T>(matrix_ * y); });
  BlockVector<T> out{Matrix<T>::Zero(free_.size(), columns), Matrix<T>::Zero(model_.multiplier_count, columns)};
  for (int i = 0; i < free; ++i) out.u.row(free_list_[i]) = x.row(i);
  if (unknown_multipliers_) {
    for (int k = 0; k < model_.multiplier_count; ++k) out.l.row(k) = rows.l.row(k) / open_diagonal_[k];
    for (std::size_t a = 0; a < active_.size(); ++a) out.l.row(active_[a]) = x.row(free + a);
  }
  return out;
}

template <class T>
EngineHoldings CondensedEngine<T>::holdings() const {
  EngineHoldings held;
  held.condensed = static_cast<long>(condensation_->schur().size() * sizeof(T));
  held.bodies_factor = condensation_->factor_bytes();
  held.matrix_entries = held.factor_entries = static_cast<long>(matrix_.size());
  held.matrix = static_cast<long>(matrix_.size() * sizeof(T));
  held.factor = factor_.bytes();
  held.body_solves = condensation_->backsolves();
  held.unsymmetric = symmetry_ == Symmetry::general;
  return held;
}

template <class T>
std::string CondensedEngine<T>::name() const {
  const std::string of_bodies = condensation_->name();  // empty where no body has an inside
  return std::string("condensed, dense ") + (symmetry_ == Symmetry::positive_definite ? "LL^T" : "LU") +
         (of_bodies.empty() ? "" : " on " + of_bodies);
}

}  // namespace stickslip
