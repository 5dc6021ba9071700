/// One contact point: kinematics, trial traction, projection onto the law of friction and nodal forces, for every
/// method and scalar.
///
/// At small strain projection, normal, frame and area are those of the initial configuration, so the relative
/// displacement w = u_s - sum N_i u_i - u_obstacle gives
///
///   g_N  = g_0 + n . w           normal gap (length; negative is penetration)
///   s    = e_a . w               tangential placement; the only history of the augmented Lagrangian methods
///   dg_T = s - s_previous        slip increment since the last converged increment
///   z    = lambda + rho (g_N, (rho_T/rho) dg_T),   t = P_mu(z)        core/contact/friction_cone.hpp
///
/// and the nodal forces of the residual: slave +A (t_N n + t_a e_a), master node i  -N_i A (t_N n + t_a e_a).
/// The methods differ only in who supplies lambda. Source: theory of [AC91], [PC99], [SL92].
#pragma once

#include "core/contact/cone_radius.hpp"
#include "core/contact/friction_cone.hpp"
#include "core/contact/point_geometry.hpp"

namespace stickslip {

/// What the history keeps of a foot, in D dimensions: its place, and in space a normal and a tangent.
template <class T, int D>
using Feet = Vec<T, D == 3 ? 9 : D>;

/// What a contact point leaves behind at the end of an increment: its local unknowns, and the history of the next.
template <class T, int Tangents>
struct PointOutcome {
  ContactState state = ContactState::open;
  T gap{};
  Vec<T, Tangents> placement = Vec<T, Tangents>::Zero();       ///< s
  Vec<T, Tangents> slip = Vec<T, Tangents>::Zero();            ///< dg_T of this increment
  Traction<T, Tangents> traction;                              ///< t
  Feet<T, Tangents + 1> foot = Feet<T, Tangents + 1>::Zero();  ///< in present geometry
};

/// Penalty / scale of a point, force per length cubed.
template <class T>
struct PointRegularisation {
  T normal{}, tangential{};
};

/// Sets state and traction of a point whose gap, placement and slip are known. `tie_length`: a gap up to this counts as
/// none. `state`: the branch to take; nullptr: classify.
template <class T, int Tangents>
void project_point(const Traction<T, Tangents>& multiplier, const PointRegularisation<T>& rho,
                   const FrictionLaw<T>& friction, ConeRadius cone, double tie_length, const ContactState* state,
                   PointOutcome<T, Tangents>& point) {
  Traction<T, Tangents> trial;
  trial.normal = multiplier.normal + rho.normal * point.gap;
  for (int a = 0; a < Tangents; ++a) trial.tangential[a] = multiplier.tangential[a] + rho.tangential * point.slip[a];
  T bound{};
  ContactState piece = state && is_slipping(*state) ? *state : ContactState::slip;
  if constexpr (Tangents > 0) {
    const bool augmented = cone == ConeRadius::augmented;
    const T pressure = augmented ? T(-trial.normal) : T(-multiplier.normal);
    if (!state) piece = friction.piece(value(pressure));
    if (value(pressure) > 0 || augmented || !friction.follows_pressure(piece)) bound = friction.bound(pressure, piece);
  }
  point.state = state ? *state : classify(trial, value(bound), value(rho.normal) * tie_length);
  if (point.state == ContactState::slip) point.state = piece;
  point.traction = project_onto_cone(trial, bound, point.state);
}

/// Evaluates the point in its initial geometry. `w`: relative displacement.
template <class T, int D, int Tangents>
PointOutcome<T, Tangents> evaluate_point(const PointGeometry<T>& geometry, const Vec<T, D>& w,
                                         const Traction<T, Tangents>& multiplier,
                                         const Vec<T, Tangents>& previous_placement, const PointRegularisation<T>& rho,
                                         const FrictionLaw<T>& friction, ConeRadius cone, double tie_length,
                                         const ContactState* state) {
  static_assert(Tangents == 0 || Tangents == D - 1);
  PointOutcome<T, Tangents> point;
  point.gap = geometry.gap + dot(geometry.normal.template head<D>(), w);
  for (int a = 0; a < Tangents; ++a) {
    point.placement[a] = dot(geometry.tangents.col(a).template head<D>(), w);
    point.slip[a] = point.placement[a] - previous_placement[a];
  }
  project_point(multiplier, rho, friction, cone, tie_length, state, point);
  return point;
}

/// Outcome of a point with its present geometry. `foot`: as History::foot stores it. `foot_motion`: vector from the
/// foot of the last increment to this one, both on the present master, length. The slip is the tangential part of
/// `foot_motion`. On a curved obstacle this is the chord, which differs from the arc by O(slip^3).
template <class T, int D, int Tangents>
PointOutcome<T, Tangents> evaluate_moved_point(const PointGeometry<T>& geometry, const Feet<T, D>& foot,
                                               const Vec<T, D>& foot_motion, const Traction<T, Tangents>& multiplier,
                                               const Vec<T, Tangents>& previous_placement,
                                               const PointRegularisation<T>& rho, const FrictionLaw<T>& friction,
                                               ConeRadius cone, double tie_length, const ContactState* state) {
  PointOutcome<T, Tangents> point;
  point.gap = geometry.gap;
  for (int a = 0; a < Tangents; ++a) {
    point.slip[a] = dot(geometry.tangents.col(a).template head<D>(), foot_motion);
    point.placement[a] = previous_placement[a] + point.slip[a];
  }
  if constexpr (Tangents > 0) point.foot = foot;
  project_point(multiplier, rho, friction, cone, tie_length, state, point);
  return point;
}

/// Force of the point per unit weight, A (t_N n + t_a e_a): add weight_i times it to the residual rows of node i.
template <class T, int D, int Tangents>
Vec<T, D> point_force(const PointGeometry<T>& geometry, const Traction<T, Tangents>& traction) {
  Vec<T, D> force;
  for (int i = 0; i < D; ++i) {
    T f = traction.normal * geometry.normal[i];
    for (int a = 0; a < Tangents; ++a) f += traction.tangential[a] * geometry.tangents(i, a);
    force[i] = geometry.area * f;
  }
  return force;
}

}  // namespace stickslip
