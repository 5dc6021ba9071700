/// What a run is given beside its method, and what it leaves.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/model/engine.hpp"
#include "methods/options.hpp"
#include "methods/trace.hpp"

namespace stickslip {

/// How a run is carried out, apart from its method.
struct RunOptions {
  LinearAlgebra linear_algebra;
  Backend backend = Backend::automatic;
  std::vector<double> replay;     ///< ends of the increments to repeat, without cutting; empty: the model's own steps
  std::function<void()> on_step;  ///< called after each requested step; may be empty
  Trace* trace = nullptr;         ///< not owned; gathers every iterate where it is there
};

/// What a run allocates and leaves for its sensitivities: owned by the caller, the only mutable thing beside them.
/// `condensation` may be handed on to another run on the same slots (a sweep over methods): it is reused if it is
/// there.
template <class T>
struct Workspace {
  std::shared_ptr<Condensation<T>> condensation;
  std::optional<Engine<T>> engine;
};

}  // namespace stickslip
