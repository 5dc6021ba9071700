/// All solutions of one increment with few contact points in 2D, by trying every branch of every point; and the
/// solution in which the bodies come to rest.
///
/// K: stiffness of the bodies on the contact dofs; column of B: gradient of one component of g = (g_N, dg_T) by these
/// dofs; A: tributary areas; g_0: g at the start. The increment v from the start satisfies
///
///   K v + B A t = f,   g = g_0 + B^T v
///
/// K may be singular, since bodies may be free to move rigidly. So K + B W B^T is factorised (W: local stiffness of the
/// points). It gives a relation between g and the tractions as lengths, tau = A t / W:
///
///   (I - P) g + P tau = g_f,   P = B^T (K + B W B^T)^-1 B W
///
/// Each combination of branches turns it into a linear system. y: compliance of a regularised constraint, 0 if it is
/// exact; sigma: its stored tangential traction, as a length.
///
///   open   tau_N = tau_T = 0                    valid where g_N >= 0
///   closed g_N = y tau_N                        valid where tau_N <= 0
///   stick  dg_T = y (tau_T - sigma)             valid where |tau_T| <= -mu tau_N
///   slip   tau_T = -s mu tau_N, s = -1 or 1     valid where s (dg_T - y (tau_T - sigma)) >= 0
///   limited  tau_T = s limit, s = -1 or 1       as slip, and where -mu tau_N >= limit
///
/// With a limit, slip is also valid only where -mu tau_N <= limit, and stick only where |tau_T| <= limit.
///
/// If no combination has a negative determinant, the piecewise linear map is coherently oriented and the solution
/// unique under every load: S. M. Robinson, Math. Oper. Res. 17 (1992) 691-714.
#pragma once

#include <optional>

#include "core/engine/engine.hpp"
#include "core/model/contact_assembly.hpp"
#include "core/model/loading.hpp"
#include "methods/rescue/uniqueness.hpp"

namespace stickslip {

/// The contact problem of an increment on its free contact dofs.
struct ContactProblem {
  struct Point {
    int normal = 0, tangential = -1;                          ///< rows of g; tangential -1: frictionless
    FrictionLaw<double> friction;                             ///< law for tractions as lengths
    double compliance_normal = 0, compliance_tangential = 0;  ///< y
    double stored = 0;                                        ///< sigma, length; read where y > 0
  };
  std::vector<Point> points;
  std::vector<Eigen::Index> dofs;  ///< compact dofs that are free
  Matrix<double> stiffness;        ///< K
  Matrix<double> directions;       ///< B
  Vector<double> load;             ///< f
  Vector<double> start;            ///< g_0
  Vector<double> weight, area;     ///< W and A, per component
  Vector<double> damping;          ///< D of methods/rescue/motion.hpp
};

/// One solution: branches, increment v of the free dofs, g and tractions t.
struct BranchSolution {
  std::vector<ContactState> state;
  Vector<double> increment, kinematics, traction;
  bool reversed = false;  ///< its combination has a negative determinant
};

/// Whether a model is 2D, has at most 4096 combinations of branches, and piecewise linear friction laws.
bool can_try_all_branches(const Model& model);

/// What the determinants of all combinations say of the number of solutions.
Uniqueness uniqueness_of(const ContactProblem& problem);

/// Largest increment of a contact dof if springs of the local stiffness took the place of the contacts, length: beside
/// it a difference of two solutions may be rounding. 0 if bodies can move although all points stick.
double reach_of(const ContactProblem& problem);

/// All solutions. Two count as one whose gaps, slips and tractions differ by less than 1e-9 of the largest, or by the
/// rounding of the motion (all tractions are that where nothing presses). None if bodies can move although all points
/// stick.
///
///   alpha, from  add the forces alpha D (v - from) to the problem
///   rounding     share of lengths and of tractions by which a condition of a branch may be violated
inline constexpr double rounding_of_branches = 1e-11;  // a dozen unknowns, condition numbers up to 1e4
std::optional<std::vector<BranchSolution>> all_solutions(const ContactProblem& problem, double alpha = 0,
                                                         const Vector<double>& from = {},
                                                         double rounding = rounding_of_branches);

/// Whether constraints repeat one another, as those of two contacts at one node. If repeated constraints are active,
/// their tractions are not unique, and all_solutions() does not contain this solution.
bool has_repeated_constraints(const ContactProblem& problem);

/// Whether some motion of the bodies violates no constraint.
bool is_feasible(const ContactProblem& problem);

/// Index of the solution in whose branches the overdamped motion from the start comes to rest; none if it does not.
/// Each step of the motion takes the solution nearest to the last step (methods/rescue/motion.hpp).
std::optional<std::size_t> resting_solution(const ContactProblem& problem, const std::vector<BranchSolution>& all);

/// Whether mu of some point reaches k_t / |k_nt|, beyond which its tangent in slip changes sign. k: stiffness of its
/// slave node with all other contact nodes held. `schur`: stiffness of the bodies on the contact dofs.
bool exceeds_critical_friction(const Model& model, const Slots<double>& slots, const Matrix<double>& schur);

/// D per contact node, force per length: the largest local stiffness among its points. `of`: per body, whether it is
/// damped; empty: all are.
template <class T>
Vector<double> damping(const Model& model, const Slots<T>& slots, const std::vector<char>& of = {}) {
  Vector<double> stiffness = Vector<double>::Zero(static_cast<Eigen::Index>(model.contact_nodes.size()));
  for (std::size_t p = 0; p < model.points.size(); ++p)
    for (int place : model.points[p].places) stiffness[place] = std::max(stiffness[place], value(slots.stiffness[p]));
  for (std::size_t b = 0; b < of.size(); ++b)
    for (std::size_t place = 0; !of[b] && place < model.contact_nodes.size(); ++place) {
      const int first = model.bodies[b].first_node, node = model.contact_nodes[place] - first;
      if (node >= 0 && node < model.bodies[b].mesh.node_count) stiffness[static_cast<Eigen::Index>(place)] = 0;
    }
  return stiffness;
}

/// The contact problem of an increment.
///
///   from    displacements at the start, all dofs
///   engine  its begin() has applied loads and prescribed motions, and returned `u`
///   stored  tractions of the penalty's history; nullptr: constraints are exact, and rho is not read
template <class T>
ContactProblem contact_problem(const ContactInput<T>& input, const Engine<T>& engine, const Vector<T>& u,
                               const Matrix<T>& schur, const Vector<T>* stored) {
  const Model& model = input.model;
  ContactProblem problem;
  for (Eigen::Index i = 0; i < u.size(); ++i)
    if (engine.is_free(i)) problem.dofs.push_back(i);
  ForceScale unused;
  const Vector<double> rows = values(engine.residual(u, Vector<T>::Constant(u.size(), T(0)), unused));
  const auto field =
      evaluate_contact<T>(input, engine.compact(u), Vector<T>::Constant(model.multiplier_count, T(0)), nullptr);
  Matrix<double> directions = Matrix<double>::Zero(u.size(), model.multiplier_count);
  for (auto* v : {&problem.start, &problem.weight, &problem.area}) v->resize(model.multiplier_count);
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    const auto& geometry = input.slots.geometry[p];
    for (int c = 0; c < point.components(); ++c) {
      Vector<T> column = Vector<T>::Constant(u.size(), T(0));
      const Vector<T> direction = c == 0 ? Vector<T>(geometry.normal) : Vector<T>(geometry.tangents.col(0));
      for (std::size_t n = 0; n < point.places.size(); ++n)
        column.template segment<2>(2 * point.places[n]) += geometry.weights[n] * direction;
      const int k = point.multiplier + c;
      directions.col(k) = values(into_frames(model, input.slots.frames, NodalLayout::compact, std::move(column)));
      problem.weight[k] = value(input.slots.stiffness[p]);
      problem.area[k] = value(geometry.area);
      problem.start[k] = value(c == 0 ? field.gap[p] : field.slip[tangential_offset(model, p)]);
    }
    ContactProblem::Point at{point.multiplier, point.tangents > 0 ? point.multiplier + 1 : -1};
    const double local = value(input.slots.stiffness[p]) / value(geometry.area);
    if (point.tangents > 0)
      at.friction = input.slots.friction[point.contact]
                        .template as<double>([](const T& x) { return value(x); })
                        .in_units_of(local);
    if (stored) {
      at.compliance_normal = local / value(input.rho[p].normal);
      at.compliance_tangential = local / value(input.rho[p].tangential);
      if (point.tangents > 0) at.stored = value((*stored)[point.multiplier + 1]) / local;
    }
    problem.points.push_back(at);
  }
  const Vector<double> D = damping(model, input.slots);
  const auto free = static_cast<Eigen::Index>(problem.dofs.size());
  problem.stiffness.resize(free, free);
  problem.directions.resize(free, model.multiplier_count);
  problem.load.resize(free);
  problem.damping.resize(free);
  for (Eigen::Index i = 0; i < free; ++i) {
    for (Eigen::Index j = 0; j < free; ++j) problem.stiffness(i, j) = value(schur(problem.dofs[i], problem.dofs[j]));
    problem.directions.row(i) = directions.row(problem.dofs[i]);
    problem.load[i] = -rows[problem.dofs[i]];
    problem.damping[i] = D[problem.dofs[i] / model.dimension];
  }
  return problem;
}

/// The state of a solution, without its dissipation. `u`: as above.
template <class T>
State<T> as_state(const ContactInput<T>& input, const Engine<T>& engine, Vector<T> u, const ContactProblem& problem,
                  const BranchSolution& solution) {
  for (std::size_t i = 0; i < problem.dofs.size(); ++i) u[problem.dofs[i]] += T(solution.increment[i]);
  State<T> state;
  state.displacement = engine.all(u);
  state.multiplier = solution.traction.template cast<T>();
  state.contact = evaluate_contact<T>(input, engine.compact(u), state.multiplier, &solution.state);
  state.contact.traction = state.multiplier;
  state.history.placement = std::move(state.contact.placement);
  return state;
}

}  // namespace stickslip
