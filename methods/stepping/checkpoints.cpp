#include "methods/stepping/checkpoints.hpp"

#include <cmath>

namespace stickslip {

double thinned_bytes(const Model& model) {
  return sizeof(double) * (static_cast<double>(model.dof_count()) + model.memory_count);
}

std::size_t CheckpointPlan::whole() const {
  std::size_t count = 0;
  for (std::size_t step = 1; step <= steps; ++step) count += keeps(step);
  return count;
}

std::size_t CheckpointPlan::repeated() const {
  const bool ends_whole = thinned == steps && steps % stride != 0;  // (the last state is whole)
  return thinned - thinned / stride - (ends_whole ? 1 : 0);
}

std::optional<CheckpointPlan> plan_checkpoints(std::size_t steps, double room) {
  const auto all = static_cast<double>(steps);
  if (!(all > room)) return std::nullopt;
  const auto least = static_cast<std::size_t>(std::ceil(std::sqrt(all)));
  for (std::size_t stride = 2; stride <= least; ++stride) {
    const auto s = static_cast<double>(stride);
    const double thinned = std::ceil((all - std::floor(room) + s - 1) / (s - 1)) * s;  // (a whole number of stretches)
    if (thinned <= all) return CheckpointPlan{steps, static_cast<std::size_t>(thinned), stride};
  }
  return CheckpointPlan{steps, steps, std::max<std::size_t>(least, 2)};
}

std::optional<CheckpointPlan> plan_checkpoints(const Model& model, const RunOptions& options) {
  if (model.scene.arc_length) return std::nullopt;     // (a path continues from the two states before)
  if (options.output_every == 1) return std::nullopt;  // all are to stay
  const std::size_t steps = options.replay.empty() ? model.times.size() : options.replay.size();
  auto plan = plan_checkpoints(steps, options.state_memory / thinned_bytes(model));
  if (plan) plan->output_every = static_cast<std::size_t>(options.output_every);
  return plan;
}

}  // namespace stickslip
