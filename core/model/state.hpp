/// State of a model at one time, and the trajectory of states that a run leaves: plain values in any scalar.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/contact/contact_point.hpp"
#include "core/model/history.hpp"
#include "core/model/model.hpp"
#include "core/model/result.hpp"
#include "core/model/seconds.hpp"

namespace stickslip {

/// Local unknowns of all contact points. Normal quantities: one per point; tangential ones: `tangents` per point at
/// tangential_offset(); tractions: 1 + tangents per point at ContactPoint::multiplier. Frictionless: nothing
/// tangential.
template <class T>
struct ContactField {
  std::vector<ContactState> state;
  Vector<T> gap;
  Vector<T> placement;  ///< s, the slip since the start; empty in a State, whose history holds it
  Vector<T> foot;       ///< places on obstacles, as History::foot; empty in a State likewise
  Vector<T> slip;       ///< dg_T of this increment
  Vector<T> traction;   ///< t; compression negative
  /// Geometry of each point where it is now; empty where it stays that of the start (Slots::geometry).
  std::vector<PointGeometry<T>> moved;
  /// What each point faces of its curve; empty where no point slides along one.
  std::vector<Facing> facing;
  /// For derivatives alone (sensitivity/branches.hpp), laid out as traction: the direction in which the trial of a
  /// slipping point leaves the apex of its cone. Zero for other points; empty where no point is at an apex.
  Vector<double> ray;
};

/// Geometry that a point has in a field.
template <class S, class T>
const PointGeometry<T>& geometry_in(const ContactField<T>& field, const S& slots, std::size_t p) {
  return field.moved.empty() ? slots.geometry[p] : field.moved[p];
}

/// Area that the tractions of a point act on in a field, in the measure of the start.
template <class S, class T>
const T& area_in(const ContactField<T>& field, const S& slots, std::size_t p) {
  return geometry_in(field, slots, p).area;
}

/// Calls f(n, place) for each n: weights[n] of geometry_in() belongs to the node Model::contact_nodes[place].
template <class T, class F>
void for_each_place(const Model& model, const ContactField<T>& field, std::size_t p, F&& f) {
  const auto& point = model.points[p];
  if (field.facing.empty() || point.curve < 0) {
    for (std::size_t n = 0; n < point.places.size(); ++n) f(n, point.places[n]);
    return;
  }
  const Facing& facing = field.facing[p];
  if (!facing.nodes.empty()) {
    for (std::size_t n = 0; n < facing.nodes.size(); ++n) f(n, model.place_of(facing.nodes[n]));
    return;
  }
  f(std::size_t{0}, point.places[0]);
  const auto& curve = model.curves[point.curve];
  const int patch = facing.patch;
  if (curve.obstacle >= 0 || patch == Patch::none) return;
  std::size_t n = 0;
  for (int vertex : curve.patches[patch].vertices)
    if (vertex != Patch::none) f(++n, curve.places[vertex]);
}

/// The nodes to which the weights of geometry_in() belong.
template <class T>
std::vector<int> nodes_in(const Model& model, const ContactField<T>& field, std::size_t p) {
  std::vector<int> nodes;
  for_each_place(model, field, p, [&](std::size_t, int place) { nodes.push_back(model.contact_nodes[place]); });
  return nodes;
}

/// Where the tangential quantities of point p stand (each earlier point has exactly one normal component).
inline int tangential_offset(const Model& model, int p) { return model.points[p].multiplier - p; }

template <class T>
struct State {
  Vector<T> displacement;  ///< all dofs
  Vector<T> multiplier;    ///< lambda as the increment's last equilibrium used it, laid out as traction
  ContactField<T> contact;
  History<T> history;      ///< for the next increment
  FlowBranches flow = {};  ///< for derivatives alone: of points at a tie (sensitivity/flow_ties.hpp)
};

/// Uzawa: the equilibrium after one augmentation; kept only where the truncated sensitivity asks for it.
template <class T>
struct AugmentedState {
  State<T> state;
  std::vector<double> rho_factor;
};

template <class T>
struct Increment {
  double time = 0;
  bool requested = true;  ///< an end of step the scene asked for; false: a sub-step from step cutting
  Status status = Status::converged;
  std::string message;
  State<T> state;
  std::vector<double> rho_factor;  ///< adaption of the regularisation, per contact point
  int newton = 0, augmentations = 0, cutbacks = 0;
  double pace = 0;         ///< largest motion of a node over the increment's time; 0 where all bodies are linear
  double contraction = 0;  ///< Uzawa: last measured ratio of multiplier updates; 0 if not measured
  std::vector<IterationRecord> history;
  std::vector<AugmentedState<T>> augmented;
  /// Some tangent of Newton's method had a determinant of the other sign (Engine::reversed): the increment may have
  /// other solutions.
  bool reversed = false;
  bool counted = false;  ///< all solutions of the increment were looked for
  /// Solutions that were found and not taken. Their dissipation is that of the taken one.
  std::vector<State<T>> others;
  /// Time at which the branch of solutions ended that led here, so that the solution jumped; none: it did not.
  std::optional<double> jump;
  /// max_augmentations ended the increment, as the scene asked (status cap). Each of its equilibria was found.
  bool cut_off = false;
  /// Good enough to go on from.
  bool usable() const { return is_converged(status) || cut_off; }
};

template <class T>
struct Trajectory {
  Status status = Status::converged;
  std::string message;
  State<T> initial;
  std::vector<Increment<T>> increments;
  Counters counters;
  Seconds seconds;
  std::string engine;        ///< "sparse, MUMPS ..." or "condensed, ..."
  int reduced_unknowns = 0;  ///< size of the systems Newton solved
  /// Ends of all increments, sub-steps included: replaying them repeats the discrete path.
  std::vector<double> step_table() const {
    std::vector<double> times;
    for (const auto& increment : increments) times.push_back(increment.time);
    return times;
  }
};

}  // namespace stickslip
