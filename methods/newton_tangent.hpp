/// The tangent of a Newton step: assembled in given branches, then factorised, or taken as an update of the last
/// factor.
#pragma once

#include "core/model/shared_forces.hpp"
#include "methods/assumed_branches.hpp"

namespace stickslip {

namespace detail {

/// A constraint that supports decide takes its multiplier from the gap as a penalty of the local stiffness k / A would,
/// step by step, also where rho is smaller: steps of rho would not get to the bound of friction.
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

}  // namespace detail

template <class T, class E>
class NewtonTangent {
 public:
  NewtonTangent(E& engine, const EquilibriumTask<T>& task, Account& account)
      : engine_(engine), task_(task), account_(account) {
    if (task.solves_for_multipliers()) decided_ = decided_elsewhere(task.contact.model, task.contact.slots);
  }

  /// Takes the tangent of what depends on the place: of the bodies where it is not constant, what points face, and
  /// which multipliers are decided elsewhere where normals turn.
  void move_to(const Unknowns<T>& unknowns, const ContactField<T>& field) {
    const auto& [model, slots] = std::tie(task_.contact.model, task_.contact.slots);
    if (!model.effects.linear_bulk) {
      const Stopwatch time(account_.seconds.assembly);
      const Vector<T> moved = engine_.all(unknowns.u);
      engine_.linearise({moved, task_.contact.previous.bodies, task_.contact.time});
    }
    facing_ = field.facing;
    if (model.effects.current_geometry && task_.solves_for_multipliers())
      decided_ = decided_elsewhere(model, slots, &field);
  }

  /// Prepares the engine to solve with the tangent in `branches`. Where that is singular while points are open, as of a
  /// body that nothing holds but the contact it is about to make, they are presumed closed, in `branches` too: those
  /// that should not be are in tension then, and open. False where the tangent stays singular.
  bool factorise(const Unknowns<T>& unknowns, std::vector<ContactState>& branches);
  /// Of the points, as they were factorised last.
  const std::vector<PointTangent<T>>& tangents() const { return tangents_; }
  /// Constraints repeat one another: they share the force.
  bool redundant() const { return redundant_; }

 private:
  bool factorise_in(const std::vector<ContactState>& branches, const Unknowns<T>& unknowns);
  std::vector<PointTangent<T>> point_tangents(const std::vector<ContactState>& branches, const Unknowns<T>& unknowns);

  E& engine_;
  const EquilibriumTask<T>& task_;
  Account& account_;
  std::vector<char> decided_;
  std::vector<Facing> facing_;  ///< of the place
  std::vector<PointTangent<T>> tangents_;
  bool redundant_ = false;
  int presumptions_ = 3;  ///< left
};

template <class T, class E>
bool NewtonTangent<T, E>::factorise(const Unknowns<T>& unknowns, std::vector<ContactState>& branches) {
  if (factorise_in(branches, unknowns)) return true;
  const auto closed = detail::presume_contact(task_.contact, branches);
  if (closed == branches || presumptions_-- == 0) return false;
  branches = closed;
  return factorise_in(branches, unknowns);
}

template <class T, class E>
std::vector<PointTangent<T>> NewtonTangent<T, E>::point_tangents(const std::vector<ContactState>& branches,
                                                                 const Unknowns<T>& unknowns) {
  const Stopwatch time(account_.seconds.assembly);
  const auto& input = task_.contact;
  std::vector<PointTangent<T>> tangents;
  const Vector<T> compact = engine_.compact(unknowns.u);
  for (int p = 0; p < static_cast<int>(input.model.points.size()); ++p)
    tangents.push_back(point_tangent<T>(input, p, compact, unknowns.multiplier, branches[p], facing_));
  return tangents;
}

template <class T, class E>
bool NewtonTangent<T, E>::factorise_in(const std::vector<ContactState>& branches, const Unknowns<T>& unknowns) {
  auto tangents = point_tangents(branches, unknowns);
  if (task_.from && !task_.contact.model.effects.linear_bulk) tangents_ = tangents;
  if (!decided_.empty()) detail::yield_decided(task_.contact, decided_, tangents);
  const auto& hold = task_.anchor.stiffness;
  if (!redundant_) {
    const Stopwatch time(account_.seconds.backsolve);
    if (engine_.update(tangents, account_.counters, hold)) return true;
  }
  const Stopwatch time(account_.seconds.factorization);
  if (!task_.solves_for_multipliers()) return engine_.factorise(tangents, account_.counters, hold);
  return factorise_sharing(engine_, task_.contact.model, {}, std::move(tangents), redundant_, account_.counters, hold);
}

}  // namespace stickslip
