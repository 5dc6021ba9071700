/// All solutions of one increment with few contact points, found by trying every branch of every point, in 2D.
///
/// With the bodies condensed to the compliance H of the contact points (W times tributary areas) and what the
/// regularisation yields, c = 1 / rho (0 where the constraint is exact), each combination of branches is a linear
/// system for the tractions t, g = (g_N, dg_T) = g_0 - H t:
///
///   open   t_N = t_T = 0                        valid where g_N >= 0
///   closed g_N = c_N t_N                        valid where t_N <= 0
///   stick  dg_T = c_T (t_T - lambda_T)          valid where |t_T| <= -mu t_N
///   slip   t_T = -s mu t_N, s = -1 or 1         valid where s (dg_T - c_T (t_T - lambda_T)) >= 0
///
/// If no combination has a negative determinant, the piecewise linear map is coherently oriented and the solution
/// unique under every load: S. M. Robinson, Math. Oper. Res. 17 (1992) 691-714.
#pragma once

#include <optional>

#include "core/model/engine.hpp"

namespace stickslip {

/// The increment's problem on its contact points.
struct BranchProblem {
  /// Combinations that are tried at most: six points with friction.
  static constexpr long most_combinations = 4096;
  struct Point {
    int normal = 0, tangential = -1;                ///< rows of H; tangential -1: without friction
    double friction = 0;                            ///< mu
    double yield_normal = 0, yield_tangential = 0;  ///< c_N, c_T; length^3 per force
    double stored = 0;                              ///< lambda_T; read where c_T > 0
  };
  std::vector<Point> points;
  Matrix<double> compliance;  ///< H, length^3 per force
  Vector<double> free;        ///< g_0: gaps and slips without any traction
  Vector<double> unloaded;    ///< engine dofs without any traction
  Matrix<double> lift;        ///< and what each traction takes off them
};

/// One solution: branches, and g and t in the rows of H.
struct BranchSolution {
  std::vector<ContactState> state;
  Vector<double> kinematics, traction;
};

/// Whether some combination has a negative determinant: under some loads there are several solutions then.
bool may_have_several(const BranchProblem& problem);

/// All solutions; those whose tractions differ by less than 1e-9 of the largest are one.
std::vector<BranchSolution> all_solutions(const BranchProblem& problem);

/// Solutions of an increment other than the one in `taken`, as states; nothing where not all can be tried. The problem
/// is branch_problem's, with its arguments.
std::optional<std::vector<State<double>>> other_solutions(const ContactInput<double>& input,
                                                          const Vector<double>& displacement,
                                                          const State<double>& taken,
                                                          std::shared_ptr<Condensation<double>> condensation,
                                                          const Vector<double>* stored);

/// Whether a model has few enough points for it, in 2D, and friction.
bool can_try_all_branches(const Model& model);

/// Whether mu of some point reaches k_t / |k_nt|, its slave node's stiffness with all other contact nodes held
/// (`schur`: of the bodies on the contact dofs): in slip its tangent would have the other sign.
bool exceeds_critical_friction(const Model& model, const Slots<double>& slots, const Matrix<double>& schur);

/// The problem of an increment that starts from `displacement` (all dofs). `stored`: tractions of the penalty's
/// history; nullptr: exact constraints, of which rho is no part. Nothing where the bodies can move as a whole.
std::optional<BranchProblem> branch_problem(const ContactInput<double>& input, const Vector<double>& displacement,
                                            std::shared_ptr<Condensation<double>> condensation,
                                            const Vector<double>* stored);

}  // namespace stickslip
