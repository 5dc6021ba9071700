/// Residuals of one equilibrium. Each is relative to a scale: the largest value among the run's equilibria so far and
/// the present iterate.
///
///   equilibrium   largest nodal |R_u|, over the largest nodal force of any kind
///   normal        closed: |t_N - lambda_N|/rho = |g_N|, over the largest of A|t|/k and of the relative displacement
///   tangential    stick: |dg_T|, over the same; open and slip: |t - lambda|, over the largest traction
#pragma once

#include "core/contact/segment_facets.hpp"
#include "core/model/contact_assembly.hpp"
#include "core/model/loading.hpp"
#include "methods/newton/equilibrium.hpp"
#include "methods/newton/kept_patches.hpp"

namespace stickslip {

namespace detail {

inline constexpr double rounding_factor = 100;  // several hundred terms are summed in a row; each rounds once

/// x / scale; 0 for x = 0. NaN if the scale is not finite, so that no residual passes as small.
inline double ratio(double x, double scale) {
  return x == 0 ? 0 : std::isfinite(scale) ? x / scale : std::numeric_limits<double>::quiet_NaN();
}

struct Residuals {
  double equilibrium = 0, normal = 0, tangential = 0;
  double floor_equilibrium = 0, floor_length = 0, floor_traction = 0;  ///< residuals that rounding alone may leave
  double largest() const { return larger(larger(equilibrium, normal), tangential); }
  bool finite() const { return std::isfinite(equilibrium) && std::isfinite(normal) && std::isfinite(tangential); }
  /// The largest force of the run and of this iterate is no more than rounding.
  bool forces_are_rounding() const { return floor_equilibrium >= 1; }
  bool within(double tolerance) const { return finite() && largest() <= tolerance; }
  bool within_rounding(double tolerance) const {
    return finite() && equilibrium <= std::max(tolerance, floor_equilibrium) &&
           normal <= std::max(tolerance, floor_length) &&
           tangential <= std::max({tolerance, floor_length, floor_traction});
  }
};

/// Field, rows and residuals of one Newton iterate.
template <class T>
struct Evaluation {
  ContactField<T> field;
  Vector<T> rows_u, rows_l;
  Residuals residuals;
  RunScales scales;  ///< largest values of the run and of this iterate
  /// No load acts, bodies bear nothing, the run has had no force, and contact has what the rounding of gaps makes of
  /// rho.
  bool forceless = false;
};

/// Extreme values over the contact points, for estimates of rounding.
struct PointSizes {
  double area_times_rho = 0;                                 ///< largest A rho of a point that touches
  double distance = 0;                                       ///< largest initial gap of a closed point, length
  double bulge = 0;                                          ///< largest bulge_at() of a closed point, length
  double tie = 0;                                            ///< largest tie_length() of a point that touches, length
  double tie_force = 0;                                      ///< largest force that it makes of the body, k times it
  double elastic = 0;                                        ///< largest k / A
  double rho = 0;                                            ///< largest rho
  double softest = std::numeric_limits<double>::infinity();  ///< least k
};

/// How far the sides of quadratic elements that a point is on, or faces, bulge from straight ones at the start, length:
/// its gap is a difference of such lengths.
template <class T>
double bulge_at(const ContactInput<T>& input, const ContactField<T>& field, std::size_t p) {
  if (p >= field.facing.size()) return 0;
  const auto start = [&](int node) {
    return at_start<double>(values(input.slots.points.col(node)).template head<2>());
  };
  double largest = 0;
  for (const auto& segment : field.facing[p].pieces)
    for (const auto& side : {segment.slave_edge, segment.master_edge})
      largest = std::max(largest, detail::bulge_of<double, double>(side, start).start.norm());
  return largest;
}

/// Raises the scales of length and traction to those of a field, and returns the extreme values of its points.
template <class T>
PointSizes measure_points(const ContactInput<T>& input, const ContactField<T>& field, RunScales& scales) {
  PointSizes sizes;
  for (std::size_t p = 0; p < input.model.points.size(); ++p) {
    const auto& point = input.model.points[p];
    const double area = value(input.slots.geometry[p].area), stiffness = value(input.slots.stiffness[p]);
    const int offset = tangential_offset(input.model, static_cast<int>(p)) - 1;
    const double moved = root_of_squares(point.components(), [&](int c) {
      return c == 0 ? value(field.gap[p]) - value(input.slots.geometry[p].gap) : value(field.placement[offset + c]);
    });
    const double traction =
        root_of_squares(point.components(), [&](int c) { return value(field.traction[point.multiplier + c]); });
    scales.traction = std::max(scales.traction, traction);
    scales.length = std::max({scales.length, moved, area * traction / stiffness});
    const double tie = tie_length(point, input.slots.geometry[p]);
    const bool is_closed = field.state[p] != ContactState::open;
    if (is_closed || value(field.gap[p]) <= tie)  // (the gap of others makes no force)
      sizes.area_times_rho = std::max(sizes.area_times_rho, area * value(input.rho[p].normal));
    if (is_closed) {
      sizes.distance = std::max(sizes.distance, std::abs(value(input.slots.geometry[p].gap)));
      sizes.bulge = std::max(sizes.bulge, bulge_at(input, field, p));
    }
    if (value(field.gap[p]) <= tie) {
      sizes.tie = std::max(sizes.tie, tie);
      sizes.tie_force = std::max(sizes.tie_force, stiffness * tie);
    }
    sizes.elastic = std::max(sizes.elastic, stiffness / area);
    sizes.softest = std::min(sizes.softest, stiffness);
    sizes.rho = std::max(sizes.rho, value(input.rho[p].normal));
  }
  return sizes;
}

/// Largest nodal displacement, length, that supports prescribe at a time.
template <class T>
double prescribed_motion(const Model& model, const Slots<T>& slots, double time) {
  Vector<T> displacement = Vector<T>::Constant(model.dof_count(), T(0));
  prescribe(model, slots, time, displacement);
  return largest_nodal_norm(displacement, model.dimension);
}

/// Largest values of an iterate, lengths.
struct Magnitudes {
  double displacement = 0;  ///< of a contact node
  double relative = 0;      ///< whose rounding appears in a gap: displacement; with present geometry also relative
                            ///< displacement, which an obstacle makes too
  double prescribed = 0;    ///< displacement that supports prescribe
};

/// Sets the residuals that rounding alone may leave. `rounding`: of the bodies' nodal forces, force.
inline void set_floors(const PointSizes& sizes, const RunScales& scales, double rounding, const Magnitudes& magnitudes,
                       Residuals& residuals) {
  // A rounding of 1e-5 of the forces means displacements 1e9 times those that the forces cause in the stiffest body.
  // Such a body drifts off on a nearly singular tangent, and has no equilibrium that rounding hides. Exceptions:
  // supports prescribe a tenth of that motion, or a softer body yields that far under 1e3 times its force.
  constexpr double adrift = 1e-5, carried = 10, yielded = 1e3;
  const double bulk_floor = rounding_factor * ratio(rounding, scales.force),
               in_gap = std::max(magnitudes.relative, sizes.bulge);
  if (bulk_floor <= adrift || magnitudes.displacement <= carried * magnitudes.prescribed ||
      sizes.softest * magnitudes.displacement <= yielded * scales.force)
    residuals.floor_equilibrium =
        bulk_floor +
        rounding_factor * ratio(unit_roundoff * sizes.area_times_rho * std::max(in_gap, sizes.distance), scales.force);
  residuals.floor_length = rounding_factor * ratio(unit_roundoff * in_gap, scales.length);
  // In slip the bound turns the rounding of the pressure lambda_N + rho g_N into one of the tangential traction.
  residuals.floor_traction = rounding_factor * ratio(unit_roundoff * sizes.rho * in_gap, scales.traction);
}

/// Sets the normal and tangential residuals from t - lambda. `largest_displacement`: of a contact node, length.
template <class T>
void measure_multipliers(const ContactInput<T>& input, const Vector<T>& multiplier, const PointSizes& sizes,
                         double largest_displacement, Evaluation<T>& at) {
  const Model& model = input.model;
  // Where a body slides without pressure, its tractions are the rounding of its displacements.
  const bool presses = at.scales.traction > rounding_factor * unit_roundoff * sizes.elastic * largest_displacement;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    const ContactState state = at.field.state[p];
    // `count` components from `first` on; of those along the surface the length, which does not depend on its frame
    const auto measure = [&](int first, int count, bool is_length, const T& rho, double& worst) {
      const double defect = root_of_squares(
          count, [&](int c) { return value(at.field.traction[first + c]) - value(multiplier[first + c]); });
      const double traction_scale = at.scales.traction > 0 ? at.scales.traction : defect;  // all open, lambda not yet 0
      const double relative = is_length ? ratio(defect / value(rho), at.scales.length)
                              : presses ? ratio(defect, traction_scale)
                                        : 0;
      worst = larger(worst, relative);
    };
    const bool sticks = state == ContactState::stick;
    measure(point.multiplier, 1, state != ContactState::open, input.rho[p].normal, at.residuals.normal);
    measure(point.multiplier + 1, point.tangents, sticks, input.rho[p].tangential, at.residuals.tangential);
  }
}

}  // namespace detail

/// Evaluates the iterates of one equilibrium.
template <class T>
class Evaluator {
 public:
  Evaluator(Engine<T>& engine, const EquilibriumTask<T>& task, Account& account)
      : engine_(engine),
        task_(task),
        account_(account),
        prescribed_(detail::prescribed_motion(task.contact.model, task.contact.slots, task.contact.time)) {
    if (!task.contact.model.effects.current_geometry) return;
    for (const auto& point : task.contact.model.points) longest_step_ = std::max(longest_step_, point.mesh_size);
  }

  /// Field, rows and residuals at an iterate. Each point takes the branch of its trial traction.
  detail::Evaluation<T> operator()(const Unknowns<T>& unknowns);
  /// Largest share <= 1 of a step (engine dofs) that moves no contact node farther than the largest facet; 1 with
  /// initial geometry.
  double good_share(const Matrix<T>& step) const {
    if (longest_step_ == 0) return 1;
    const double largest = largest_nodal_norm(engine_.compact(Vector<T>(step.col(0))), task_.contact.model.dimension);
    return largest > longest_step_ ? longest_step_ / largest : 1;
  }
  /// Largest force of the run's equilibria so far.
  double force_of_run() const { return account_.scales.force; }
  /// What closed points face from iterate to iterate.
  KeptPatches<T>& patches() { return patches_; }
  /// Replaces the rows of an evaluation by those in given branches.
  void take_rows_in(const std::vector<ContactState>& branches, const Unknowns<T>& unknowns, detail::Evaluation<T>& at);

 private:
  detail::Magnitudes magnitudes_at(const Vector<T>& compact, const RunScales& scales) const {
    const Model& model = task_.contact.model;
    const double moved = largest_nodal_norm(compact, model.dimension);
    return {moved, model.effects.current_geometry ? std::max(moved, scales.length) : moved, prescribed_};
  }
  ContactField<T> field_at(const ContactInput<T>& input, const Vector<T>& compact, const Vector<T>& multiplier,
                           const std::vector<ContactState>* branches) const {
    if (task_.compliance) return evaluate_contact<T>(input, compact, task_.compliance->seen(multiplier), branches);
    return evaluate_contact<T>(input, compact, multiplier, branches);
  }
  Vector<T> contact_field_forces(const Vector<T>& compact, const ContactField<T>& field) const;
  /// Whether no load acts, and bodies bear no more than `most`, force.
  bool bears_nothing(const Unknowns<T>& unknowns, double most) const {
    const ContactInput<T>& input = task_.contact;
    ForceScale bodies;
    engine_.residual(unknowns.u, Vector<T>::Zero(engine_.compact(unknowns.u).size()), bodies);
    return bodies.force <= most &&
           external_forces(input.model, input.slots, input.time, engine_.all(unknowns.u)).isZero(0);
  }
  void count() { account_.counters.contact_evaluations += static_cast<long>(task_.contact.model.points.size()); }

  Engine<T>& engine_;
  const EquilibriumTask<T>& task_;
  Account& account_;
  double prescribed_;        ///< largest displacement that supports prescribe
  double longest_step_ = 0;  ///< largest step of a contact node: the largest facet; 0: unlimited
  KeptPatches<T> patches_;
};

/// Forces of contact and of the anchor, if any, on the contact nodes, compact.
template <class T>
Vector<T> Evaluator<T>::contact_field_forces(const Vector<T>& compact, const ContactField<T>& field) const {
  const Model& model = task_.contact.model;
  Vector<T> forces = contact_forces(model, task_.contact.slots, field);
  if (task_.anchor.stiffness.size() > 0) forces += task_.anchor.force(compact, model.dimension);
  return forces;
}

template <class T>
detail::Evaluation<T> Evaluator<T>::operator()(const Unknowns<T>& unknowns) {
  ContactInput<T> input = task_.contact;
  const Model& model = input.model;
  detail::Evaluation<T> at;
  at.scales = account_.scales;
  if (task_.arc) engine_.move_loads(unknowns.time);
  const Vector<T> compact = engine_.compact(unknowns.u);
  std::vector<Facing> facing;
  if (model.slides_on_surfaces()) {
    const Stopwatch time(account_.seconds.contact_search);
    facing = detail::facings(input, compact, patches_.kept());
    input.facing = &facing;
  }
  Vector<T> forces;
  {
    const Stopwatch time(account_.seconds.contact);
    at.field = field_at(input, compact, unknowns.multiplier, nullptr);
    forces = contact_field_forces(compact, at.field);
  }
  count();
  ForceScale force{at.scales.force, 0};
  {
    const Stopwatch time(account_.seconds.bodies);
    at.rows_u = engine_.residual(unknowns.u, forces, force);
  }
  at.scales.force = force.force;
  const auto sizes = detail::measure_points(input, at.field, at.scales);
  const detail::Magnitudes magnitudes = magnitudes_at(compact, at.scales);
  for (Eigen::Index row = 0; row < at.rows_u.size(); ++row)
    if (!engine_.is_free(row)) at.rows_u[row] = T(0);
  at.residuals.equilibrium = detail::ratio(largest_nodal_norm(at.rows_u, model.dimension), at.scales.force);
  detail::set_floors(sizes, at.scales, force.rounding, magnitudes, at.residuals);
  at.forceless = account_.scales.force == 0 && at.scales.force > 0 &&
                 at.scales.force <= sizes.area_times_rho * sizes.tie && bears_nothing(unknowns, sizes.tie_force);
  if (!task_.has_multiplier_rows()) return at;
  at.rows_l = multiplier_residual(model, input.slots, at.field.traction, unknowns.multiplier);
  detail::measure_multipliers(input, unknowns.multiplier, sizes, magnitudes.displacement, at);
  return at;
}

template <class T>
void Evaluator<T>::take_rows_in(const std::vector<ContactState>& branches, const Unknowns<T>& unknowns,
                                detail::Evaluation<T>& at) {
  ContactInput<T> input = task_.contact;
  input.facing = &at.field.facing;
  const Vector<T> compact = engine_.compact(unknowns.u);
  ContactField<T> field;
  Vector<T> forces;
  {
    const Stopwatch time(account_.seconds.contact);
    field = field_at(input, compact, unknowns.multiplier, &branches);
    forces = contact_field_forces(compact, field);
  }
  count();
  ForceScale unused;
  {
    const Stopwatch time(account_.seconds.bodies);
    at.rows_u = engine_.residual(unknowns.u, forces, unused);
  }
  if (task_.has_multiplier_rows())
    at.rows_l = multiplier_residual(input.model, input.slots, field.traction, unknowns.multiplier);
}

}  // namespace stickslip
