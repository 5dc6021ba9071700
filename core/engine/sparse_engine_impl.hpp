/// Definitions of the templates in sparse_engine.hpp.
#pragma once

#include "core/engine/condensed_part_impl.hpp"
#include "core/engine/condensed_tangent_impl.hpp"
#include "core/engine/sparse_engine.hpp"

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
SparseEngine<T>::SparseEngine(const Model& model, const Slots<T>& slots, bool unknown_multipliers, ConeRadius cone,
                              Backend backend, std::shared_ptr<Condensation<T>> condensation,
                              std::shared_ptr<CondensedTangent<T>> tangent)
    : model_(model),
      slots_(slots),
      unknown_multipliers_(unknown_multipliers),
      tangent_(std::move(tangent)),
      condenses_(tangent_ != nullptr),
      symmetry_(detail::symmetry_of(model, unknown_multipliers, cone)),
      solver_(backend) {
  if (condensation) part_.emplace(model, slots, std::move(condensation));
  size_ = static_cast<int>(dofs().size()) + (unknown_multipliers ? model.multiplier_count : 0);
  lay_out(places_at_start());
  for (int i = 0; i < static_cast<int>(dofs().size()); ++i)
    stiffness_ = std::max(stiffness_, value(bulk_[locate(*pattern_, i, i)]));
}

template <class T>
std::vector<int> SparseEngine<T>::rows_of(std::size_t p, const std::vector<int>& places) const {
  std::vector<int> nodes;
  for (int place : places) nodes.push_back(model_.contact_nodes[place]);
  const int displacements = static_cast<int>(dofs().size());
  return detail::rows_of_point(model_, row_of_dof(), nodes, model_.points[p],
                               unknown_multipliers_ ? displacements : -1);
}

template <class T>
std::vector<std::vector<int>> SparseEngine<T>::places_at_start() const {
  std::vector<std::vector<int>> places;
  for (const auto& point : model_.points) places.push_back(point.places);
  return places;
}

template <class T>
void SparseEngine<T>::lay_out(const std::vector<std::vector<int>>& places) {
  auto lists = element_rows(model_, row_of_dof(), part_ ? BodyKind::changing : BodyKind::all);
  point_map_.clear();
  if (condenses_) {
    pattern_ = tangent_->rows().pattern;
  } else {
    if (part_) part_->rows().add_blocks(lists);
    for (std::size_t p = 0; p < places.size(); ++p) lists.add(rows_of(p, places[p]));
    pattern_ = make_pattern(size_, lists);
    for (std::size_t p = 0; p < places.size() && !model_.slides_along_curves(); ++p)
      point_map_.push_back(detail::entries_of(*pattern_, rows_of(p, places[p])));
  }
  if (linearised_) {
    const BodyMotion<T> at{linearised_->displacement, linearised_->last_memory, linearised_->time,
                           &linearised_->branches};
    assemble(lists, &at);
  } else {
    assemble(lists, nullptr);
  }
  if (model_.slides_along_curves()) places_ = places;
  if (!model_.effects.linear_bulk) lists_ = std::move(lists);
  analysed_ = false;
}

template <class T>
void SparseEngine<T>::assemble(const RowLists& lists, const BodyMotion<T>* at) {
  bulk_ = assemble_bodies<T>(model_, slots_, lists, *pattern_, at, part_ ? BodyKind::changing : BodyKind::all);
  if (part_) part_->add_stiffness(*pattern_, bulk_);
  if (!at || model_.followers.empty()) return;
  for_each_follower_tangent(model_, slots_, *at, [&](const std::vector<int>& nodes, const Matrix<T>& K) {
    const Matrix<T> framed = into_frames(model_, slots_.frames, nodes, K);
    const auto row_of = [&](Eigen::Index k) { return row_of_dof()[nodes[k / 2] * 2 + k % 2]; };
    for (Eigen::Index r = 0; r < K.rows(); ++r)
      for (Eigen::Index c = 0; c < K.cols(); ++c)
        if (row_of(r) >= 0 && row_of(c) >= 0) bulk_[locate(*pattern_, row_of(r), row_of(c))] -= framed(r, c);
  });
}

template <class T>
std::vector<int> SparseEngine<T>::places_around(std::size_t p, const PointTangent<T>& tangent) const {
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
void SparseEngine<T>::make_room(const std::vector<PointTangent<T>>& tangents) {
  const auto has_room = [&](std::size_t p) {
    return std::all_of(tangents[p].places.begin(), tangents[p].places.end(),
                       [&](int place) { return std::binary_search(places_[p].begin(), places_[p].end(), place); });
  };
  bool enough = true;
  for (std::size_t p = 0; p < tangents.size() && enough; ++p) enough = has_room(p);
  if (enough) return;
  auto places = places_;
  for (std::size_t p = 0; p < tangents.size(); ++p)
    if (!tangents[p].places.empty()) places[p] = places_around(p, tangents[p]);
  lay_out(places);
}

template <class T>
void SparseEngine<T>::linearise(const BodyMotion<T>& at) {
  assemble(*lists_, &at);
  condensed_ = false;
  if (model_.slides_along_curves() || condenses_)
    linearised_ = {at.displacement, at.last_memory, at.time, at.branches ? *at.branches : FlowBranches()};
  valid_ = false;
}

template <class T>
Vector<T> SparseEngine<T>::body_rows(const Vector<T>& moved) const {
  Vector<T> rows = into_frames(model_, slots_.frames, Layout::all,
                               bulk_forces(model_, slots_, moved, bulk_flow(model_, slots_, moved, before_),
                                           part_ ? &part_->others() : nullptr));
  if (part_) part_->add_balance(into_frames(model_, slots_.frames, Layout::all, moved), rows);
  return rows;
}

template <class T>
Vector<T> SparseEngine<T>::tangent_times(const BodyMotion<T>& at, const Vector<T>& motion) const {
  if (!part_) return stickslip::tangent_times(model_, slots_, at, motion, false);
  Vector<T> rows = into_frames(model_, slots_.frames, Layout::all,
                               stickslip::tangent_times(model_, slots_, at, motion, false, &part_->others()));
  part_->add_stiffness_times(into_frames(model_, slots_.frames, Layout::all, motion), rows);
  return out_of_frames(model_, slots_.frames, Layout::all, std::move(rows));
}

template <class T>
Vector<T> SparseEngine<T>::all(const Vector<T>& u) {
  if (!part_) return out_of_frames(model_, slots_.frames, Layout::all, u);
  Matrix<T> expanded = u;
  part_->expand_all(expanded);
  return out_of_frames(model_, slots_.frames, Layout::all, Vector<T>(expanded));
}

template <class T>
Matrix<T> SparseEngine<T>::expand(const Matrix<T>& u, Matrix<T> others, const std::vector<int>* wanted) {
  if (!part_) return out_of_frames(model_, slots_.frames, Layout::all, u);
  Matrix<T> expanded = u;
  part_->expand(expanded, std::move(others), wanted);
  return out_of_frames(model_, slots_.frames, Layout::all, std::move(expanded));
}

template <class T>
bool SparseEngine<T>::has_tangent_near(const BodyMotion<T>& at) const {
  constexpr double near = 1e-4;
  if (!keeps_tangent()) return false;
  double facet = std::numeric_limits<double>::infinity();
  for (const auto& point : model_.points) facet = std::min(facet, point.mesh_size);
  const Vector<T> moved = at.displacement - linearised_->displacement;
  return largest_nodal_norm(moved, model_.dimension) <= near * facet;
}

template <class T>
void SparseEngine<T>::hold_bodies(const BodyMotion<T>& at, const Vector<T>& u, HeldTangent tangent) {
  if (model_.effects.linear_bulk) return;
  if (tangent == HeldTangent::at_motion) linearise(at);
  HeldBodies held{into_frames(model_, slots_.frames, Layout::all, at.displacement), body_rows(at.displacement)};
  if (!model_.followers.empty())
    held.rows -=
        into_frames(model_, slots_.frames, Layout::all, follower_forces(model_, slots_, time_, at.displacement));
  Vector<T> prescribed = u - held.u;
  for (int dof : model_.free_dofs) prescribed[dof] = T(0);
  if (values(prescribed).cwiseAbs().maxCoeff() > 0)
    held.rows += into_frames(model_, slots_.frames, Layout::all, tangent_times(at, spread(prescribed)));
  held_bodies_ = std::move(held);
}

template <class T>
Vector<T> SparseEngine<T>::begin(double time, const Vector<T>& displacement, const Vector<T>& before) {
  before_ = before;
  time_ = time;
  if (tangent_ && !condenses_) {
    condenses_ = true;
    valid_ = condensed_ = false;
    lay_out(places_at_start());
  }
  Vector<T> u = displacement;
  prescribe(model_, slots_, time, u);
  u = into_frames(model_, slots_.frames, Layout::all, std::move(u));
  Vector<T> external = dead_forces(model_, slots_, time);
  if (part_) part_->begin(u, external);
  external_ = into_frames(model_, slots_.frames, Layout::all, std::move(external));
  return u;
}

template <class T>
void SparseEngine<T>::move_loads(double time) {
  time_ = time;
  external_ = into_frames(model_, slots_.frames, Layout::all, dead_forces(model_, slots_, time));
}

template <class T>
Vector<T> SparseEngine<T>::load_rate(const Vector<T>& u) {
  const double end = model_.times.back();
  const Vector<T> moved = all(u);
  const Vector<T> change =
      external_forces(model_, slots_, time_ + end, moved) - external_forces(model_, slots_, time_, moved);
  return into_frames(model_, slots_.frames, Layout::all, Vector<T>(change / T(end)));
}

template <class T>
Vector<T> SparseEngine<T>::residual(const Vector<T>& u, const Vector<T>& contact, ForceScale& scale) const {
  const Vector<T> moved = spread(u);
  Vector<T> rows;
  if (held_bodies_)
    rows = held_bodies_->rows + apply_stiffness(u - held_bodies_->u).col(0);
  else
    rows = body_rows(moved);
  const int D = model_.dimension;
  scale.force = std::max(
      {scale.force, largest_nodal_norm(rows, D), largest_nodal_norm(external_, D), largest_nodal_norm(contact, D)});
  if (part_) scale.force = std::max(scale.force, part_->force_scale());
  scale.rounding = unit_roundoff * stiffness_ * largest_nodal_norm(u, D);
  rows -= external_;
  if (!model_.followers.empty() && !held_bodies_) {
    const Vector<T> follower =
        into_frames(model_, slots_.frames, Layout::all, follower_forces(model_, slots_, time_, moved));
    scale.force = std::max(scale.force, largest_nodal_norm(follower, D));
    rows -= follower;
  }
  add_compact(model_, into_frames(model_, slots_.frames, Layout::compact, contact), rows);
  return rows;
}

template <class T>
bool SparseEngine<T>::factorise(const std::vector<PointTangent<T>>& tangents, Counters& counters,
                                const Vector<double>& hold) {
  update_.clear();
  const bool same = detail::same_values(hold, held_) && detail::same_tangents(tangents, factorised_);
  if (valid_ && model_.effects.linear_bulk && same) return true;
  if (condenses_ && !condensed_) condense(counters);
  if (condenses_) {
    ++counters.assemblies;
    return valid_ = tangent_->factorise(tangents, hold);
  }
  const bool along_curves = model_.slides_along_curves();
  if (along_curves) make_room(tangents);
  values_ = bulk_;
  for (Eigen::Index n = 0; n < hold.size(); ++n)
    for (int i = 0; i < model_.dimension; ++i)
      if (const int row = row_of_dof()[model_.contact_nodes[n] * model_.dimension + i]; row >= 0)
        values_[locate(*pattern_, row, row)] += T(hold[n]);
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
void SparseEngine<T>::condense(Counters& counters) {
  condensed_ = condenses_ = tangent_->condense(bulk_, counters);
  if (!condenses_) lay_out(places_at_start());
}

template <class T>
bool SparseEngine<T>::update(const std::vector<PointTangent<T>>& tangents, Counters& counters,
                             const Vector<double>& hold) {
  if (!valid_ || !model_.effects.linear_bulk || !detail::same_values(hold, held_)) return false;
  const auto rows = [&](std::size_t p) { return rows_of(p, model_.points[p].places); };
  return detail::update_factor<T>(
      model_, slots_, factorised_, tangents, unknown_multipliers_, rows, size_, counters,
      [&](const Matrix<T>& b) { return solver_.solve(b); }, update_);
}

template <class T>
EngineMemory<T> SparseEngine<T>::memory() const {
  EngineMemory<T> memory{places_, model_.effects.linear_bulk ? recipe() : FactorRecipe<T>{}, {}};
  if (keeps_tangent()) {
    memory.condensed_at = linearised_->displacement;
    memory.touched = tangent_->touched();
  }
  return memory;
}

template <class T>
void SparseEngine<T>::restore(const EngineMemory<T>& memory, Counters& counters) {
  const bool condensed = memory.condensed_at.size() > 0;
  const bool switches = condensed && !std::exchange(condenses_, true);
  if (switches || memory.places != places_) lay_out(memory.places);
  valid_ = condensed_ = false;
  if (condensed) {
    linearise({memory.condensed_at, Vector<T>()});
    condense(counters);
    tangent_->touch(memory.touched);
  }
  if (memory.factor.valid) factorise(memory.factor.tangents, counters, memory.factor.hold);
  update_ = memory.factor.update;
}

template <class T>
bool SparseEngine<T>::reversed() const {
  if (condenses_) return tangent_->reversed();
  const bool odd = unknown_multipliers_ && model_.multiplier_count % 2 == 1;  // each multiplier turns the sign
  return (solver_.determinant_sign() != (odd ? -1 : 1)) != update_.turns_sign();
}

template <class T>
BlockVector<T> SparseEngine<T>::solve(const BlockVector<T>& rows, Solving how) {
  if (condenses_) return tangent_->solve(rows, how);
  const bool transposed = how == Solving::transposed;
  const int free = static_cast<int>(dofs().size());
  Matrix<T> b(size_, rows.u.cols());
  for (int i = 0; i < free; ++i) b.row(i) = rows.u.row(dofs()[i]);
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
  for (int i = 0; i < free; ++i) out.u.row(dofs()[i]) = x.row(i);
  if (unknown_multipliers_) out.l = x.bottomRows(model_.multiplier_count);
  return out;
}

template <class T>
Matrix<T> SparseEngine<T>::apply_stiffness(const Matrix<T>& u, bool transposed) const {
  Matrix<T> rows = Matrix<T>::Zero(u.rows(), u.cols());
  const auto& dof_of = dofs();
  for (std::size_t j = 0; j < dof_of.size(); ++j)
    for (int k = pattern_->column_start[j]; k < pattern_->column_start[j + 1]; ++k)
      if (pattern_->row[k] < static_cast<int>(dof_of.size())) {
        const int row = dof_of[pattern_->row[k]], column = dof_of[j];
        rows.row(transposed ? column : row) += bulk_[k] * u.row(transposed ? row : column);
      }
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

template <class T>
EngineHoldings SparseEngine<T>::holdings() const {
  EngineHoldings held;
  held.bodies = static_cast<long>(bulk_.size() * sizeof(T));
  held.matrix = static_cast<long>(values_.size() * sizeof(T) +
                                  (pattern_->row.size() + pattern_->column_start.size()) * sizeof(int));
  for (const auto& map : point_map_) held.matrix += static_cast<long>(map.size() * sizeof(int));
  held.factor = solver_.factor_bytes();
  held.matrix_entries = static_cast<long>(pattern_->nonzeros());
  held.factor_entries = solver_.factor_nonzeros();
  held.unsymmetric = symmetry_ == Symmetry::general;
  if (condenses_) tangent_->add_holdings(held);
  if (!part_) return held;
  held.condensed = static_cast<long>(part_->condensation().schur().size() * sizeof(T));
  held.bodies_factor = part_->condensation().factor_bytes();
  held.body_solves = part_->condensation().backsolves();
  return held;
}

template <class T>
std::string SparseEngine<T>::name() const {
  if (condenses_) return "sparse, " + tangent_->name();
  std::string name = solver_.name().empty() ? "sparse" : "sparse, " + solver_.name();
  if (part_) name += ", bodies of constant stiffness condensed on " + part_->condensation().name();
  return name;
}

}  // namespace stickslip
