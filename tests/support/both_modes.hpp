/// Derivatives of objectives by both modes: backward in time, and forward by those of the responses.
#pragma once

#include "sensitivity/adjoint.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::scenes {

/// Gives a scene its responses at the end, and summed over the steps, as objectives.
inline void ask_for_objectives(Scene& scene) {
  for (int i = 0; i < static_cast<int>(scene.responses.size()); ++i) {
    scene.objectives.push_back({"end of " + scene.responses[i].name, i, scene.legs.back().end});
    scene.objectives.push_back({"sum of " + scene.responses[i].name, i, {}});
  }
}

/// Largest difference of the two modes, of each objective over the largest of its derivatives; NaN where one of them
/// has none.
inline double difference_of_modes(const Scene& scene, const Method& method) {
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  Workspace<double> workspace;
  const auto trajectory = solve(model, slots, method, {}, workspace);
  const auto forward = differentiate(model, slots, method, trajectory, workspace);
  const Matrix<double> direct = objective_gradients(model, slots, trajectory, forward.of_responses);
  const Matrix<double> backward = adjoint(model, slots, method, trajectory, workspace).of_objectives;
  if (direct.size() == 0 || backward.rows() != direct.rows()) return std::numeric_limits<double>::quiet_NaN();
  double worst = 0;
  for (Eigen::Index i = 0; i < direct.rows(); ++i)
    worst = larger(worst, largest_entry(backward.row(i) - direct.row(i)) / largest_entry(direct.row(i)));
  return worst;
}

}  // namespace stickslip::scenes
