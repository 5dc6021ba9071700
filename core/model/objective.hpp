/// Objectives: scalars over time, sums of what single steps contribute (docs/scene.md).
#pragma once

#include "core/model/response.hpp"

namespace stickslip {

/// Whether the step that ends at `time` contributes. `end`: of the run; times closer than 1e-9 of it are one.
inline bool contributes(const Objective& objective, double time, double end) {
  return !objective.at || std::abs(time - *objective.at) <= 1e-9 * end;
}

/// What a step contributes. `response`: its value at the end of the step.
template <class T>
T contribution(const Objective& objective, const T& response, double time, const Numbers<T>& numbers) {
  if (!objective.target) return response;
  const T distance = response - evaluate(*objective.target, time, numbers);
  return distance * distance;
}

/// Adds what the step that ends at `time` contributes to each objective, out of the values of all responses.
inline void add_contributions(const Model& model, const Numbers<double>& numbers, double time,
                              const Vector<double>& responses, Vector<double>& sums) {
  const auto& objectives = model.scene.objectives;
  for (std::size_t j = 0; j < objectives.size(); ++j)
    if (contributes(objectives[j], time, model.times.back()))
      sums[j] += contribution(objectives[j], responses[objectives[j].response], time, numbers);
}

}  // namespace stickslip
