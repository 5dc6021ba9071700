/// Augmented Lagrangian with Uzawa updates: Newton with lambda frozen, then lambda <- t, until the update is small.
///
///   repeat  solve  R(u) = f_int - f_ext + sum A t dg = 0,   t = P_mu(lambda + rho g)     (lambda fixed)
///           lambda <- t
///
///   rho  scale, force per length cubed; adapt: times 4 where an augmentation left more than 1/4 of the violation
///
/// The error shrinks by 1/(1 + rho s_min) an augmentation (s_min: smallest stiffness-free compliance of the active
/// constraints, S = B K^-1 B^T A), so a large rho needs few augmentations of harder inner problems. Slip is always
/// measured from the last converged increment, never from the last augmentation. Start: the last increment's lambda.
/// Stops where update, violation and states have settled to `tolerance`. Options: methods/options.hpp. [SL92]
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "methods/increment.hpp"

namespace stickslip {

namespace detail {

/// Violation of the constraint that point p should meet: |g_N| if closed, |dg_T| too if it sticks (length).
template <class T>
double violation(const Model& model, const ContactField<T>& field, int p) {
  if (field.state[p] == ContactState::open) return 0;
  double worst = std::abs(value(field.gap[p]));
  if (field.state[p] == ContactState::stick)
    for (int a = 0; a < model.points[p].tangents; ++a)
      worst = std::max(worst, std::abs(value(field.slip[tangential_offset(model, p) + a])));
  return worst;
}

/// Raises the factor of the points whose violation did not fall to a quarter; capped at 1e3 nodal stiffnesses.
template <class T>
void adapt(const Slots<T>& slots, const RegularisationField<T>& initial, const std::vector<double>& before,
           const std::vector<double>& now, double negligible, std::vector<double>& factor) {
  for (std::size_t p = 0; p < now.size(); ++p) {
    if (now[p] <= negligible || now[p] <= 0.25 * before[p]) continue;
    const double cap = 1e3 * value(slots.stiffness[p]) / value(slots.geometry[p].area) / value(initial[p].normal);
    factor[p] = std::max(factor[p], std::min(4 * factor[p], cap));
  }
}

/// Contraction of the updates d, A d, A^2 d, ... of a linear iteration: the spectral radius of A on the space of all
/// but the last (Arnoldi). Directions that are new by less than 2 %, of which rounding may be part, are left out of it;
/// what is left at least is the ratio of the last two lengths. pre: two updates at least.
inline double contraction(const std::vector<Vector<double>>& updates) {
  const auto m = static_cast<Eigen::Index>(updates.size()) - 1;
  Matrix<double> space(updates[0].size(), m), image(updates[0].size(), m);
  for (Eigen::Index j = 0; j < m; ++j) {
    space.col(j) = updates[j] / updates[j].norm();
    image.col(j) = updates[j + 1] / updates[j].norm();
  }
  Eigen::ColPivHouseholderQR<Matrix<double>> qr;
  qr.setThreshold(0.02);
  qr.compute(space);
  const Eigen::Index rank = qr.rank();
  if (rank < 2) return updates[m].norm() / updates[m - 1].norm();
  const Matrix<double> turned = qr.householderQ().adjoint() * (image * qr.colsPermutation());
  const Matrix<double> R = qr.matrixQR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>();
  const Matrix<double> A = R.transpose().partialPivLu().solve(turned.topLeftCorner(rank, rank).transpose());
  return A.eigenvalues().cwiseAbs().maxCoeff();  // of A transposed, which has the same
}

/// Largest derivative that rides on the entries: the imaginary part of the oracle, nothing on a double.
inline double riding(const Vector<double>&) { return 0; }
inline double riding(const Vector<std::complex<double>>& v) { return v.size() ? v.imag().cwiseAbs().maxCoeff() : 0; }

}  // namespace detail

template <class T, class E>
Increment<T> solve_increment(const UzawaAL& method, Run<T, E>& run, const State<T>& previous,
                             const std::vector<double>& previous_factor, double time) {
  const Model& model = run.model;
  const int points = static_cast<int>(model.points.size());
  const bool truncated = method.sensitivity == UzawaAL::Sensitivity::truncated;
  Increment<T> increment;
  increment.rho_factor = previous_factor.empty() ? std::vector<double>(points, 1.0) : previous_factor;
  const auto initial = initial_regularisation(run.slots, method);
  Vector<T> u = run.engine.begin(time, previous.displacement), lambda = previous.contact.traction;
  std::vector<double> violations;
  std::vector<ContactState> states;
  std::vector<Vector<double>> updates;  // the last five, made in the same states
  double last_update = 0, last_riding = std::numeric_limits<double>::infinity();
  NewtonOptions inner = method.newton;  // an inner residual above the outer tolerance would stall the updates
  inner.tolerance = std::min(inner.tolerance, 0.01 * method.tolerance);
  for (int sweep = 1;; ++sweep) {
    const auto rho = adapted(initial, increment.rho_factor);
    const ContactInput<T> input{model, run.slots, rho, previous.contact.placement, ConeRadius::augmented, time};
    const auto equilibrium =
        newton(run.engine, input, u, lambda, false, sweep == 1 ? previous.contact.state : std::vector<ContactState>{},
               inner, run.account);
    account_for(increment, equilibrium, sweep);
    increment.augmentations = sweep;
    ++run.account.counters.augmentations;
    auto keep = [&] {
      increment.state = settle(run, input, equilibrium, previous.dissipation);
      return increment;
    };
    if (!is_converged(equilibrium.status)) return keep();
    if (truncated)
      increment.sweeps.push_back({settle(run, input, equilibrium, previous.dissipation), increment.rho_factor});

    const Vector<T> change = equilibrium.field.traction - lambda;
    const double update = values(change).norm();
    const double largest_update = change.size() ? values(change).cwiseAbs().maxCoeff() : 0;
    std::vector<double> now(points);
    for (int p = 0; p < points; ++p) now[p] = detail::violation(model, equilibrium.field, p);
    const double worst = points ? *std::max_element(now.begin(), now.end()) : 0;
    const bool settled = equilibrium.field.state == states;
    if (!settled) updates.clear();
    updates.push_back(values(change));
    if (updates.size() > 5) updates.erase(updates.begin());
    if (updates.size() > 1 && last_update > 0) increment.contraction = detail::contraction(updates);
    // what is left of a geometric series after this update, not the update itself, is the error
    const double q = increment.contraction;
    const double left = settled && q > 0 && q < 1 ? largest_update * std::max(1.0, q / (1 - q)) : largest_update;
    const double negligible = method.tolerance * run.account.scales.length;
    const double reach = largest_nodal_norm(run.engine.compact(equilibrium.u), model.dimension);
    const double rounding = 10 * detail::unit_roundoff * reach;  // of a gap
    const bool at_roundoff = settled && worst <= rounding && last_update > 0 && 2 * update > last_update;
    const bool done = (settled || largest_update == 0) &&
                      ((left <= method.tolerance * run.account.scales.traction && worst <= negligible) || at_roundoff);
    const double riding = truncated ? 0 : detail::riding(change);
    const bool still_riding = riding > 1e-13 * detail::riding(equilibrium.field.traction) && !(riding >= last_riding);
    const int limit = method.max_augmentations * (std::is_same_v<T, double> || truncated ? 1 : 20);
    if (done)  // the outer tolerance decides, not the stricter one of the inner solves
      increment.status = at_roundoff && left > method.tolerance * run.account.scales.traction
                             ? Status::converged_at_roundoff
                             : Status::converged;
    if (done && !(still_riding && sweep < limit)) return keep();
    if (sweep >= limit) {
      increment.status = Status::cap;
      increment.message = "max_augmentations reached; try a larger scale, or adapt";
      return keep();
    }
    if (method.adapt && settled && !done)
      detail::adapt(run.slots, initial, violations, now, std::max(negligible, rounding), increment.rho_factor);
    violations = now;
    states = equilibrium.field.state;
    last_update = update;
    last_riding = done ? riding : std::numeric_limits<double>::infinity();
    u = equilibrium.u;
    lambda = equilibrium.field.traction;
  }
}

}  // namespace stickslip
