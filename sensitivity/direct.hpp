/// Direct differentiation: the part that all schemes share.
///
/// A State<Direction> carries the derivative of a state by `directions` parameters. At the converged state of an
/// increment
///
///   K Dp = -r,     r = directional derivative of R by parameters, history and prescribed motion at fixed p
///
/// p is u, and lambda too where it is an unknown. One sweep of the solver's own residual in dual numbers gives r. A
/// second sweep with Dp gives the derivatives of the local unknowns, which are the history of the next increment. The
/// schemes differ, as the methods do, in what they pass for D lambda. [MTV94], [SLK10]
#pragma once

#include "methods/newton/regularisation.hpp"
#include "sensitivity/differentiation.hpp"
#include "sensitivity/tangent.hpp"

namespace stickslip {

/// rho of the method with its derivatives, per block. `rho_factor`: adaption of rho per point; empty: none.
inline std::vector<RegularisationField<Direction>> regularisation_blocks(const Differentiation& problem,
                                                                         const std::vector<double>& rho_factor = {}) {
  std::vector<RegularisationField<Direction>> rho;
  for (const auto& block : problem.blocks)
    rho.push_back(adapted(initial_regularisation(block.slots, problem.method), rho_factor));
  return rho;
}

/// Derivative problem of one equilibrium: factorised tangent and the bodies' part of the pseudo-load. Neither changes
/// while D lambda is iterated.
class LinearisedEquilibrium {
 public:
  ///   at          the state; its multiplier is the lambda of the equilibrium
  ///   rho         in double; rho_blocks: per block
  ///   multipliers unknown: lambda is part of p
  ///   previous    history of the last increment
  LinearisedEquilibrium(Differentiation& problem, const State<double>& at, const RegularisationField<double>& rho,
                        std::vector<RegularisationField<Direction>> rho_blocks, ConeRadius cone, double time,
                        Multipliers multipliers, const History<double>& previous);

  /// Solves for the derivative. False if the tangent is singular. `lambda`: per block, D lambda as a seed. If lambda is
  /// unknown, pass D lambda = 0; its solution is added.
  bool solve(std::vector<Vector<Direction>>& lambda);
  /// Of the last solve, per block: local unknowns with all derivatives.
  const std::vector<ContactField<Direction>>& fields() const { return fields_; }

  /// Stores the derivatives of the last solve in the current state of every block. Displacements remain unexpanded.
  void store_state(const std::vector<Vector<Direction>>& lambda);

  /// Largest derivatives, per parameter. largest_motion(): of contact displacements in this increment and of placements
  /// in the last, length. load(): of the forces of bodies and loads in the engine's rows, before they cancel.
  Vector<double> largest_motion() const {
    const Matrix<double> then = gather(
        problem_.blocks,
        problem_.parameters, [&](auto& block, int) -> auto& { return block.previous.history.placement; });
    return largest(compact_).cwiseMax(largest(then));
  }
  Vector<double> load() const { return largest(load_.reduced.kept); }

 private:
  static constexpr int refinements = 2;
  static Vector<double> largest(const Matrix<double>& columns) {
    if (columns.rows() == 0) return Vector<double>::Zero(columns.cols());
    return columns.cwiseAbs().colwise().maxCoeff();
  }
  struct Rows {
    Matrix<double> u, l;
    std::vector<ContactField<Direction>> fields;
    bool accurate = true;
  };
  /// One solve with the factor. Adds its result to the increment, to the compact displacements and, if unknown, to
  /// lambda.
  void improve(const Rows& rows, std::vector<Vector<Direction>>& compact, std::vector<Vector<Direction>>& lambda);
  Rows evaluate(const std::vector<Vector<Direction>>& compact, const std::vector<Vector<Direction>>& lambda);
  bool solves_for_multipliers() const { return multipliers_ == Multipliers::unknown; }
  ContactInput<Direction> input(int block) const {
    return {problem_.model,
            problem_.blocks[block].slots,
            rho_blocks_[block],
            problem_.blocks[block].previous.history,
            cone_,
            time_,
            &at_.contact.facing};
  }

  Differentiation& problem_;
  ContactInput<double> primal_;
  const State<double>& at_;
  std::vector<RegularisationField<Direction>> rho_blocks_;
  const RegularisationField<double>& rho_;
  ConeRadius cone_;
  double time_;
  Multipliers multipliers_;
  bool valid_ = false;
  bool redundant_ = false;                ///< constraints repeat one another: one more solve is needed
  bool unproven_ = false;                 ///< the factor is Newton's last, and not yet checked on these rows
  Solving solving_ = Solving::unrefined;  ///< unrefined as long as that is accurate
  PseudoLoad load_;
  Matrix<double> increment_, compact_;
  std::vector<ContactField<Direction>> fields_;
};

}  // namespace stickslip
