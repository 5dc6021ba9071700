/// Which branch the derivative of a contact point takes where its state is a tie.
///
/// At a tie neighbouring branches of the projection give the same traction, but other derivatives. Along one direction
/// of the parameters, dphi = s d with s = +-1, the branch of each such point is the one that its own derivative
/// confirms (Dz = D lambda + D(rho g), found with that branch):
///
///   opens  z_N = 0                 open iff s Dz_N > 0
///   slips  |z_T| = bound > 0       slip iff s (m.Dz_T - D bound) > 0,  m = z_T / |z_T|
///   apex   z_N = 0 and z_T = 0     open iff s Dz_N > 0; else stick iff |Dz_T| <= -mu s Dz_N; else slip along Dz_T
///   line   bound = 0 and z_T = 0   stick iff |Dz_T| <= s Dbound; else slip along Dz_T
///   corner mu p = limit, slipping  limited iff s (D(mu p) - D limit) > 0
///
/// At the corner of a limited law (core/contact/friction_law.hpp) Dbound is the lesser of both. Tresca's bound has no
/// apex: a point that opens or closes while it bears a tangential traction jumps, and has no derivative to that side.
/// A point that slides while it touches (z_N = 0, z_T not zero) closes into slip: that is `opens` too. Where Dz itself
/// ties, both branches have the same derivative, and either is confirmed.
#pragma once

#include <optional>
#include <vector>

#include "sensitivity/direct.hpp"

namespace stickslip {

struct WeakPoint {
  enum class Tie { opens, slips, apex, line, corner };
  int point;
  Tie tie;
};

/// Largest pressure, or k / A times the largest motion: contact that has only just begun is measured by that.
double traction_scale(const Model& model, const Slots<double>& slots, const State<double>& state);

/// The points of an equilibrium that are about to change state. `rho`, `cone`: of the equilibrium. `largest`: the
/// traction_scale of the run so far, for what was moved may be back where it was.
std::vector<WeakPoint> weak_points(const Model& model, const Slots<double>& slots, const State<double>& state,
                                   const RegularisationField<double>& rho, ConeRadius cone, double largest);

struct Branch {
  ContactState state;
  Vector<double> ray;  ///< ContactField::ray of the point; empty: none
};

/// Branch of a point at a state, and the change to another.
Branch branch_of(const Model& model, const State<double>& at, int point);
void take_branch(const Model& model, int point, const Branch& branch, State<double>& at);

/// All branches that a tie can take in the plane; in space without those that slip from an apex.
std::vector<Branch> branches_of(const Model& model, const WeakPoint& weak);

/// What a derivative, found with the branches of a state, says of them.
struct Verdict {
  bool possible = true;               ///< false: the parameter cannot move this way (friction below zero)
  std::optional<Branch> contradicts;  ///< where it contradicts the branch it was found with: the one that it points to
  double severity = 0;                ///< how much, in units of what is negligible
};

/// The direction of a derivative, and what it is measured by.
struct SideDirection {
  double side;            ///< -1 or 1, times the seed
  double parameter;       ///< size of what is seeded by one; 0: not known
  double largest_so_far;  ///< traction_scale of the run up to here
};

/// `block`: the derivative, in its first direction. `rho`: that of the scheme, which belongs to the block's multiplier.
/// `own`: that of the equilibrium.
Verdict judge(const Model& model, const Slots<double>& slots, const ParameterBlock& block,
              const RegularisationField<Direction>& rho, const RegularisationField<double>& own, ConeRadius cone,
              const WeakPoint& weak, const State<double>& at, const SideDirection& along);

}  // namespace stickslip
