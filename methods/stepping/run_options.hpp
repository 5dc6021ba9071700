/// Options of a run apart from its method, and the workspace that it leaves.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/engine/condensation.hpp"
#include "core/engine/engine.hpp"
#include "core/model/state.hpp"
#include "methods/newton/trace.hpp"
#include "methods/options.hpp"

namespace stickslip {

/// Options of a run apart from its method.
struct RunOptions {
  LinearAlgebra linear_algebra;
  Backend backend = Backend::automatic;
  std::vector<double> replay;         ///< ends of increments to repeat, uncut; empty: the model's own steps
  std::vector<Vector<double>> guide;  ///< start displacements, all dofs, of the increments of a path that is repeated
  std::function<void()> on_step;      ///< called after each requested step; may be empty
  Trace* trace = nullptr;             ///< not owned; nullptr: iterates are not recorded
  /// Bytes for the displacements and the memory of the bodies in all states. Beyond it states are thinned, and solved
  /// again when an adjoint asks for them (methods/stepping/checkpoints.hpp).
  double state_memory = std::numeric_limits<double>::infinity();
  /// Every output_every-th state stays whole all the same; 0: the last state alone, which always does.
  int output_every = 0;
};

/// Options that repeat the increments of a run. The increments of a path start from their own displacements. Why: under
/// the load alone, an increment past a limit point would return to the branch before it.
inline RunOptions repeating(RunOptions options, const Model& model, const Trajectory<double>& trajectory) {
  options.replay = trajectory.step_table();
  options.guide.clear();
  for (const auto& increment : trajectory.increments)
    if (model.scene.arc_length) options.guide.push_back(increment.state.displacement);
  return options;
}

template <class T>
class Checkpoints;

/// What a run allocates and leaves for its sensitivities. The caller owns it. A `condensation` that is set is reused; a
/// sweep over methods passes it on between runs with the same slots.
template <class T>
struct Workspace {
  std::shared_ptr<Condensation<T>> condensation;
  std::shared_ptr<Engine<T>> engine;
  std::shared_ptr<Checkpoints<T>> checkpoints = nullptr;  ///< set if states were thinned
};

}  // namespace stickslip
