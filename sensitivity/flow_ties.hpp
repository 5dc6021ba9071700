/// Which branch the derivative of a material point takes where its flow is at a tie.
///
/// At the bound, and at a corner of a table of hardening, neighbouring branches of the flow give the same stress, but
/// other derivatives. Along one direction of the parameters, dphi = s d with s = +-1, the branch of each such point is
/// the one that its own derivative confirms (Dq of the trial, Da of what the flow leaves, found with that branch):
///
///   bound   q = bound(a')   flows iff s (Dq - D bound(a')) > 0
///   corner  a = c           ends behind the corner iff s (Da - Dc) > 0
///
/// Where a point at its bound is at a corner too, a' before the flow says which piece has the bound, and a after it on
/// which one the flow ends. Where a rate itself ties, both branches have the same derivative, and either is confirmed:
/// so do bodies that rest at their bound. Source: core/README.md.
#pragma once

#include "core/model/flow_points.hpp"
#include "sensitivity/branches.hpp"

namespace stickslip {

/// A material point that is about to change its branch.
struct FlowTie {
  int body, element;
  Eigen::Index memory;        ///< FlowPoint::memory
  std::vector<int> branches;  ///< of flow_branch, that meet here; the first holds most
  int corner = -1;            ///< row of the table that the flow ends at; -1: none
  int now;                    ///< the branch of its values
  bool yields() const { return branches.front() == flow_branch::none; }
};

/// The material points of an increment that are at a tie. `before`: what bodies remember of the last increment.
std::vector<FlowTie> flow_ties(const Model& model, const Slots<double>& slots, const Vector<double>& displacement,
                               const Vector<double>& before);

/// Sets the branches of ties to those of their values.
void take_values(const Model& model, const std::vector<FlowTie>& ties, State<double>& at);

/// What a derivative found with the branches of a state says of a tie.
struct FlowVerdict {
  std::optional<int> contradicts;  ///< the branch that it points to, where it contradicts the one it was found with
  double severity = 0;             ///< how much, in units of what is negligible
};

/// One verdict for each tie. `block`: the derivative, in its first direction, found with the branches of `at`.
std::vector<FlowVerdict> judge(const Model& model, const ParameterBlock& block, const std::vector<FlowTie>& ties,
                               const State<double>& at, const SideDirection& along);

}  // namespace stickslip
