/// State of a model at one time, and the trajectory of states of a run, in any scalar.
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

/// Local unknowns of all contact points. Normal quantities: one per point. Tangential quantities: `tangents` per point,
/// from tangential_offset(). Tractions: 1 + tangents per point, from ContactPoint::multiplier. Frictionless points have
/// no tangential quantities.
template <class T>
struct ContactField {
  std::vector<ContactState> state;
  Vector<T> gap;
  Vector<T> placement;  ///< s, slip since the start, length; empty in a State, see History::placement
  Vector<T> foot;       ///< as History::foot; empty in a State
  Vector<T> slip;       ///< dg_T of this increment, length
  Vector<T> traction;   ///< t, force per area; normal: compression negative
  /// Present geometry of each point; empty at small strain, where Slots::geometry holds.
  std::vector<PointGeometry<T>> moved;
  /// What each point faces of its surface; empty if no point slides along one.
  std::vector<Facing> facing;
  /// For derivatives alone (sensitivity/rays.hpp), laid out as traction: direction in which the trial of a slipping
  /// point leaves the apex of its cone. Zero for other points; empty if no point is at an apex.
  Vector<double> ray;
};

/// Geometry of point p in a field.
template <class S, class T>
const PointGeometry<T>& geometry_in(const ContactField<T>& field, const S& slots, std::size_t p) {
  return field.moved.empty() ? slots.geometry[p] : field.moved[p];
}

/// Initial area on which the traction of point p acts in a field.
template <class S, class T>
const T& area_in(const ContactField<T>& field, const S& slots, std::size_t p) {
  return geometry_in(field, slots, p).area;
}

/// Offset of the tangential quantities of point p. Each earlier point has exactly one normal component.
inline int tangential_offset(const Model& model, int p) { return model.points[p].multiplier - p; }

template <class T>
struct State {
  Vector<T> displacement;  ///< all dofs
  Vector<T> multiplier;    ///< lambda of the increment's last equilibrium, laid out as traction
  ContactField<T> contact;
  History<T> history;      ///< at the end of the increment
  FlowBranches flow = {};  ///< for derivatives alone: branches of ties (sensitivity/ties/flow_tie.hpp)
};

/// Uzawa: equilibrium after one augmentation. Kept only for the truncated scheme.
template <class T>
struct AugmentedState {
  State<T> state;
  std::vector<double> rho_factor;
};

template <class T>
struct Increment {
  double time = 0;
  bool requested = true;  ///< ends a step of the scene; false: a sub-step from step cutting
  Status status = Status::converged;
  std::string message;
  State<T> state;
  std::vector<double> rho_factor;  ///< adaption of rho, per contact point
  int newton = 0, augmentations = 0, cutbacks = 0;
  double pace = 0;         ///< largest nodal motion over time of the increment; 0 if all bodies are linear
  double contraction = 0;  ///< Uzawa: last measured ratio of multiplier updates; 0 if not measured
  std::vector<IterationRecord> history;
  std::vector<AugmentedState<T>> augmented;
  /// Some tangent of Newton's method had a determinant of the other sign (Engine::reversed). Then there may be other
  /// solutions.
  bool reversed = false;
  bool counted = false;  ///< whether all solutions of the increment were sought
  /// The last tangent of bodies that are not linear had such a determinant: the equilibrium is not stable.
  bool unstable = false;
  /// Motions that bodies and closed contacts do not resist, when they were counted last
  /// (methods/stepping/stability.hpp).
  int unresisted = 0;
  /// Other solutions. Their dissipation is that of the one taken.
  std::vector<State<T>> others;
  /// Time at which the solution jumped, because its branch ended; none: it did not jump.
  std::optional<double> jump;
  /// max_augmentations ended the increment (status cap). Each of its equilibria converged.
  bool cut_off = false;
  /// Whether the run can continue from this increment.
  bool usable() const { return is_converged(status) || cut_off; }
  /// Whether its state is what the method takes for a solution. Only such a state has derivatives and is told of.
  bool solved() const { return usable() || status == Status::inaccurate; }
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
  int reduced_unknowns = 0;  ///< number of unknowns of Newton's systems
  /// The state that increment n starts from.
  const State<T>& before(std::size_t n) const { return n == 0 ? initial : increments[n - 1].state; }
  /// What the next increment starts from: state, time, and the adaption of rho so far (empty: none).
  const State<T>& last() const { return before(increments.size()); }
  double last_time() const { return increments.empty() ? 0 : increments.back().time; }
  std::vector<double> last_factor() const {
    return increments.empty() ? std::vector<double>{} : increments.back().rho_factor;
  }
  /// Ends of all increments, sub-steps included. A run with these times repeats the discrete path.
  std::vector<double> step_table() const {
    std::vector<double> times;
    for (const auto& increment : increments) times.push_back(increment.time);
    return times;
  }
  /// Number of increments before the first that found no solution.
  std::size_t solved_count() const {
    std::size_t count = 0;
    while (count < increments.size() && increments[count].solved()) ++count;
    return count;
  }
};

}  // namespace stickslip
