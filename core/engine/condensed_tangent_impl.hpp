/// Definitions of the templates in condensed_tangent.hpp.
#pragma once

#include <algorithm>
#include <utility>

#include "core/engine/condensation_impl.hpp"
#include "core/engine/condensed_tangent.hpp"
#include "core/engine/contact_system_impl.hpp"

namespace stickslip {

template <class T>
CondensedTangent<T>::CondensedTangent(const Model& model, const Slots<T>& slots, bool unknown_multipliers,
                                      Symmetry symmetry, Backend backend)
    : model_(model), rows_(model), solver_(backend), system_(model, slots, unknown_multipliers, symmetry) {
  solver_.analyse(rows_.pattern, Symmetry::positive_definite, rows_.kept);
  const auto contacts = static_cast<Eigen::Index>(model.contact_nodes.size()) * model.dimension;
  for (Eigen::Index c = 0; c < contacts; ++c)
    if (system_.is_free(c)) kept_.push_back(static_cast<int>(c));
  schur_ = Matrix<T>::Zero(contacts, contacts);
  const auto touched = touched_by(std::vector<PointTangent<T>>(model.points.size()), {});
  dense_rows_ = unknown_multipliers ? model.multiplier_count : 0;
  for (int row : kept_) dense_rows_ += touched[row];
}

template <class T>
std::vector<char> CondensedTangent<T>::touched_by(const std::vector<PointTangent<T>>& tangents,
                                                  const Vector<double>& hold) const {
  const int D = model_.dimension;
  std::vector<char> touched(schur_.rows(), hold.size() > 0);
  for (std::size_t p = 0; p < tangents.size(); ++p)
    for (int place : tangents[p].places.empty() ? model_.points[p].places : tangents[p].places)
      std::fill_n(touched.begin() + place * D, D, 1);
  return touched;
}

template <class T>
bool CondensedTangent<T>::condense(const std::vector<T>& bodies, Counters& counters) {
  if (!std::exchange(analysis_counted_, true)) ++counters.analyses;
  const int inside = rows_.pattern->size - rows_.kept;
  std::vector<T> values = bodies;
  const Vector<double> shift = detail::shift_of(*rows_.pattern, values, inside);
  for (int k = 0; k < rows_.kept; ++k) values[locate(*rows_.pattern, inside + k, inside + k)] += shift[k];
  const auto before = solver_.counters();
  const bool valid = solver_.factorise(values.data());
  counters.factorizations += solver_.counters().factorizations - before.factorizations;
  if (!valid || solver_.counters().fallbacks > before.fallbacks) return false;
  Matrix<T> S = solver_.schur_complement();
  S.diagonal() -= shift.template cast<T>();
  for (int j = 0; j < rows_.kept; ++j)
    for (int i = 0; i < rows_.kept; ++i) schur_(kept_[i], kept_[j]) = T(0.5) * (S(i, j) + S(j, i));
  eliminated_ = false;
  return true;
}

template <class T>
void CondensedTangent<T>::eliminate_all_but(const std::vector<char>& touched) {
  untouched_.eliminate(schur_, kept_, touched);
  system_.take_rows(untouched_.touched());
  eliminated_ = true;
}

template <class T>
void CondensedTangent<T>::touch(const std::vector<int>& rows) {
  std::vector<char> touched(schur_.rows(), false);
  for (int row : rows) touched[row] = true;
  eliminate_all_but(touched);
}

template <class T>
bool CondensedTangent<T>::factorise(const std::vector<PointTangent<T>>& tangents, const Vector<double>& hold) {
  long dense = 0;  // (the bodies' factor is the one that counts)
  auto touched = touched_by(tangents, hold);
  if (!eliminated_ || !untouched_.has(touched)) {
    if (eliminated_)  // points go on: what they touched they may touch again
      for (int row : untouched_.touched()) touched[row] = 1;
    eliminate_all_but(touched);
  }
  return system_.factorise(untouched_.reduced(), tangents, hold, dense);
}

template <class T>
BlockVector<T> CondensedTangent<T>::solve(const BlockVector<T>& rows, Solving how) {
  const Eigen::Index columns = rows.u.cols();
  Matrix<T> b(rows_.pattern->size, columns);
  detail::take_rows(rows.u, rows_.dofs, b);
  auto reduced = solver_.reduce(b);
  Matrix<T> contact = Matrix<T>::Zero(schur_.rows(), columns);
  detail::put_rows(reduced.kept, kept_, contact);
  auto solved = system_.solve({untouched_.reduce(contact), rows.l}, how);
  untouched_.expand(contact, solved.u);
  Matrix<T> kept(rows_.kept, columns);
  detail::take_rows(solved.u, kept_, kept);
  Matrix<T> x(rows_.pattern->size, columns);
  x.topRows(x.rows() - rows_.kept) = solver_.expand(kept, std::move(reduced.others));
  x.bottomRows(rows_.kept) = kept;
  BlockVector<T> out{Matrix<T>::Zero(model_.dof_count(), columns), solved.l};
  detail::put_rows(x, rows_.dofs, out.u);
  return out;
}

template <class T>
double CondensedTangent<T>::condition_estimate() {
  return std::max(solver_.condition_estimate(), system_.condition_estimate());
}

template <class T>
std::string CondensedTangent<T>::name() const {
  return "tangents condensed by " + solver_.name() + ", dense " +
         (system_.symmetry() == Symmetry::positive_definite ? "LL^T" : "LU");
}

template <class T>
void CondensedTangent<T>::add_holdings(EngineHoldings& held) const {
  held.condensed = static_cast<long>(schur_.size() * sizeof(T)) + untouched_.bytes();
  held.matrix = static_cast<long>(system_.entries() * sizeof(T)) + rows_.pattern->bytes();
  held.matrix_entries = static_cast<long>(rows_.pattern->nonzeros());
  held.factor = solver_.factor_bytes() + system_.factor_bytes();
  held.factor_entries = solver_.factor_nonzeros();
}

}  // namespace stickslip
