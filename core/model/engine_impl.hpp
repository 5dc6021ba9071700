/// Definitions of the engines in engine.hpp.
#pragma once

#include "core/model/engine.hpp"

namespace stickslip {

namespace detail {

template <class T>
std::vector<std::vector<int>> element_row_lists(const Model& model) {
  const int D = model.dimension;
  std::vector<std::vector<int>> lists;
  for (const auto& body : model.bodies)
    for (int e = 0; e < body.mesh.element_count(); ++e) {
      std::vector<int> rows;
      for (int node : element_nodes(body, e))
        for (int i = 0; i < D; ++i) rows.push_back(model.free_index[node * D + i]);
      lists.push_back(rows);
    }
  return lists;
}

/// Entry of (row, column) in the pattern. pre: it exists.
inline int locate(const Pattern& pattern, int row, int column) {
  const auto first = pattern.row.begin() + pattern.column_start[column];
  const auto last = pattern.row.begin() + pattern.column_start[column + 1];
  return static_cast<int>(std::lower_bound(first, last, row) - pattern.row.begin());
}

/// Pattern of a sum of dense blocks over lists of rows (-1: not there); every diagonal entry is stored.
inline std::shared_ptr<Pattern> make_pattern(int size, const std::vector<std::vector<int>>& lists) {
  std::vector<std::vector<int>> columns(size);
  for (int i = 0; i < size; ++i) columns[i].push_back(i);
  for (const auto& rows : lists)
    for (int column : rows)
      if (column >= 0)
        for (int row : rows)
          if (row >= 0) columns[column].push_back(row);
  auto pattern = std::make_shared<Pattern>();
  pattern->size = size;
  pattern->column_start.push_back(0);
  for (auto& column : columns) {
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    pattern->row.insert(pattern->row.end(), column.begin(), column.end());
    pattern->column_start.push_back(static_cast<int>(pattern->row.size()));
  }
  return pattern;
}

/// Adds one point's tangent to a matrix through add(row index in rows, column index in rows, value), where rows are
/// the point's displacement rows (node-major) followed by its multiplier rows (if unknown).
template <class T, class Add>
void for_each_entry(const PointGeometry<T>& geometry, const PointTangent<T>& tangent, bool unknown_multipliers,
                    Add&& add) {
  const int D = static_cast<int>(tangent.force_w.rows()), C = static_cast<int>(tangent.row_l.rows());
  const int nodes = static_cast<int>(geometry.weights.size());
  for (int n = 0; n < nodes; ++n)
    for (int i = 0; i < D; ++i) {
      for (int m = 0; m < nodes; ++m)
        for (int j = 0; j < D; ++j)
          add(n * D + i, m * D + j, geometry.weights[n] * geometry.weights[m] * tangent.force_w(i, j));
      if (unknown_multipliers)
        for (int c = 0; c < C; ++c) {
          add(n * D + i, nodes * D + c, geometry.weights[n] * tangent.force_l(i, c));
          add(nodes * D + c, n * D + i, geometry.weights[n] * tangent.row_w(c, i));
        }
    }
  if (unknown_multipliers)
    for (int r = 0; r < C; ++r)
      for (int c = 0; c < C; ++c) add(nodes * D + r, nodes * D + c, tangent.row_l(r, c));
}

/// The same in the frames of the nodes.
template <class T, class Add>
void for_each_framed_entry(const Model& model, const Slots<T>& slots, int p, const PointTangent<T>& tangent,
                           bool unknown_multipliers, Add&& add) {
  const auto& geometry = slots.geometry[p];
  if (model.framed.empty()) return for_each_entry(geometry, tangent, unknown_multipliers, add);
  const auto rows = geometry.weights.size() * model.dimension + (unknown_multipliers ? tangent.row_l.rows() : 0);
  Matrix<T> K = Matrix<T>::Constant(rows, rows, T(0));
  for_each_entry(geometry, tangent, unknown_multipliers, [&](int r, int c, const T& x) { K(r, c) += x; });
  K = into_frames(model, slots.frames, model.points[p].nodes, std::move(K));
  for (int c = 0; c < rows; ++c)
    for (int r = 0; r < rows; ++r) add(r, c, K(r, c));
}

/// for_each_element_tangent of a body, in the frames of the nodes.
template <class T, class Sink>
void for_each_framed_tangent(const Model& model, const Slots<T>& slots, int b, Sink&& sink) {
  for_each_element_tangent(model, slots, b, nullptr, [&](const auto& nodes, const auto& K) {
    if (model.framed.empty())
      sink(nodes, K);
    else
      sink(nodes, into_frames(model, slots.frames, nodes, Matrix<T>(K)));
  });
}

/// Whether a point's multipliers are their own rows alone.
template <class T>
bool is_open(const PointTangent<T>& tangent) {
  return tangent.row_w.cwiseAbs().maxCoeff() == 0;
}

/// Takes tangents as an update of the factor of others. rows(p): rows of the factor of point p's entries.
template <class T, class Rows, class Solve>
bool update_factor(const Model& model, const Slots<T>& slots, const std::vector<PointTangent<T>>& factorised,
                   const std::vector<PointTangent<T>>& tangents, bool unknown_multipliers, Rows&& rows,
                   Eigen::Index size, Counters& counters, Solve&& solve, TangentUpdate& update) {
  if constexpr (std::is_same_v<T, double>) {
    std::vector<TangentUpdate::Change> changes;
    for (std::size_t p = 0; p < tangents.size(); ++p) {
      if (same_tangent(factorised[p], tangents[p])) continue;
      if (changes.size() == TangentUpdate::most) return false;
      TangentUpdate::Change change{static_cast<int>(p), rows(p), {}};
      const auto n = static_cast<Eigen::Index>(change.rows.size());
      change.block = Matrix<double>::Zero(n, n);
      const auto add = [&](double sign) {
        return [&change, sign](int r, int c, double x) { change.block(r, c) += sign * x; };
      };
      for_each_framed_entry(model, slots, change.point, tangents[p], unknown_multipliers, add(1));
      for_each_framed_entry(model, slots, change.point, factorised[p], unknown_multipliers, add(-1));
      changes.push_back(std::move(change));
    }
    return update.take(std::move(changes), size, counters, solve);
  }
  return false;
}

/// The solution with a factor and its update; only in double there are any.
template <class T, class Solve, class Multiply>
Matrix<T> solve_updated(const TangentUpdate& update, const Matrix<T>& b, Solve&& solve, Multiply&& multiply) {
  if constexpr (std::is_same_v<T, double>)
    if (!update.empty()) return update.solve(b, solve, multiply);
  return solve(b);
}

/// Slip couples the normal into the tangential rows, not the other way round; with the radius of the cone fixed while
/// the system is solved (that of known multipliers) nothing couples them.
inline Symmetry symmetry_of(const Model& model, bool unknown_multipliers, ConeRadius cone) {
  const bool fixed_radius = cone == ConeRadius::multiplier && !unknown_multipliers;
  if (model.effects.friction && !fixed_radius) return Symmetry::general;
  return unknown_multipliers ? Symmetry::indefinite : Symmetry::positive_definite;
}

}  // namespace detail

// --- SparseEngine ----------------------------------------------------------------------------------------------------

template <class T>
SparseEngine<T>::SparseEngine(const Model& model, const Slots<T>& slots, bool unknown_multipliers, ConeRadius cone,
                              Backend backend)
    : model_(model),
      slots_(slots),
      unknown_multipliers_(unknown_multipliers),
      symmetry_(detail::symmetry_of(model, unknown_multipliers, cone)),
      size_(static_cast<int>(model.free_dofs.size()) + (unknown_multipliers ? model.multiplier_count : 0)),
      solver_(backend) {
  auto lists = detail::element_row_lists<T>(model);
  const std::size_t elements = lists.size();
  for (const auto& point : model.points) lists.push_back(point_rows(point));
  pattern_ = detail::make_pattern(size_, lists);
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& rows = lists[elements + p];
    std::vector<int> map;
    for (int row : rows)
      for (int column : rows) map.push_back(row < 0 || column < 0 ? -1 : detail::locate(*pattern_, row, column));
    point_map_.push_back(std::move(map));
  }
  bulk_.assign(pattern_->nonzeros(), T(0));
  std::size_t e = 0;
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    detail::for_each_framed_tangent(model, slots, static_cast<int>(b), [&](const auto&, const auto& K) {
      const auto& rows = lists[e++];
      for (std::size_t c = 0; c < rows.size(); ++c)
        for (std::size_t r = 0; r < rows.size(); ++r)
          if (rows[r] >= 0 && rows[c] >= 0) bulk_[detail::locate(*pattern_, rows[r], rows[c])] += K(r, c);
    });
  for (int i = 0; i < static_cast<int>(model.free_dofs.size()); ++i)
    stiffness_ = std::max(stiffness_, value(bulk_[detail::locate(*pattern_, i, i)]));
}

template <class T>
std::vector<int> SparseEngine<T>::point_rows(const ContactPoint& point) const {
  std::vector<int> rows;
  const int D = model_.dimension;
  for (int node : point.nodes)
    for (int i = 0; i < D; ++i) rows.push_back(model_.free_index[node * D + i]);
  if (unknown_multipliers_)
    for (int c = 0; c < point.components(); ++c)
      rows.push_back(static_cast<int>(model_.free_dofs.size()) + point.multiplier + c);
  return rows;
}

template <class T>
Vector<T> SparseEngine<T>::begin(double time, const Vector<T>& displacement) {
  external_ = into_frames(model_, slots_.frames, Layout::all, external_forces(model_, slots_, time));
  Vector<T> u = displacement;
  prescribe(model_, slots_, time, u);
  return into_frames(model_, slots_.frames, Layout::all, std::move(u));
}

template <class T>
Vector<T> SparseEngine<T>::residual(const Vector<T>& u, const Vector<T>& contact, ForceScale& scale) const {
  Vector<T> rows = into_frames(model_, slots_.frames, Layout::all, bulk_forces(model_, slots_, all(u)));
  const int D = model_.dimension;
  scale.force = std::max(
      {scale.force, largest_nodal_norm(rows, D), largest_nodal_norm(external_, D), largest_nodal_norm(contact, D)});
  scale.rounding = unit_roundoff * stiffness_ * largest_nodal_norm(u, D);
  rows -= external_;
  add_compact(model_, into_frames(model_, slots_.frames, Layout::compact, contact), rows);
  return rows;
}

template <class T>
bool SparseEngine<T>::factorise(const std::vector<PointTangent<T>>& tangents, Counters& counters,
                                const Vector<double>& hold) {
  update_.clear();
  const bool same = detail::same_values(hold, held_) && detail::same_tangents(tangents, factorised_);
  if (valid_ && model_.effects.linear_bulk && same) return true;
  values_ = bulk_;
  for (Eigen::Index n = 0; n < hold.size(); ++n)
    for (int i = 0; i < model_.dimension; ++i)
      if (const int row = model_.free_index[model_.contact_nodes[n] * model_.dimension + i]; row >= 0)
        values_[detail::locate(*pattern_, row, row)] += T(hold[n]);
  for (std::size_t p = 0; p < tangents.size(); ++p) {
    const auto& map = point_map_[p];
    const int n = static_cast<int>(std::lround(std::sqrt(static_cast<double>(map.size()))));
    auto add = [&](int row, int column, const T& x) {
      if (const int entry = map[row * n + column]; entry >= 0) values_[entry] += x;
    };
    detail::for_each_framed_entry(model_, slots_, static_cast<int>(p), tangents[p], unknown_multipliers_, add);
  }
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
bool SparseEngine<T>::update(const std::vector<PointTangent<T>>& tangents, Counters& counters,
                             const Vector<double>& hold) {
  if (!valid_ || !model_.effects.linear_bulk || !detail::same_values(hold, held_)) return false;
  const auto rows = [&](std::size_t p) { return point_rows(model_.points[p]); };
  return detail::update_factor<T>(
      model_, slots_, factorised_, tangents, unknown_multipliers_, rows, size_, counters,
      [&](const Matrix<T>& b) { return solver_.solve(b); }, update_);
}

template <class T>
bool SparseEngine<T>::reversed() const {
  const bool odd = unknown_multipliers_ && model_.multiplier_count % 2 == 1;  // each multiplier turns the sign
  return (solver_.determinant_sign() != (odd ? -1 : 1)) != update_.turns_sign();
}

template <class T>
BlockVector<T> SparseEngine<T>::solve(const BlockVector<T>& rows, bool transposed) {
  const int free = static_cast<int>(model_.free_dofs.size());
  Matrix<T> b(size_, rows.u.cols());
  for (int i = 0; i < free; ++i) b.row(i) = rows.u.row(model_.free_dofs[i]);
  if (unknown_multipliers_) b.bottomRows(model_.multiplier_count) = rows.l;
  const auto multiply = [&](const Matrix<T>& x) {
    Matrix<T> product = Matrix<T>::Zero(size_, x.cols());
    for (int j = 0; j < size_; ++j)
      for (int k = pattern_->column_start[j]; k < pattern_->column_start[j + 1]; ++k)
        product.row(pattern_->row[k]) += values_[k] * x.row(j);
    return product;
  };
  const Matrix<T> x = detail::solve_updated<T>(
      update_, b, [&](const Matrix<T>& r) { return solver_.solve(r, transposed); }, multiply);
  BlockVector<T> out{Matrix<T>::Zero(model_.dof_count(), b.cols()), Matrix<T>::Zero(model_.multiplier_count, b.cols())};
  for (int i = 0; i < free; ++i) out.u.row(model_.free_dofs[i]) = x.row(i);
  if (unknown_multipliers_) out.l = x.bottomRows(model_.multiplier_count);
  return out;
}

template <class T>
Matrix<T> SparseEngine<T>::apply_stiffness(const Matrix<T>& u) const {
  Matrix<T> rows = Matrix<T>::Zero(u.rows(), u.cols());
  for (std::size_t j = 0; j < model_.free_dofs.size(); ++j)
    for (int k = pattern_->column_start[j]; k < pattern_->column_start[j + 1]; ++k)
      if (pattern_->row[k] < static_cast<int>(model_.free_dofs.size()))
        rows.row(model_.free_dofs[pattern_->row[k]]) += bulk_[k] * u.row(model_.free_dofs[j]);
  return rows;
}

template <class T>
Matrix<T> SparseEngine<T>::scatter(const Matrix<T>& compact) const {
  Matrix<T> rows = Matrix<T>::Zero(model_.dof_count(), compact.cols());
  const int D = model_.dimension;
  for (std::size_t n = 0; n < model_.contact_nodes.size(); ++n)
    for (int i = 0; i < D; ++i) rows.row(model_.contact_nodes[n] * D + i) += compact.row(n * D + i);
  return rows;
}

// --- Condensation ----------------------------------------------------------------------------------------------------

template <class T>
Condensation<T>::Condensation(const Model& model, const Slots<T>& slots, Backend backend)
    : model_(model), place_(model.dof_count(), -1), solver_(backend) {
  const int D = model.dimension, n = model.dof_count();
  std::vector<int> contact_place(n, -1);
  for (std::size_t i = 0; i < model.contact_nodes.size(); ++i)
    for (int d = 0; d < D; ++d) contact_place[model.contact_nodes[i] * D + d] = static_cast<int>(i) * D + d;
  for (int dof : model.free_dofs)
    if (contact_place[dof] < 0) {
      place_[dof] = static_cast<int>(interior_.size());
      interior_.push_back(dof);
    }
  std::vector<Eigen::Triplet<T>> all;
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    detail::for_each_framed_tangent(model, slots, static_cast<int>(b), [&](const auto& nodes, const auto& K) {
      for (std::size_t i = 0; i < nodes.size() * D; ++i)
        for (std::size_t j = 0; j < nodes.size() * D; ++j)
          all.emplace_back(nodes[i / D] * D + i % D, nodes[j / D] * D + j % D, K(i, j));
    });
  stiffness_.resize(n, n);
  stiffness_.setFromTriplets(all.begin(), all.end());
  const int contacts = static_cast<int>(model.contact_nodes.size()) * D, interior = static_cast<int>(interior_.size());
  std::vector<Eigen::Triplet<T>> coupling, inner;
  schur_ = Matrix<T>::Zero(contacts, contacts);
  for (int column = 0; column < n; ++column)
    for (typename Eigen::SparseMatrix<T>::InnerIterator it(stiffness_, column); it; ++it) {
      const int row = static_cast<int>(it.row());
      if (contact_place[column] >= 0 && contact_place[row] >= 0)
        schur_(contact_place[row], contact_place[column]) = it.value();
      if (place_[row] >= 0 && contact_place[column] >= 0)
        coupling.emplace_back(place_[row], contact_place[column], it.value());
      if (place_[row] >= 0 && place_[column] >= 0) inner.emplace_back(place_[row], place_[column], it.value());
    }
  interior_contact_.resize(interior, contacts);
  interior_contact_.setFromTriplets(coupling.begin(), coupling.end());
  if (interior == 0) return;
  Eigen::SparseMatrix<T> K(interior, interior);
  K.setFromTriplets(inner.begin(), inner.end());
  auto pattern = std::make_shared<Pattern>();
  pattern->size = interior;
  pattern->column_start.assign(K.outerIndexPtr(), K.outerIndexPtr() + interior + 1);
  pattern->row.assign(K.innerIndexPtr(), K.innerIndexPtr() + K.nonZeros());
  solver_.analyse(pattern, Symmetry::positive_definite);
  valid_ = solver_.factorise(K.valuePtr());
  counters.analyses = 1;
  counters.factorizations = solver_.counters().factorizations;
  if (!valid_) return;
  constexpr int block = 64;
  for (int first = 0; first < contacts; first += block) {
    const int count = std::min(block, contacts - first);
    const Matrix<T> columns = interior_contact_.middleCols(first, count);
    schur_.middleCols(first, count) -= interior_contact_.transpose() * solver_.solve(columns);
  }
  schur_ = (T(0.5) * (schur_ + schur_.transpose())).eval();
  counters.backsolves = solver_.counters().backsolves;
}

template <class T>
Matrix<T> Condensation<T>::reduce(const Matrix<T>& rows) {
  const int D = model_.dimension;
  Matrix<T> reduced(static_cast<Eigen::Index>(model_.contact_nodes.size()) * D, rows.cols());
  for (std::size_t n = 0; n < model_.contact_nodes.size(); ++n)
    for (int i = 0; i < D; ++i) reduced.row(n * D + i) = rows.row(model_.contact_nodes[n] * D + i);
  if (interior_.empty()) return reduced;
  Matrix<T> inner(interior_.size(), rows.cols());
  for (std::size_t i = 0; i < interior_.size(); ++i) inner.row(i) = rows.row(interior_[i]);
  if (inner.isZero(0)) return reduced;
  reduced -= interior_contact_.transpose() * solver_.solve(inner);
  return reduced;
}

template <class T>
Matrix<T> Condensation<T>::expand(const Matrix<T>& compact, const Matrix<T>& rows) {
  const int D = model_.dimension;
  Matrix<T> all = Matrix<T>::Zero(model_.dof_count(), compact.cols());
  for (std::size_t n = 0; n < model_.contact_nodes.size(); ++n)
    for (int i = 0; i < D; ++i) all.row(model_.contact_nodes[n] * D + i) = compact.row(n * D + i);
  if (interior_.empty()) return all;
  Matrix<T> inner(interior_.size(), rows.cols());
  for (std::size_t i = 0; i < interior_.size(); ++i) inner.row(i) = rows.row(interior_[i]);
  inner -= interior_contact_ * compact;
  inner = solver_.solve(inner);
  for (std::size_t i = 0; i < interior_.size(); ++i) all.row(interior_[i]) = inner.row(i);
  return all;
}

// --- CondensedEngine -------------------------------------------------------------------------------------------------

template <class T>
CondensedEngine<T>::CondensedEngine(const Model& model, const Slots<T>& slots, bool unknown_multipliers,
                                    ConeRadius cone, std::shared_ptr<Condensation<T>> condensation)
    : model_(model),
      slots_(slots),
      unknown_multipliers_(unknown_multipliers),
      condensation_(std::move(condensation)),
      symmetric_(detail::symmetry_of(model, unknown_multipliers, cone) == Symmetry::positive_definite) {
  const int D = model.dimension;
  for (int node : model.contact_nodes)
    for (int i = 0; i < D; ++i) {
      free_.push_back(model.free_index[node * D + i] >= 0);
      free_place_.push_back(free_.back() ? static_cast<int>(free_list_.size()) : -1);
      if (free_.back()) free_list_.push_back(static_cast<int>(free_.size()) - 1);
    }
}

template <class T>
Vector<T> CondensedEngine<T>::begin(double time, const Vector<T>& displacement) {
  Vector<T> u = displacement;
  prescribe(model_, slots_, time, u);
  u = into_frames(model_, slots_.frames, Layout::all, std::move(u));
  rest_ = Vector<T>::Constant(model_.dof_count(), T(0));
  for (const auto& constraint : model_.constraints) rest_[constraint.dof] = u[constraint.dof];
  for (int node : model_.contact_nodes)
    for (int i = 0; i < model_.dimension; ++i) rest_[node * model_.dimension + i] = T(0);
  rest_rows_ = into_frames(model_, slots_.frames, Layout::all, external_forces(model_, slots_, time)) -
               condensation_->apply_stiffness(rest_);
  load_ = condensation_->reduce(rest_rows_);
  return to_compact(model_, u);
}

template <class T>
Vector<T> CondensedEngine<T>::all(const Vector<T>& u) {
  return out_of_frames(model_, slots_.frames, Layout::all,
                       Vector<T>(rest_ + condensation_->expand(u, rest_rows_).col(0)));
}

template <class T>
Vector<T> CondensedEngine<T>::residual(const Vector<T>& u, const Vector<T>& contact, ForceScale& scale) const {
  const int D = model_.dimension;
  Vector<T> rows = condensation_->schur() * u;
  scale.force = std::max(
      {scale.force, largest_nodal_norm(rows, D), largest_nodal_norm(load_, D), largest_nodal_norm(contact, D)});
  double stiffest = 0;
  for (Eigen::Index i = 0; i < u.size(); ++i) stiffest = std::max(stiffest, value(condensation_->schur()(i, i)));
  scale.rounding = unit_roundoff * stiffest * largest_nodal_norm(u, D);
  rows += into_frames(model_, slots_.frames, Layout::compact, contact) - load_;
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
  ++counters.factorizations;
  factorised_ = tangents;
  held_ = hold;
  cholesky_ = false;
  valid_ = false;
  message_.clear();
  if (!K.allFinite()) {
    message_ = "the tangent is not finite";
    return false;
  }
  if (K.rows() == 0) return valid_ = true;
  if (symmetric_) {
    llt_.compute(K);
    cholesky_ = llt_.info() == Eigen::Success;
    if (!cholesky_) ++counters.factorizations;
  }
  if (!cholesky_) lu_.compute(K);
  // The limit of LinearSolver: beyond a condition of 0.1 / epsilon nothing of a solution is left. A pivot of exactly
  // zero escapes the estimate, which drops what is not a number.
  const bool regular = cholesky_ || lu_.matrixLU().diagonal().cwiseAbs().minCoeff() > 0;
  valid_ = regular && (cholesky_ ? llt_.rcond() : lu_.rcond()) > 10 * std::numeric_limits<double>::epsilon();
  if (!valid_) message_ = "the tangent is singular to working precision";
  return valid_;
}

template <class T>
bool CondensedEngine<T>::update(const std::vector<PointTangent<T>>& tangents, Counters& counters,
                                const Vector<double>& hold) {
  if (!valid_ || !detail::same_values(hold, held_)) return false;
  if (unknown_multipliers_)  // the factor has no rows for the multipliers of what was open then
    for (std::size_t p = 0; p < tangents.size(); ++p)
      if (detail::is_open(factorised_[p]) && !detail::same_tangent(factorised_[p], tangents[p])) return false;
  const auto rows = [&](std::size_t p) { return point_rows(model_.points[p]); };
  const auto solve = [&](const Matrix<T>& b) { return solve_factorised(b, false); };
  return detail::update_factor<T>(model_, slots_, factorised_, tangents, unknown_multipliers_, rows,
                                  static_cast<Eigen::Index>(free_list_.size() + active_.size()), counters, solve,
                                  update_);
}

template <class T>
bool CondensedEngine<T>::reversed() const {
  if (cholesky_ || free_list_.size() + active_.size() == 0) return update_.turns_sign();
  double sign = static_cast<double>(lu_.permutationP().determinant());
  for (Eigen::Index i = 0; i < lu_.matrixLU().rows(); ++i)
    if (value(lu_.matrixLU()(i, i)) < 0) sign = -sign;
  return (sign != (active_.size() % 2 == 1 ? -1 : 1)) != update_.turns_sign();  // each multiplier turns the sign
}

template <class T>
Matrix<T> CondensedEngine<T>::solve_factorised(const Matrix<T>& b, bool transposed) const {
  if (b.rows() == 0) return b;
  if (cholesky_) return llt_.solve(b);
  if (transposed) return lu_.transpose().solve(b);
  return lu_.solve(b);
}

template <class T>
BlockVector<T> CondensedEngine<T>::solve(const BlockVector<T>& rows, bool transposed) {
  const int free = static_cast<int>(free_list_.size());
  const Eigen::Index columns = rows.u.cols();
  Matrix<T> b(free + active_.size(), columns);
  for (int i = 0; i < free; ++i) b.row(i) = rows.u.row(free_list_[i]);
  for (std::size_t a = 0; a < active_.size(); ++a) b.row(free + a) = rows.l.row(active_[a]);
  const Matrix<T> x = detail::solve_updated<T>(
      update_, b, [&](const Matrix<T>& r) { return solve_factorised(r, transposed); },
      [&](const Matrix<T>& y) { return Matrix<T>(matrix_ * y); });
  BlockVector<T> out{Matrix<T>::Zero(free_.size(), columns), Matrix<T>::Zero(model_.multiplier_count, columns)};
  for (int i = 0; i < free; ++i) out.u.row(free_list_[i]) = x.row(i);
  if (unknown_multipliers_) {
    for (int k = 0; k < model_.multiplier_count; ++k) out.l.row(k) = rows.l.row(k) / open_diagonal_[k];
    for (std::size_t a = 0; a < active_.size(); ++a) out.l.row(active_[a]) = x.row(free + a);
  }
  return out;
}

template <class T>
double CondensedEngine<T>::condition_estimate() {
  if (!valid_ || active_.size() + free_list_.size() == 0) return 0;
  return 1 / (cholesky_ ? llt_.rcond() : lu_.rcond());
}

template <class T>
std::string CondensedEngine<T>::name() const {
  const std::string of_bodies = condensation_->name();  // empty where no body has an inside
  return std::string("condensed, dense ") + (symmetric_ ? "LL^T" : "LU") +
         (of_bodies.empty() ? "" : " on " + of_bodies);
}

}  // namespace stickslip
