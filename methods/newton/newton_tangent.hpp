/// The tangent of a Newton step: assembled in given branches, then factorised, or taken as an update of the last
/// factor; and the step.
#pragma once

#include <Eigen/LU>

#include "core/engine/shared_forces.hpp"
#include "core/model/point_tangent.hpp"
#include "methods/newton/assumed_branches.hpp"

namespace stickslip {

namespace detail {

/// A constraint that supports decide takes its multiplier from the gap, step by step, as a penalty of the local
/// stiffness k / A would. That holds also where rho is smaller: steps of rho would not reach the bound of friction.
template <class T>
void yield_decided(const ContactInput<T>& input, const std::vector<char>& decided,
                   std::vector<PointTangent<T>>& tangents) {
  constexpr double nothing = 1e-8;
  for (std::size_t p = 0; p < tangents.size(); ++p) {
    auto& tangent = tangents[p];
    const double local = value(input.slots.stiffness[p]) / value(input.slots.geometry[p].area);
    const double share = std::min(1.0, value(input.rho[p].normal) / local);
    for (Eigen::Index c = 0; c < tangent.row_l.rows(); ++c) {
      if (!decided[input.model.points[p].multiplier + c]) continue;
      const double own = values(tangent.row_l.row(c)).cwiseAbs().maxCoeff();
      const double along = values(tangent.row_w.row(c)).cwiseAbs().maxCoeff();
      if (own <= nothing * along) tangent.row_l(c, c) -= T(share * along);
    }
  }
}

/// Calls f(column of the point's tangent, compact displacement, its weight there).
template <class T, class F>
void for_each_column(const Model& model, const Slots<T>& slots, std::size_t p, const PointTangent<T>& tangent, F&& f) {
  const int D = model.dimension;
  const bool by_places = !tangent.places.empty();
  const auto& places = by_places ? tangent.places : model.points[p].places;
  for (int n = 0; n < static_cast<int>(places.size()); ++n)
    for (int i = 0; i < D; ++i)
      f((by_places ? n * D : 0) + i, places[n] * D + i, by_places ? T(1) : slots.geometry[p].weights[n]);
}

/// What the columns of a point's tangent take from compact displacements.
template <class T>
Vector<T> gather(const Model& model, const Slots<T>& slots, std::size_t p, const PointTangent<T>& tangent,
                 const Vector<T>& compact) {
  Vector<T> own = Vector<T>::Constant(tangent.force_w.cols(), T(0));
  for_each_column(model, slots, p, tangent, [&](int c, int row, const T& weight) { own[c] += weight * compact[row]; });
  return own;
}

/// Adds what a point does to its columns to compact rows.
template <class T>
void scatter(const Model& model, const Slots<T>& slots, std::size_t p, const PointTangent<T>& tangent,
             const Vector<T>& own, Vector<T>& compact) {
  for_each_column(model, slots, p, tangent, [&](int c, int row, const T& weight) { compact[row] += weight * own[c]; });
}

/// Turns l, the multipliers over rho that systems are solved for, into multipliers.
template <class T>
void multiply_by_rho(const ContactInput<T>& input, Matrix<T>& l) {
  for (std::size_t p = 0; l.size() > 0 && p < input.model.points.size(); ++p)
    for (int c = 0; c < input.model.points[p].components(); ++c)
      l(input.model.points[p].multiplier + c, 0) *= c == 0 ? input.rho[p].normal : input.rho[p].tangential;
}

/// Of tractions that are solved for point by point (Compliance): a point's own unknowns, eliminated.
template <class T>
class OwnTractions {
 public:
  /// `tangents`: with respect to displacement and to lambda as the points see it. They become tangents with respect to
  /// the displacement alone.
  void eliminate(const EquilibriumTask<T>& task, std::vector<PointTangent<T>>& tangents) {
    points_.clear();
    for (std::size_t p = 0; p < tangents.size(); ++p) {
      auto& tangent = tangents[p];
      const auto& rho = task.contact.rho[p];
      const T area = task.contact.slots.geometry[p].area;
      for (Eigen::Index c = 0; c < tangent.row_l.cols(); ++c) {
        const T share = task.compliance->share[task.contact.model.points[p].multiplier + c];
        const T own = area * (c == 0 ? rho.normal : rho.tangential);
        tangent.row_l(c, c) += own;
        tangent.row_l.col(c) *= T(1) - share;
        tangent.force_l.col(c) *= T(1) - share;
        tangent.row_l(c, c) -= own;
      }
      points_.push_back(tangent);
      const Matrix<T> inverse = tangent.row_l.inverse();
      points_.back().row_w = inverse * tangent.row_w;
      points_.back().row_l = inverse;
      tangent.force_w -= tangent.force_l * points_.back().row_w;
    }
  }
  /// What the points' rows add to those of the displacements (compact).
  Vector<T> carried(const Model& model, const Slots<T>& slots, const Vector<T>& rows_l) const {
    Vector<T> rows = Vector<T>::Constant(static_cast<Eigen::Index>(model.contact_nodes.size()) * model.dimension, T(0));
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const auto& point = points_[p];
      const Vector<T> force =
          -(point.force_l * (point.row_l * rows_l.segment(model.points[p].multiplier, point.row_l.rows())));
      scatter(model, slots, p, point, force, rows);
    }
    return rows;
  }
  /// The points' unknowns after a step of the displacements (compact).
  Matrix<T> recover(const Model& model, const Slots<T>& slots, const Vector<T>& rows_l, const Vector<T>& motion) const {
    Matrix<T> l(model.multiplier_count, 1);
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const auto& point = points_[p];
      const auto C = point.row_l.rows();
      l.block(model.points[p].multiplier, 0, C, 1) = -(point.row_l * rows_l.segment(model.points[p].multiplier, C) +
                                                       point.row_w * gather(model, slots, p, point, motion));
    }
    return l;
  }

 private:
  std::vector<PointTangent<T>> points_;  ///< row_w, row_l: multiplied by the inverse of row_l, and that inverse
};

}  // namespace detail

/// When the bodies' tangent is taken anew. For a first step the last one is as good where it is near.
enum class Linearise { always, unless_near };

template <class T>
class NewtonTangent {
 public:
  NewtonTangent(Engine<T>& engine, const EquilibriumTask<T>& task, Account& account)
      : engine_(engine), task_(task), account_(account) {
    if (task.solves_for_multipliers()) decided_ = decided_elsewhere(task.contact.model, task.contact.slots);
  }

  /// Takes the tangent of what depends on the place: of the bodies where it is not constant, what points face, and
  /// which multipliers are decided elsewhere where normals turn.
  void move_to(const Unknowns<T>& unknowns, const ContactField<T>& field, Linearise linearise) {
    const auto& [model, slots] = std::tie(task_.contact.model, task_.contact.slots);
    if (!model.effects.linear_bulk) {
      const Stopwatch time(account_.seconds.bodies);
      const Vector<T> moved = engine_.spread(unknowns.u);
      const BodyMotion<T> at{moved, task_.contact.previous.bodies, task_.arc ? unknowns.time : task_.contact.time};
      if (linearise == Linearise::always || !engine_.has_tangent_near(at)) engine_.linearise(at);
    }
    face(field);
  }
  /// The same of the contact points alone.
  void face(const ContactField<T>& field) {
    const auto& [model, slots] = std::tie(task_.contact.model, task_.contact.slots);
    facing_ = field.facing;
    if (model.effects.current_geometry && task_.solves_for_multipliers())
      decided_ = decided_elsewhere(model, slots, &field);
  }

  /// Prepares the engine to solve with the tangent in `branches`. It may be singular while points are open, as of a
  /// body that nothing holds but the contact it is about to make. Then open points are presumed closed, in `branches`
  /// too: those that should not be are in tension next, and open. False where the tangent stays singular.
  bool factorise(const Unknowns<T>& unknowns, std::vector<ContactState>& branches);
  /// The same in these branches alone.
  bool factorise_in(const std::vector<ContactState>& branches, const Unknowns<T>& unknowns);
  /// The step that takes rows of residuals to zero: the motion, and that of lambda where it has rows. Not finite where
  /// the tangent is singular after all.
  NewtonStep<T> step(const Vector<T>& rows_u, const Vector<T>& rows_l);
  /// The same along a path, from a place on it or near it: with the time's, on the arc.
  NewtonStep<T> step_along(const Arc& arc, const Unknowns<T>& unknowns, const Vector<T>& rows_u,
                           const Vector<T>& rows_l);
  /// Of the points, as they were factorised last.
  const std::vector<PointTangent<T>>& tangents() const { return tangents_; }
  /// Constraints repeat one another: they share the force.
  bool redundant() const { return redundant_; }

 private:
  std::vector<PointTangent<T>> point_tangents(const std::vector<ContactState>& branches, const Unknowns<T>& unknowns);

  Engine<T>& engine_;
  const EquilibriumTask<T>& task_;
  Account& account_;
  std::vector<char> decided_;
  std::vector<Facing> facing_;  ///< of the place
  std::vector<PointTangent<T>> tangents_;
  detail::OwnTractions<T> own_;  ///< where tractions are solved for point by point
  bool redundant_ = false;
  int presumptions_ = 3;  ///< how often open points may still be presumed closed
};

template <class T>
bool NewtonTangent<T>::factorise(const Unknowns<T>& unknowns, std::vector<ContactState>& branches) {
  if (factorise_in(branches, unknowns)) return true;
  const auto closed = detail::presume_contact(task_.contact, branches);
  if (closed == branches || presumptions_-- == 0) return false;
  branches = closed;
  return factorise_in(branches, unknowns);
}

template <class T>
std::vector<PointTangent<T>> NewtonTangent<T>::point_tangents(const std::vector<ContactState>& branches,
                                                              const Unknowns<T>& unknowns) {
  const Stopwatch time(account_.seconds.contact);
  const auto& input = task_.contact;
  std::vector<PointTangent<T>> tangents;
  const Vector<T> compact = engine_.compact(unknowns.u);
  const Vector<T> seen = task_.compliance ? task_.compliance->seen(unknowns.multiplier) : Vector<T>();
  for (int p = 0; p < static_cast<int>(input.model.points.size()); ++p)
    tangents.push_back(
        point_tangent<T>(input, p, compact, task_.compliance ? seen : unknowns.multiplier, branches[p], facing_));
  if (task_.compliance) own_.eliminate(task_, tangents);
  return tangents;
}

template <class T>
NewtonStep<T> NewtonTangent<T>::step(const Vector<T>& rows_u, const Vector<T>& rows_l) {
  const Stopwatch time(account_.seconds.backsolve);
  NewtonStep<T> step;
  if (task_.compliance) {
    const auto& [model, slots] = std::tie(task_.contact.model, task_.contact.slots);
    Vector<T> rows = rows_u;
    add_compact(model, into_frames(model, slots.frames, NodalLayout::compact, own_.carried(model, slots, rows_l)),
                rows);
    step = {engine_.solve({-rows, Matrix<T>()})};
    step.l = own_.recover(model, slots, rows_l, engine_.compact(step.u.col(0)));
  } else {
    step = {engine_.solve({-rows_u, task_.solves_for_multipliers() ? Matrix<T>(-rows_l) : Matrix<T>()})};
  }
  account_.counters.backsolves += engine_.solves();
  detail::multiply_by_rho(task_.contact, step.l);
  return step;
}

/// A step along a path is x + y dt, with K x = -R and K y = df_ext/dt; dt takes it to the arc. Of the two places where
/// that line meets the arc, the one in the direction of the iterate is taken; at the very beginning of a path, the one
/// in the direction of the load. Where the line misses the arc, its nearest place is taken.
template <class T>
NewtonStep<T> NewtonTangent<T>::step_along(const Arc& arc, const Unknowns<T>& unknowns, const Vector<T>& rows_u,
                                           const Vector<T>& rows_l) {
  NewtonStep<T> step = this->step(rows_u, rows_l);
  const auto along = this->step(-engine_.load_rate(unknowns.u), Vector<T>::Constant(rows_l.size(), T(0)));
  const Vector<double> moved = values(engine_.all(unknowns.u)) - arc.start,
                       start = moved + values(engine_.increment(step.u.col(0), 0)),
                       y = values(engine_.increment(along.u.col(0), 1));
  const double passed = unknowns.time - arc.time, of_motion = 1 / (arc.nodes * arc.length * arc.length),
               of_time = 1 / (arc.span * arc.span);
  const double a = of_motion * y.squaredNorm() + of_time, b = of_motion * y.dot(start) + of_time * passed,
               c = of_motion * start.squaredNorm() + of_time * passed * passed - 1;
  const double ahead = of_motion * y.dot(moved) + of_time * passed;
  step.time = (std::copysign(std::sqrt(std::max(b * b - a * c, 0.0)), ahead) - b) / a;
  step.u += T(step.time) * along.u;
  if (step.l.size() > 0) step.l += T(step.time) * along.l;
  return step;
}

template <class T>
bool NewtonTangent<T>::factorise_in(const std::vector<ContactState>& branches, const Unknowns<T>& unknowns) {
  auto tangents = point_tangents(branches, unknowns);
  if (task_.last && !task_.contact.model.effects.linear_bulk) tangents_ = tangents;
  if (!decided_.empty()) detail::yield_decided(task_.contact, decided_, tangents);
  const auto& anchor = task_.anchor.stiffness;
  if (!redundant_) {
    const Stopwatch time(account_.seconds.backsolve);
    if (engine_.update(tangents, account_.counters, anchor)) return true;
  }
  const Stopwatch time(account_.seconds.factorization);
  if (!task_.solves_for_multipliers()) return engine_.factorise(tangents, account_.counters, anchor);
  return factorise_sharing(engine_, task_.contact.model, {}, std::move(tangents), redundant_, account_.counters,
                           anchor);
}

}  // namespace stickslip
