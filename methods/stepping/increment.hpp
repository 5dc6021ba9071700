/// One increment: what every method starts from and leaves, and the method of each in a file of its own
/// (methods/penalty.hpp, methods/uzawa.hpp, methods/monolithic.hpp).
#pragma once

#include <memory>

#include "core/engine/condensation.hpp"
#include "core/model/contact_assembly.hpp"
#include "core/model/facings.hpp"
#include "methods/newton/equilibrium.hpp"
#include "methods/newton/regularisation.hpp"
#include "methods/rescue/uniqueness.hpp"
#include "methods/stepping/free_bodies.hpp"

namespace stickslip {

/// What becomes of a step that finds no solution.
enum class Steps {
  cut,   ///< it is cut into parts
  whole  ///< it fails: of a path that is repeated, whose parts are known
};

/// A run in progress: the immutable problem, the engine, and what is carried from increment to increment.
template <class T>
struct Run {
  const Method& method;
  const Model& model;
  const Slots<T>& slots;
  Engine<T>& engine;
  Account account;
  Uniqueness uniqueness = Uniqueness::unique;
  std::shared_ptr<Condensation<T>> condensation = nullptr;  ///< where all branches are tried; made on demand
  double start = 0;                                         ///< time at which the increment begins
  FreeBodies free = {};                                     ///< where the increment begins, of nonlinear bodies
};

/// Where a method begins to look for an increment's solution, and what holds the bodies there.
template <class T>
struct Start {
  const State<T>& state;     ///< the last increment's state, or a step of the motion
  Anchor<T> anchor;          ///< of the motion, or at rest of bodies that float; empty: none
  bool inexact_step = true;  ///< whether a step of the motion is solved to the root of the tolerance alone
  const Arc* arc = nullptr;  ///< of a step along a path, whose time is a guess then
  bool at_rest = false;      ///< whether the overdamped motion ended in the state
  bool is_step() const { return anchor.stiffness.size() > 0 && !at_rest; }
  bool is_of_motion() const { return is_step() || at_rest; }
  /// States that points resume which start on their cone: those of the last increment, where it starts there.
  std::span<const ContactState> resumed(const State<T>& previous) const {
    if (&state != &previous) return {};
    return previous.contact.state;
  }
  double tolerance(double asked) const { return is_step() && inexact_step ? std::sqrt(asked) : asked; }
};

/// The multiplier lambda of a penalty: zero normal part, tangential traction of the last increment.
template <class T>
Vector<T> stored_traction(const Model& model, const State<T>& previous) {
  Vector<T> lambda = previous.contact.traction;
  for (const auto& point : model.points) lambda[point.multiplier] = T(0);
  return lambda;
}

/// An equilibrium as the state that the next increment starts from. `at`: its multiplier is the lambda it was found
/// with.
template <class T>
State<T> settle(Run<T>& run, const ContactInput<T>& input, Unknowns<T> at, ContactField<T> field) {
  State<T> state;
  state.displacement = run.engine.all(at.u);
  state.multiplier = std::move(at.multiplier);
  state.contact = std::move(field);
  if (run.model.slides_on_surfaces()) detail::place_open_vertices(input, run.engine.compact(at.u), state.contact);
  state.history = next_history(input, state.contact, state.multiplier);
  state.history.bodies = bulk_flow(run.model, run.slots, state.displacement, input.previous.bodies);
  return state;
}

/// Fills the parts of an increment that all methods have.
template <class T>
void account_for(Increment<T>& increment, const Equilibrium<T>& equilibrium, int augmentation) {
  increment.time = equilibrium.unknowns.time;
  increment.status = equilibrium.status;
  increment.message = equilibrium.message;
  increment.newton += equilibrium.iterations;
  increment.reversed |= equilibrium.reversed;
  if (equilibrium.unstable) increment.unstable = *equilibrium.unstable;
  for (auto entry : equilibrium.history) {
    entry.augmentation = augmentation;
    increment.history.push_back(entry);
  }
}

/// Solves an increment by the method of the run. Defined in methods/all_methods.hpp.
template <class T>
Increment<T> solve_increment(Run<T>& run, const State<T>& previous, const std::vector<double>& rho_factor, double time,
                             const Start<T>& start);

}  // namespace stickslip
