/// Derivatives of objectives in two modes. Direct: from the derivatives of all responses. Adjoint: backward in time, at
/// the cost of one transposed solve per objective and increment for any number of parameters. Each method has the
/// adjoint of its own scheme, so both modes agree to rounding.
#pragma once

#include "sensitivity/differentiate.hpp"

namespace stickslip {

/// Value of each objective of the scene, over the increments of the trajectory.
Vector<double> objective_values(const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory);

/// Derivatives of the objectives, objectives x parameters, from the derivatives of the responses at every increment
/// (Gradients::of_responses, or one of their sides). Empty if the derivatives of an increment are missing. `responses`:
/// their values, per increment; those that were not requested are not read.
Matrix<double> objective_gradients(const Model& model, const Trajectory<double>& trajectory,
                                   const std::vector<Vector<double>>& responses,
                                   const std::vector<Matrix<double>>& of_responses);
/// The same, of a trajectory whose states are whole.
Matrix<double> objective_gradients(const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory,
                                   const std::vector<Matrix<double>>& of_responses);

/// Derivatives of the objectives backward in time. Of Gradients, only of_objectives and the records of cost are set.
/// `workspace`: that of the run, as for differentiate().
Gradients adjoint(const Model& model, const Slots<double>& slots, const Method& method,
                  const Trajectory<double>& trajectory, Workspace<double>& workspace);

}  // namespace stickslip
