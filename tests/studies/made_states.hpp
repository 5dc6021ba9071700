/// Models whose states the test writes by hand.
#pragma once

#include <vector>

#include "core/model/contact_assembly.hpp"
#include "studies/run/metrics.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::made_states {

/// A model with a trajectory that the test writes.
struct Made {
  Model model;
  Slots<double> slots;
  Trajectory<double> trajectory;

  explicit Made(const Scene& scene) : model(make_model(scene)), slots(make_slots<double>(model, scene.as<double>())) {
    trajectory.initial = initial_state<double>(model, slots);
  }
  /// A further increment; it starts as nothing moved and nothing pressed.
  State<double>& next() {
    trajectory.increments.emplace_back();
    trajectory.increments.back().time = static_cast<double>(trajectory.increments.size());
    trajectory.increments.back().state = initial_state<double>(model, slots);
    return trajectory.increments.back().state;
  }
  std::vector<KktError> errors() const { return kkt_errors(model, slots, trajectory); }
};

/// A point on a spring, 100 along x and 200 along y, over a floor with its normal along y; friction 1/2. The tangent of
/// the floor is (-1, 0), the load (0, -10), the tributary area 1.
inline Scene one_point() {
  Scene s;
  s.legs = {{4, 4}};
  s.bodies = {{"a", PointMesh{{0.0, 0.0}}, GroundedSpring{{{100.0, 0.0}, {0.0, 200.0}}}, "", 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  s.contacts = {scenes::contact("one", "a.node", "floor")};
  s.contacts[0].friction = 0.5;
  s.loads = {scenes::force("a.node", {0.0, -10.0})};
  return s;
}

/// One point in balance: pressed by 10 and not moved, but for what the test changes; the run's length is 10 / 200.
struct Point : Made {
  Point() : Made(one_point()) {}
  State<double>& rest() {
    auto& state = next();
    state.contact.state[0] = ContactState::stick;
    state.contact.traction << -10, 0;
    return state;
  }
};

}  // namespace stickslip::made_states
