/// What the augmentations of one increment tell of their own convergence: how far they are from their fixed point, how
/// fast they get there, and whether they ever will.
///
///   contraction   q of the map lambda -> t(u(lambda), lambda), from differences of its values in the same contact
///                 states, as far as these stand above rounding and above the residuals of the inner solves
///   error left    q / (1 - q) times the last update: the sum of the geometric series of updates to come
///   two-cycle     three updates in a row undo each other, but for 1e-6
///   infeasible    a constraint whose gap does not answer to its multiplier, three times in a row. The change of the
///                 multiplier would close a gap of 1e-8 of the displacements through the local stiffness k, and the gap
///                 moves by less than 1e-6 of that. Against a body of stiffness k it would move by about the whole,
///                 whatever rho is. A change that leads out of the state's part of the cone ends in another state: it
///                 does not count
#pragma once

#include <string>

#include "methods/acceleration.hpp"
#include "methods/carried.hpp"
#include "methods/increment.hpp"

namespace stickslip {

namespace detail {

/// Component c of the constraint that a closed point should meet: g_N, or in stick dg_T (length).
template <class T>
double constraint_error(const Model& model, const ContactField<T>& field, int p, int c) {
  return value(c == 0 ? field.gap[p] : field.slip[tangential_offset(model, p) + c - 1]);
}

/// Number of constraints of a point in its state.
template <class T>
int constraint_count(const Model& model, const ContactField<T>& field, int p) {
  if (field.state[p] == ContactState::open) return 0;
  return field.state[p] == ContactState::stick ? model.points[p].components() : 1;
}

}  // namespace detail

template <class T>
class Augmentations {
 public:
  Augmentations(const Model& model, const Slots<T>& slots, UzawaAL::Acceleration acceleration)
      : model_(model), slots_(slots), acceleration_(acceleration), stuck_(model.points.size(), 0) {}

  /// Takes in one value of the map: `field` at `multiplier`. `reach`: largest displacement of a contact node. `left`:
  /// residual of the inner solve, over the one that it started from.
  void record(const Vector<T>& multiplier, const ContactField<T>& field, double reach, double left);

  bool settled() const { return settled_; }            ///< no state changed since the last augmentation
  double contraction() const { return contraction_; }  ///< 0: not measured yet
  double update() const { return values_or_zero(update_); }
  /// Largest error of a multiplier: update() times q / (1 - q), and at least update(). q = 0 is not measured: update().
  /// q > 1 - 1e-4 gives update() too. Updates that do not fall come from constraints that repeat one another: rounding
  /// in the gap pushes their multipliers for ever, and moves nothing. A rho so small that updates truly fall that
  /// slowly is seen by the violation, which has a tolerance of its own.
  double error_left() const {
    constexpr double not_falling = 1 - 1e-4;
    const double q = contraction_;
    if (q == 0 || q > not_falling) return update();
    return update() * std::max(1.0, q / (1 - q));
  }
  /// In the same states the last update has not fallen to half of the one before.
  bool stalled() const { return settled_ && last_update_ > 0 && 2 * update_.norm() > last_update_; }
  /// In the same states no update has fallen to 0.7 of the least one for 50 augmentations. The cause is a rho far above
  /// the stiffness of the other body: it turns residuals of the inner solves into tractions.
  bool exhausted() const { return settled_ && idle_ >= 50; }
  /// q < 0.9: so fast a map would have reached rounding, so updates that do not fall are rounding.
  bool converges() const { return contraction_ > 0 && contraction_ < 0.9; }
  const std::vector<double>& violations() const { return violations_; }  ///< per point, length
  const std::vector<double>& last_violations() const { return last_violations_; }
  double violation() const {
    return violations_.empty() ? 0 : *std::max_element(violations_.begin(), violations_.end());
  }
  /// Whether a nodal force of this size explains what is left: each update, as a traction, and each violation, as a gap
  /// through the local stiffness k.
  bool is_within(double force) const;
  bool alternates() const { return undone_ >= patience; }
  /// Whether the derivatives that the scalar carries (methods/carried.hpp) still converge. Asked once the value has
  /// settled. They have converged where their update is below 1e-13 of themselves, or no longer falls. On a double:
  /// false.
  bool carried_moves() {
    const bool moves = carried_ > 1e-13 * Carried<T>::size(field_.traction) && carried_ < settled_carried_;
    settled_carried_ = carried_;
    return moves;
  }
  /// Says that rho has changed, so that the next value is that of another map.
  void change_map() { same_map_ = false; }
  /// Of the points whose gap does not answer to their multiplier, the one with the largest violation, in words of the
  /// scene. Empty where no violation is above `negligible`.
  std::string unanswered(double negligible) const;

 private:
  static constexpr int patience = 3;
  static constexpr std::size_t kept_secants = 8;
  static double values_or_zero(const Vector<double>& v) { return v.size() ? v.cwiseAbs().maxCoeff() : 0; }
  void record_rate(const Vector<T>& multiplier, const ContactField<T>& field, double left);
  bool keeps_state(const Vector<double>& by, const ContactField<T>& field, int p) const;
  bool answers(const Vector<T>& multiplier, const ContactField<T>& field, int p, double reach) const;

  const Model& model_;
  const Slots<T>& slots_;
  UzawaAL::Acceleration acceleration_;
  bool settled_ = false, same_map_ = true;
  double contraction_ = 0, last_update_ = 0, carried_ = 0;
  double inner_error_ = 0;   ///< part of the update (norm) that the last inner solve left uncertain
  double least_update_ = 0;  ///< least norm of an update in the present states
  int idle_ = 0;             ///< augmentations since an update fell to 0.7 of the least
  double settled_carried_ = std::numeric_limits<double>::infinity();
  Vector<double> update_;
  std::vector<double> violations_, last_violations_;
  std::vector<Secant> secants_;  ///< the last few, of the same map in the same states
  std::vector<int> stuck_;       ///< per point: augmentations in a row that its gap has not answered to
  int undone_ = 0;
  Vector<T> multiplier_;
  ContactField<T> field_;
};

template <class T>
void Augmentations<T>::record(const Vector<T>& multiplier, const ContactField<T>& field, double reach, double left) {
  const int points = static_cast<int>(model_.points.size());
  settled_ = field.state == field_.state;
  const Vector<T> change = field.traction - multiplier;
  carried_ = Carried<T>::size(change);
  const Vector<double> update = values(change);
  const bool undone = update_.size() && update.norm() > 0 && (update + update_).norm() <= 1e-6 * update.norm();
  undone_ = undone ? undone_ + 1 : 0;
  last_update_ = update_.size() ? update_.norm() : 0;
  update_ = update;
  if (!settled_ || !same_map_ || update.norm() < 0.7 * least_update_) {
    least_update_ = update.norm();
    idle_ = 0;
  } else {
    ++idle_;
  }
  record_rate(multiplier, field, left);
  last_violations_ = std::move(violations_);
  violations_.assign(points, 0.0);
  for (int p = 0; p < points; ++p) {
    for (int c = 0; c < detail::constraint_count(model_, field, p); ++c)
      violations_[p] = std::max(violations_[p], std::abs(detail::constraint_error(model_, field, p, c)));
    stuck_[p] = multiplier_.size() && !answers(multiplier, field, p, reach) ? stuck_[p] + 1 : 0;
  }
  multiplier_ = multiplier;
  field_ = field;
}

template <class T>
void Augmentations<T>::record_rate(const Vector<T>& multiplier, const ContactField<T>& field, double left) {
  const double before = inner_error_;
  inner_error_ = left * last_update_;
  if (!settled_ || !same_map_) secants_.clear();
  if (!same_map_) contraction_ = 0;
  const bool comparable = settled_ && same_map_ && last_update_ > 0;
  same_map_ = true;
  if (!comparable) return;
  const Vector<double> moved = values(multiplier - multiplier_);
  const double length = moved.norm(), rounding = 8 * unit_roundoff * values(field.traction).norm();
  const double noise = (rounding + before + inner_error_) / length;
  // rounding has no rate; nor have values so close that an inner solve found nothing to solve
  if (100 * rounding > length || noise > 0.5) return;
  secants_.push_back({moved, values(field.traction - field_.traction), noise});
  if (secants_.size() > kept_secants) secants_.erase(secants_.begin());
  const double q = stickslip::contraction(secants_);
  // Plain updates align with the slowest mode, so the last q counts. Accelerated ones suppress that mode once they have
  // shown it, so the largest q counts.
  const bool plain = acceleration_ == UzawaAL::Acceleration::none || secants_.size() == 1;
  if (plain || q < 1) contraction_ = plain ? q : std::max(contraction_, q);
}

/// Whether a multiplier that goes on to grow by `by` stays closed, and sticks if it sticks.
template <class T>
bool Augmentations<T>::keeps_state(const Vector<double>& by, const ContactField<T>& field, int p) const {
  const auto& point = model_.points[p];
  if (by[0] > 0) return false;
  if (field.state[p] != ContactState::stick) return true;
  return by.tail(point.tangents).norm() <= -slots_.friction[point.contact].slope_at_infinity() * by[0];
}

/// Whether a point answers to the last change of its multiplier. `pushed`: the motion that the change would cause in a
/// body of the local stiffness k. Where that is below `telling` of the displacements it says nothing, and the point
/// counts as answering. Else a constraint that moves by less than `nothing` of it does not answer.
template <class T>
bool Augmentations<T>::answers(const Vector<T>& multiplier, const ContactField<T>& field, int p, double reach) const {
  constexpr double telling = 1e-8, nothing = 1e-6;
  const double compliance = value(slots_.geometry[p].area) / value(slots_.stiffness[p]);
  const int common = std::min(detail::constraint_count(model_, field, p), detail::constraint_count(model_, field_, p));
  const int first = model_.points[p].multiplier, components = model_.points[p].components();
  const Vector<double> by = values(multiplier.segment(first, components) - multiplier_.segment(first, components));
  if (!keeps_state(by, field, p)) return true;
  for (int c = 0; c < common; ++c) {
    const double pushed = compliance * std::abs(by[c]);
    const double before = detail::constraint_error(model_, field_, p, c),
                 now = detail::constraint_error(model_, field, p, c);
    if (pushed > telling * reach && std::abs(now - before) <= nothing * pushed) return false;
  }
  return true;
}

template <class T>
bool Augmentations<T>::is_within(double force) const {
  for (int p = 0; p < static_cast<int>(model_.points.size()); ++p) {
    const auto& point = model_.points[p];
    const double update = update_.segment(point.multiplier, point.components()).norm();
    if (violations_[p] * value(slots_.stiffness[p]) > force || update * value(slots_.geometry[p].area) > force)
      return false;
  }
  return true;
}

template <class T>
std::string Augmentations<T>::unanswered(double negligible) const {
  int worst = -1;
  for (int p = 0; p < static_cast<int>(stuck_.size()); ++p)
    if (stuck_[p] >= patience && (worst < 0 || violations_[p] > violations_[worst])) worst = p;
  if (worst < 0 || violations_[worst] <= negligible) return "";
  return name_of_point(model_, slots_, worst) + " violates its constraint by " + short_number(violations_[worst]) +
         " and does not yield, however large its multiplier; is its motion prescribed?";
}

}  // namespace stickslip
