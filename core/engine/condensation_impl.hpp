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
bool SchurFactor<T>::factorise(std::vector<T> values) {
  const int others = pattern->size - kept;
  shift = detail::shift_of(*pattern, values, others);
  for (int k = 0; k < kept; ++k) values[locate(*pattern, others + k, others + k)] += shift[k];
  return solver.factorise(values.data());
}

template <class T>
Matrix<T> SchurFactor<T>::schur() {
  Matrix<T> S = solver.schur_complement();
  S.diagonal() -= shift.template cast<T>();
  return T(0.5) * (S + S.transpose());
}

template <class T>
Condensation<T>::Condensation(const Model& model, Backend backend)
    : model_(model), rows_(constant_bodies(model)), factor_{LinearSolver<T>(backend)} {
  factor_.kept = static_cast<int>(rows_.contact.size());
  if (!rows_.interior.empty()) factor_.solver.analyse(rows_.pattern, Symmetry::positive_definite, factor_.kept);
  counters.analyses = factor_.solver.counters().analyses;
}

template <class T>
bool Condensation<T>::factorise(const Slots<T>& slots) {
  const Pattern& pattern = *rows_.pattern;
  const int contacts = static_cast<int>(rows_.contact.size());
  auto values = assemble_bodies<T>(model_, slots, rows_.lists, pattern, nullptr, BodyKind::constant);
  rows_.lists = {};
  rows_.row_of_dof = std::vector<int>();
  if (rows_.interior.empty()) {
    schur_ = Matrix<T>::Zero(contacts, contacts);
    for (int j = 0; j < contacts; ++j)
      for (int e = pattern.column_start[j]; e < pattern.column_start[j + 1]; ++e) schur_(pattern.row[e], j) = values[e];
    return valid_ = true;
  }
  factor_.pattern = rows_.pattern;
  valid_ = factor_.factorise(std::move(values));
  if (valid_) schur_ = factor_.schur();
  counters.analyses = factor_.solver.counters().analyses;
  counters.factorizations = factor_.solver.counters().factorizations;
  counters.backsolves = factor_.solver.counters().backsolves;
  return valid_;
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
    solved = factor_.solver.reduce(b);
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
  const Matrix<T> expanded = factor_.solver.expand(compact, std::move(others), wanted ? &inside : nullptr);
  detail::put_rows(expanded, rows_.interior, all);
  return all;
}

}  // namespace stickslip
