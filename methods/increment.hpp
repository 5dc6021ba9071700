/// What every method's increment starts from and leaves.
#pragma once

#include <cstdio>
#include <string>

#include "core/model/shared_forces.hpp"
#include "methods/newton.hpp"
#include "methods/regularisation.hpp"

namespace stickslip {

/// A run in progress: the immutable problem, the engine, and what is carried from increment to increment.
template <class T, class E>
struct Run {
  const Model& model;
  const Slots<T>& slots;
  E& engine;
  Account account;
  bool several = false;  ///< increments may have several solutions (methods/motion.hpp)
  std::shared_ptr<Condensation<T>> condensation = nullptr;  ///< where all branches are tried; made on demand
};

/// Where a method begins to look for an increment's solution, and what holds the bodies there.
template <class T>
struct Start {
  const State<T>& state;     ///< the last increment's state, or a step of the motion
  Anchor<T> anchor;          ///< of the motion; empty: the unmodified equations
  bool inexact_step = true;  ///< whether a step of the motion is solved to the root of the tolerance alone
  const Arc* arc = nullptr;  ///< of a step along a path, whose time is a guess then
  bool is_step() const { return anchor.stiffness.size() > 0; }
  /// States that points resume which start on their cone: those of the last increment, where it starts there.
  std::span<const ContactState> resumed(const State<T>& previous) const {
    if (&state != &previous) return {};
    return previous.contact.state;
  }
  double tolerance(double asked) const { return is_step() && inexact_step ? std::sqrt(asked) : asked; }
};

/// An equilibrium as the state that the next increment starts from. `at`: its multiplier is the lambda it was found
/// with.
template <class T, class E>
State<T> settle(Run<T, E>& run, const ContactInput<T>& input, Unknowns<T> at, ContactField<T> field) {
  State<T> state;
  state.displacement = run.engine.all(at.u);
  state.multiplier = std::move(at.multiplier);
  state.contact = std::move(field);
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
  for (auto entry : equilibrium.history) {
    entry.augmentation = augmentation;
    increment.history.push_back(entry);
  }
}

/// Six digits of a number, for messages.
inline std::string short_number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

/// A contact point in words of the scene: its contact, and where its node was at the start.
template <class T>
std::string name_of_point(const Model& model, const Slots<T>& slots, int p) {
  const auto& point = model.points[p];
  std::string place;
  for (int i = 0; i < model.dimension; ++i)
    place += (i ? ", " : "") + short_number(value(slots.points(i, point.nodes[0])));
  return "the contact point of " + model.scene.contacts[point.contact].name + " at (" + place + ")";
}

/// The contact point that violates its constraint the most while supports prescribe the motion of all its nodes, in
/// words of the scene; empty where there is none.
template <class T>
std::string prescribed_penetration(const Model& model, const Slots<T>& slots, const State<T>& state) {
  constexpr double rounding = 1e-12;
  const auto decided = decided_elsewhere(model, slots);
  double worst = rounding * largest_nodal_norm(state.displacement, model.dimension);
  int found = -1;
  for (int p = 0; !decided.empty() && p < static_cast<int>(state.contact.gap.size()); ++p) {
    if (!decided[model.points[p].multiplier] || -value(state.contact.gap[p]) <= worst) continue;
    worst = -value(state.contact.gap[p]);
    found = p;
  }
  if (found < 0) return "";
  return name_of_point(model, slots, found) + " penetrates by " + short_number(worst) +
         ", and supports prescribe its motion: no traction can prevent that";
}

}  // namespace stickslip
