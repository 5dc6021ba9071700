/// Branches of contact points at ties, for one-sided derivatives.
///
/// At a tie, neighbouring branches of the projection give the same traction but different derivatives. Take one side of
/// a parameter, dphi = s d with s = +-1. The branch of a point at a tie is the one that its own derivative confirms.
/// That derivative is Dz = D lambda + D(rho g), found with this branch:
///
///   opens  z_N = 0                 open iff s Dz_N > 0
///   slips  |z_T| = bound > 0       slip iff s (m.Dz_T - D bound) > 0,  m = z_T / |z_T|
///   apex   z_N = 0 and z_T = 0     open iff s Dz_N > 0; else stick iff |Dz_T| <= -mu s Dz_N; else slip along Dz_T
///   line   bound = 0 and z_T = 0   stick iff |Dz_T| <= s Dbound; else slip along Dz_T
///   corner mu p = limit, slipping  limited iff s (D(mu p) - D limit) > 0
///
/// At the corner of a limited law (core/contact/friction_law.hpp) Dbound is the lesser of the two derivatives. Tresca's
/// bound has no apex: a point that opens or closes with a tangential traction jumps, and has no derivative on that
/// side. A point that slides while it touches (z_N = 0, z_T not zero) is of the kind `opens`, and closes into slip. If
/// Dz itself ties, both branches have the same derivative, and each is confirmed.
#pragma once

#include <optional>
#include <vector>

#include "sensitivity/direct.hpp"

namespace stickslip {

/// A contact point at a tie.
struct WeakPoint {
  enum class Tie { opens, slips, apex, line, corner };
  int point;
  Tie tie;
};

/// Scale of the tractions of a state, force per area: the larger of the largest pressure and of k / A times the largest
/// motion of a point. The second counts where contact has only just begun.
double traction_scale(const Model& model, const Slots<double>& slots, const State<double>& state);

/// The points at ties of an equilibrium. `rho`, `cone`: of the equilibrium; `largest`: traction_scale() of the run so
/// far. Why of the run: what was moved may be back where it was.
std::vector<WeakPoint> weak_points(const Model& model, const Slots<double>& slots, const State<double>& state,
                                   const RegularisationField<double>& rho, ConeRadius cone, double largest);

/// Size of the derivatives of tractions at a state, per direction: the largest of
///
///   the derivatives of all tractions, and of all motions times k / A
///   1e-3 of k / A times the largest derivative of a displacement: what a rigid motion leaves of these
Direction::Gradient traction_rates(const Model& model, const Slots<double>& slots, const State<Direction>& at);

/// Branch of the projection.
struct Branch {
  ContactState state;
  Vector<double> ray;  ///< ContactField::ray of the point; empty: it does not slip from an apex
};

/// Branch of a point at a state.
Branch branch_of(const Model& model, const State<double>& at, int point);
/// Sets the branch of a point at a state.
void set_branch(const Model& model, int point, const Branch& branch, State<double>& at);

/// All branches of a tie, the one that holds most first. In space those that slip from an apex are left out.
std::vector<Branch> branches_of(const Model& model, const WeakPoint& weak);

/// Whether a derivative that was found with the branch of a point confirms this branch.
struct Verdict {
  bool possible = true;               ///< false: the parameter cannot move this way (friction below zero)
  std::optional<Branch> contradicts;  ///< none: confirmed; else the branch that the derivative points to
  double severity = 0;                ///< size of the contradiction, in units of what is negligible
};

/// Side of a one-sided derivative, and its scales.
struct SideDirection {
  double side;            ///< s: -1 or 1
  double parameter;       ///< size of the parameter; 0: not known
  double largest_so_far;  ///< traction_scale() of the run so far
};

/// Verdict on the branch of a point at a tie.
///
///   block  the derivative, in its first direction, found with the branches of `at`
///   rho    of the scheme, which belongs to the multiplier of the block
///   own    rho of the equilibrium
Verdict branch_verdict(const Model& model, const Slots<double>& slots, const ParameterBlock& block,
                       const RegularisationField<Direction>& rho, const RegularisationField<double>& own,
                       ConeRadius cone, const WeakPoint& weak, const State<double>& at, const SideDirection& along);

}  // namespace stickslip
