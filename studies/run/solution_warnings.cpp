#include "studies/run/solution_warnings.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <span>

#include "core/mesh/shapes.hpp"
#include "core/model/element_nodes.hpp"
#include "methods/newton/residuals.hpp"
#include "methods/stepping/checkpoints.hpp"
#include "methods/stepping/diagnosis.hpp"
#include "sensitivity/force_search.hpp"
#include "studies/io/wording.hpp"
#include "studies/run/warnings.hpp"

namespace stickslip {
namespace {

void add_loose_bodies(const CaseResult& result, std::vector<Warning>& warnings) {
  if (const Body* const loose = loose_body(result.problem->model))
    warnings.push_back({WarningCode::non_unique, loose->name, 0, "add a support or a contact",
                        loose->name + " may be anywhere: no support holds it and no contact touches it; it is left "
                                      "where it is"});
}

/// Steps with other solutions than the one that was taken, where these were counted, or with tangents that belong to
/// problems of which some have several.
void add_other_solutions(const CaseResult& result, std::vector<Warning>& warnings) {
  std::size_t most = 0, several = 0, uncounted = 0;
  double first = 0;
  const std::span increments(result.trajectory.increments.data(), result.trajectory.solved_count());
  for (const auto& increment : increments) {
    if (increment.reversed && !increment.counted) ++uncounted;
    if (increment.others.empty()) continue;
    if (several++ == 0) first = increment.time;
    most = std::max(most, 1 + increment.others.size());
  }
  const std::string remedy =
      "look at `solutions`, and whether friction this high is meant; smaller steps follow a branch";
  if (several > 0)
    warnings.push_back(
        {WarningCode::non_unique, "", static_cast<double>(most), remedy,
         fmt::format("{} of {} increments have several solutions, up to {}, the first at t = {:.6g}; the one "
                     "is taken in which the motion from the last increment comes to rest",
                     several, increments.size(), most, first)});
  for (const auto& increment : increments)
    if (increment.jump)
      warnings.push_back({WarningCode::branch_ends, "", *increment.jump,
                          "control a displacement in place of a force, or lower the friction",
                          fmt::format("the branch of solutions ends at t = {:.4g}, and the bodies jump to another one",
                                      *increment.jump)});
  if (several == 0 && uncounted > 0)
    warnings.push_back(
        {WarningCode::non_unique, "", 1, remedy,
         fmt::format("{} of {} increments met tangents whose determinant has the other sign: there may be "
                     "other solutions",
                     uncounted, increments.size())});
}

/// Steps whose equilibrium the least disturbance leaves, but along a path by arc length, which seeks such.
void add_unstable_steps(const CaseResult& result, std::vector<Warning>& warnings) {
  if (result.problem->model.scene.arc_length) return;
  const auto steps = solved_steps(result);
  const auto is_unstable = [](const StepResult& step) {
    return step.increment->unstable || step.increment->unresisted > 1;
  };
  const auto first = std::find_if(steps.begin(), steps.end(), is_unstable);
  if (first == steps.end()) return;
  const auto count = std::count_if(first, steps.end(), is_unstable);
  warnings.push_back({WarningCode::unstable, "", static_cast<double>(count),
                      "hold what may tip, buckle or slide aside, or prescribe a motion in place of a force",
                      fmt::format("in {} of {} steps, first at t = {:.6g}, the equilibrium is unstable: as the "
                                  "step goes on, the bodies resist some motion by less than nothing, and the least "
                                  "disturbance leads to another solution",
                                  count, steps.size(), first->increment->time)});
}

/// Contacts whose forces equilibrium leaves open, and points on a vertex or at an end.
void add_undetermined_contacts(const CaseResult& result, std::vector<Warning>& warnings) {
  const auto& contacts = result.problem->model.scene.contacts;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const std::string& name = contacts[c].name;
    const auto warn = [&](std::vector<char> StepResult::*marks, double value, const char* remedy, const char* what) {
      if (const long n = steps_with(result, c, marks); n > 0)
        warnings.push_back({WarningCode::non_unique, name, value, remedy,
                            fmt::format("{}: in {} of {} steps {}", name, n, solved_steps(result).size(), what)});
    };
    warn(&StepResult::undetermined, 0,
         "take friction off one of the contacts of a node, or use fewer slave nodes on a facet of the master",
         "the forces of its points are not determined: their constraints repeat one another, so that other forces "
         "balance the same loads; methods, scales and steps may settle on different ones");
    warn(
        &StepResult::at_vertex, 1,
        R"(smooth the master, integrate over segments ("discretization": "segment"), or shift a mesh a little)",
        "a point that presses begins or ends at a vertex of the master's facets, or next to it: each of the two facets "
        "may lead to a solution of its own, and methods, steps and rounding may settle on different ones");
    warn(&StepResult::at_end, 1,
         R"(integrate over segments ("discretization": "segment"), take the other side as the slave, or smaller steps)",
         "a node that presses comes to an end of its master: friction may hold it there, or let it go, and methods may "
         "settle on different ones");
  }
}

/// Bars that only their tension holds once it is there: at the start they are a mechanism, and any way that it folds
/// may be the one of a solution.
void add_mechanisms(const CaseResult& result, std::vector<Warning>& warnings) {
  const auto& model = result.problem->model;
  if (!model.effects.friction || !model.scene.finite_strain) return;
  const auto& initial = result.trajectory.initial;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const std::string& name = model.scene.bodies[b].name;
    if (const std::string joint =
            detail::free_joint(model, result.problem->slots, b, initial,
                               touching_states(model, result.problem->slots, initial.contact.state));
        !joint.empty())
      warnings.push_back(
          {WarningCode::non_unique, name, 1, "hold its joints until the bars are in tension, and take small steps",
           fmt::format("{} begins as a mechanism: its joint {}, and nothing but the tension that its bars get will "
                       "hold it; the ways in which it may fold, and the slip on each, are solutions of their own",
                       name, joint)});
  }
}

/// dN/dxi, nodes x dimension, at the natural places at which the change of volume of an element is looked at: of
/// straight sides its corners; of curved ones a grid of 5 x 5.
template <class Shape>
std::vector<Matrix<double>> gradients_of_shape() {
  std::vector<Matrix<double>> all;
  constexpr int n = Shape::nodes > Shape::corners ? 4 : 1;
  constexpr bool simplex = Shape::is_simplex;
  const auto natural = [](int i) { return simplex ? static_cast<double>(i) / n : 2.0 * i / n - 1; };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= (simplex ? n - i : n); ++j)
      if constexpr (Shape::dimension == 3)
        for (int k = 0; k <= (simplex ? n - i - j : n); ++k)
          all.emplace_back(Shape::at(natural(i), natural(j), natural(k), 0).gradient.transpose());
      else
        all.emplace_back(Shape::at(natural(i), natural(j), 0).gradient.transpose());
  return all;
}
std::vector<Matrix<double>> gradients_of(ElementShape shape) {
  std::vector<Matrix<double>> gradients;
  with_shape(shape, [&]<class Shape>(Shape) { gradients = gradients_of_shape<Shape>(); });
  return gradients;
}

/// Least over largest of the change of volume J within an element whose nodes go from X to x; negative where it turns
/// over. `gradients`: of its shape.
template <int D>
double evenness(const std::vector<Matrix<double>>& gradients, const Points<double>& X, const Points<double>& x) {
  double least = std::numeric_limits<double>::infinity(), largest = 0;
  for (const auto& gradient : gradients) {
    const Mat<double, D> before = X * gradient, now = x * gradient;
    const double J = now.determinant() / before.determinant();
    least = std::min(least, J);
    largest = std::max(largest, J);
  }
  return least / largest;
}

/// Bodies at finite strain with folded elements, or nearly folded ones, in a state that is kept.
void add_folded_elements(const CaseResult& result, std::vector<Warning>& warnings) {
  constexpr double nearly = 0.02;  // volumes that change fifty times as much within one element are not its to resolve
  const auto& [model, slots, unused] = *result.problem;
  if (!model.scene.finite_strain) return;
  for (const auto& body : model.bodies) {
    if (!is_continuum(body.mesh.shape)) continue;
    long most = 0;
    double first = 0;
    std::vector<int> nodes;
    Points<double> X, x;
    const auto gradients = gradients_of(body.mesh.shape);
    for (const auto& step : solved_steps(result)) {
      const auto& u = step.increment->state.displacement;
      long folded = 0;
      for (int e = 0; is_whole(step.increment->state) && e < body.mesh.element_count(); ++e) {
        detail::set_element_nodes(body, e, nodes);
        X = slots.points(Eigen::all, nodes);
        x = X + u.reshaped(model.dimension, model.node_count)(Eigen::all, nodes);
        with_dimension(model.dimension, [&]<int D>() { folded += evenness<D>(gradients, X, x) < nearly; });
      }
      if (folded > 0 && most == 0) first = step.increment->time;
      most = std::max(most, folded);
    }
    if (most == 0) continue;
    const std::string& name = model.scene.bodies[&body - model.bodies.data()].name;
    warnings.push_back(
        {WarningCode::folded_element, name, static_cast<double>(most), "take smaller steps, or a finer mesh there",
         fmt::format("{}: {} of its elements {} folded or nearly so, first at t = {:.6g}: no integration "
                     "point sees it, and there may be another solution",
                     name, most, most == 1 ? "is" : "are", first)});
  }
}

/// Springs of a penalty that yield beside the bodies: under the contact's force, as the method-blind errors measure it;
/// and under the part of the pressures that the slave alone shares out, where more nodes of it face the master than
/// nodes of that. It yields there by 1/k of its nodes, beside which the springs' 1/(stiffness A) is to be small.
void add_soft_penalty(const CaseResult& result, std::vector<Warning>& warnings) {
  constexpr double most = 0.02;
  if (prevents_penetration(result.method)) return;
  constexpr const char* stiffer = "raise `stiffness`, or take another method";
  double yields = 0;
  for (const auto& step : solved_steps(result)) yields = std::max({yields, step.kkt.gap, step.kkt.stick});
  if (yields > most)
    warnings.push_back(
        {WarningCode::soft_penalty, "", yields, stiffer,
         fmt::format("the springs of the penalty yield by {} of the motion of the contact, and forces are "
                     "off by about as much",
                     in_percent(yields))});
  const auto& [model, slots, unused] = *result.problem;
  const auto rho = initial_regularisation(slots, result.method);
  const auto shares = slave_shares(model, slots);
  std::vector<double> softest(model.scene.contacts.size(), 0);
  for (std::size_t p = 0; p < shares.size(); ++p)
    softest[model.points[p].contact] =
        std::max(softest[model.points[p].contact], shares[p] / (rho[p].normal * slots.geometry[p].area));
  for (std::size_t c = 0; c < softest.size(); ++c)
    if (softest[c] > most && softest[c] > 10 * yields)  // (the first sentence says the rest)
      warnings.push_back(
          {WarningCode::soft_penalty, model.scene.contacts[c].name, softest[c], stiffer,
           fmt::format("{}: several nodes of a stiff slave share facets of a softer master, and the springs of the "
                       "penalty yield by {:.2g} times what the slave does: they decide how its nodes share the force",
                       model.scene.contacts[c].name, softest[c])});
}

}  // namespace

void add_solution_warnings(const CaseResult& result, std::vector<Warning>& warnings) {
  if (has_ended(result)) add_loose_bodies(result, warnings);
  add_mechanisms(result, warnings);
  add_folded_elements(result, warnings);
  add_other_solutions(result, warnings);
  add_unstable_steps(result, warnings);
  add_undetermined_contacts(result, warnings);
  add_soft_penalty(result, warnings);
}

const Body* loose_body(const Model& model) {
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto in_body = [body = nodes_of_body(model, b)](int node) { return body.has(node); };
    if (!is_supported(model, b) && std::none_of(model.contact_nodes.begin(), model.contact_nodes.end(), in_body))
      return &model.scene.bodies[b];
  }
  return nullptr;
}

}  // namespace stickslip
