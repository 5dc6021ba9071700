#include "sensitivity/direct.hpp"

namespace stickslip {

LinearisedEquilibrium::LinearisedEquilibrium(Differentiation& problem, const State<double>& at,
                                             const RegularisationField<double>& rho,
                                             std::vector<RegularisationField<Direction>> rho_blocks, ConeRadius cone,
                                             double time, Multipliers multipliers, const History<double>& previous)
    : problem_(problem),
      primal_{problem.model, problem.slots, rho, previous, cone, time, &at.contact.facing},
      at_(at),
      rho_blocks_(std::move(rho_blocks)),
      rho_(rho),
      cone_(cone),
      time_(time),
      multipliers_(multipliers) {
  unproven_ = problem.follows && reuse_factor(problem, primal_, at, multipliers);
  valid_ = unproven_ || factorise_converged(problem, primal_, at, multipliers, redundant_);
  if (!valid_) return;
  if (problem.prepared) {
    load_ = std::move(*problem.prepared);
    problem.prepared.reset();
    return;
  }
  std::vector<PseudoLoad> alone{pseudo_load(problem, at, time)};
  reduce(problem, alone);
  load_ = std::move(alone[0]);
}

bool LinearisedEquilibrium::solve(std::vector<Vector<Direction>>& lambda) {
  if (!valid_) return false;
  std::vector<Vector<Direction>> compact;
  for (const auto& displacement : load_.displacement) compact.push_back(to_compact(problem_.model, displacement));
  increment_ = Matrix<double>();
  compact_ = Matrix<double>::Zero(compact[0].size(), problem_.parameters);
  Rows rows = evaluate(compact, lambda);
  for (int pass = 0;; ++pass) {
    improve(rows, compact, lambda);
    rows = evaluate(compact, lambda);
    if (unproven_ && !rows.accurate) {
      if (std::exchange(solving_, Solving::refined) == Solving::unrefined) continue;
      valid_ = factorise_converged(problem_, primal_, at_, multipliers_, redundant_);
      if (!valid_) return false;
      unproven_ = false;
      continue;
    }
    unproven_ = false;
    if (!solves_for_multipliers() || pass >= refinements || (rows.accurate && !redundant_)) {
      fields_ = std::move(rows.fields);
      return true;
    }
  }
}

void LinearisedEquilibrium::improve(const Rows& rows, std::vector<Vector<Direction>>& compact,
                                    std::vector<Vector<Direction>>& lambda) {
  const Model& model = problem_.model;
  const auto step = problem_.engine.solve({-rows.u, -rows.l}, solving_);
  problem_.counters.sensitivity_backsolves +=
      problem_.parameters * (solving_ == Solving::refined ? problem_.engine.solves() : 1);
  increment_ = increment_.size() == 0 ? step.u : Matrix<double>(increment_ + step.u);
  Matrix<double> moved(compact_.rows(), compact_.cols()), multiplier = step.l;
  for (int j = 0; j < problem_.parameters; ++j) moved.col(j) = problem_.engine.compact(step.u.col(j));
  compact_ += moved;
  if (solves_for_multipliers())
    for (std::size_t p = 0; p < model.points.size(); ++p)
      for (int c = 0; c < model.points[p].components(); ++c)
        multiplier.row(model.points[p].multiplier + c) *= c == 0 ? rho_[p].normal : rho_[p].tangential;
  for (int b = 0; b < static_cast<int>(compact.size()); ++b) {
    add_derivatives(compact[b], moved, problem_.blocks[b]);
    if (solves_for_multipliers()) add_derivatives(lambda[b], multiplier, problem_.blocks[b]);
  }
}

/// Rows of the derivative problem at the present derivatives. `accurate`: the displacement rows are rounding, compared
/// with the derivatives of the forces that balance in them. A large rho magnifies the rounding of Dg and so the rows;
/// if lambda is unknown, another solve removes them; if it is given, none can.
LinearisedEquilibrium::Rows LinearisedEquilibrium::evaluate(const std::vector<Vector<Direction>>& compact,
                                                            const std::vector<Vector<Direction>>& lambda) {
  const int blocks = static_cast<int>(problem_.blocks.size());
  Rows rows;
  std::vector<Vector<Direction>> forces, multiplier_rows;
  problem_.counters.contact_evaluations += blocks * static_cast<long>(problem_.model.points.size());
  for (int b = 0; b < blocks; ++b) {
    const auto& slots = problem_.blocks[b].slots;
    rows.fields.push_back(evaluate_contact<Direction>(input(b), compact[b], lambda[b], &at_.contact.state));
    take_rays(input(b), lambda[b], at_.contact.ray, rows.fields[b]);
    forces.push_back(into_frames(problem_.model, slots.frames, NodalLayout::compact,
                                 contact_forces(problem_.model, slots, rows.fields[b])));
    if (solves_for_multipliers())
      multiplier_rows.push_back(multiplier_residual(problem_.model, slots, rows.fields[b].traction, lambda[b]));
  }
  auto columns = [&](std::vector<Vector<Direction>>& of) {
    return gather(
        problem_.blocks, problem_.parameters, [&](auto&, int b) -> auto& { return of[b]; });
  };
  const Matrix<double> contact = columns(forces);
  rows.u = load_.reduced.kept + problem_.engine.scatter(contact);
  if (solves_for_multipliers()) rows.l = columns(multiplier_rows);
  if ((!solves_for_multipliers() && !unproven_) || increment_.size() == 0) return rows;
  const Matrix<double> internal = problem_.engine.apply_stiffness(increment_);
  rows.u += internal;
  for (Eigen::Index i = 0; i < rows.u.rows(); ++i)
    if (!problem_.engine.is_free(i)) rows.u.row(i).setZero();
  constexpr double rounding = 100 * unit_roundoff;  // several hundred terms are summed in a row; each rounds once
  double stiffest = 0;                              // largest A rho, force per length
  for (std::size_t p = 0; p < rho_.size() && !solves_for_multipliers(); ++p)
    stiffest = std::max(stiffest, problem_.slots.geometry[p].area * std::max(rho_[p].normal, rho_[p].tangential));
  for (Eigen::Index j = 0; j < rows.u.cols() && rows.u.rows() > 0; ++j) {
    const double size = contact.rows() ? contact.col(j).cwiseAbs().maxCoeff() : 0;
    const double magnified = contact.rows() ? rounding * stiffest * compact_.col(j).cwiseAbs().maxCoeff() : 0;
    rows.accurate &= rows.u.col(j).cwiseAbs().maxCoeff() <=
                     std::max(magnified, 1e-12 * std::max(size, internal.col(j).cwiseAbs().maxCoeff()));
  }
  return rows;
}

void LinearisedEquilibrium::store_state(const std::vector<Vector<Direction>>& lambda) {
  for (std::size_t b = 0; b < problem_.blocks.size(); ++b) {
    auto& block = problem_.blocks[b];
    block.current.multiplier = lambda[b];
    block.current.contact = fields_[b];
    block.current.history = next_history(input(static_cast<int>(b)), block.current.contact, lambda[b]);
  }
  if (problem_.model.effects.plasticity) {
    const auto displacement = without_inside(problem_, {load_, increment_});  // (bodies with memory are not condensed)
    for (std::size_t b = 0; b < problem_.blocks.size(); ++b) {
      auto& block = problem_.blocks[b];
      auto& bodies = block.current.history.bodies;
      bodies = bulk_flow(problem_.model, block.slots, displacement[b], block.previous.history.bodies, at_.flow);
      if (!at_.flow.empty())  // (a prescribed branch at a tie moves the values by the tolerance)
        for (Eigen::Index k = 0; k < bodies.size(); ++k) bodies[k].v = at_.history.bodies[k];
    }
  }
  problem_.unexpanded = {std::move(load_), increment_};
}

}  // namespace stickslip
