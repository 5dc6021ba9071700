/// What a run is given beside its method, and what it leaves.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/model/engine.hpp"
#include "core/model/state.hpp"
#include "methods/options.hpp"
#include "methods/trace.hpp"

namespace stickslip {

/// How a run is carried out, apart from its method.
struct RunOptions {
  LinearAlgebra linear_algebra;
  Backend backend = Backend::automatic;
  std::vector<double> replay;  ///< ends of the increments to repeat, without cutting; empty: the model's own steps
  std::vector<Vector<double>> guide;  ///< displacements, all dofs, that increments repeated along a path begin with
  std::function<void()> on_step;      ///< called after each requested step; may be empty
  Trace* trace = nullptr;             ///< not owned; gathers every iterate where it is there
  /// Bytes for displacements and for what bodies remember, of all states; beyond them some are let go, and solved again
  /// where an adjoint asks for them (methods/checkpoints.hpp).
  double state_memory = std::numeric_limits<double>::infinity();
  /// Then every so many steps a state stays nevertheless; 0: the last alone, which always does.
  int output_every = 0;
};

/// Options that repeat the increments of a run. Those of a path begin where they ended: under a load alone a step past
/// a limit point would go back to where it came from.
inline RunOptions repeating(RunOptions options, const Model& model, const Trajectory<double>& trajectory) {
  options.replay = trajectory.step_table();
  options.guide.clear();
  for (const auto& increment : trajectory.increments)
    if (model.scene.arc_length) options.guide.push_back(increment.state.displacement);
  return options;
}

template <class T>
class Checkpoints;

/// What a run allocates and leaves for its sensitivities: owned by the caller, the only mutable thing beside them.
/// `condensation` may be handed on to another run on the same slots (a sweep over methods): it is reused if it is
/// there.
template <class T>
struct Workspace {
  std::shared_ptr<Condensation<T>> condensation;
  std::optional<Engine<T>> engine;
  std::shared_ptr<Checkpoints<T>> checkpoints = nullptr;  ///< where states were let go
};

}  // namespace stickslip
