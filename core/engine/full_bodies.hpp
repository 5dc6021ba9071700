/// Bodies of which nothing is eliminated: forces and tangent come from their elements.
#pragma once

#include <optional>

#include "core/engine/body_matrix.hpp"
#include "core/engine/elimination.hpp"
#include "core/model/loading.hpp"

namespace stickslip {

/// Engine rows and displacements are over all dofs.
template <class T>
class FullBodies : public Elimination<T> {
 public:
  using Elimination<T>::Elimination;

  Vector<T> begin(double time, Vector<T> u, const Vector<T>& before) override {
    before_ = before;
    time_ = time;
    Vector<T> external = dead_forces(model_, slots_, time);
    take_condensed_loads(u, external);
    external_ = in_frames(std::move(external));
    return u;
  }
  void move_loads(double time) override {
    time_ = time;
    external_ = in_frames(dead_forces(model_, slots_, time));
  }
  Vector<T> load_rate(const Vector<T>& u) override {
    const double end = model_.times.back();
    const Vector<T> moved = all(u);
    const Vector<T> change =
        external_forces(model_, slots_, time_ + end, moved) - external_forces(model_, slots_, time_, moved);
    return in_frames(Vector<T>(change / T(end)));
  }
  Vector<T> increment(const Vector<T>& u, double /*time*/) override { return all(u); }

  Vector<T> compact(const Vector<T>& u) const override {
    return out_of_frames(model_, slots_.frames, NodalLayout::compact, to_compact(model_, u));
  }
  Vector<T> all(const Vector<T>& u) const override { return in_axes(u); }
  Matrix<T> spread(const Matrix<T>& u) const override { return in_axes(u); }
  Vector<T> spread(const Vector<T>& u) const override { return in_axes(u); }
  Matrix<T> scatter(const Matrix<T>& compact) const override;
  Reduction<T> reduce(const Matrix<T>& rows) const override { return {rows, Matrix<T>(0, rows.cols())}; }
  Matrix<T> expand(const Matrix<T>& u, Matrix<T> /*others*/, const std::vector<int>* /*wanted*/) const override {
    return in_axes(u);
  }
  void add_contact(const Vector<T>& forces, Vector<T>& rows) const override { add_compact(model_, forces, rows); }

  Vector<T> residual(const Vector<T>& u, const TangentSystem<T>& system, ForceScale& scale) const override;
  void linearise(const BodyMotion<T>& at) override;
  void fix(const BodyMotion<T>& at, const Vector<T>& u) override;
  void release() override { fixed_.reset(); }
  Vector<T> tangent_times(const BodyMotion<T>& at, const Vector<T>& motion) const override {
    return stickslip::tangent_times(model_, slots_, at, motion, Taken::as_is);
  }

  // ---- their matrix

  /// Dofs that systems have rows of, and their places; -1: none.
  virtual const std::vector<int>& dofs() const { return model_.free_dofs; }
  virtual const std::vector<int>& row_of_dof() const { return model_.free_index; }
  /// Rows of the blocks that add up to it: those of element_rows(), then others.
  virtual RowLists blocks(const std::vector<int>& row_of_dof) const { return element_rows(model_, row_of_dof); }
  /// The bodies' tangent on the pattern of `matrix`, at the motion of the last linearise(); at the start before it.
  virtual std::vector<T> tangent(const BodyMatrix<T>& matrix) const { return tangent_of(matrix, BodyKind::all); }
  /// Displacement of the last linearise(); nullptr: the tangent is that of the start.
  const Vector<T>* linearised_at() const { return at_ ? &at_->displacement : nullptr; }

 protected:
  using Elimination<T>::model_, Elimination<T>::slots_;

  /// f_int of a displacement in the axes, in the frames; of condensed bodies less their loads.
  virtual Vector<T> forces(const Vector<T>& moved) const { return forces_of(moved, nullptr); }
  /// Takes the loads of condensed bodies from `external`, all dofs in the axes. `u`: what supports prescribe.
  virtual void take_condensed_loads(const Vector<T>& /*u*/, Vector<T>& /*external*/) {}
  /// Force that the residual of condensed bodies is measured by.
  virtual double condensed_force() const { return 0; }

  Vector<T> forces_of(const Vector<T>& moved, const ElementLists* only) const {
    return in_frames(bulk_forces(model_, slots_, moved, bulk_flow(model_, slots_, moved, before_), only));
  }
  std::vector<T> tangent_of(const BodyMatrix<T>& matrix, BodyKind kind) const;
  template <class V>
  V in_frames(V v) const {
    return into_frames(model_, slots_.frames, NodalLayout::all, std::move(v));
  }
  template <class V>
  V in_axes(V v) const {
    return out_of_frames(model_, slots_.frames, NodalLayout::all, std::move(v));
  }

 private:
  double time_ = 0;
  Vector<T> external_;  ///< in the frames, of what does not depend on displacements
  Vector<T> before_;    ///< what bodies remember of the last increment
  /// Motion that the tangent is taken at.
  struct Linearised {
    Vector<T> displacement, last_memory;
    double time;
    FlowBranches branches;
  };
  std::optional<Linearised> at_;
  /// Bodies that are linear for a while: their forces, less the loads that follow them, at a displacement of the free
  /// dofs.
  struct Fixed {
    Vector<T> u, rows;
  };
  std::optional<Fixed> fixed_;
};

template <class T>
Matrix<T> FullBodies<T>::scatter(const Matrix<T>& compact) const {
  Matrix<T> rows = Matrix<T>::Zero(model_.dof_count(), compact.cols());
  const int D = model_.dimension;
  for (std::size_t n = 0; n < model_.contact_nodes.size(); ++n)
    for (int i = 0; i < D; ++i) rows.row(model_.contact_nodes[n] * D + i) += compact.row(n * D + i);
  return rows;
}

template <class T>
Vector<T> FullBodies<T>::residual(const Vector<T>& u, const TangentSystem<T>& system, ForceScale& scale) const {
  const int D = model_.dimension;
  const Vector<T> moved = spread(u);
  Vector<T> rows = fixed_ ? Vector<T>(fixed_->rows + system.times(u - fixed_->u, Taken::as_is).col(0)) : forces(moved);
  scale.force =
      std::max({scale.force, largest_nodal_norm(rows, D), largest_nodal_norm(external_, D), condensed_force()});
  rows -= external_;
  if (!model_.followers.empty() && !fixed_) {
    const Vector<T> follower = in_frames(follower_forces(model_, slots_, time_, moved));
    scale.force = std::max(scale.force, largest_nodal_norm(follower, D));
    rows -= follower;
  }
  return rows;
}

template <class T>
void FullBodies<T>::linearise(const BodyMotion<T>& at) {
  if (!at_) at_.emplace();
  at_->displacement = at.displacement;
  at_->last_memory = at.last_memory;
  at_->time = at.time;
  if (at.branches)
    at_->branches = *at.branches;
  else
    at_->branches.clear();
}

template <class T>
void FullBodies<T>::fix(const BodyMotion<T>& at, const Vector<T>& u) {
  Fixed fixed{in_frames(at.displacement), forces(at.displacement)};
  if (!model_.followers.empty()) fixed.rows -= in_frames(follower_forces(model_, slots_, time_, at.displacement));
  Vector<T> prescribed = u - fixed.u;
  for (int dof : model_.free_dofs) prescribed[dof] = T(0);
  if (values(prescribed).cwiseAbs().maxCoeff() > 0) fixed.rows += in_frames(tangent_times(at, spread(prescribed)));
  fixed_ = std::move(fixed);
}

template <class T>
std::vector<T> FullBodies<T>::tangent_of(const BodyMatrix<T>& matrix, BodyKind kind) const {
  if (!at_) return assemble_bodies<T>(model_, slots_, matrix.lists, *matrix.pattern, nullptr, kind);
  const BodyMotion<T> at{at_->displacement, at_->last_memory, at_->time, &at_->branches};
  auto values = assemble_bodies<T>(model_, slots_, matrix.lists, *matrix.pattern, &at, kind);
  if (model_.followers.empty()) return values;
  for_each_follower_tangent(model_, slots_, at, [&](const std::vector<int>& nodes, const Matrix<T>& K) {
    const Matrix<T> framed = into_frames(model_, slots_.frames, nodes, K);
    const int D = model_.dimension;
    const auto row_of = [&](Eigen::Index k) { return matrix.row_of_dof[nodes[k / D] * D + k % D]; };
    for (Eigen::Index r = 0; r < K.rows(); ++r)
      for (Eigen::Index c = 0; c < K.cols(); ++c)
        if (row_of(r) >= 0 && row_of(c) >= 0) values[locate(*matrix.pattern, row_of(r), row_of(c))] -= framed(r, c);
  });
  return values;
}

extern template class FullBodies<double>;

}  // namespace stickslip
