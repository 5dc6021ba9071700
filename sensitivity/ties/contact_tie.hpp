/// Ties of contact points: neighbouring branches of the projection give the same traction but different derivatives.
///
/// Dz = D lambda + D(rho g) is the derivative of the trial, found with the branch that it is to confirm:
///
///   opens  z_N = 0                 open iff s Dz_N > 0
///   slips  |z_T| = bound > 0       slip iff s (m.Dz_T - D bound) > 0,  m = z_T / |z_T|
///   apex   z_N = 0 and z_T = 0     open iff s Dz_N > 0; else stick iff |Dz_T| <= -mu s Dz_N; else slip along Dz_T
///   line   bound = 0 and z_T = 0   stick iff |Dz_T| <= s Dbound; else slip along Dz_T
///   corner mu p = limit, slipping  limited iff s (D(mu p) - D limit) > 0
///
/// At the corner of a limited law (core/contact/friction_law.hpp) Dbound is the lesser of the two derivatives. Tresca's
/// bound has no apex: a point that opens or closes with a tangential traction jumps, and has no derivative on that
/// side. A point that slides while it touches (z_N = 0, z_T not zero) is of the kind `opens`, and closes into slip.
#pragma once

#include "sensitivity/ties/choice.hpp"

namespace stickslip {

struct ContactTie {
  static constexpr bool holds = true;  // by stick more than by slip
  enum class Kind { opens, slips, apex, line, corner };
  int point;
  Kind kind;

  static void find(const SolvedState& of, std::vector<Tie>& ties);
  /// In space those that slip from an apex are left out.
  std::vector<Choice> choices(const Model& model) const;
  Choice now(const Model& model, const State<double>& at) const;
  void set(const Model& model, const Choice& choice, State<double>& at) const;
  Verdict verdict(const SidedDerivative& derivative) const;
};

}  // namespace stickslip
