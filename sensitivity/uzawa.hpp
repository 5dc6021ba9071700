/// Uzawa: the derivative of  lambda <- t(u(lambda), lambda)  mirrors the updates.
///
///   iterated   (two-phase) lambda first converges, then  D lambda <- D t(Du(D lambda), D lambda)  with one
///   factorisation,
///              a back-solve a parameter and pass, until settled: error q^m, q the contraction of the updates
///   truncated  (piggyback) one pass per augmentation that was performed, with its own tangent: the exact derivative of
///              the truncated algorithm, for a loop that was cut off or stopped at a coarse tolerance
///   oversized  one pass with kappa_s rho in place of rho, states frozen: error O(1/kappa_s), no iteration [SZ00]
///
/// All carry D lambda of the last increment in as D lambda^0. Adjoint: the same maps transposed. The derivative by t
/// goes to lambda and back,  l <- l D t/D lambda,  until nothing is left (iterated), sweep by sweep (truncated), or
/// once. [SLK10 sec. 1], [CD20]
#pragma once

#include "sensitivity/direct.hpp"
#include "sensitivity/pull_back.hpp"

namespace stickslip {

namespace detail {

/// D lambda of the last increment on the value of `multiplier`.
template <class E>
std::vector<Vector<Direction>> carried_multiplier(Differentiation<E>& problem, const Vector<double>& multiplier) {
  std::vector<Vector<Direction>> lambda;
  for (auto& block : problem.blocks) {
    lambda.push_back(lift(multiplier));
    for (Eigen::Index k = 0; k < multiplier.size(); ++k) lambda.back()[k].d = block.previous.contact.traction[k].d;
  }
  return lambda;
}

/// lambda with the derivative of `fields`.
inline void update(std::vector<Vector<Direction>>& lambda, const std::vector<ContactField<Direction>>& fields) {
  for (std::size_t b = 0; b < lambda.size(); ++b)
    for (Eigen::Index k = 0; k < lambda[b].size(); ++k) lambda[b][k].d = fields[b].traction[k].d;
}

template <class E>
LinearisedEquilibrium<E> linearise(const UzawaAL& method, Differentiation<E>& problem, const State<double>& previous,
                                   const State<double>& at, std::vector<double> factor, double oversize, double time,
                                   RegularisationField<double>& rho) {
  for (double& f : factor) f *= oversize;
  rho = adapted(initial_regularisation(problem.slots, method), factor);
  return LinearisedEquilibrium<E>(problem, at, rho, regularisation_blocks(method, problem, factor),
                                  ConeRadius::augmented, time, false, previous.contact.placement);
}

/// Iterates D lambda until the change, extrapolated by its own contraction, is below `tolerance` of D lambda or at the
/// rounding of rho Dg, for every parameter.
template <class E>
bool iterate(Differentiation<E>& problem, LinearisedEquilibrium<E>& linearised, const RegularisationField<double>& rho,
             std::vector<Vector<Direction>>& lambda, std::vector<ContactField<Direction>>& fields) {
  constexpr double tolerance = 1e-13, rounding = 1e-16;
  constexpr int limit = 20000;
  double stiffest = 0;
  for (const auto& r : rho) stiffest = std::max(stiffest, r.normal);
  Eigen::ArrayXd last = Eigen::ArrayXd::Zero(problem.parameters);
  auto columns = [&](auto&& pick) { return gather(problem.blocks, problem.parameters, pick); };
  for (int pass = 1; pass <= limit; ++pass) {
    const Matrix<double> before = columns([&](auto&, int b) -> auto& { return lambda[b]; });
    fields = linearised.solve(lambda);
    const Matrix<double> after = columns([&](auto&, int b) -> auto& { return fields[b].traction; });
    update(lambda, fields);
    bool settled = true;
    for (int j = 0; j < problem.parameters && after.rows() > 0; ++j) {
      const double change = (after.col(j) - before.col(j)).cwiseAbs().maxCoeff();
      const double size = after.col(j).cwiseAbs().maxCoeff();
      const double floor = 8 * rounding * stiffest * linearised.relative_reach().col(j).cwiseAbs().maxCoeff();
      const double q = last[j] > 0 ? change / last[j] : 1;
      const double left = q < 1 ? change * q / (1 - q) : change;
      const bool stalled = pass > 3 && change <= std::max(floor, 4 * rounding * size);
      settled &= change == 0 || stalled || (q < 1 && pass > 2 && left <= tolerance * size);
      last[j] = change;
    }
    if (settled) return true;
  }
  problem.message = "the iterated sensitivity did not settle in 20000 passes; try a larger scale, or oversized";
  return false;
}

}  // namespace detail

template <class E>
bool differentiate_increment(const UzawaAL& method, Differentiation<E>& problem, const State<double>& previous,
                             const Increment<double>& increment) {
  RegularisationField<double> rho;
  if (method.sensitivity == UzawaAL::Sensitivity::truncated) {
    auto lambda = detail::carried_multiplier(problem, previous.contact.traction);
    for (const auto& sweep : increment.sweeps) {
      auto linearised =
          detail::linearise(method, problem, previous, sweep.state, sweep.rho_factor, 1, increment.time, rho);
      if (!linearised.valid()) return false;
      for (std::size_t b = 0; b < lambda.size(); ++b)
        for (Eigen::Index k = 0; k < lambda[b].size(); ++k) lambda[b][k].v = sweep.state.multiplier[k];
      const auto fields = linearised.solve(lambda);
      linearised.settle(fields, lambda);
      detail::update(lambda, fields);
    }
    return true;
  }
  const bool oversized = method.sensitivity == UzawaAL::Sensitivity::oversized;
  auto linearised = detail::linearise(method, problem, previous, increment.state, increment.rho_factor,
                                      oversized ? method.oversize : 1, increment.time, rho);
  if (!linearised.valid()) return false;
  auto lambda = detail::carried_multiplier(problem, increment.state.multiplier);
  std::vector<ContactField<Direction>> fields;
  if (oversized)
    fields = linearised.solve(lambda);
  else if (!detail::iterate(problem, linearised, rho, lambda, fields))
    return false;
  linearised.settle(fields, lambda);
  return true;
}

namespace detail {

/// Records an equilibrium of the loop with rho times `oversize`.
template <class E>
RecordedEquilibrium<E> record(const UzawaAL& method, AdjointProblem<E>& problem, const State<double>& previous,
                              const State<double>& at, std::vector<double> factor, double oversize, double time,
                              bool objectives) {
  for (double& f : factor) f *= oversize;
  problem.tape.rewind(problem.slots_end);
  return RecordedEquilibrium<E>(problem, previous, at,
                                adapted(initial_regularisation(problem.recorded, method), factor),
                                ConeRadius::augmented, time, false, objectives);
}

/// Moves the derivative by lambda on to the update before, again and again, until what is left of it is lost in
/// rounding.
template <class E>
bool iterate_back(AdjointProblem<E>& problem, RecordedEquilibrium<E>& recorded, int objective) {
  constexpr double tolerance = 1e-13, rounding = 1e-16;
  constexpr int limit = 20000;
  double largest = 0, last = 0;
  for (int pass = 1; pass <= limit; ++pass) {
    recorded.balance(objective);
    const Vector<double> left = recorded.take_multiplier(objective);
    const double size = left.size() ? left.cwiseAbs().maxCoeff() : 0;
    largest = std::max(largest, size);
    const double q = last > 0 ? size / last : 1;
    if (size <= 4 * rounding * largest || (q < 1 && pass > 2 && size / (1 - q) <= tolerance * largest)) return true;
    last = size;
    recorded.seed_traction(objective, left);
  }
  problem.message = "the iterated adjoint did not settle in 20000 passes; try a larger scale, or oversized";
  return false;
}

/// All augmentations that were performed, the last one first.
template <class E>
bool pull_back_sweeps(const UzawaAL& method, AdjointProblem<E>& problem, const State<double>& previous,
                      const Increment<double>& increment) {
  const int objectives = static_cast<int>(problem.objectives.size());
  std::vector<HistoryDerivative> gathered(objectives);
  std::vector<Vector<double>> traction(objectives);
  for (std::size_t k = increment.sweeps.size(); k-- > 0;) {
    const auto& sweep = increment.sweeps[k];
    const bool last = k + 1 == increment.sweeps.size();
    auto recorded = record(method, problem, previous, sweep.state, sweep.rho_factor, 1, increment.time,
                           last && increment.requested);
    if (!recorded.valid()) return false;
    for (int j = 0; j < objectives; ++j) {
      if (last)
        recorded.seed_outcome(j);
      else
        recorded.seed_traction(j, traction[j]);
      recorded.balance(j);
      traction[j] = recorded.take_multiplier(j);
      const auto history = recorded.finish(j);
      if (last) {
        gathered[j] = history;
      } else {
        gathered[j].placement += history.placement;
        gathered[j].dissipation += history.dissipation;
      }
    }
  }
  for (int j = 0; j < objectives; ++j) {
    problem.objectives[j].history = gathered[j];
    problem.objectives[j].history.traction = traction[j];
  }
  return true;
}

}  // namespace detail

template <class E>
bool pull_back_increment(const UzawaAL& method, AdjointProblem<E>& problem, const State<double>& previous,
                         const Increment<double>& increment) {
  if (method.sensitivity == UzawaAL::Sensitivity::truncated)
    return detail::pull_back_sweeps(method, problem, previous, increment);
  const bool oversized = method.sensitivity == UzawaAL::Sensitivity::oversized;
  auto recorded = detail::record(method, problem, previous, increment.state, increment.rho_factor,
                                 oversized ? method.oversize : 1, increment.time, increment.requested);
  if (!recorded.valid()) return false;
  for (int j = 0; j < static_cast<int>(problem.objectives.size()); ++j) {
    recorded.seed_outcome(j);
    Vector<double> carried = Vector<double>::Zero(problem.model.multiplier_count);
    if (oversized) {
      recorded.balance(j);
      carried = recorded.take_multiplier(j);
    } else if (!detail::iterate_back(problem, recorded, j)) {
      return false;
    }
    problem.objectives[j].history = recorded.finish(j);
    problem.objectives[j].history.traction = carried;
  }
  return true;
}

}  // namespace stickslip
