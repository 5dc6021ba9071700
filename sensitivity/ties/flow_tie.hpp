/// Ties of material points: at the bound, and at a corner of a hardening table, neighbouring branches of the plastic
/// flow give the same stress but different derivatives.
///
/// Dq of the trial stress q, and Da of the strain a after the flow, are found with the branch that they are to confirm:
///
///   bound   q = bound(a')   flows iff s (Dq - D bound(a')) > 0,  a' the strain before the flow
///   corner  a = c           ends behind the corner iff s (Da - Dc) > 0
///
/// If a point at its bound is at a corner too, a' decides which piece has the bound, and a decides on which piece the
/// flow ends. Example: bodies that rest at their bound. Source: core/README.md.
#pragma once

#include "sensitivity/ties/choice.hpp"

namespace stickslip {

struct FlowTie {
  static constexpr bool holds = true;  // within the bound
  int body, element;
  Eigen::Index memory;  ///< FlowPoint::memory
  std::size_t place;    ///< among the flow ties of the state
  bool yields;          ///< at its bound
  int corner;           ///< row of the hardening table at which the flow ends; -1: none
  int piece;            ///< of the bound where the increment started
  int computed;         ///< the value of flow_branch that the solution took

  static void find(const SolvedState& of, std::vector<Tie>& ties);
  /// The material points of all flow ties, with a derivative: SidedDerivative::flows.
  static std::vector<FlowPoint<Direction>> points_of(const std::vector<Tie>& ties, const SolvedState& of,
                                                     const ParameterBlock& block);
  std::vector<Choice> choices(const Model& model) const;
  Choice now(const Model& model, const State<double>& at) const;
  void set(const Model& model, const Choice& choice, State<double>& at) const;
  Verdict verdict(const SidedDerivative& derivative) const;
};

/// Derivatives of the margins of a flow up to this are rounding. `bound`: of the trial; `corner`: sizes of the
/// derivatives of the strain of a corner.
RateScales::ByDirection negligible_of_flow(const FlowPoint<Direction>& point, const Direction& bound,
                                           const RateScales::ByDirection& corner, const RateScales& scales);

}  // namespace stickslip
