/// What an adjoint leaves to be done inside the bodies, for many increments together: a inside, out of its values at
/// the contact in one solve; what it weighs of the loads there and of the motion that is prescribed; and the bodies'
/// share of the gradient, sum of a . df(u)/dslots, f the bodies' forces, in one visit of each element.
#pragma once

#include "core/model/storage.hpp"
#include "sensitivity/pull_back.hpp"

namespace stickslip {

namespace detail {

/// a of the waiting equilibria over all dofs in the axes, zero where motion is prescribed.
template <class E>
Matrix<double> weights_inside(AdjointProblem<E>& problem, const std::vector<InteriorShare>& waiting) {
  const Model& model = problem.model;
  const auto count = static_cast<Eigen::Index>(waiting.size());
  const auto join = [&](Matrix<double> InteriorShare::*part) {
    Matrix<double> all((waiting[0].*part).rows(), count);
    for (Eigen::Index n = 0; n < count; ++n) all.col(n) = waiting[n].*part;
    return all;
  };
  Matrix<double> all = problem.engine.expand(join(&InteriorShare::u), -join(&InteriorShare::others));
  for (Eigen::Index n = 0; n < count; ++n) {
    Vector<double> a = into_frames(model, problem.slots.frames, Layout::all, Vector<double>(all.col(n)));
    for (Eigen::Index dof = 0; dof < a.size(); ++dof)
      if (model.free_index[dof] < 0) a[dof] = 0;
    all.col(n) = out_of_frames(model, problem.slots.frames, Layout::all, std::move(a));
  }
  return all;
}

/// Moves weights `a` (all dofs, in the axes) inside the bodies to loads, frames and prescribed motion.
template <class E>
void pull_back_loads(AdjointProblem<E>& problem, const InteriorShare& of, const Vector<double>& a,
                     std::vector<double>& by) {
  const Model& model = problem.model;
  const auto& slots = problem.recorded;
  Tape& tape = problem.tape;
  tape.rewind(problem.slots_end);
  const auto constant = [](double x) { return Reverse(x); };
  Vector<Reverse> prescribed = of.motion.unaryExpr(constant);
  prescribe(model, slots, of.time, prescribed);
  Vector<Reverse> rows = -dead_forces(model, slots, of.time);
  if (!model.followers.empty()) {
    const Vector<Reverse> still = of.motion.unaryExpr(constant);
    rows -= follower_forces(model, slots, of.time, still);
  }
  if (of.forces.size() > 0) rows += of.forces.unaryExpr(constant);
  rows = into_frames(model, slots.frames, Layout::all, std::move(rows));
  by.resize(problem.slots_end);
  by.resize(tape.size(), 0);
  const auto seed = [&](const Reverse& x, double derivative) {
    if (x.entry >= 0) by[x.entry] += derivative;
  };
  const auto is_on_tape = [](const Vector<Reverse>& all) {
    return std::any_of(all.begin(), all.end(), [](const Reverse& x) { return x.entry >= 0; });
  };
  if (is_on_tape(rows)) {
    const Vector<double> weight = into_frames(model, problem.slots.frames, Layout::all, a);
    std::vector<char> touches(model.node_count, 0);
    for (int node : model.contact_nodes) touches[node] = 1;
    for (int dof : model.free_dofs)
      if (!touches[dof / model.dimension]) seed(rows[dof], weight[dof]);
  }
  if (is_on_tape(prescribed)) {
    Vector<double> held =
        into_frames(model, problem.slots.frames, Layout::all,
                    tangent_times(model, problem.slots, {of.motion, of.last_memory, of.time, &of.flow}, a, true,
                                  &problem.at_supports));
    for (int dof : model.free_dofs) held[dof] = 0;
    held = out_of_frames(model, problem.slots.frames, Layout::all, std::move(held));
    for (Eigen::Index i = 0; i < held.size(); ++i) seed(prescribed[i], held[i]);
  }
  tape.pull_back(by, problem.slots_end);
}

}  // namespace detail

/// Does what waits inside the bodies. What these remember adds to the derivatives by history.
template <class E>
void pull_back_inside(AdjointProblem<E>& problem) {
  long waiting = 0;
  for (const auto& objective : problem.objectives)
    for (const auto& of : objective.waiting)
      waiting +=
          bytes_of(of.motion) + bytes_of(of.forces) + bytes_of(of.weights) + bytes_of(of.u) + bytes_of(of.others);
  problem.waiting_bytes = std::max(problem.waiting_bytes, waiting);
  for (auto& objective : problem.objectives) {
    auto& waiting = objective.waiting;
    if (waiting.empty()) continue;
    WorkPairs pairs{detail::weights_inside(problem, waiting), {}, {}, {}, {}};
    pairs.motions.resize(pairs.weights.rows(), pairs.weights.cols());
    pairs.last_memory.resize(problem.model.memory_count, pairs.weights.cols());
    for (std::size_t n = 0; n < waiting.size(); ++n) {
      const auto k = static_cast<Eigen::Index>(n);
      detail::pull_back_loads(problem, waiting[n], pairs.weights.col(k), objective.adjoint);
      pairs.weights.col(k) += waiting[n].weights;
      pairs.motions.col(k) = waiting[n].motion;
      pairs.last_memory.col(k) = waiting[n].last_memory;
      pairs.flows.push_back(waiting[n].flow);
    }
    problem.tape.rewind(problem.slots_end);
    objective.adjoint.resize(problem.slots_end);
    const auto left = pull_back_bodies(problem.model, problem.recorded, problem.tape, pairs, objective.adjoint);
    if (left.last_memory.size() > 0) objective.history.local.bodies += left.last_memory.rowwise().sum();
    waiting.clear();
  }
}

}  // namespace stickslip
