/// What all kinds of ties read and give.
#pragma once

#include <optional>
#include <vector>

#include "core/model/flow_points.hpp"
#include "sensitivity/differentiation.hpp"
#include "sensitivity/ties/scales.hpp"

namespace stickslip {

class Tie;

/// One of the branches that meet at a tie.
struct Choice {
  int branch;               ///< a ContactState, a value of flow_branch, or a patch
  Vector<double> ray = {};  ///< ContactField::ray of a contact point; empty: it does not slip from an apex
};

/// Whether a derivative that was found with the choice of a tie confirms this choice.
struct Verdict {
  bool possible = true;               ///< false: the parameter cannot move this way (friction below zero)
  std::optional<Choice> contradicts;  ///< none: confirmed; else the choice that the derivative points to
  double severity = 0;                ///< size of the contradiction, in units of what is negligible
};

/// An equilibrium of a run, and what its method made it with.
struct SolvedState {
  const Model& model;
  const Slots<double>& slots;
  const State<double>& at;
  const Vector<double>& memory;  ///< History::bodies at the start of the increment
  const RegularisationField<double>& rho;
  ConeRadius cone;
  double time;
  double largest;  ///< traction_scale() of the run so far. Why of the run: what was moved may be back where it was
};

/// What a point faces of its surface; at small strain that of the start.
inline const Facing& faced_at(const Model& model, const State<double>& at, int point) {
  return at.contact.facing.empty() ? model.points[point].facing : at.contact.facing[point];
}

/// Whether the gap of a point matters to a derivative: it presses or nearly touches, or a response asks for gaps.
bool has_a_say(const SolvedState& of, int point);
/// Whether a point presses by more than what is negligible.
bool bears(const SolvedState& of, int point);

/// The derivative of an equilibrium on one side of a parameter, dphi = s d, found with the choices of SolvedState::at.
struct SidedDerivative {
  const SolvedState& of;
  const ParameterBlock& block;                   ///< has it in its first direction
  const RegularisationField<Direction>& rho;     ///< of the scheme; it belongs to the multiplier of the block
  double side;                                   ///< s: -1 or 1
  RateScales scales;                             ///< of the block
  std::vector<FlowPoint<Direction>> flows = {};  ///< the material points at ties, in their order (FlowTie::place)

  double rate(const Direction& x) const { return side * x.d[0]; }
};

}  // namespace stickslip
