/// Definitions of the templates in contact_system.hpp.
#pragma once

#include "core/engine/contact_system.hpp"

namespace stickslip {

template <class T>
ContactSystem<T>::ContactSystem(const Model& model, const Slots<T>& slots, bool unknown_multipliers, Symmetry symmetry)
    : model_(model), slots_(slots), unknown_multipliers_(unknown_multipliers), symmetry_(symmetry) {
  const int D = model.dimension;
  for (int node : model.contact_nodes)
    for (int i = 0; i < D; ++i) {
      free_.push_back(model.free_index[node * D + i] >= 0);
      free_place_.push_back(free_.back() ? static_cast<int>(free_list_.size()) : -1);
      if (free_.back()) free_list_.push_back(static_cast<int>(free_.size()) - 1);
    }
}

template <class T>
std::vector<int> ContactSystem<T>::point_rows(std::size_t p, const PointTangent<T>& tangent) const {
  const int D = model_.dimension;
  const auto& point = model_.points[p];
  std::vector<int> rows;
  for (int n : tangent.places.empty() ? point.places : tangent.places)
    for (int i = 0; i < D; ++i) rows.push_back(free_place_[n * D + i]);
  if (unknown_multipliers_)
    for (int c = 0; c < point.components(); ++c) rows.push_back(place_[point.multiplier + c]);
  return rows;
}

template <class T>
bool ContactSystem<T>::factorise(const Matrix<T>& schur, const std::vector<PointTangent<T>>& tangents,
                                 const Vector<double>& hold, long& factorizations) {
  update_.clear();
  const int D = model_.dimension, free = displacements();
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
  for (int j = 0; j < free; ++j)
    for (int i = 0; i < free; ++i) K(i, j) = schur(free_list_[i], free_list_[j]);
  if (hold.size() > 0)
    for (int i = 0; i < free; ++i) K(i, i) += T(hold[free_list_[i] / D]);
  for (std::size_t p = 0; p < tangents.size(); ++p) {
    const auto rows = point_rows(p, tangents[p]);
    auto add = [&](int row, int column, const T& x) {
      if (rows[row] >= 0 && rows[column] >= 0) K(rows[row], rows[column]) += x;
    };
    detail::for_each_framed_entry(model_, slots_, static_cast<int>(p), tangents[p], unknown_multipliers_, add);
  }
  factorised_ = tangents;
  held_ = hold;
  return valid_ = factor_.factorise(K, symmetry_ == Symmetry::positive_definite, factorizations);
}

template <class T>
bool ContactSystem<T>::update(const std::vector<PointTangent<T>>& tangents, const Vector<double>& hold,
                              Counters& counters) {
  if (!valid_ || !detail::same_values(hold, held_)) return false;
  if (unknown_multipliers_)  // the factor has no rows for the multipliers of what was open then
    for (std::size_t p = 0; p < tangents.size(); ++p)
      if (detail::is_open(factorised_[p]) && !detail::same_tangent(factorised_[p], tangents[p])) return false;
  const auto rows = [&](std::size_t p) { return point_rows(p, tangents[p]); };
  const auto solve = [&](const Matrix<T>& b) { return factor_.solve(b); };
  return detail::update_factor<T>(model_, slots_, factorised_, tangents, unknown_multipliers_, rows,
                                  static_cast<Eigen::Index>(free_list_.size() + active_.size()), counters, solve,
                                  update_);
}

template <class T>
void ContactSystem<T>::restore(const FactorRecipe<T>& recipe, const Matrix<T>& schur, long& factorizations) {
  valid_ = false;
  if (recipe.valid) factorise(schur, recipe.tangents, recipe.hold, factorizations);
  update_ = recipe.update;
}

template <class T>
BlockVector<T> ContactSystem<T>::solve(const BlockVector<T>& rows, Solving how) const {
  const bool transposed = how == Solving::transposed;
  const int free = displacements();
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

}  // namespace stickslip
