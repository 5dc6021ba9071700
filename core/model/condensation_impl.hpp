/// Definitions of the templates in condensation.hpp.
#pragma once

#include <algorithm>

#include "core/model/body_matrix.hpp"
#include "core/model/condensation.hpp"

namespace stickslip {
namespace detail {

/// The diagonal of the contact dofs; where there is none, as of a node that bars hold along one direction alone, any
/// positive number will do.
template <class T>
Vector<double> shift_of(const Pattern& pattern, const std::vector<T>& values, int interior) {
  Vector<double> shift(pattern.size - interior);
  for (int k = interior; k < pattern.size; ++k) shift[k - interior] = value(values[locate(pattern, k, k)]);
  const double largest = shift.size() > 0 ? shift.maxCoeff() : 0;
  return shift.unaryExpr([&](double k) { return k > 0 ? k : largest > 0 ? largest : 1.0; });
}

}  // namespace detail

template <class T>
Condensation<T>::Condensation(const Model& model, const Slots<T>& slots, Backend backend)
    : model_(model), contacts_(static_cast<int>(model.contact_nodes.size()) * model.dimension), solver_(backend) {
  const int D = model.dimension;
  std::vector<int> row(model.dof_count(), -1);
  for (std::size_t i = 0; i < model.contact_nodes.size(); ++i)
    for (int d = 0; d < D; ++d) row[model.contact_nodes[i] * D + d] = static_cast<int>(i) * D + d;
  for (int dof : model.free_dofs)
    if (row[dof] < 0) interior_.push_back(dof);
  const int interior = static_cast<int>(interior_.size());
  for (int& place : row)
    if (place >= 0) place += interior;
  for (int i = 0; i < interior; ++i) row[interior_[i]] = i;

  const auto lists = element_rows(model, row);
  const auto pattern = make_pattern(interior + contacts_, lists);
  auto values = assemble_bodies<T>(model, slots, lists, *pattern);
  if (interior == 0) {
    schur_ = Matrix<T>::Zero(contacts_, contacts_);
    for (int j = 0; j < contacts_; ++j)
      for (int e = pattern->column_start[j]; e < pattern->column_start[j + 1]; ++e)
        schur_(pattern->row[e], j) = values[e];
    return;
  }
  shift_ = detail::shift_of(*pattern, values, interior);
  for (int k = 0; k < contacts_; ++k) values[locate(*pattern, interior + k, interior + k)] += shift_[k];
  solver_.analyse(pattern, Symmetry::positive_definite, contacts_);
  valid_ = solver_.factorise(values.data());
  if (valid_) schur_ = solver_.schur_complement();
  counters.analyses = solver_.counters().analyses;
  counters.factorizations = solver_.counters().factorizations;
  counters.backsolves = solver_.counters().backsolves;
  if (!valid_) return;
  schur_.diagonal() -= shift_.template cast<T>();
  schur_ = (T(0.5) * (schur_ + schur_.transpose())).eval();
}

template <class T>
Matrix<T> Condensation<T>::contact_rows(const Matrix<T>& rows) const {
  const int D = model_.dimension;
  Matrix<T> compact(contacts_, rows.cols());
  for (std::size_t n = 0; n < model_.contact_nodes.size(); ++n)
    compact.middleRows(n * D, D) = rows.middleRows(model_.contact_nodes[n] * D, D);
  return compact;
}

template <class T>
Matrix<T> Condensation<T>::solve(const Matrix<T>& rows, const Matrix<T>& last) {
  const auto interior = static_cast<Eigen::Index>(interior_.size());
  Matrix<T> b(interior + contacts_, rows.cols());
  for (Eigen::Index i = 0; i < interior; ++i) b.row(i) = rows.row(interior_[i]);
  b.bottomRows(contacts_) = last;
  return solver_.solve(b);
}

template <class T>
Matrix<T> Condensation<T>::reduce(const Matrix<T>& rows) {
  Matrix<T> reduced = contact_rows(rows);
  std::vector<Eigen::Index> inside;  // columns with something to reduce: many a parameter does not touch the bodies
  for (Eigen::Index c = 0; c < rows.cols(); ++c)
    if (std::any_of(interior_.begin(), interior_.end(), [&](int dof) { return rows(dof, c) != T(0); }))
      inside.push_back(c);
  if (inside.empty()) return reduced;
  Matrix<T> picked(rows.rows(), inside.size());
  for (std::size_t k = 0; k < inside.size(); ++k) picked.col(k) = rows.col(inside[k]);
  const Matrix<T> x = solve(picked, Matrix<T>::Zero(contacts_, picked.cols())).bottomRows(contacts_);
  const Matrix<T> moved = schur_ * x + shift_.template cast<T>().asDiagonal() * x;
  for (std::size_t k = 0; k < inside.size(); ++k) reduced.col(inside[k]) += moved.col(k);
  return reduced;
}

template <class T>
Matrix<T> Condensation<T>::expand(const Matrix<T>& compact, const Matrix<T>& rows, const Matrix<T>& reduced) {
  const int D = model_.dimension;
  Matrix<T> all = Matrix<T>::Zero(model_.dof_count(), compact.cols());
  for (std::size_t n = 0; n < model_.contact_nodes.size(); ++n)
    all.middleRows(model_.contact_nodes[n] * D, D) = compact.middleRows(n * D, D);
  if (interior_.empty()) return all;
  const Matrix<T> last =
      schur_ * compact + shift_.template cast<T>().asDiagonal() * compact + contact_rows(rows) - reduced;
  const Matrix<T> x = solve(rows, last);
  for (std::size_t i = 0; i < interior_.size(); ++i) all.row(interior_[i]) = x.row(i);
  return all;
}

}  // namespace stickslip
