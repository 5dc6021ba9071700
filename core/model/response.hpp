/// Responses: scalars of a state, in any scalar, so that their derivatives are the same code (docs/scene.md).
#pragma once

#include <algorithm>
#include <optional>

#include "core/model/contact_assembly.hpp"
#include "core/model/loading.hpp"

namespace stickslip {

/// f_int - f_ext + contact over all dofs, in the axes: zero along free dofs in equilibrium, the force of the support on
/// the body along prescribed ones (support_forces). `internal`: bulk_forces of the state.
template <class T>
Vector<T> nodal_balance(const Model& model, const Slots<T>& slots, const State<T>& state, Vector<T> internal,
                        double time) {
  Vector<T> rows = less_external_forces(model, slots, time, state.displacement, std::move(internal));
  add_compact(model, contact_forces(model, slots, state.contact), rows);
  return rows;
}
template <class T>
Vector<T> nodal_balance(const Model& model, const Slots<T>& slots, const State<T>& state, double time) {
  return nodal_balance(model, slots, state, bulk_forces(model, slots, state.displacement, state.history.bodies), time);
}

/// Samples that differ by up to this share of the largest are the same: to choose among them is left to rounding.
inline constexpr double take_tie = 1e-9;

/// The derivative of a largest or smallest value that several samples share: the mean of theirs, or the one-sided one
/// where the parameter falls or grows.
enum class Ties { mean, falling, growing };

namespace detail {

/// The derivative of the largest (or smallest) of samples that are equal, on the side that `ties` names.
template <int N>
Dual<N> on_side(Ties ties, Response::Take take, const std::vector<Dual<N>>& tied) {
  Dual<N> one = tied.front();
  const bool upper = (ties == Ties::growing) == (take == Response::Take::max);
  for (const auto& sample : tied)
    for (int j = 0; j < N; ++j) one.d[j] = upper ? std::max(one.d[j], sample.d[j]) : std::min(one.d[j], sample.d[j]);
  return one;
}
template <class T>
T on_side(Ties, Response::Take, const std::vector<T>& tied) {
  return tied.front();
}

/// Reduces samples by `take`; the weights are those of the mean. max and min follow the primal value.
template <class T>
T take_of(Response::Take take, const std::vector<T>& samples, const std::vector<T>& weights, Ties ties) {
  if (take == Response::Take::mean) {
    T sum{}, total{};
    for (std::size_t i = 0; i < samples.size(); ++i) {
      sum += weights[i] * samples[i];
      total += weights[i];
    }
    return sum / total;
  }
  double best = value(samples.front()), size = 0;
  for (const T& sample : samples) {
    best = take == Response::Take::max ? std::max(best, value(sample)) : std::min(best, value(sample));
    size = std::max(size, std::abs(value(sample)));
  }
  std::vector<T> tied;
  for (const T& sample : samples)
    if (std::abs(value(sample) - best) <= take_tie * size) tied.push_back(sample);
  if (tied.empty()) return T(best);  // not a number
  if (ties != Ties::mean) return on_side(ties, take, tied);
  T mean{};
  for (const T& sample : tied) mean += sample / T(static_cast<double>(tied.size()));
  return mean + T(best - value(mean));
}

/// Where a node is, for arms of forces: where it was at the start, as long as strains are small.
template <class T>
Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 3, 1> place_of(const Model& model, const Slots<T>& slots, const State<T>& state,
                                                      int node) {
  Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 3, 1> x = slots.points.col(node);
  if (model.scene.finite_strain) x += state.displacement.segment(node * model.dimension, model.dimension);
  return x;
}

/// Component x y z of a force at a place x, or its moment: in the plane about a point, counter-clockwise; in space
/// about an axis through the point, right-handed.
template <class T, class Force, class Place>
T component_of(const Response& response, const Force& force, const Place& x, const Numbers<T>& numbers) {
  if (response.component != Response::Component::moment) return force[response.axis()];
  const auto about = [&](int i, int j) -> T {
    return (x[i] - numbers(response.about[i])) * force[j] - (x[j] - numbers(response.about[j])) * force[i];
  };
  if (response.moment_axis.empty()) return about(0, 1);
  Vec<T, 3> axis;
  for (int i = 0; i < 3; ++i) axis[i] = numbers(response.moment_axis[i]);
  return dot(axis, Vec<T, 3>(about(1, 2), about(2, 0), about(0, 1))) / norm(axis);
}

/// Accumulated tangential slip of a point along the component of a response.
template <class T>
T slip_component(const Model& model, const Slots<T>& slots, const State<T>& state, int p, const Response& response) {
  const int offset = tangential_offset(model, p);
  if (response.component == Response::Component::own) return state.history.placement[offset];
  T s{};
  for (int a = 0; a < model.points[p].tangents; ++a)
    s += geometry_in(state.contact, slots, p).tangents(response.axis(), a) * state.history.placement[offset + a];
  return s;
}

/// Force of the contact points `of_contact` on the slave, or its moment; positive in compression if normal.
template <class T>
T contact_force(const Model& model, const Slots<T>& slots, const Response& response, const State<T>& state,
                const std::vector<int>& of_contact) {
  T force{};
  for (int p : of_contact) {
    const auto& point = model.points[p];
    const auto& geometry = geometry_in(state.contact, slots, p);
    if (response.component == Response::Component::normal) {
      force -= geometry.area * state.contact.traction[point.multiplier];
      continue;
    }
    force -= with_point(model, point, [&]<int D, int Tangents>() {
      const auto on_slave =
          point_force<T, D, Tangents>(geometry, gather_traction<T, Tangents>(state.contact.traction, point.multiplier));
      Vec<T, D> at = Vec<T, D>::Constant(T(0));  // the force is shared by the slave's nodes
      for (int n = 0; n < point.slave_nodes; ++n)
        for (int i = 0; i < D; ++i) at[i] += geometry.weights[n] * place_of(model, slots, state, point.nodes[n])[i];
      return component_of(response, on_slave, at, slots.numbers);
    });
  }
  return force;
}

/// Where the arms of a half width begin, and the direction that they are measured along.
template <class T>
struct ArmOrigin {
  Vec<T, 2> place, along;
};

/// The plane of symmetry of a contact: where its slave side ends, pressed, in a node that a support holds along the
/// side, at zero, and leaves free across it. None where both ends are such, or neither. `presses(p)`: whether point p
/// does.
template <class T, class Presses>
std::optional<ArmOrigin<T>> symmetry_plane(const Model& model, const Slots<T>& slots, const State<T>& state,
                                           const std::vector<int>& of_contact, Presses&& presses) {
  constexpr double along_side = 0.5;  // largest cosine between the direction that is held and the normal
  const auto is_zero = [](const Table& table) {
    return std::all_of(table.points.begin(), table.points.end(), [](const auto& p) { return p.second.value == 0; });
  };
  const auto stays = [&](const Constraint& held) {
    if (held.support < 0) return false;
    const Support& support = model.scene.supports[held.support];
    if (support.rotate) return false;
    return is_zero(held.axis == Constraint::inclined ? support.inclined->value : support.move.at(held.axis));
  };
  std::optional<ArmOrigin<T>> found;
  for (int p : of_contact) {
    const auto& point = model.points[p];
    if (point.area_facets.size() != 1 || !presses(p)) continue;
    const int node = point.nodes[0], framed = framed_index(model, node);
    const auto first = std::find_if(model.constraints.begin(), model.constraints.end(),
                                    [&](const Constraint& held) { return held.dof / 2 == node; });
    if (first == model.constraints.end() || !stays(*first)) continue;
    if (std::next(first) != model.constraints.end() && std::next(first)->dof / 2 == node) continue;  // held at all
    ArmOrigin<T> plane;
    for (int i = 0; i < 2; ++i) {
      plane.place[i] = place_of(model, slots, state, node)[i];
      plane.along[i] = framed >= 0 ? slots.frames[framed](i, first->dof % 2) : T(i == first->dof % 2 ? 1 : 0);
    }
    const auto& normal = geometry_in(state.contact, slots, p).normal;
    if (std::abs(value(plane.along[0]) * value(normal[0]) + value(plane.along[1]) * value(normal[1])) > along_side)
      continue;
    if (found) return std::nullopt;
    found = plane;
  }
  return found;
}

/// Half width of a contact from its force F and the second moment I of its pressures: a = 2 sqrt(I / F), as of Hertz's
/// p0 sqrt(1 - x^2/a^2). Of revolution it is the radius, sqrt(5/2 I / F), likewise. Arms are measured from the point
/// `about`, where one is given; else from the plane of symmetry, where there is one; else from the centroid of the
/// pressures. 0 where fewer than two points are closed; of revolution one is enough, if it is off the axis.
template <class T>
T contact_half_width(const Model& model, const Slots<T>& slots, const Response& response, const State<T>& state,
                     const std::vector<int>& of_contact) {
  using std::sqrt;
  const bool rings = model.scene.space == Space::axisymmetric;
  T force{}, second_moment{};
  Vector<T> moment = Vector<T>::Constant(2, T(0)), normal = moment;  // normal: of the contact as a whole
  int closed = 0;
  const auto nodal_force = [&](int p) {
    return -area_in(state.contact, slots, p) * state.contact.traction[model.points[p].multiplier];
  };
  const auto place = [&](int p) { return place_of(model, slots, state, model.points[p].nodes[0]); };
  for (int p : of_contact) {
    const T f = nodal_force(p);
    closed += value(f) > 0;
    force += f;
    for (int i = 0; i < 2; ++i) {
      moment[i] += f * place(p)[i];
      normal[i] += f * geometry_in(state.contact, slots, p).normal[i];
    }
  }
  if (closed < (rings ? 1 : 2) || !(value(force) > 0)) return T(0);
  std::optional<ArmOrigin<T>> plane;
  if (!rings && response.about.empty())
    plane = symmetry_plane(model, slots, state, of_contact, [&](int p) { return value(nodal_force(p)) > 0; });
  const auto arm_of = [&](int p) -> T {
    if (rings) return place(p)[0];
    if (plane)
      return (place(p)[0] - plane->place[0]) * plane->along[0] + (place(p)[1] - plane->place[1]) * plane->along[1];
    const auto origin = [&](int i) -> T {
      return response.about.empty() ? T(moment[i] / force) : slots.numbers(response.about[i]);
    };
    return (normal[0] * (place(p)[1] - origin(1)) - normal[1] * (place(p)[0] - origin(0))) / norm(normal);
  };
  for (int p : of_contact) {
    const T arm = arm_of(p);
    second_moment += nodal_force(p) * arm * arm;
  }
  return value(second_moment) > 0 ? sqrt(T(rings ? 2.5 : 4.0) * second_moment / force) : T(0);
}

template <class T>
T contact_response(const Model& model, const Slots<T>& slots, const Response& response, const ResponsePlace& place,
                   const State<T>& state, Ties ties) {
  using Kind = Response::Kind;
  if (response.kind == Kind::dissipation) {
    T work{};
    for (int c : place.contacts)
      if (c < state.history.work.size()) work += state.history.work[c];
    return work;
  }
  if (response.kind == Kind::contact_force) return contact_force(model, slots, response, state, place.points);
  if (response.kind == Kind::contact_half_width) return contact_half_width(model, slots, response, state, place.points);
  std::vector<T> samples, weights;
  for (int p : place.points) {
    if (response.kind == Kind::slip && model.points[p].tangents == 0) continue;
    weights.push_back(area_in(state.contact, slots, p));
    if (response.kind == Kind::contact_pressure) samples.push_back(-state.contact.traction[model.points[p].multiplier]);
    if (response.kind == Kind::gap) samples.push_back(state.contact.gap[p]);
    if (response.kind == Kind::slip) samples.push_back(slip_component(model, slots, state, p, response));
  }
  return samples.empty() ? T(0) : take_of(response.take, samples, weights, ties);
}

}  // namespace detail

/// Nodal forces of a state that some responses read, all dofs; empty where none does.
template <class T>
struct NodalForces {
  Vector<T> internal;  ///< bulk_forces, of the elements that are read
  Vector<T> held;      ///< support_forces
};

namespace detail {

/// Mean (by volume), largest or least equivalent plastic strain of bodies.
template <class T>
T plastic_strain(const Model& model, const Slots<T>& slots, Response::Take take, const std::vector<int>& bodies,
                 const State<T>& state) {
  std::vector<T> samples, volumes;
  for (int b : bodies)
    for_each_plastic_strain(model, slots, b, state.history.bodies, [&](const T& strain, const T& volume) {
      samples.push_back(strain);
      volumes.push_back(volume);
    });
  return samples.empty() ? T(0) : take_of(take, samples, volumes, Ties::mean);
}

}  // namespace detail

/// Value of a response at a state.
template <class T>
T evaluate_response(const Model& model, const Slots<T>& slots, int index, const State<T>& state,
                    const NodalForces<T>& forces, Ties ties = Ties::mean) {
  const Response& response = model.scene.responses[index];
  const ResponsePlace& place = model.response_places[index];
  const int D = model.dimension;
  if (response.kind == Response::Kind::reaction) {
    T sum{};
    for (int node : place.nodes)
      sum += detail::component_of(response, forces.held.segment(node * D, D),
                                  detail::place_of(model, slots, state, node), slots.numbers);
    return sum;
  }
  if (response.kind == Response::Kind::displacement) {
    const auto moved = [&](int node) -> const T& { return state.displacement[node * D + response.axis()]; };
    if (!place.weights.empty()) {
      T u{};
      for (std::size_t a = 0; a < place.nodes.size(); ++a) u += T(place.weights[a]) * moved(place.nodes[a]);
      return u;
    }
    std::vector<T> samples;
    for (int node : place.nodes) samples.push_back(moved(node));
    return detail::take_of(response.take, samples, std::vector<T>(samples.size(), T(1)), ties);
  }
  if (response.kind == Response::Kind::strain_energy)
    return model.effects.linear_bulk ? T(T(0.5) * dot(forces.internal, state.displacement))
                                     : bulk_energy(model, slots, state.displacement, state.history.bodies);
  if (response.kind == Response::Kind::plastic_strain)
    return detail::plastic_strain(model, slots, response.take, place.bodies, state);
  return detail::contact_response(model, slots, response, place, state, ties);
}

/// Whether a response is the largest or smallest of several values, which may tie.
inline bool can_tie(const Response& response) {
  using Kind = Response::Kind;
  const bool sampled = response.kind == Kind::displacement || response.kind == Kind::contact_pressure ||
                       response.kind == Kind::gap || response.kind == Kind::slip;
  return sampled && response.take != Response::Take::mean && response.at.empty();
}

/// All responses of a model at a state.
template <class T>
Vector<T> evaluate_responses(const Model& model, const Slots<T>& slots, const State<T>& state, double time,
                             Ties ties = Ties::mean) {
  const auto& responses = model.scene.responses;
  auto asked = [&](Response::Kind kind) {
    return std::any_of(responses.begin(), responses.end(), [&](const Response& r) { return r.kind == kind; });
  };
  const bool reaction = asked(Response::Kind::reaction);
  NodalForces<T> forces;
  const bool energy = asked(Response::Kind::strain_energy);  // of all elements; a reaction needs those at its support
  if (reaction || energy)
    forces.internal =
        bulk_forces(model, slots, state.displacement, state.history.bodies, energy ? nullptr : &model.at_reactions);
  if (reaction) forces.held = support_forces(model, slots, nodal_balance(model, slots, state, forces.internal, time));
  Vector<T> out(responses.size());
  for (std::size_t i = 0; i < responses.size(); ++i)
    out[i] = evaluate_response(model, slots, static_cast<int>(i), state, forces, ties);
  return out;
}

extern template double evaluate_response(const Model&, const Slots<double>&, int, const State<double>&,
                                         const NodalForces<double>&, Ties);
extern template Vector<double> evaluate_responses(const Model&, const Slots<double>&, const State<double>&, double,
                                                  Ties);

}  // namespace stickslip
