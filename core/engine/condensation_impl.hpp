/// Definitions of the templates in condensation.hpp.
#pragma once

#include <algorithm>

#include "core/engine/body_matrix.hpp"
#include "core/engine/condensation.hpp"

namespace stickslip {
namespace detail {

/// The diagonal of the contact dofs. Where an entry is zero, as of a node that bars hold along one direction alone, any
/// positive number will do.
template <class T>
Vector<double> shift_of(const Pattern& pattern, const std::vector<T>& values, int interior) {
  Vector<double> shift(pattern.size - interior);
  for (int k = interior; k < pattern.size; ++k) shift[k - interior] = value(values[locate(pattern, k, k)]);
  const double largest = shift.size() > 0 ? shift.maxCoeff() : 0;
  return shift.unaryExpr([&](double k) { return k > 0 ? k : largest > 0 ? largest : 1.0; });
}

/// Rows of a matrix that stand at `dofs`, and back. (Eigen's own views copy the list.)
template <class From, class To>
void take_rows(const From& rows, const std::vector<int>& dofs, To&& out) {
  for (Eigen::Index c = 0; c < out.cols(); ++c)
    for (std::size_t k = 0; k < dofs.size(); ++k) out(static_cast<Eigen::Index>(k), c) = rows(dofs[k], c);
}
template <class From, class To>
void put_rows(const From& rows, const std::vector<int>& dofs, To& all) {
  for (Eigen::Index c = 0; c < rows.cols(); ++c)
    for (std::size_t k = 0; k < dofs.size(); ++k) all(dofs[k], c) = rows(static_cast<Eigen::Index>(k), c);
}

}  // namespace detail

template <class T>
Condensation<T>::Condensation(const Model& model, Backend backend)
    : model_(model), rows_(with_contact_last(model)), solver_(backend) {
  if (!rows_.interior.empty())
    solver_.analyse(rows_.pattern, Symmetry::positive_definite, static_cast<int>(rows_.contact.size()));
  counters.analyses = solver_.counters().analyses;
}

template <class T>
bool Condensation<T>::factorise(const Slots<T>& slots) {
  const Pattern& pattern = *rows_.pattern;
  const int interior = static_cast<int>(rows_.interior.size()), contacts = static_cast<int>(rows_.contact.size());
  auto values = assemble_bodies<T>(model_, slots, rows_.lists, pattern, nullptr, BodyKind::constant);
  rows_.lists = {};
  if (interior == 0) {
    schur_ = Matrix<T>::Zero(contacts, contacts);
    for (int j = 0; j < contacts; ++j)
      for (int e = pattern.column_start[j]; e < pattern.column_start[j + 1]; ++e) schur_(pattern.row[e], j) = values[e];
    return valid_ = true;
  }
  const Vector<double> shift = detail::shift_of(pattern, values, interior);
  for (int k = 0; k < contacts; ++k) values[locate(pattern, interior + k, interior + k)] += shift[k];
  valid_ = solver_.factorise(values.data());
  if (valid_) schur_ = solver_.schur_complement();
  counters.analyses = solver_.counters().analyses;
  counters.factorizations = solver_.counters().factorizations;
  counters.backsolves = solver_.counters().backsolves;
  if (!valid_) return false;
  schur_.diagonal() -= shift.template cast<T>();
  schur_ = (T(0.5) * (schur_ + schur_.transpose())).eval();
  return true;
}

template <class T>
Reduction<T> Condensation<T>::reduce(const Matrix<T>& rows) {
  const auto interior = static_cast<Eigen::Index>(rows_.interior.size());
  const auto contacts = static_cast<Eigen::Index>(rows_.contact.size());
  std::vector<Eigen::Index> inside;  // columns with something to reduce: many a parameter does not touch the bodies
  for (Eigen::Index c = 0; c < rows.cols(); ++c)
    if (std::any_of(rows_.interior.begin(), rows_.interior.end(), [&](int dof) { return rows(dof, c) != T(0); }))
      inside.push_back(c);
  Reduction<T> solved;
  if (!inside.empty()) {
    Matrix<T> b(interior + contacts, inside.size());
    for (std::size_t k = 0; k < inside.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      detail::take_rows(rows.col(inside[k]), rows_.interior, b.block(0, column, interior, 1));
      detail::take_rows(rows.col(inside[k]), rows_.contact, b.block(interior, column, contacts, 1));
    }
    solved = solver_.reduce(b);
    if (b.cols() == rows.cols()) return solved;
  }
  Reduction<T> reduced{Matrix<T>(contacts, rows.cols()),
                       Matrix<T>::Zero(interior > 0 ? interior + contacts : 0, rows.cols())};
  detail::take_rows(rows, rows_.contact, reduced.kept);
  if (inside.empty()) return reduced;
  reduced.kept(Eigen::all, inside) = solved.kept;
  reduced.others(Eigen::all, inside) = solved.others;
  return reduced;
}

template <class T>
Matrix<T> Condensation<T>::expand(const Matrix<T>& compact, Matrix<T> others, const std::vector<int>* wanted) {
  Matrix<T> all = Matrix<T>::Zero(model_.dof_count(), compact.cols());
  detail::put_rows(compact, rows_.contact, all);
  if (rows_.interior.empty()) return all;
  std::vector<int> inside;
  for (std::size_t k = 0; wanted && k < rows_.interior.size(); ++k)
    if (std::binary_search(wanted->begin(), wanted->end(), rows_.interior[k])) inside.push_back(static_cast<int>(k));
  const Matrix<T> expanded = solver_.expand(compact, std::move(others), wanted ? &inside : nullptr);
  detail::put_rows(expanded, rows_.interior, all);
  return all;
}

}  // namespace stickslip
