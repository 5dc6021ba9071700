/// A scene that has been run, in the state in which the program takes its derivatives: with the workspace of the run.
#pragma once

#include "sensitivity/adjoint.hpp"
#include "sensitivity/one_sided.hpp"

namespace stickslip::scenes {

struct SolvedRun {
  Model model;
  Slots<double> slots;
  Method method;
  Workspace<double> workspace = {};
  Trajectory<double> trajectory;

  SolvedRun(const Scene& scene, const Method& by, const RunOptions& options = {})
      : model(make_model(scene)),
        slots(make_slots<double>(model, scene.as<double>())),
        method(by),
        trajectory(solve(model, slots, method, options, workspace)) {}
  SolvedRun(const SolvedRun&) = delete;  // (the workspace refers to the model)

  Gradients direct() { return differentiate(model, slots, method, trajectory, workspace); }
  Gradients backward() { return adjoint(model, slots, method, trajectory, workspace); }
  std::optional<OneSided> both_sides() { return one_sided_derivatives(model, slots, method, trajectory, workspace); }
  /// The derivatives of the objectives out of those of the responses.
  Matrix<double> objectives_of(const Gradients& direct) const {
    return objective_gradients(model, slots, trajectory, direct.of_responses);
  }
  Trajectory<double> again() { return solve(model, slots, method, {}, workspace); }
};

}  // namespace stickslip::scenes
