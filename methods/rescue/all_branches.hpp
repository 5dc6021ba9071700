/// All solutions of an increment with few contact points, as states of the run; methods/rescue/solutions.hpp finds
/// them.
#pragma once

#include "methods/rescue/solutions.hpp"
#include "methods/stepping/increment.hpp"

namespace stickslip {

/// Whether friction alone may hold some body between surfaces that are not parallel: a body without a support whose
/// contacts have more than one normal.
template <class T>
bool is_wedged(const Model& model, const Slots<T>& slots) {
  constexpr double parallel = 1e-9;
  if (!model.effects.friction) return false;
  return std::any_of(model.bodies.begin(), model.bodies.end(), [&](const BodyMesh& body) {
    const auto owns = [&](int node) {
      return node >= body.first_node && node < body.first_node + body.mesh.node_count;
    };
    if (std::any_of(model.constraints.begin(), model.constraints.end(),
                    [&](const Constraint& constraint) { return owns(constraint.dof / model.dimension); }))
      return false;
    Vector<double> first;  // normal into the body
    for (std::size_t p = 0; p < model.points.size(); ++p) {
      const auto& nodes = model.points[p].nodes;
      if (!owns(nodes.front()) && !owns(nodes.back())) continue;
      const Vector<double> normal = values(slots.geometry[p].normal) * (owns(nodes.front()) ? 1 : -1);
      if (first.size() == 0) first = normal;
      if ((normal - first).norm() > parallel) return true;
    }
    return false;
  });
}

/// Whether two states of an increment are the same solution, as far as a method's tolerance tells.
template <class T>
bool same_solution(const Model& model, const State<T>& a, const State<T>& b, double least_length) {
  constexpr double same = 1e-6;
  const int D = model.dimension;
  const double length =
      std::max({largest_nodal_norm(a.displacement, D), largest_nodal_norm(b.displacement, D), least_length});
  const double traction = std::max(norm(values(a.contact.traction)), norm(values(b.contact.traction)));
  return largest_nodal_norm(Vector<T>(a.displacement - b.displacement), D) <= same * length &&
         norm(values(a.contact.traction - b.contact.traction)) <= same * traction;
}

/// All solutions of an increment with few contact points.
template <class T>
struct Solutions {
  std::vector<State<T>> states;
  std::optional<std::size_t> resting;  ///< the one that is taken (methods/rescue/solutions.hpp)
  double reach = 0;                    ///< length beside which differences of solutions may be rounding
  bool complete = true;                ///< but for rounding, there are no others
  bool feasible = true;                ///< some motion violates no constraint
};

/// Nothing where there are too many points, or bodies can move although all points stick.
template <class T>
std::optional<Solutions<T>> try_all_branches(Run<T>& run, const State<T>& previous,
                                             const std::vector<double>& rho_factor, double time) {
  if (!can_try_all_branches(run.model)) return std::nullopt;
  if (!run.condensation) run.condensation = std::make_shared<Condensation<T>>(run.model, run.slots, Backend::automatic);
  if (!run.condensation->valid()) return std::nullopt;
  auto engine = condensed_engine(run.model, run.slots, SystemKind{}, run.condensation);  // (factorises nothing)
  const auto initial = initial_regularisation(run.slots, run.method);
  const auto rho = rho_factor.empty() ? initial : adapted(initial, rho_factor);
  const ContactInput<T> input{run.model, run.slots, rho, previous.history, ConeRadius::augmented, time};
  const Vector<T> u = engine.begin(time, previous.displacement, {}), stored = stored_traction(run.model, previous);
  const ContactProblem problem = contact_problem(input, engine, u, run.condensation->schur(),
                                                 prevents_penetration(run.method) ? nullptr : &stored);
  const auto all = all_solutions(problem);
  if (!all) return std::nullopt;
  Solutions<T> solutions;
  for (const auto& solution : *all) {
    solutions.states.push_back(as_state(input, engine, u, problem, solution));
    solutions.states.back().history.work = previous.history.work;
  }
  solutions.complete = !has_repeated_constraints(problem);
  solutions.resting = resting_solution(problem, *all);
  solutions.reach = std::max(largest_nodal_norm(u, run.model.dimension), reach_of(problem));
  if (all->empty()) {
    constexpr double nearly = 1e-6;  // what misses its branches by less is not taken for nothing
    solutions.complete = solutions.complete && all_solutions(problem, 0, {}, nearly)->empty();
    solutions.feasible = is_feasible(problem);
  }
  return solutions;
}

}  // namespace stickslip
