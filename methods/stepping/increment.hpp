/// What every method's increment starts from and leaves.
#pragma once

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <string>

#include "core/engine/shared_forces.hpp"
#include "methods/newton/newton.hpp"
#include "methods/newton/regularisation.hpp"

namespace stickslip {

/// A run in progress: the immutable problem, the engine, and what is carried from increment to increment.
template <class T, class E>
struct Run {
  const Model& model;
  const Slots<T>& slots;
  E& engine;
  Account account;
  bool several = false;   ///< increments may have several solutions (methods/rescue/motion.hpp)
  bool critical = false;  ///< increments may have a continuum of solutions, and no other several
  std::shared_ptr<Condensation<T>> condensation = nullptr;  ///< where all branches are tried; made on demand
  double start = 0;                                         ///< time at which the increment begins
  /// Per body: it is free to move where the increment begins, and nothing presses on it; empty: no body is.
  std::vector<char> floating = {};
};

/// Where a method begins to look for an increment's solution, and what holds the bodies there.
template <class T>
struct Start {
  const State<T>& state;     ///< the last increment's state, or a step of the motion
  Anchor<T> anchor;          ///< of the motion; empty: the unmodified equations
  bool inexact_step = true;  ///< whether a step of the motion is solved to the root of the tolerance alone
  const Arc* arc = nullptr;  ///< of a step along a path, whose time is a guess then
  bool at_rest = false;      ///< whether the overdamped motion ended in the state
  bool is_step() const { return anchor.stiffness.size() > 0; }
  /// States that points resume which start on their cone: those of the last increment, where it starts there.
  std::span<const ContactState> resumed(const State<T>& previous) const {
    if (&state != &previous) return {};
    return previous.contact.state;
  }
  double tolerance(double asked) const { return is_step() && inexact_step ? std::sqrt(asked) : asked; }
};

/// Whether the start values count as solved if only rounding is left of their residuals: nothing but rounding moves a
/// body that floats.
template <class T, class E>
bool rests(const Run<T, E>& run, const Start<T>& start) {
  return start.at_rest && !run.floating.empty();
}

/// An equilibrium as the state that the next increment starts from. `at`: its multiplier is the lambda it was found
/// with.
template <class T, class E>
State<T> settle(Run<T, E>& run, const ContactInput<T>& input, Unknowns<T> at, ContactField<T> field) {
  State<T> state;
  state.displacement = run.engine.all(at.u);
  state.multiplier = std::move(at.multiplier);
  state.contact = std::move(field);
  if (run.model.slides_along_curves()) detail::place_open_vertices(input, run.engine.compact(at.u), state.contact);
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

/// Whether a point with friction bears a tangential traction however small its pressure, and none once it is open.
template <class T>
bool has_abrupt_friction(const Model& model, const Slots<T>& slots) {
  return std::any_of(model.points.begin(), model.points.end(), [&](const auto& point) {
    return point.tangents > 0 && !slots.friction[point.contact].has_apex();
  });
}

inline constexpr auto abrupt_friction_message =
    "friction that does not grow with the pressure ends at once where a point opens, and then there may be no "
    "equilibrium; try one that grows with it";

/// Whether supports prescribe all displacements of a node.
inline bool is_prescribed(const Model& model, int node) {
  const auto first = model.free_index.begin() + node * model.dimension;
  return std::all_of(first, first + model.dimension, [](int index) { return index < 0; });
}

/// The contact point that violates its constraint the most while supports prescribe the motion of all its nodes, in
/// words of the scene; empty where there is none. With present geometry a node that is free in one direction may slide
/// off its master, and does not count.
template <class T>
std::string prescribed_penetration(const Model& model, const Slots<T>& slots, const State<T>& state) {
  constexpr double rounding = 1e-12;
  const bool moved = model.effects.current_geometry;
  const auto decided = decided_elsewhere(model, slots, moved ? &state.contact : nullptr);
  double worst = rounding * largest_nodal_norm(state.displacement, model.dimension);
  for (const auto& point : model.points) worst = std::max(worst, moved ? 10 * point.tie_length : 0);
  int found = -1;
  for (int p = 0; !decided.empty() && p < static_cast<int>(state.contact.gap.size()); ++p) {
    if (!decided[model.points[p].multiplier] || !(-value(state.contact.gap[p]) > worst)) continue;
    const auto nodes = nodes_in(model, state.contact, p);
    if (moved && !std::all_of(nodes.begin(), nodes.end(), [&](int node) { return is_prescribed(model, node); }))
      continue;
    worst = -value(state.contact.gap[p]);
    found = p;
  }
  if (found < 0) return "";
  return name_of_point(model, slots, found) + " penetrates by " + short_number(worst) +
         ", and supports prescribe its motion: no traction can prevent that";
}

/// Facets of a contact whose nodes are all prescribed, without repetition.
struct PrescribedFacets {
  std::vector<std::array<int, 2>> slave, master;
};

inline PrescribedFacets prescribed_facets(const Model& model, int contact) {
  PrescribedFacets facets;
  const auto take = [&](std::vector<std::array<int, 2>>& to, int a, int b) {
    if (!is_prescribed(model, a) || !is_prescribed(model, b)) return;
    if (std::find(to.begin(), to.end(), std::array{a, b}) == to.end()) to.push_back({a, b});
  };
  for (const auto& point : model.points)
    for (const auto& [a, b] : point.area_facets)
      if (point.contact == contact && point.obstacle < 0) take(facets.slave, a, b);
  for (const auto& curve : model.curves)
    if (curve.contact == contact && curve.obstacle < 0)
      for (const auto& patch : curve.patches)
        take(facets.master, curve.nodes[patch.vertices[1]], curve.nodes[patch.vertices[2]]);
  return facets;
}

/// Two facets that supports move through one another, and how far.
struct Crossing {
  double overlap = 0;  ///< length; 0: no facets cross
  std::string words;   ///< of the scene
};

/// Of the pairs of facets that cross at a time the one that overlaps the most. With present geometry; at small strain
/// the points alone tell.
template <class T>
Crossing crossing_facets(const Model& model, const Slots<T>& slots, double time) {
  constexpr double rounding = 1e-9;  // of a facet
  if (!model.effects.current_geometry || !model.effects.deformable_master) return {};
  Vector<T> displacement = Vector<T>::Constant(model.dof_count(), T(0));
  prescribe(model, slots, time, displacement);
  const auto start = [&](int node) { return values(slots.points.col(node).template head<2>()); };
  const auto place = [&](int node) -> Vec<double, 2> {
    return start(node) + values(displacement.template segment<2>(2 * node));
  };
  const auto off = [](const Vec<double, 2>& x, const Vec<double, 2>& a, const Vec<double, 2>& b) {
    const Vec<double, 2> along = b - a, arm = x - a;
    return (along[0] * arm[1] - along[1] * arm[0]) / along.norm();
  };
  Crossing crossing;
  for (int c = 0; c < static_cast<int>(model.scene.contacts.size()); ++c) {
    const auto facets = prescribed_facets(model, c);
    for (const auto& [a, b] : facets.slave)
      for (const auto& [d, e] : facets.master) {
        if (a == d || a == e || b == d || b == e) continue;
        const auto A = place(a), B = place(b), D = place(d), E = place(e);
        const std::array<double, 4> distances{off(D, A, B), off(E, A, B), off(A, D, E), off(B, D, E)};
        if (distances[0] * distances[1] >= 0 || distances[2] * distances[3] >= 0) continue;
        double overlap = std::numeric_limits<double>::infinity();
        for (double x : distances) overlap = std::min(overlap, std::abs(x));
        if (overlap <= std::max(crossing.overlap, rounding * std::max((B - A).norm(), (E - D).norm()))) continue;
        crossing.overlap = overlap;
        const auto named = [&](int node) {
          return "(" + short_number(start(node)[0]) + ", " + short_number(start(node)[1]) + ")";
        };
        crossing.words = model.scene.contacts[c].name + ": the facets from " + named(a) + " to " + named(b) +
                         " and from " + named(d) + " to " + named(e) + " cross and overlap by " +
                         short_number(overlap) +
                         ", and supports prescribe the motion of both: no traction can prevent that";
      }
  }
  return crossing;
}

/// Whether supports move facets through one another between two times, or further.
template <class T>
bool cross_between(const Model& model, const Slots<T>& slots, double start, double end) {
  constexpr double rounding = 1e-6;
  const double crossed = crossing_facets(model, slots, end).overlap;
  return crossed > 0 && crossed > (1 + rounding) * crossing_facets(model, slots, start).overlap;
}

/// What supports alone push into one another, in words; empty if there is none. A point that penetrates counts if the
/// method prevents penetration; facets that cross always do.
template <class T>
std::string prescribed_overlap(const Model& model, const Slots<T>& slots, double time, bool prevents_penetration,
                               const State<T>& state) {
  if (prevents_penetration)
    if (std::string point = prescribed_penetration(model, slots, state); !point.empty()) return point;
  return crossing_facets(model, slots, time).words;
}

}  // namespace stickslip
