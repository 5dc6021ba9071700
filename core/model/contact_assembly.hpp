/// Contact points of a model: their local unknowns, nodal forces, multiplier rows and tangents.
///
/// Displacements enter, and forces leave, as compact vectors over Model::contact_nodes (D per node). The multiplier
/// lambda is an argument: the methods differ only in who supplies it.
#pragma once

#include "core/model/frames.hpp"
#include "core/model/state.hpp"

namespace stickslip {

/// Regularisation of all points, force per length cubed.
template <class T>
using RegularisationField = std::vector<PointRegularisation<T>>;

/// Everything a contact evaluation reads beside displacement and multiplier.
template <class T>
struct ContactInput {
  const Model& model;
  const Slots<T>& slots;
  const RegularisationField<T>& rho;
  const History<T>& previous;  ///< of the last increment
  ConeRadius cone = ConeRadius::augmented;
  double time = 0;
};

namespace detail {

/// The place on an obstacle that a place in its frame faces.
template <class T, class Place, class Read>
Vector<T> foot_on(const Obstacle& obstacle, const Place& x, const Read& numbers) {
  const auto geometry = against_rigid<T>(x, obstacle.shape, numbers);
  Vector<T> foot(x.size());
  for (Eigen::Index i = 0; i < foot.size(); ++i) foot[i] = x[i] - geometry.gap * geometry.normal[i];
  return foot;
}

}  // namespace detail

/// What history begins with: no slip, no work; where geometry is the present one, the feet of the points at the start.
template <class T>
History<T> initial_history(const Model& model, const Slots<T>& slots) {
  const auto zeros = [](std::size_t n) { return Vector<T>::Constant(static_cast<Eigen::Index>(n), T(0)).eval(); };
  History<T> history{zeros(model.multiplier_count - model.points.size()), zeros(model.foot_count),
                     zeros(model.effects.friction ? model.scene.contacts.size() : 0)};
  for (const auto& point : model.points) {
    if (point.foot < 0) continue;
    const Vector<T> at = slots.points.col(point.nodes[0]);
    history.foot.segment(point.foot, model.dimension) =
        detail::foot_on<T>(model.scene.obstacles[point.obstacle], at, slots.numbers);
  }
  return history;
}

/// State before the first increment: nothing has moved, no traction.
template <class T>
State<T> initial_state(const Model& model, const Slots<T>& slots) {
  State<T> state;
  auto zeros = [](std::size_t n) { return Vector<T>::Constant(static_cast<Eigen::Index>(n), T(0)).eval(); };
  const std::size_t points = model.points.size(), tangential = model.multiplier_count - points;
  state.displacement = zeros(model.dof_count());
  state.multiplier = state.contact.traction = zeros(model.multiplier_count);
  state.contact.state.assign(points, ContactState::open);
  state.contact.gap = zeros(points);
  state.contact.slip = zeros(tangential);
  if (model.effects.current_geometry) state.contact.moved = slots.geometry;
  state.history = initial_history(model, slots);
  return state;
}

namespace detail {

/// Calls f.template operator()<D, Tangents>() for a point.
template <class F>
decltype(auto) with_point(const Model& model, const ContactPoint& point, F&& f) {
  return with_dimension(model.dimension, [&]<int D>() {
    return point.tangents > 0 ? f.template operator()<D, D - 1>() : f.template operator()<D, 0>();
  });
}

/// Rigid displacement of the obstacle of a point, at the place that the point faces.
template <class T, int D>
Vec<T, D> obstacle_displacement(const ContactInput<T>& input, int p) {
  const auto& point = input.model.points[p];
  Vec<T, D> u = Vec<T, D>::Constant(T(0));
  if (point.obstacle < 0) return u;
  for (const auto& [axis, table] : input.model.scene.obstacles[point.obstacle].move)
    u[axis - 'x'] = evaluate(table, input.time, input.slots.numbers);
  if (const auto& rotate = input.model.scene.obstacles[point.obstacle].rotate) {
    const T angle = evaluate(rotate->angle, input.time, input.slots.numbers);
    for (int i = 0; i < D; ++i) u[i] += angle * input.slots.spins[p][i];
  }
  return u;
}

template <class T, int Tangents>
Traction<T, Tangents> gather_traction(const Vector<T>& field, int offset) {
  Traction<T, Tangents> t;
  t.normal = field[offset];
  for (int a = 0; a < Tangents; ++a) t.tangential[a] = field[offset + 1 + a];
  return t;
}

/// Relative displacement w of a point from compact displacements.
template <class T, int D>
Vec<T, D> relative_displacement(const ContactInput<T>& input, int p, const Vector<T>& compact) {
  const auto& point = input.model.points[p];
  Vec<T, D> w = -obstacle_displacement<T, D>(input, p);
  for (std::size_t n = 0; n < point.places.size(); ++n)
    for (int i = 0; i < D; ++i) w[i] += input.slots.geometry[p].weights[n] * compact[point.places[n] * D + i];
  return w;
}

/// A point where it is now: its geometry, its foot in the frame of the obstacle, and the way of the foot since the last
/// increment, which the obstacle carries along.
template <class T, int D>
struct MovedPoint {
  PointGeometry<T> geometry;
  Vec<T, D> foot, way;
};

/// Where the frame of a point's obstacle is: turned about its centre, then shifted.
template <class T, int D>
struct Frame {
  Vec<T, D> shift = Vec<T, D>::Constant(T(0)), center = Vec<T, D>::Constant(T(0));
  std::optional<Turn<T>> turn;  ///< in the plane
};
template <class T, int D>
Frame<T, D> frame_of_obstacle(const ContactInput<T>& input, const Obstacle& obstacle) {
  Frame<T, D> frame;
  for (const auto& [axis, table] : obstacle.move)
    frame.shift[axis - 'x'] = evaluate(table, input.time, input.slots.numbers);
  if (!obstacle.rotate) return frame;
  for (int i = 0; i < D; ++i) frame.center[i] = input.slots.numbers(obstacle.rotate->center[i]);
  frame.turn = Turn<T>::by(evaluate(obstacle.rotate->angle, input.time, input.slots.numbers));
  return frame;
}

/// `u`: displacement of the slave node, in the scalar U built on T.
template <class U, class T, int D>
MovedPoint<U, D> moved_point(const ContactInput<T>& input, int p, const Vec<U, D>& u) {
  const auto& point = input.model.points[p];
  const auto number = [&](const Number& n) { return U(input.slots.numbers(n)); };
  const auto& obstacle = input.model.scene.obstacles[point.obstacle];
  const auto frame = frame_of_obstacle<T, D>(input, obstacle);
  Vec<U, D> x;
  for (int i = 0; i < D; ++i) x[i] = U(input.slots.points(i, point.nodes[0]) - frame.shift[i]) + u[i];
  if constexpr (D == 2)
    if (frame.turn) x += frame.turn->back().change(Vec<U, 2>(x[0] - U(frame.center[0]), x[1] - U(frame.center[1])));
  MovedPoint<U, D> at;
  at.geometry = against_rigid<U>(x, obstacle.shape, number);
  for (int i = 0; i < D; ++i) {
    at.foot[i] = x[i] - at.geometry.gap * at.geometry.normal[i];
    at.way[i] = point.foot < 0 ? U(0) : U(at.foot[i] - U(input.previous.foot[point.foot + i]));
  }
  if constexpr (D == 2)
    if (frame.turn) {  // what is of the frame is turned with it
      const auto turned = [&](const Vec<U, 2>& v) { return Vec<U, 2>(v + frame.turn->change(v)); };
      const Vec<U, 2> normal = turned(Vec<U, 2>(at.geometry.normal[0], at.geometry.normal[1]));
      at.geometry.normal << normal[0], normal[1];
      at.geometry.tangents = tangent_frame<U>(at.geometry.normal);
      at.way = turned(at.way);
    }
  at.geometry.gap += number(input.model.scene.contacts[point.contact].offset);
  at.geometry.area = U(input.slots.geometry[p].area);
  return at;
}

template <class T, int Tangents>
Vec<T, Tangents> previous_placement(const ContactInput<T>& input, int p) {
  Vec<T, Tangents> s;
  for (int a = 0; a < Tangents; ++a) s[a] = input.previous.placement[tangential_offset(input.model, p) + a];
  return s;
}

/// The geometry of a point with the scalar U built on T.
template <class U, class T>
PointGeometry<U> promote(const PointGeometry<T>& g) {
  PointGeometry<U> out;
  auto cast = [](const T& x) { return U(x); };
  out.gap = U(g.gap);
  out.area = U(g.area);
  out.normal = g.normal.unaryExpr(cast);
  out.tangents = g.tangents.unaryExpr(cast);
  return out;
}

/// tie_length() of a point at compact displacements.
template <class T>
double tie_at(const ContactInput<T>& input, int p, const Vector<T>& compact) {
  const auto& point = input.model.points[p];
  const int D = input.model.dimension;
  double reach = 0;
  for (int place : point.places)
    for (int i = 0; i < D; ++i) reach = std::max(reach, std::abs(value(compact[place * D + i])));
  // (present places round as coordinates do, wherever they began)
  if (input.model.effects.current_geometry) return point.tie_length + 8 * unit_roundoff * reach;
  return tie_length(point, input.slots.geometry[p], reach);
}

/// Evaluates a point where it is now, which sets `geometry`.
template <class T, int D, int Tangents>
PointOutcome<T, Tangents> evaluate_present(const ContactInput<T>& input, int p, const Vector<T>& compact,
                                           const Traction<T, Tangents>& multiplier, const ContactState* state,
                                           PointGeometry<T>& geometry) {
  const auto& point = input.model.points[p];
  const Vec<T, D> u = compact.template segment<D>(point.places[0] * D);
  auto at = moved_point<T, T, D>(input, p, u);
  const auto outcome = evaluate_moved_point<T, D, Tangents>(
      at.geometry, at.foot, at.way, multiplier, previous_placement<T, Tangents>(input, p), input.rho[p],
      input.slots.friction[point.contact], input.cone, tie_at<T>(input, p, compact), state);
  geometry = std::move(at.geometry);
  return outcome;
}

}  // namespace detail

/// Local unknowns of all points. `compact`: displacements of the contact nodes; `multiplier`: lambda; `states`: the
/// branches to take, or nullptr to classify.
template <class T>
ContactField<T> evaluate_contact(const ContactInput<T>& input, const Vector<T>& compact, const Vector<T>& multiplier,
                                 const std::vector<ContactState>* states) {
  const Model& model = input.model;
  ContactField<T> field;
  const int count = static_cast<int>(model.points.size());
  field.state.resize(count);
  field.gap.resize(count);
  field.traction.resize(model.multiplier_count);
  field.placement.resize(model.multiplier_count - count);
  field.foot.resize(model.foot_count);
  field.slip.resize(model.multiplier_count - count);
  const bool present = model.effects.current_geometry;
  if (present) field.moved.resize(count);
  for (int p = 0; p < count; ++p) {
    const auto& point = model.points[p];
    const ContactState* const state = states ? &(*states)[p] : nullptr;
    detail::with_point(model, point, [&]<int D, int Tangents>() {
      const auto lambda = detail::gather_traction<T, Tangents>(multiplier, point.multiplier);
      const auto outcome =
          present ? detail::evaluate_present<T, D, Tangents>(input, p, compact, lambda, state, field.moved[p])
                  : evaluate_point<T, D, Tangents>(
                        input.slots.geometry[p], detail::relative_displacement<T, D>(input, p, compact), lambda,
                        detail::previous_placement<T, Tangents>(input, p), input.rho[p],
                        input.slots.friction[point.contact], input.cone, detail::tie_at<T>(input, p, compact), state);
      field.state[p] = outcome.state;
      field.gap[p] = outcome.gap;
      field.traction[point.multiplier] = outcome.traction.normal;
      const int offset = tangential_offset(model, p);
      for (int a = 0; a < Tangents; ++a) {
        field.placement[offset + a] = outcome.placement[a];
        field.slip[offset + a] = outcome.slip[a];
        field.traction[point.multiplier + 1 + a] = outcome.traction.tangential[a];
      }
      if constexpr (Tangents > 0)
        if (point.foot >= 0) field.foot.template segment<D>(point.foot) = outcome.foot;
    });
  }
  return field;
}

/// Nodal contact forces of the residual, compact, of the tractions of a field.
template <class T>
Vector<T> contact_forces(const Model& model, const Slots<T>& slots, const ContactField<T>& field) {
  const int D = model.dimension;
  Vector<T> forces = Vector<T>::Constant(static_cast<Eigen::Index>(model.contact_nodes.size()) * D, T(0));
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    detail::with_point(model, point, [&]<int d, int Tangents>() {
      const auto& geometry = geometry_in(field, slots, p);
      const Vec<T, d> force =
          point_force<T, d, Tangents>(geometry, detail::gather_traction<T, Tangents>(field.traction, point.multiplier));
      for (std::size_t n = 0; n < point.places.size(); ++n)
        for (int i = 0; i < d; ++i) forces[point.places[n] * d + i] += geometry.weights[n] * force[i];
    });
  }
  return forces;
}

/// Multiplier rows of the monolithic method, A (t - lambda) per component (force).
template <class T>
Vector<T> multiplier_residual(const Model& model, const Slots<T>& slots, const Vector<T>& traction,
                              const Vector<T>& multiplier) {
  Vector<T> rows(model.multiplier_count);
  for (std::size_t p = 0; p < model.points.size(); ++p)
    for (int c = 0; c < model.points[p].components(); ++c) {
      const int k = model.points[p].multiplier + c;
      rows[k] = slots.geometry[p].area * (traction[k] - multiplier[k]);
    }
  return rows;
}

/// Tangent of one point with respect to its relative displacement w (where geometry is the present one: the
/// displacement of its slave node, which turns normal and frame) and its scaled multiplier l = lambda / rho.
template <class T>
struct PointTangent {
  Matrix<T> force_w, force_l;  ///< D x D, D x components
  Matrix<T> row_w, row_l;      ///< of A (t - lambda): components x D, components x components
};

template <class T>
PointTangent<T> point_tangent(const ContactInput<T>& input, int p, const Vector<T>& compact,
                              const Vector<T>& multiplier, ContactState state) {
  const auto& point = input.model.points[p];
  return detail::with_point(input.model, point, [&]<int D, int Tangents>() {
    constexpr int C = 1 + Tangents;
    using Probe = Dual<D + C, T>;
    const auto friction =
        input.slots.friction[point.contact].template as<Probe>([](const T& number) { return Probe(number); });
    const bool present = input.model.effects.current_geometry;
    Vec<T, D> w_value;
    if (present)
      w_value = compact.template segment<D>(point.places[0] * D);
    else
      w_value = detail::relative_displacement<T, D>(input, p, compact);
    const auto lambda_value = detail::gather_traction<T, Tangents>(multiplier, point.multiplier);
    const PointRegularisation<Probe> rho{Probe(input.rho[p].normal), Probe(input.rho[p].tangential)};
    Vec<Probe, D> w;
    for (int i = 0; i < D; ++i) w[i] = Probe::seed(w_value[i], i);
    Traction<Probe, Tangents> lambda;
    lambda.normal = Probe(lambda_value.normal);
    lambda.normal.d[D] = input.rho[p].normal;
    Vec<Probe, Tangents> previous;
    for (int a = 0; a < Tangents; ++a) {
      lambda.tangential[a] = Probe(lambda_value.tangential[a]);
      lambda.tangential[a].d[D + 1 + a] = input.rho[p].tangential;
      previous[a] = Probe(input.previous.placement[tangential_offset(input.model, p) + a]);
    }
    PointOutcome<Probe, Tangents> outcome;
    PointGeometry<Probe> geometry;
    if (present) {
      auto at = detail::moved_point<Probe, T, D>(input, p, w);
      outcome = evaluate_moved_point<Probe, D, Tangents>(at.geometry, at.foot, at.way, lambda, previous, rho, friction,
                                                         input.cone, 0, &state);
      geometry = std::move(at.geometry);
    } else {
      geometry = detail::promote<Probe>(input.slots.geometry[p]);
      outcome = evaluate_point<Probe, D, Tangents>(geometry, w, lambda, previous, rho, friction, input.cone, 0, &state);
    }
    const Vec<Probe, D> force = point_force<Probe, D, Tangents>(geometry, outcome.traction);
    PointTangent<T> tangent{Matrix<T>(D, D), Matrix<T>(D, C), Matrix<T>(C, D), Matrix<T>(C, C)};
    for (int i = 0; i < D; ++i) {
      for (int j = 0; j < D; ++j) tangent.force_w(i, j) = force[i].d[j];
      for (int c = 0; c < C; ++c) tangent.force_l(i, c) = force[i].d[D + c];
    }
    for (int r = 0; r < C; ++r) {
      const Probe row = r == 0 ? outcome.traction.normal - lambda.normal
                               : outcome.traction.tangential[r - 1] - lambda.tangential[r - 1];
      for (int j = 0; j < D; ++j) tangent.row_w(r, j) = input.slots.geometry[p].area * row.d[j];
      for (int c = 0; c < C; ++c) tangent.row_l(r, c) = input.slots.geometry[p].area * row.d[D + c];
    }
    return tangent;
  });
}

/// Frictional work of the increment, added to that before, per contact: sum A t_T . plastic slip, where
/// the elastic part (t - lambda)/rho of a regularised slip does no work that is lost.
template <class T>
Vector<T> dissipated(const ContactInput<T>& input, const ContactField<T>& field, const Vector<T>& multiplier,
                     const Vector<T>& before) {
  Vector<T> work = before;
  for (std::size_t p = 0; p < input.model.points.size(); ++p) {
    const auto& point = input.model.points[p];
    if (!is_slipping(field.state[p])) continue;
    for (int a = 0; a < point.tangents; ++a) {
      const int k = point.multiplier + 1 + a;
      const T plastic = field.slip[tangential_offset(input.model, static_cast<int>(p)) + a] -
                        (field.traction[k] - multiplier[k]) / input.rho[p].tangential;
      work[point.contact] += input.slots.geometry[p].area * field.traction[k] * plastic;
    }
  }
  return work;
}

/// The history that an increment leaves: takes placement and feet out of its field. `multiplier`: lambda.
template <class T>
History<T> next_history(const ContactInput<T>& input, ContactField<T>& field, const Vector<T>& multiplier) {
  Vector<T> work = dissipated(input, field, multiplier, input.previous.work);
  return {std::move(field.placement), std::move(field.foot), std::move(work)};
}

}  // namespace stickslip
