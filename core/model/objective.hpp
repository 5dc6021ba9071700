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

}  // namespace stickslip
