/// Derivatives of objectives: from those of all responses (direct), or backward in time (adjoint), where the cost is a
/// transposed solve an objective and increment, however many parameters there are. Each method has the adjoint of its
/// own scheme; the two modes agree to rounding.
#pragma once

#include "sensitivity/differentiate.hpp"

namespace stickslip {

/// Value of each objective of the scene, over the increments that there are.
Vector<double> objective_values(const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory);

/// Derivatives of the objectives, objectives x parameters, from those of the responses at every increment. Empty where
/// some are missing.
Matrix<double> objective_gradients(const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory,
                                   const Gradients& gradients);

/// Derivatives of the objectives backward in time: Gradients::of_objectives, and nothing else of them. `workspace`:
/// that of the run, as differentiate() has it.
Gradients adjoint(const Model& model, const Slots<double>& slots, const Method& method,
                  const Trajectory<double>& trajectory, Workspace<double>& workspace);

}  // namespace stickslip
