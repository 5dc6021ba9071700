/// Definitions of the templates in contact_assembly.hpp.
#pragma once

#include "core/model/contact_assembly.hpp"
#include "core/model/facings_impl.hpp"
#include "core/model/stencil.hpp"

namespace stickslip {

namespace detail {

/// Adds the labels of the next point.
template <class T>
void take_labels(const Facing& facing, History<T>& history) {
  const bool faces = facing.patch != no_patch;
  history.patch.push_back(faces ? facing.patch : facing.nearest);
  history.faced.push_back(faces);
}

/// Relative displacement w, D, of point p with initial geometry. `compact`: displacements of the contact nodes.
template <class T, int D>
Vec<T, D> relative_displacement(const ContactInput<T>& input, int p, const Vector<T>& compact) {
  const auto& point = input.model.points[p];
  Vec<T, D> w = -obstacle_displacement<T, D>(input, p);
  for (std::size_t n = 0; n < point.places.size(); ++n)
    for (int i = 0; i < D; ++i) w[i] += input.slots.geometry[p].weights[n] * compact[point.places[n] * D + i];
  return w;
}

/// Tangential placement s of point p after the last increment, length.
template <class T, int Tangents>
Vec<T, Tangents> previous_placement(const ContactInput<T>& input, int p) {
  Vec<T, Tangents> s;
  for (int a = 0; a < Tangents; ++a) s[a] = input.previous.placement[tangential_offset(input.model, p) + a];
  return s;
}

/// What is known of point p from earlier.
template <class T>
Earlier<T> earlier(const ContactInput<T>& input, int p) {
  const auto& point = input.model.points[p];
  Earlier<T> known{&input.slots.geometry[p]};
  if (point.foot >= 0) known.foot = &input.previous.foot[point.foot];
  if (point.foot >= 0 && point.surface >= 0) known.patch = input.previous.patch[p];
  return known;
}

/// Outcome of a point with present geometry `at`. If it faces no master, it is open.
template <class U, class T, int D, int Tangents>
PointOutcome<U, Tangents> point_outcome(const ContactInput<T>& input, const PlacedPoint<U, D>& at,
                                        const Traction<U, Tangents>& multiplier, const Vec<U, Tangents>& previous,
                                        const PointRegularisation<U>& rho, const FrictionLaw<U>& friction,
                                        double tie_length, const ContactState* state) {
  constexpr ContactState open = ContactState::open;
  return evaluate_moved_point<U, D, Tangents>(at.geometry, at.foot, at.foot_motion, multiplier, previous, rho, friction,
                                              input.cone, tie_length, at.faces_master ? state : &open);
}

/// Outcome of point p with its present geometry, which is stored in `geometry`. `facing`: what it faces of its surface;
/// not read where it has none.
template <class T, int D, int Tangents>
PointOutcome<T, Tangents> evaluate_present(const ContactInput<T>& input, int p, const Vector<T>& compact,
                                           const Facing& facing, const Traction<T, Tangents>& multiplier,
                                           const ContactState* state, PointGeometry<T>& geometry) {
  const auto displacement = [&](int place) -> Vec<T, D> { return compact.template segment<D>(place * D); };
  const Positions<T, T, decltype(displacement)> positions{input.model, input.slots, displacement, input.time};
  auto at = place_point<D>(positions, input.model.points[p], facing, earlier(input, p));
  const auto outcome = point_outcome<T, T, D, Tangents>(
      input, at, multiplier, previous_placement<T, Tangents>(input, p), input.rho[p],
      input.slots.friction[input.model.points[p].contact], tie_at<T>(input, p, compact), state);
  geometry = std::move(at.geometry);
  return outcome;
}

}  // namespace detail

template <class T>
History<T> initial_history(const Model& model, const Slots<T>& slots) {
  const auto zeros = [](std::size_t n) { return Vector<T>::Constant(static_cast<Eigen::Index>(n), T(0)).eval(); };
  History<T> history{zeros(model.multiplier_count - model.points.size()), zeros(model.foot_count),
                     zeros(model.effects.friction ? model.scene.contacts.size() : 0), zeros(model.memory_count)};
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    if (model.slides_on_surfaces()) detail::take_labels(point.facing, history);
    if (point.foot < 0) continue;
    with_dimension(model.dimension, [&]<int D>() {
      const auto at = detail::place_point<D>(detail::positions_of_start(model, slots), point, point.facing);
      for (int i = 0; i < point.feet(D); ++i) history.foot[point.foot + i] = at.foot[i];
    });
  }
  return history;
}

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
  for (std::size_t p = 0; model.slides_on_surfaces() && p < points; ++p)
    state.contact.facing.push_back(model.points[p].facing);
  state.history = initial_history(model, slots);
  return state;
}

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
  const bool present = model.effects.current_geometry, slides = model.slides_on_surfaces();
  if (present) field.moved.resize(count);
  if (slides) field.facing = input.facing ? *input.facing : detail::facings(input, compact);
  for (int p = 0; p < count; ++p) {
    const auto& point = model.points[p];
    const ContactState* const state = states ? &(*states)[p] : nullptr;
    detail::with_point(model, point, [&]<int D, int Tangents>() {
      const auto lambda = detail::gather_traction<T, Tangents>(multiplier, point.multiplier);
      const auto outcome =
          present ? detail::evaluate_present<T, D, Tangents>(input, p, compact, slides ? field.facing[p] : point.facing,
                                                             lambda, state, field.moved[p])
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
        if (point.foot >= 0)
          for (int i = 0; i < point.feet(D); ++i) field.foot[point.foot + i] = outcome.foot[i];
    });
  }
  return field;
}

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
      for_each_place(model, field, p, [&](std::size_t n, int place) {
        for (int i = 0; i < d; ++i) forces[place * d + i] += geometry.weights[n] * force[i];
      });
    });
  }
  return forces;
}

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

/// Frictional work per contact: `before` plus that of the increment, sum A t_T . (dg_T - (t_T - lambda_T)/rho_T) over
/// slipping points. The subtracted part of a regularised slip is elastic and dissipates nothing. t_T has the direction
/// of dg_T, so the work is positive or zero.
template <class T>
Vector<T> frictional_work(const ContactInput<T>& input, const ContactField<T>& field, const Vector<T>& multiplier,
                          const Vector<T>& before) {
  Vector<T> work = before;
  for (std::size_t p = 0; p < input.model.points.size(); ++p) {
    const auto& point = input.model.points[p];
    if (!is_slipping(field.state[p])) continue;
    for (int a = 0; a < point.tangents; ++a) {
      const int k = point.multiplier + 1 + a;
      const T plastic = field.slip[tangential_offset(input.model, static_cast<int>(p)) + a] -
                        (field.traction[k] - multiplier[k]) / input.rho[p].tangential;
      work[point.contact] += area_in(field, input.slots, p) * field.traction[k] * plastic;
    }
  }
  return work;
}

template <class T>
History<T> next_history(const ContactInput<T>& input, ContactField<T>& field, const Vector<T>& multiplier) {
  Vector<T> work = frictional_work(input, field, multiplier, input.previous.work);
  History<T> history{std::move(field.placement), std::move(field.foot), std::move(work), {}};
  for (const auto& facing : field.facing) detail::take_labels(facing, history);
  return history;
}

}  // namespace stickslip
