/// Derivatives of objectives by both modes: backward in time, and forward by those of the responses.
#pragma once

#include "tests/support/largest.hpp"
#include "tests/support/solved_run.hpp"

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
  SolvedRun run(scene, method);
  const Matrix<double> direct = run.objectives_of(run.direct()), backward = run.backward().of_objectives;
  if (direct.size() == 0 || backward.rows() != direct.rows()) return std::numeric_limits<double>::quiet_NaN();
  double worst = 0;
  for (Eigen::Index i = 0; i < direct.rows(); ++i)
    worst = larger(worst, largest_entry(backward.row(i) - direct.row(i)) / largest_entry(direct.row(i)));
  return worst;
}

}  // namespace stickslip::scenes
