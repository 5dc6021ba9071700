/// Bodies of constant stiffness among others: those are eliminated once but for their contact dofs, these are in full.
#pragma once

#include <memory>
#include <numeric>

#include "core/engine/condensed_bodies.hpp"
#include "core/engine/full_bodies.hpp"

namespace stickslip {

/// Some bodies condensed, each to a dense block on its contact dofs in the matrix of the others.
template <class T>
class SomeBodiesCondensed : public FullBodies<T> {
 public:
  SomeBodiesCondensed(const Model& model, const Slots<T>& slots, std::shared_ptr<Condensation<T>> condensation)
      : FullBodies<T>(model, slots),
        rows_(model),
        others_(elements_of(model, BodyKind::changing)),
        condensed_(model, slots, std::move(condensation), elements_of(model, BodyKind::constant)) {}

  Vector<T> all(const Vector<T>& u) const override {
    Vector<T> expanded = u;
    put_inside(condensed_.all(compact_of(u)), expanded);
    return this->in_axes(std::move(expanded));
  }
  Reduction<T> reduce(const Matrix<T>& rows) const override {
    auto reduced = condensed_.condensation().reduce(rows);
    Matrix<T> kept = rows;
    for (int dof : condensed_.condensation().interior()) kept.row(dof).setConstant(T(0));
    detail::put_rows(reduced.kept, rows_.contact, kept);
    return {std::move(kept), std::move(reduced.others)};
  }
  Matrix<T> expand(const Matrix<T>& u, Matrix<T> others, const std::vector<int>* wanted) const override {
    Matrix<T> expanded = u;
    put_inside(condensed_.condensation().expand(compact_of(u), std::move(others), wanted), expanded);
    return this->in_axes(std::move(expanded));
  }
  Vector<T> tangent_times(const BodyMotion<T>& at, const Vector<T>& motion) const override {
    Vector<T> rows = this->in_frames(stickslip::tangent_times(model_, slots_, at, motion, Taken::as_is, &others_));
    add_stiffness_times(this->in_frames(motion), rows);
    return this->in_axes(std::move(rows));
  }

  const std::vector<int>& dofs() const override { return rows_.dofs; }
  const std::vector<int>& row_of_dof() const override { return rows_.row_of_dof; }
  RowLists blocks(const std::vector<int>& row_of_dof) const override {
    auto lists = element_rows(model_, row_of_dof, BodyKind::changing);
    rows_.add_blocks(lists);
    return lists;
  }
  std::vector<T> tangent(const BodyMatrix<T>& matrix) const override;

  std::string name() const override {
    return ", bodies of constant stiffness condensed on " + condensed_.condensation().name();
  }
  void add_to_report(EngineReport& report) const override { condensed_.add_to_report(report); }

 private:
  using FullBodies<T>::model_, FullBodies<T>::slots_;

  static ElementLists elements_of(const Model& model, BodyKind kind) {
    ElementLists elements(model.bodies.size());
    for (std::size_t b = 0; b < model.bodies.size(); ++b)
      if (is_among(model, b, kind)) {
        elements[b].resize(model.bodies[b].mesh.element_count());
        std::iota(elements[b].begin(), elements[b].end(), 0);
      }
    return elements;
  }
  template <class V>
  V compact_of(const V& u) const {
    V compact(static_cast<Eigen::Index>(rows_.contact.size()), u.cols());
    detail::take_rows(u, rows_.contact, compact);
    return compact;
  }
  void add_stiffness_times(const Vector<T>& u, Vector<T>& rows) const {
    const Vector<T> forces = condensed_.schur() * compact_of(u);
    for (std::size_t k = 0; k < rows_.contact.size(); ++k)
      rows[rows_.contact[k]] += forces[static_cast<Eigen::Index>(k)];
  }
  template <class From, class To>
  void put_inside(const From& all, To& u) const {
    for (Eigen::Index c = 0; c < u.cols(); ++c)
      for (int dof : condensed_.condensation().interior()) u(dof, c) = all(dof, c);
  }

  Vector<T> forces(const Vector<T>& moved) const override {
    Vector<T> rows = this->forces_of(moved, &others_);
    add_stiffness_times(this->in_frames(moved), rows);
    for (std::size_t k = 0; k < rows_.contact.size(); ++k)
      rows[rows_.contact[k]] -= condensed_.load()[static_cast<Eigen::Index>(k)];
    return rows;
  }
  void take_condensed_loads(const Vector<T>& u, Vector<T>& external) override { condensed_.begin(u, external); }
  double condensed_force() const override { return condensed_.force(0); }

  MixedRows rows_;
  ElementLists others_;  ///< elements of the bodies that are not condensed
  CondensedBodies<T> condensed_;
};

template <class T>
std::vector<T> SomeBodiesCondensed<T>::tangent(const BodyMatrix<T>& matrix) const {
  auto values = this->tangent_of(matrix, BodyKind::changing);
  const auto row = [&](int k) { return matrix.row_of_dof[rows_.contact[k]]; };
  const auto& S = condensed_.schur();
  for (const auto& [first, end] : rows_.blocks)
    for (int j = first; j < end; ++j) {
      if (row(j) < 0) continue;
      int entry = matrix.pattern->column_start[row(j)];
      for (int i = first; i < end; ++i) {  // (rows of a column ascend, and those of a block do)
        if (row(i) < 0) continue;
        while (matrix.pattern->row[entry] < row(i)) ++entry;
        values[entry] += S(i, j);
      }
    }
  return values;
}

}  // namespace stickslip
