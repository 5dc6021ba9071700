/// Branches of material points at ties of their plastic flow, for one-sided derivatives.
///
/// At the bound, and at a corner of a hardening table, neighbouring branches of the flow give the same stress but
/// different derivatives. Take one side of a parameter, dphi = s d with s = +-1. The branch of a point at a tie is the
/// one that its own derivative confirms: Dq of the trial stress q, and Da of the strain a after the flow, found with
/// this branch:
///
///   bound   q = bound(a')   flows iff s (Dq - D bound(a')) > 0,  a' the strain before the flow
///   corner  a = c           ends behind the corner iff s (Da - Dc) > 0
///
/// If a point at its bound is at a corner too, a' decides which piece has the bound, and a decides on which piece the
/// flow ends. If a rate itself ties, both branches have the same derivative, and each is confirmed. Example: bodies
/// that rest at their bound. Source: core/README.md.
#pragma once

#include "core/model/flow_points.hpp"
#include "sensitivity/branches.hpp"

namespace stickslip {

/// A material point at a tie.
struct FlowTie {
  int body, element;
  Eigen::Index memory;        ///< FlowPoint::memory
  std::vector<int> branches;  ///< the values of flow_branch that meet here; the first holds most
  int corner = -1;            ///< row of the hardening table at which the flow ends; -1: none
  int now;                    ///< the branch of the computed flow
  /// Whether the point is at its bound.
  bool yields() const { return branches.front() == flow_branch::none; }
};

/// The material points of an increment at a tie. `before`: History::bodies of the last increment.
std::vector<FlowTie> flow_ties(const Model& model, const Slots<double>& slots, const Vector<double>& displacement,
                               const Vector<double>& before);

/// Sets the branches of ties to those of the computed flow.
void set_computed_branches(const Model& model, const std::vector<FlowTie>& ties, State<double>& at);

/// Whether a derivative that was found with the branch of a tie confirms this branch.
struct FlowVerdict {
  std::optional<int> contradicts;  ///< none: confirmed; else the branch that the derivative points to
  double severity = 0;             ///< size of the contradiction, in units of what is negligible
};

/// One verdict for each tie. `block`: the derivative, in its first direction, found with the branches of `at`.
std::vector<FlowVerdict> flow_verdicts(const Model& model, const ParameterBlock& block,
                                       const std::vector<FlowTie>& ties, const State<double>& at,
                                       const SideDirection& along);

}  // namespace stickslip
