/// Progress of the augmentations of one increment: distance from their fixed point, rate, and whether they converge.
///
///   contraction   q of the map lambda -> t(u(lambda), lambda). It comes from differences of values in the same contact
///                 states that exceed rounding and the residuals of the inner solves
///   error left    q / (1 - q) times the last update: the sum of the geometric series of the updates to come
///   two-cycle     three successive updates undo each other to 1e-6
///   infeasible    the gap of a constraint does not change with its multiplier, three times in a row. The last change
///                 of the multiplier, over the local stiffness k, exceeds 1e-8 of the displacements, and the gap
///                 changes by less than 1e-6 of it. Against a body of stiffness k the gap would change by about the
///                 whole, for any rho. A multiplier that leaves the cone of its state does not count, since it ends in
///                 another state
#pragma once

#include <string>

#include "methods/augmentation/acceleration.hpp"
#include "methods/newton/carried.hpp"
#include "methods/stepping/increment.hpp"
#include "methods/stepping/prescribed.hpp"

namespace stickslip {

namespace detail {

/// Error of constraint c of a closed point, length: g_N for c = 0; in stick also dg_T, component c - 1.
template <class T>
double constraint_error(const Model& model, const ContactField<T>& field, int p, int c) {
  return value(c == 0 ? field.gap[p] : field.slip[tangential_offset(model, p) + c - 1]);
}

/// Number of constraints of a point: open 0, slip 1 (g_N = 0), stick 1 + tangents (dg_T = 0 too).
template <class T>
int constraint_count(const Model& model, const ContactField<T>& field, int p) {
  if (field.state[p] == ContactState::open) return 0;
  return field.state[p] == ContactState::stick ? model.points[p].components() : 1;
}

}  // namespace detail

template <class T>
class AugmentationProgress {
 public:
  AugmentationProgress(const Model& model, const Slots<T>& slots, UzawaAL::Acceleration acceleration)
      : model_(model), slots_(slots), acceleration_(acceleration), unanswered_(model.points.size(), 0) {}

  /// Records one value of the map: `field` at `multiplier`. `largest_displacement`: of a contact node, length;
  /// `residual_ratio`: last over first residual of the inner solve.
  void record(const Vector<T>& multiplier, const ContactField<T>& field, double largest_displacement,
              double residual_ratio);

  bool has_same_states() const { return same_states_; }  ///< as after the last augmentation
  double contraction() const { return contraction_; }    ///< q; 0: not measured yet
  /// Largest component of the last update t - lambda, force per area.
  double update() const { return values_or_zero(update_); }
  /// Estimate of the largest error of a multiplier, force per area: update() times q / (1 - q), but at least update().
  /// update() alone if q is not measured, or if q > 1 - 1e-4. In the second case constraints repeat one another:
  /// rounding in their gaps changes their multipliers for ever, and moves nothing. A rho so small that updates truly
  /// fall that slowly leaves a violation, which has a tolerance of its own.
  double error_left() const {
    constexpr double not_falling = 1 - 1e-4;
    const double q = contraction_;
    if (q == 0 || q > not_falling) return update();
    return update() * std::max(1.0, q / (1 - q));
  }
  /// Whether, in the same states, the norm of the last update exceeds half of that before.
  bool is_stalled() const { return same_states_ && last_update_ > 0 && 2 * norm(update_) > last_update_; }
  /// Whether, in the same states, no update has fallen to 0.7 of the least one for 50 augmentations. Cause: a rho far
  /// above the stiffness of the other body, which turns residuals of the inner solves into tractions.
  bool is_exhausted() const { return same_states_ && idle_ >= 50; }
  /// Whether q < 0.9. Such a map soon reaches rounding, so updates that do not fall are rounding.
  bool contracts_fast() const { return contraction_ > 0 && contraction_ < 0.9; }
  /// Per point: largest constraint error, length.
  const std::vector<double>& violations() const { return violations_; }
  const std::vector<double>& last_violations() const { return last_violations_; }
  double violation() const {
    return violations_.empty() ? 0 : *std::max_element(violations_.begin(), violations_.end());
  }
  /// Whether a nodal force explains every update and violation: A |update| <= force and k |violation| <= force for each
  /// point, k the local nodal stiffness.
  bool is_within(double force) const;
  /// Whether the last three updates undo each other.
  bool is_two_cycle() const { return undone_ >= patience; }
  /// Whether the derivatives that the scalar carries (methods/newton/carried.hpp) still converge. They do not if their
  /// update is below 1e-13 of themselves, or no longer falls. Call it when the value has converged. On a double: false.
  bool has_carried_updates() {
    const bool converges = carried_ > 1e-13 * Carried<T>::size(field_.traction) && carried_ < last_carried_;
    last_carried_ = carried_;
    return converges;
  }
  /// Number of successive inner solves within the tolerance. `is_within`: whether the last one is.
  int times_within(bool is_within) { return times_within_ = is_within ? times_within_ + 1 : 0; }
  /// Declares that rho has changed: the next value belongs to another map.
  void change_map() { same_map_ = false; }
  /// The point with the largest violation among those whose gap does not change with their multiplier, in words of the
  /// scene. Empty if no violation exceeds `negligible`, length.
  std::string infeasible_point(double negligible) const;

 private:
  static constexpr int patience = 3;
  static constexpr std::size_t kept_secants = 8;
  static double values_or_zero(const Vector<double>& v) { return v.size() ? v.cwiseAbs().maxCoeff() : 0; }
  void record_rate(const Vector<T>& multiplier, const ContactField<T>& field, double residual_ratio);
  bool keeps_state(const Vector<double>& change, const ContactField<T>& field, int p) const;
  bool answers(const Vector<T>& multiplier, const ContactField<T>& field, int p, double largest_displacement) const;

  const Model& model_;
  const Slots<T>& slots_;
  UzawaAL::Acceleration acceleration_;
  bool same_states_ = false, same_map_ = true;
  double contraction_ = 0, last_update_ = 0, carried_ = 0;
  double inner_error_ = 0;   ///< norm of the error that the last inner solve leaves in the update
  double least_update_ = 0;  ///< least norm of an update in the present states
  int idle_ = 0;             ///< augmentations since an update fell to 0.7 of the least
  int times_within_ = 0;
  double last_carried_ = std::numeric_limits<double>::infinity();
  Vector<double> update_;
  std::vector<double> violations_, last_violations_;
  std::vector<Secant> secants_;  ///< the last few, of the same map in the same states
  std::vector<int> unanswered_;  ///< per point: successive augmentations without an answer of its gap
  int undone_ = 0;
  Vector<T> multiplier_;
  ContactField<T> field_;
};

template <class T>
void AugmentationProgress<T>::record(const Vector<T>& multiplier, const ContactField<T>& field,
                                     double largest_displacement, double residual_ratio) {
  const int points = static_cast<int>(model_.points.size());
  same_states_ = field.state == field_.state;
  const Vector<T> change = field.traction - multiplier;
  carried_ = Carried<T>::size(change);
  const Vector<double> update = values(change);
  const bool undone = update_.size() && norm(update) > 0 && norm(update + update_) <= 1e-6 * norm(update);
  undone_ = undone ? undone_ + 1 : 0;
  last_update_ = update_.size() ? norm(update_) : 0;
  update_ = update;
  if (!same_states_ || !same_map_ || norm(update) < 0.7 * least_update_) {
    least_update_ = norm(update);
    idle_ = 0;
  } else {
    ++idle_;
  }
  record_rate(multiplier, field, residual_ratio);
  last_violations_ = std::move(violations_);
  violations_.assign(points, 0.0);
  for (int p = 0; p < points; ++p) {
    for (int c = 0; c < detail::constraint_count(model_, field, p); ++c)
      violations_[p] = std::max(violations_[p], std::abs(detail::constraint_error(model_, field, p, c)));
    unanswered_[p] =
        multiplier_.size() && !answers(multiplier, field, p, largest_displacement) ? unanswered_[p] + 1 : 0;
  }
  multiplier_ = multiplier;
  field_ = field;
}

template <class T>
void AugmentationProgress<T>::record_rate(const Vector<T>& multiplier, const ContactField<T>& field,
                                          double residual_ratio) {
  const double before = inner_error_;
  inner_error_ = residual_ratio * last_update_;
  if (!same_states_ || !same_map_) secants_.clear();
  if (!same_map_) contraction_ = 0;
  const bool comparable = same_states_ && same_map_ && last_update_ > 0;
  same_map_ = true;
  if (!comparable) return;
  const Vector<double> moved = values(multiplier - multiplier_);
  const double size = norm(moved), rounding = 8 * unit_roundoff * norm(values(field.traction));
  const double noise = (rounding + before + inner_error_) / size;
  // Rounding has no rate. Neither have values so close that the inner solve had nothing to do.
  if (100 * rounding > size || noise > 0.5) return;
  secants_.push_back({moved, values(field.traction - field_.traction), noise});
  if (secants_.size() > kept_secants) secants_.erase(secants_.begin());
  const double q = stickslip::contraction(secants_);
  // Plain updates align with the slowest mode, so the last q is right. Accelerated updates suppress this mode after
  // they have shown it, so the largest q is right.
  const bool plain = acceleration_ == UzawaAL::Acceleration::none || secants_.size() == 1;
  if (plain || q < 1) contraction_ = plain ? q : std::max(contraction_, q);
}

/// Whether a point keeps its state if its multiplier grows by any multiple of `change`: it stays closed, and a sticking
/// point stays in the cone.
template <class T>
bool AugmentationProgress<T>::keeps_state(const Vector<double>& change, const ContactField<T>& field, int p) const {
  const auto& point = model_.points[p];
  if (change[0] > 0) return false;
  if (field.state[p] != ContactState::stick) return true;
  return norm(change.tail(point.tangents)) <= -slots_.friction[point.contact].slope_at_infinity() * change[0];
}

/// Whether the gap of point p changes with its multiplier. `expected`: change of the gap in a body of the local
/// stiffness k. A change below `telling` of the displacements says nothing, and the point counts as answering.
/// Otherwise a constraint that changes by less than `nothing` of the expected change does not answer.
template <class T>
bool AugmentationProgress<T>::answers(const Vector<T>& multiplier, const ContactField<T>& field, int p,
                                      double largest_displacement) const {
  constexpr double telling = 1e-8, nothing = 1e-6;
  const double compliance = value(slots_.geometry[p].area) / value(slots_.stiffness[p]);
  const int common = std::min(detail::constraint_count(model_, field, p), detail::constraint_count(model_, field_, p));
  const int first = model_.points[p].multiplier, components = model_.points[p].components();
  const Vector<double> change = values(multiplier.segment(first, components) - multiplier_.segment(first, components));
  if (!keeps_state(change, field, p)) return true;
  for (int c = 0; c < common; ++c) {
    const double expected = compliance * std::abs(change[c]);
    const double before = detail::constraint_error(model_, field_, p, c),
                 now = detail::constraint_error(model_, field, p, c);
    if (expected > telling * largest_displacement && std::abs(now - before) <= nothing * expected) return false;
  }
  return true;
}

template <class T>
bool AugmentationProgress<T>::is_within(double force) const {
  for (int p = 0; p < static_cast<int>(model_.points.size()); ++p) {
    const auto& point = model_.points[p];
    const double update = norm(update_.segment(point.multiplier, point.components()));
    if (violations_[p] * value(slots_.stiffness[p]) > force || update * value(slots_.geometry[p].area) > force)
      return false;
  }
  return true;
}

template <class T>
std::string AugmentationProgress<T>::infeasible_point(double negligible) const {
  int worst = -1;
  for (int p = 0; p < static_cast<int>(unanswered_.size()); ++p)
    if (unanswered_[p] >= patience && (worst < 0 || violations_[p] > violations_[worst])) worst = p;
  if (worst < 0 || violations_[worst] <= negligible) return "";
  return name_of_point(model_, slots_, worst) + " violates its constraint by " + short_number(violations_[worst]) +
         " and does not yield, however large its multiplier; is its motion prescribed?";
}

}  // namespace stickslip
