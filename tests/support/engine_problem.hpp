/// A contact problem at an arbitrary state, for tests of the engines alone.
#pragma once

#include <memory>
#include <vector>

#include "core/engine/condensation.hpp"
#include "core/engine/engine.hpp"
#include "core/model/contact_assembly.hpp"
#include "core/model/facings.hpp"
#include "core/model/loading.hpp"
#include "core/model/point_tangent.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip {

/// Relative difference of two ways to solve such a problem: rounding times a condition number of some 1e4 (two boxes,
/// rho of the size of the nodal stiffness).
inline constexpr double solved = 1e-11;

/// A model with everything that a tangent of its contact points needs: a displacement, multipliers, a slip history, and
/// a branch for each point, of all kinds.
struct EngineProblem {
  Scene scene;
  Model model;
  Slots<double> slots;
  RegularisationField<double> rho;
  History<double> previous;
  Vector<double> u, multiplier;
  std::vector<ContactState> states;

  explicit EngineProblem(const Scene& of)
      : scene(of), model(make_model(of)), slots(make_slots<double>(model, of.as<double>())) {
    for (std::size_t p = 0; p < model.points.size(); ++p) {
      const double local = slots.stiffness[p] / slots.geometry[p].area;
      rho.push_back({2 * local, 1.5 * local});
    }
    previous = initial_history(model, slots);
    previous.placement =
        1e-3 * derivatives::arbitrary(model.multiplier_count - static_cast<int>(model.points.size()), 1);
    u = 1e-2 * derivatives::arbitrary(model.dof_count(), 2);
    multiplier = 10 * derivatives::arbitrary(model.multiplier_count, 3);
    for (const auto& point : model.points) multiplier[point.multiplier] = -20;
    for (std::size_t p = 0; p < model.points.size(); ++p) states.push_back(static_cast<ContactState>(p % 3));
    if (!model.effects.friction)
      for (auto& state : states) state = state == ContactState::open ? state : ContactState::slip;
  }

  ContactInput<double> input() const { return {model, slots, rho, previous, ConeRadius::augmented, 1.0}; }
  std::vector<PointTangent<double>> tangents() const {
    const Vector<double> compact = to_compact(model, u);
    const auto facing = model.slides_on_surfaces() ? detail::facings(input(), compact) : std::vector<Facing>();
    std::vector<PointTangent<double>> all;
    for (std::size_t p = 0; p < model.points.size(); ++p)
      all.push_back(point_tangent<double>(input(), static_cast<int>(p), compact, multiplier, states[p], facing));
    return all;
  }
  /// The same with every point open.
  std::vector<PointTangent<double>> open_tangents() const {
    EngineProblem open = *this;
    open.states.assign(states.size(), ContactState::open);
    return open.tangents();
  }
  SystemKind kind(bool unknown) const {
    return system_kind(model, unknown ? Multipliers::unknown : Multipliers::given, ConeRadius::augmented,
                       Backend::automatic);
  }
  Engine<double> sparse(bool unknown) const { return sparse_engine(model, slots, kind(unknown)); }
  std::shared_ptr<Condensation<double>> condensation() const {
    return std::make_shared<Condensation<double>>(model, slots, Backend::automatic);
  }
  Engine<double> condensed(bool unknown) const { return condensed_engine(model, slots, kind(unknown), condensation()); }
  /// Rows with zeros at prescribed dofs.
  Matrix<double> rows(int columns) const {
    Matrix<double> r(model.dof_count(), columns);
    for (int j = 0; j < columns; ++j) r.col(j) = derivatives::arbitrary(model.dof_count(), 10 + j);
    for (const auto& constraint : model.constraints) r.row(constraint.dof).setZero();
    return r;
  }
};

/// The upper box without its support: nothing but contact can hold it. `cells` along the interface.
inline Scene floating(int cells, bool friction) {
  auto scene = scenes::two_boxes(cells, cells + 2);
  scene.supports.pop_back();
  scene.responses.clear();
  if (!friction) scene.contacts[0].friction.reset();
  return scene;
}

}  // namespace stickslip
