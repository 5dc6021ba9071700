/// The tangent that Newton's method solves with, against the complex step of all that is in the equilibrium.
#pragma once

#include "core/model/contact_assembly.hpp"
#include "core/model/loading.hpp"
#include "core/model/point_tangent.hpp"
#include "methods/newton/newton.hpp"
#include "methods/newton/regularisation.hpp"
#include "tests/support/compiled_slots.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::scenes {

/// Largest difference of the tangent times a motion from the complex step along it, over the largest entry: of the
/// bodies' forces and the loads that follow them, of the forces of contact, and of the rows A (t - lambda).
struct TangentErrors {
  double bodies = 0, contact = 0, rows = 0;
  double largest() const { return larger(larger(bodies, contact), rows); }
};

/// rho of an increment.
inline RegularisationField<double> rho_of(const Slots<double>& slots, const Method& method,
                                          const Increment<double>& increment) {
  return std::visit([&](const auto& m) { return adapted(initial_regularisation(slots, m), increment.rho_factor); },
                    method);
}

/// In the branches that points are in after increment n, at its displacements, along an arbitrary motion.
inline TangentErrors errors_of_tangent(const Model& model, const Slots<double>& slots, const Method& method,
                                       const Trajectory<double>& trajectory, std::size_t n) {
  using derivatives::arbitrary;
  using C = derivatives::Complex;
  constexpr double h = 1e-30;
  const auto& increment = trajectory.increments[n];
  const State<double>&before = trajectory.before(n), &at = increment.state;
  const auto rho = rho_of(slots, method, increment);
  const Vector<double> motion = arbitrary(model.dof_count(), 1), along = to_compact(model, motion);
  Vector<double> l = arbitrary(model.multiplier_count, 2), lambda = l;  // lambda / rho
  for (std::size_t p = 0; p < rho.size(); ++p)
    for (int c = 0; c < model.points[p].components(); ++c)
      lambda[model.points[p].multiplier + c] *= c == 0 ? rho[p].normal : rho[p].tangential;

  const auto* const facing = at.contact.facing.empty() ? nullptr : &at.contact.facing;
  const ContactInput<double> input{model, slots, rho, before.history, ConeRadius::augmented, increment.time, facing};
  const Vector<double> compact = to_compact(model, at.displacement);
  std::vector<PointTangent<double>> tangents;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p)
    tangents.push_back(point_tangent<double>(input, p, compact, at.multiplier, at.contact.state[p], at.contact.facing));
  Vector<double> forces = Vector<double>::Zero(compact.size()), rows = Vector<double>::Zero(l.size());
  detail::add_tangent_times(model, slots, tangents, along, forces, rows);
  for (std::size_t p = 0; p < tangents.size(); ++p) {
    const Vector<double> own = l.segment(model.points[p].multiplier, model.points[p].components());
    detail::scatter(model, slots, p, tangents[p], Vector<double>(tangents[p].force_l * own), forces);
    rows.segment(model.points[p].multiplier, own.size()) += tangents[p].row_l * own;
  }
  const Vector<double> bodies = tangent_times<double>(
      model, slots, {at.displacement, before.history.bodies, increment.time}, motion, Taken::as_is);

  const auto complex_slots = make_slots<C>(model, model.scene.as<C>());
  const auto step = [&](const Vector<double>& x, const Vector<double>& direction) {
    return Vector<C>(x.cast<C>() + C(0, h) * direction.cast<C>());
  };
  History<C> previous;
  for_each_part([](const Vector<double>& part, Vector<C>& out) { out = part.cast<C>(); }, before.history, previous);
  previous.patch = before.history.patch;
  previous.faced = before.history.faced;
  RegularisationField<C> complex_rho;
  for (const auto& each : rho) complex_rho.push_back({C(each.normal), C(each.tangential)});
  const ContactInput<C> moved{model,          complex_slots, complex_rho, previous, ConeRadius::augmented,
                              increment.time, facing};
  const Vector<C> u = step(at.displacement, motion), multiplier = step(at.multiplier, lambda);
  const auto field = evaluate_contact<C>(moved, step(compact, along), multiplier, &at.contact.state);
  Vector<C> of_bodies = bulk_forces(model, complex_slots, u, bulk_flow(model, complex_slots, u, previous.bodies));
  if (!model.followers.empty()) of_bodies -= follower_forces(model, complex_slots, increment.time, u);
  const auto difference = [&](const Vector<double>& tangent, const Vector<C>& stepped) {
    return derivatives::relative_difference(tangent, stepped.imag() / h);
  };
  return {difference(bodies, of_bodies), difference(forces, contact_forces(model, complex_slots, field)),
          difference(rows, multiplier_residual(model, complex_slots, field.traction, multiplier))};
}

}  // namespace stickslip::scenes
