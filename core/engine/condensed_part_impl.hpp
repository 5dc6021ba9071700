/// Definitions of the templates in condensed_part.hpp.
#pragma once

#include <numeric>

#include "core/engine/condensation_impl.hpp"
#include "core/engine/condensed_part.hpp"

namespace stickslip {

template <class T>
CondensedPart<T>::CondensedPart(const Model& model, const Slots<T>& slots,
                                std::shared_ptr<Condensation<T>> condensation)
    : model_(model),
      slots_(slots),
      condensation_(std::move(condensation)),
      rows_(model),
      own_(model.bodies.size()),
      others_(model.bodies.size()) {
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    auto& elements = is_among(model, b, BodyKind::constant) ? own_[b] : others_[b];
    elements.resize(model.bodies[b].mesh.element_count());
    std::iota(elements.begin(), elements.end(), 0);
  }
}

template <class T>
void CondensedPart<T>::add_stiffness(const Pattern& pattern, std::vector<T>& values) const {
  const auto row = [&](int k) { return rows_.row_of_dof[rows_.contact[k]]; };
  const auto& S = condensation_->schur();
  for (const auto& [first, end] : rows_.blocks)
    for (int j = first; j < end; ++j) {
      if (row(j) < 0) continue;
      int entry = pattern.column_start[row(j)];
      for (int i = first; i < end; ++i) {  // (rows of a column ascend, and those of a block do)
        if (row(i) < 0) continue;
        while (pattern.row[entry] < row(i)) ++entry;
        values[entry] += S(i, j);
      }
    }
}

template <class T>
void CondensedPart<T>::begin(const Vector<T>& u, Vector<T>& external) {
  const int D = model_.dimension;
  Vector<T> rest;
  auto reduced = reduce_loads(*condensation_, model_, slots_, u, external, rest, &own_);
  load_ = reduced.kept;
  reduced_ = std::move(reduced.others);
  largest_external_ = 0;
  for (std::size_t b = 0; b < model_.bodies.size(); ++b) {
    if (!is_among(model_, b, BodyKind::constant)) continue;
    auto own = external.segment(model_.bodies[b].first_node * D, model_.bodies[b].mesh.node_count * D);
    largest_external_ = std::max(largest_external_, largest_nodal_norm(Vector<T>(own), D));
    own.setConstant(T(0));
  }
}

template <class T>
double CondensedPart<T>::force_scale() const {
  return std::max(largest_external_, cancelling_forces * largest_nodal_norm(load_, model_.dimension));
}

template <class T>
void CondensedPart<T>::add_balance(const Vector<T>& u, Vector<T>& rows) const {
  add_stiffness_times(u, rows);
  for (std::size_t k = 0; k < rows_.contact.size(); ++k) rows[rows_.contact[k]] -= load_[static_cast<Eigen::Index>(k)];
}

template <class T>
void CondensedPart<T>::add_stiffness_times(const Vector<T>& u, Vector<T>& rows) const {
  const auto count = static_cast<Eigen::Index>(rows_.contact.size());
  Vector<T> compact(count);
  for (Eigen::Index k = 0; k < count; ++k) compact[k] = u[rows_.contact[k]];
  const Vector<T> forces = condensation_->schur() * compact;
  for (Eigen::Index k = 0; k < count; ++k) rows[rows_.contact[k]] += forces[k];
}

template <class T>
Reduction<T> CondensedPart<T>::reduce(const Matrix<T>& rows) const {
  auto reduced = condensation_->reduce(rows);
  Matrix<T> kept = rows;
  for (int dof : condensation_->interior()) kept.row(dof).setConstant(T(0));
  detail::put_rows(reduced.kept, rows_.contact, kept);
  return {std::move(kept), std::move(reduced.others)};
}

template <class T>
void CondensedPart<T>::expand(Matrix<T>& u, Matrix<T> reduced, const std::vector<int>* wanted) const {
  Matrix<T> compact(static_cast<Eigen::Index>(rows_.contact.size()), u.cols());
  detail::take_rows(u, rows_.contact, compact);
  const Matrix<T> all = condensation_->expand(compact, std::move(reduced), wanted);
  for (Eigen::Index c = 0; c < u.cols(); ++c)
    for (int dof : condensation_->interior()) u(dof, c) = all(dof, c);
}

}  // namespace stickslip
