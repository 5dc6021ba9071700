/// Definitions of the templates in sparse_engine.hpp.
#pragma once

#include "core/engine/condensed_part_impl.hpp"
#include "core/engine/condensed_tangent_impl.hpp"
#include "core/engine/sparse_engine.hpp"
#include "core/engine/sparse_system_impl.hpp"

namespace stickslip {
template <class T>
SparseEngine<T>::SparseEngine(const Model& model, const Slots<T>& slots, bool unknown_multipliers, ConeRadius cone,
                              Backend backend, std::shared_ptr<Condensation<T>> condensation,
                              std::shared_ptr<CondensedTangent<T>> tangent)
    : model_(model),
      slots_(slots),
      part_(condensation ? std::make_optional<CondensedPart<T>>(model, slots, std::move(condensation)) : std::nullopt),
      tangent_(std::move(tangent)),
      symmetry_(detail::symmetry_of(model, unknown_multipliers, cone)),
      sparse_(model, slots, unknown_multipliers, symmetry_, backend,
              part_ ? part_->rows().row_of_dof : model.free_index, part_ ? part_->rows().dofs : model.free_dofs),
      condenses_(tangent_ != nullptr) {
  lay_out(sparse_.places_at_start());
  for (int i = 0; i < static_cast<int>(system().dofs().size()); ++i)
    stiffness_ = std::max(stiffness_, value(bulk_[locate(system().pattern(), i, i)]));
}

template <class T>
void SparseEngine<T>::lay_out(const typename SparseSystem<T>::Places& places) {
  auto lists = element_rows(model_, system().row_of_dof(), own());
  if (!condenses_) {
    if (part_) part_->rows().add_blocks(lists);
    lists = sparse_.lay_out(std::move(lists), places);
  }
  if (linearised_) {
    const BodyMotion<T> at{linearised_->displacement, linearised_->last_memory, linearised_->time,
                           &linearised_->branches};
    assemble(lists, &at);
  } else {
    assemble(lists, nullptr);
  }
  if (!model_.effects.linear_bulk) lists_ = std::move(lists);
}

template <class T>
void SparseEngine<T>::assemble(const RowLists& lists, const BodyMotion<T>* at) {
  const Pattern& pattern = system().pattern();
  bulk_ = assemble_bodies<T>(model_, slots_, lists, pattern, at, own());
  if (part_) part_->add_stiffness(pattern, bulk_);
  if (!at || model_.followers.empty()) return;
  for_each_follower_tangent(model_, slots_, *at, [&](const std::vector<int>& nodes, const Matrix<T>& K) {
    const Matrix<T> framed = into_frames(model_, slots_.frames, nodes, K);
    const auto row_of = [&](Eigen::Index k) { return system().row_of_dof()[nodes[k / 2] * 2 + k % 2]; };
    for (Eigen::Index r = 0; r < K.rows(); ++r)
      for (Eigen::Index c = 0; c < K.cols(); ++c)
        if (row_of(r) >= 0 && row_of(c) >= 0) bulk_[locate(pattern, row_of(r), row_of(c))] -= framed(r, c);
  });
}

template <class T>
void SparseEngine<T>::linearise(const BodyMotion<T>& at) {
  assemble(*lists_, &at);
  condensed_ = false;
  if (model_.slides_along_curves() || condenses_)
    linearised_ = {at.displacement, at.last_memory, at.time, at.branches ? *at.branches : FlowBranches()};
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
    condensed_ = false;
    lay_out(sparse_.places_at_start());
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
  sparse_.drop_update();
  if (model_.effects.linear_bulk && sparse_.is_factor_of(tangents, hold)) return true;
  if (condenses_ && !condensed_) condense(counters);
  if (condenses_) {
    ++counters.assemblies;
    return tangent_->factorise(tangents, hold);
  }
  if (const auto places = sparse_.places_for(tangents)) lay_out(*places);
  return sparse_.factorise(bulk_, tangents, hold, counters);
}

template <class T>
void SparseEngine<T>::condense(Counters& counters) {
  condensed_ = condenses_ = tangent_->condense(bulk_, counters);
  if (!condenses_) lay_out(sparse_.places_at_start());
}

template <class T>
bool SparseEngine<T>::update(const std::vector<PointTangent<T>>& tangents, Counters& counters,
                             const Vector<double>& hold) {
  return model_.effects.linear_bulk && sparse_.update(tangents, hold, counters);
}

template <class T>
EngineMemory<T> SparseEngine<T>::memory() const {
  EngineMemory<T> memory{sparse_.places(), model_.effects.linear_bulk ? sparse_.recipe() : FactorRecipe<T>{}};
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
  if (switches || memory.places != sparse_.places()) lay_out(memory.places);
  condensed_ = false;
  if (condensed) {
    linearise({memory.condensed_at, Vector<T>()});
    condense(counters);
    tangent_->touch(memory.touched);
  }
  sparse_.restore(memory.factor, bulk_, counters);
}

template <class T>
Matrix<T> SparseEngine<T>::apply_stiffness(const Matrix<T>& u, bool transposed) const {
  Matrix<T> rows = Matrix<T>::Zero(u.rows(), u.cols());
  const auto& dof_of = system().dofs();
  const Pattern& pattern = system().pattern();
  for (std::size_t j = 0; j < dof_of.size(); ++j)
    for (int k = pattern.column_start[j]; k < pattern.column_start[j + 1]; ++k)
      if (pattern.row[k] < static_cast<int>(dof_of.size())) {
        const int row = dof_of[pattern.row[k]], column = dof_of[j];
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
  held.unsymmetric = symmetry_ == Symmetry::general;
  system().add_holdings(held);
  if (!part_) return held;
  held.condensed = static_cast<long>(part_->condensation().schur().size() * sizeof(T));
  held.bodies_factor = part_->condensation().factor_bytes();
  held.body_solves = part_->condensation().backsolves();
  return held;
}

template <class T>
std::string SparseEngine<T>::name() const {
  const std::string by = system().name();
  std::string name = by.empty() ? "sparse" : "sparse, " + by;
  if (part_) name += ", bodies of constant stiffness condensed on " + part_->condensation().name();
  return name;
}

}  // namespace stickslip
