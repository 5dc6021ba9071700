/// Direct differentiation: the part that all schemes share.
///
/// A State<Direction> carries the derivative of a state by `directions` parameters. At the converged state of an
/// increment
///
///   K Dp = -r,     r = directional derivative of R by parameters, history and prescribed motion at fixed p
///
/// p is u, and lambda too where it is an unknown. One sweep of the solver's own residual in dual numbers gives r. A
/// second sweep with Dp gives the derivatives of the local unknowns, which are the history of the next increment. The
/// schemes differ, as the methods do, in what they pass for D lambda. [MTV94], [SLK10]
#pragma once

#include "sensitivity/differentiation.hpp"
#include "sensitivity/tangent.hpp"

namespace stickslip {

/// rho of a method with its derivatives, per block. `factor`: adaption of rho per point; empty: none.
template <class M, class E>
std::vector<RegularisationField<Direction>> regularisation_blocks(const M& method, const Differentiation<E>& problem,
                                                                  const std::vector<double>& factor = {}) {
  std::vector<RegularisationField<Direction>> rho;
  for (const auto& block : problem.blocks) rho.push_back(adapted(initial_regularisation(block.slots, method), factor));
  return rho;
}

/// Derivative problem of one equilibrium: factorised tangent and the bodies' part of the pseudo-load. Neither changes
/// while D lambda is iterated.
template <class E>
class LinearisedEquilibrium {
 public:
  ///   at          the state; its multiplier is the lambda of the equilibrium
  ///   rho         in double; rho_blocks: per block
  ///   unknown     lambda is part of p
  ///   previous    history of the last increment
  LinearisedEquilibrium(Differentiation<E>& problem, const State<double>& at, const RegularisationField<double>& rho,
                        std::vector<RegularisationField<Direction>> rho_blocks, ConeRadius cone, double time,
                        bool unknown, const History<double>& previous);

  /// False if the tangent is singular.
  bool valid() const { return valid_; }
  /// Solves for the derivative. False if the tangent is singular.
  ///
  ///   lambda  per block: D lambda as a seed. If lambda is unknown, pass D lambda = 0; its solution is added
  ///   fields  result, per block: local unknowns with all derivatives
  bool solve(std::vector<Vector<Direction>>& lambda, std::vector<ContactField<Direction>>& fields);

  /// Stores the derivatives of the last solve in the current state of every block. Displacements remain unexpanded.
  void store_state(const std::vector<ContactField<Direction>>& fields, const std::vector<Vector<Direction>>& lambda);

  /// Largest derivatives, per parameter. largest_motion(): of contact displacements in this increment and of placements
  /// in the last, length. load(): of the forces of bodies and loads in the engine's rows, before they cancel.
  Vector<double> largest_motion() const {
    const Matrix<double> then = gather(
        problem_.blocks,
        problem_.parameters, [&](auto& block, int) -> auto& { return block.previous.history.placement; });
    return largest(compact_).cwiseMax(largest(then));
  }
  Vector<double> load() const { return largest(load_.reduced.kept); }

 private:
  static constexpr int refinements = 2;
  static Vector<double> largest(const Matrix<double>& columns) {
    if (columns.rows() == 0) return Vector<double>::Zero(columns.cols());
    return columns.cwiseAbs().colwise().maxCoeff();
  }
  struct Rows {
    Matrix<double> u, l;
    std::vector<ContactField<Direction>> fields;
    bool accurate = true;
  };
  /// One solve with the factor. Adds its result to the increment, to the compact displacements and, if unknown, to
  /// lambda.
  void improve(const Rows& rows, std::vector<Vector<Direction>>& compact, std::vector<Vector<Direction>>& lambda);
  Rows evaluate(const std::vector<Vector<Direction>>& compact, const std::vector<Vector<Direction>>& lambda);
  ContactInput<Direction> input(int block) const {
    return {problem_.model,
            problem_.blocks[block].slots,
            rho_blocks_[block],
            problem_.blocks[block].previous.history,
            cone_,
            time_,
            &at_.contact.facing};
  }

  Differentiation<E>& problem_;
  ContactInput<double> primal_;
  const State<double>& at_;
  std::vector<RegularisationField<Direction>> rho_blocks_;
  const RegularisationField<double>& rho_;
  ConeRadius cone_;
  double time_;
  bool unknown_, valid_ = false;
  bool redundant_ = false;                ///< constraints repeat one another: one more solve is needed
  bool unproven_ = false;                 ///< the factor is Newton's last, and not yet checked on these rows
  Solving solving_ = Solving::unrefined;  ///< unrefined as long as that is accurate
  PseudoLoad load_;
  Matrix<double> increment_, compact_;
};

template <class E>
LinearisedEquilibrium<E>::LinearisedEquilibrium(Differentiation<E>& problem, const State<double>& at,
                                                const RegularisationField<double>& rho,
                                                std::vector<RegularisationField<Direction>> rho_blocks, ConeRadius cone,
                                                double time, bool unknown, const History<double>& previous)
    : problem_(problem),
      primal_{problem.model, problem.slots, rho, previous, cone, time, &at.contact.facing},
      at_(at),
      rho_blocks_(std::move(rho_blocks)),
      rho_(rho),
      cone_(cone),
      time_(time),
      unknown_(unknown) {
  unproven_ = problem.follows && reuse_factor(problem, primal_, at, unknown);
  valid_ = unproven_ || factorise_converged(problem, primal_, at, unknown, redundant_);
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

template <class E>
bool LinearisedEquilibrium<E>::solve(std::vector<Vector<Direction>>& lambda,
                                     std::vector<ContactField<Direction>>& fields) {
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
      valid_ = factorise_converged(problem_, primal_, at_, unknown_, redundant_);
      if (!valid_) return false;
      unproven_ = false;
      continue;
    }
    unproven_ = false;
    if (!unknown_ || pass >= refinements || (rows.accurate && !redundant_)) {
      fields = std::move(rows.fields);
      return true;
    }
  }
}

template <class E>
void LinearisedEquilibrium<E>::improve(const Rows& rows, std::vector<Vector<Direction>>& compact,
                                       std::vector<Vector<Direction>>& lambda) {
  const Model& model = problem_.model;
  const auto step = problem_.engine.solve({-rows.u, -rows.l}, solving_);
  problem_.counters.sensitivity_backsolves +=
      problem_.parameters * (solving_ == Solving::refined ? problem_.engine.solves() : 1);
  increment_ = increment_.size() == 0 ? step.u : Matrix<double>(increment_ + step.u);
  Matrix<double> moved(compact_.rows(), compact_.cols()), multiplier = step.l;
  for (int j = 0; j < problem_.parameters; ++j) moved.col(j) = problem_.engine.compact(step.u.col(j));
  compact_ += moved;
  if (unknown_)
    for (std::size_t p = 0; p < model.points.size(); ++p)
      for (int c = 0; c < model.points[p].components(); ++c)
        multiplier.row(model.points[p].multiplier + c) *= c == 0 ? rho_[p].normal : rho_[p].tangential;
  for (int b = 0; b < static_cast<int>(compact.size()); ++b) {
    add_derivatives(compact[b], moved, problem_.blocks[b]);
    if (unknown_) add_derivatives(lambda[b], multiplier, problem_.blocks[b]);
  }
}

/// Rows of the derivative problem at the present derivatives. `accurate`: the displacement rows are rounding, compared
/// with the derivatives of the forces that balance in them. A large rho magnifies the rounding of Dg and so the rows;
/// if lambda is unknown, another solve removes them; if it is given, none can.
template <class E>
typename LinearisedEquilibrium<E>::Rows LinearisedEquilibrium<E>::evaluate(
    const std::vector<Vector<Direction>>& compact, const std::vector<Vector<Direction>>& lambda) {
  const int blocks = static_cast<int>(problem_.blocks.size());
  Rows rows;
  std::vector<Vector<Direction>> forces, multiplier_rows;
  problem_.counters.contact_evaluations += blocks * static_cast<long>(problem_.model.points.size());
  for (int b = 0; b < blocks; ++b) {
    const auto& slots = problem_.blocks[b].slots;
    rows.fields.push_back(evaluate_contact<Direction>(input(b), compact[b], lambda[b], &at_.contact.state));
    take_rays(input(b), lambda[b], at_.contact.ray, rows.fields[b]);
    forces.push_back(into_frames(problem_.model, slots.frames, Layout::compact,
                                 contact_forces(problem_.model, slots, rows.fields[b])));
    if (unknown_)
      multiplier_rows.push_back(multiplier_residual(problem_.model, slots, rows.fields[b].traction, lambda[b]));
  }
  auto columns = [&](std::vector<Vector<Direction>>& of) {
    return gather(
        problem_.blocks, problem_.parameters, [&](auto&, int b) -> auto& { return of[b]; });
  };
  const Matrix<double> contact = columns(forces);
  rows.u = load_.reduced.kept + problem_.engine.scatter(contact);
  if (unknown_) rows.l = columns(multiplier_rows);
  if ((!unknown_ && !unproven_) || increment_.size() == 0) return rows;
  const Matrix<double> internal = problem_.engine.apply_stiffness(increment_);
  rows.u += internal;
  for (Eigen::Index i = 0; i < rows.u.rows(); ++i)
    if (!problem_.engine.is_free(i)) rows.u.row(i).setZero();
  constexpr double rounding = 100 * unit_roundoff;  // several hundred terms are summed in a row; each rounds once
  double stiffest = 0;                              // largest A rho, force per length
  for (std::size_t p = 0; p < rho_.size() && !unknown_; ++p)
    stiffest = std::max(stiffest, problem_.slots.geometry[p].area * std::max(rho_[p].normal, rho_[p].tangential));
  for (Eigen::Index j = 0; j < rows.u.cols() && rows.u.rows() > 0; ++j) {
    const double size = contact.rows() ? contact.col(j).cwiseAbs().maxCoeff() : 0;
    const double magnified = contact.rows() ? rounding * stiffest * compact_.col(j).cwiseAbs().maxCoeff() : 0;
    rows.accurate &= rows.u.col(j).cwiseAbs().maxCoeff() <=
                     std::max(magnified, 1e-12 * std::max(size, internal.col(j).cwiseAbs().maxCoeff()));
  }
  return rows;
}

template <class E>
void LinearisedEquilibrium<E>::store_state(const std::vector<ContactField<Direction>>& fields,
                                           const std::vector<Vector<Direction>>& lambda) {
  for (std::size_t b = 0; b < problem_.blocks.size(); ++b) {
    auto& block = problem_.blocks[b];
    block.current.multiplier = lambda[b];
    block.current.contact = fields[b];
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

/// Differentiates one increment and expands its displacements. The blocks then have its complete state.
template <class M, class E>
bool differentiate_alone(const M& method, Differentiation<E>& problem, const State<double>& previous,
                         const Increment<double>& increment) {
  if (!differentiate_increment(method, problem, previous, increment)) return false;
  auto displacement = expand(problem, {std::move(*problem.unexpanded)});
  for (std::size_t b = 0; b < problem.blocks.size(); ++b)
    problem.blocks[b].current.displacement = std::move(displacement[0][b]);
  return true;
}

}  // namespace stickslip
