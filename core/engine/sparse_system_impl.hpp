/// Definitions of the templates in sparse_system.hpp.
#pragma once

#include "core/engine/sparse_system.hpp"

namespace stickslip {
namespace detail {

/// Rows of a point's nodes, node-major, then of its multipliers, of which `first_multiplier` is the first row of all;
/// -1: they are not unknowns.
std::vector<int> rows_of_point(const Model& model, const std::vector<int>& row_of_dof, const std::vector<int>& nodes,
                               const ContactPoint& point, int first_multiplier);
/// Entry of each (row, column) pair; -1: of a row that is not there.
std::vector<int> entries_of(const Pattern& pattern, const std::vector<int>& rows);

}  // namespace detail

template <class T>
std::vector<int> SparseSystem<T>::rows_of(std::size_t p, const std::vector<int>& places) const {
  std::vector<int> nodes;
  for (int place : places) nodes.push_back(model_.contact_nodes[place]);
  const int displacements = static_cast<int>(dofs_.size());
  return detail::rows_of_point(model_, row_of_dof_, nodes, model_.points[p], unknown_multipliers_ ? displacements : -1);
}

template <class T>
typename SparseSystem<T>::Places SparseSystem<T>::places_at_start() const {
  Places places;
  for (const auto& point : model_.points) places.push_back(point.places);
  return places;
}

template <class T>
RowLists SparseSystem<T>::lay_out(RowLists lists, const Places& places) {
  point_map_.clear();
  for (std::size_t p = 0; p < places.size(); ++p) lists.add(rows_of(p, places[p]));
  pattern_ = make_pattern(size_, lists);
  for (std::size_t p = 0; p < places.size() && !model_.slides_along_curves(); ++p)
    point_map_.push_back(detail::entries_of(*pattern_, rows_of(p, places[p])));
  if (model_.slides_along_curves()) places_ = places;
  analysed_ = false;
  return lists;
}

template <class T>
std::vector<int> SparseSystem<T>::places_around(std::size_t p, const PointTangent<T>& tangent) const {
  std::vector<int> places = tangent.places;
  std::sort(places.begin(), places.end());
  if (model_.points[p].curve < 0) return places;
  const auto& curve = model_.curves[model_.points[p].curve];
  const auto add = [&](const Patch& patch) {
    for (int vertex : patch.vertices)
      if (vertex != Patch::none) places.push_back(curve.places[vertex]);
  };
  const auto is_faced = [&](const Patch& patch) {
    const auto holds = [&](int vertex) {
      return std::find(tangent.places.begin(), tangent.places.end(), curve.places[vertex]) != tangent.places.end();
    };
    return holds(patch.vertices[1]) || holds(patch.vertices[2]);
  };
  if (curve.obstacle < 0 && tangent.places.size() > 1)
    for (const auto& patch : curve.patches)
      if (is_faced(patch)) add(patch);
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

template <class T>
std::optional<typename SparseSystem<T>::Places> SparseSystem<T>::places_for(
    const std::vector<PointTangent<T>>& tangents) const {
  if (!model_.slides_along_curves()) return std::nullopt;
  const auto has_room = [&](std::size_t p) {
    return std::all_of(tangents[p].places.begin(), tangents[p].places.end(),
                       [&](int place) { return std::binary_search(places_[p].begin(), places_[p].end(), place); });
  };
  bool enough = true;
  for (std::size_t p = 0; p < tangents.size() && enough; ++p) enough = has_room(p);
  if (enough) return std::nullopt;
  Places places = places_;
  for (std::size_t p = 0; p < tangents.size(); ++p)
    if (!tangents[p].places.empty()) places[p] = places_around(p, tangents[p]);
  return places;
}

template <class T>
void SparseSystem<T>::add_points(const std::vector<PointTangent<T>>& tangents) {
  const bool along_curves = model_.slides_along_curves();
  for (std::size_t p = 0; p < tangents.size(); ++p) {
    const bool moves = !tangents[p].places.empty();
    const auto own =
        along_curves ? detail::entries_of(*pattern_, rows_of(p, moves ? tangents[p].places : model_.points[p].places))
                     : std::vector<int>();
    const auto& map = along_curves ? own : point_map_[p];
    const int n = static_cast<int>(std::lround(std::sqrt(static_cast<double>(map.size()))));
    auto add = [&](int row, int column, const T& x) {
      if (const int entry = map[row * n + column]; entry >= 0) values_[entry] += x;
    };
    detail::for_each_framed_entry(model_, slots_, static_cast<int>(p), tangents[p], unknown_multipliers_, add);
  }
}

template <class T>
bool SparseSystem<T>::factorise(const std::vector<T>& bodies, const std::vector<PointTangent<T>>& tangents,
                                const Vector<double>& hold, Counters& counters) {
  update_.clear();
  values_ = bodies;
  for (Eigen::Index n = 0; n < hold.size(); ++n)
    for (int i = 0; i < model_.dimension; ++i)
      if (const int row = row_of_dof_[model_.contact_nodes[n] * model_.dimension + i]; row >= 0)
        values_[locate(*pattern_, row, row)] += T(hold[n]);
  add_points(tangents);
  ++counters.assemblies;
  if (!analysed_) {
    solver_.analyse(pattern_, symmetry_);
    ++counters.analyses;
    analysed_ = true;
  }
  const long before = solver_.counters().factorizations;
  valid_ = solver_.factorise(values_.data());
  counters.factorizations += solver_.counters().factorizations - before;
  factorised_ = tangents;
  held_ = hold;
  return valid_;
}

template <class T>
bool SparseSystem<T>::update(const std::vector<PointTangent<T>>& tangents, const Vector<double>& hold,
                             Counters& counters) {
  if (!valid_ || !detail::same_values(hold, held_)) return false;
  const auto rows = [&](std::size_t p) { return rows_of(p, model_.points[p].places); };
  return detail::update_factor<T>(
      model_, slots_, factorised_, tangents, unknown_multipliers_, rows, size_, counters,
      [&](const Matrix<T>& b) { return solver_.solve(b); }, update_);
}

template <class T>
void SparseSystem<T>::restore(const FactorRecipe<T>& recipe, const std::vector<T>& bodies, Counters& counters) {
  valid_ = false;
  if (recipe.valid) factorise(bodies, recipe.tangents, recipe.hold, counters);
  update_ = recipe.update;
}

template <class T>
bool SparseSystem<T>::reversed() const {
  const bool odd = unknown_multipliers_ && model_.multiplier_count % 2 == 1;  // each multiplier turns the sign
  return (solver_.determinant_sign() != (odd ? -1 : 1)) != update_.turns_sign();
}

template <class T>
BlockVector<T> SparseSystem<T>::solve(const BlockVector<T>& rows, Solving how) {
  const bool transposed = how == Solving::transposed;
  const int free = static_cast<int>(dofs_.size());
  Matrix<T> b(size_, rows.u.cols());
  for (int i = 0; i < free; ++i) b.row(i) = rows.u.row(dofs_[i]);
  if (unknown_multipliers_) b.bottomRows(model_.multiplier_count) = rows.l;
  const auto multiply = [&](const Matrix<T>& x) {
    Matrix<T> product = Matrix<T>::Zero(size_, x.cols());
    for (int j = 0; j < size_; ++j)
      for (int k = pattern_->column_start[j]; k < pattern_->column_start[j + 1]; ++k)
        product.row(transposed ? j : pattern_->row[k]) += values_[k] * x.row(transposed ? pattern_->row[k] : j);
    return product;
  };
  const Matrix<T> x = detail::solve_updated<T>(
      update_, b, how, [&](const Matrix<T>& r) { return solver_.solve(r, transposed); }, multiply);
  BlockVector<T> out{Matrix<T>::Zero(model_.dof_count(), b.cols()), Matrix<T>::Zero(model_.multiplier_count, b.cols())};
  for (int i = 0; i < free; ++i) out.u.row(dofs_[i]) = x.row(i);
  if (unknown_multipliers_) out.l = x.bottomRows(model_.multiplier_count);
  return out;
}

template <class T>
void SparseSystem<T>::add_holdings(EngineHoldings& held) const {
  held.matrix = static_cast<long>(values_.size() * sizeof(T)) + pattern_->bytes();
  for (const auto& map : point_map_) held.matrix += static_cast<long>(map.size() * sizeof(int));
  held.factor = solver_.factor_bytes();
  held.matrix_entries = static_cast<long>(pattern_->nonzeros());
  held.factor_entries = solver_.factor_nonzeros();
}

}  // namespace stickslip
