/// What a run costs by each engine, predicted before it from counts alone: the choice, and so the bits of the results,
/// hang on no clock.
#pragma once

#include "core/algebra/linear_solver.hpp"
#include "core/engine/multipliers.hpp"
#include "core/model/model.hpp"

namespace stickslip {

/// Floating-point operations, in units of one of a sparse factorisation: operations that wait for memory count more,
/// those on dense blocks less, by the time that they take.
struct EnginePrice {
  double sparse = 0;
  double condensed = 0;  ///< as far as bodies can be; infinite where none can
};

/// Factor of the bodies of constant stiffness that condenses them, the contact dofs eliminated last; analysed, not
/// made.
FactorSize bodies_factor(const Model& model);

/// Price of all increments of a scene and their derivatives. `multipliers` and `symmetry`: of the tangents; `factor`:
/// of the bodies.
EnginePrice predict_price(const Model& model, Multipliers multipliers, Symmetry symmetry, const FactorSize& factor);

/// Whether the dense system of bodies that are condensed once leaves multipliers to a factor (PointElimination): it is
/// small, or its points are integrated and share their nodes.
bool factorises_multipliers(const Model& model, Multipliers multipliers);

/// Whether each tangent of bodies that change is to be condensed: `bodies`: their factor with the contact dofs last;
/// `dense_rows`: of what is left; `symmetry`: of the whole tangent.
bool prefers_condensed_tangents(const FactorSize& bodies, int dense_rows, Symmetry symmetry);

/// Whether the bodies are to be condensed. Where all can be, and there are fewer than 200 unknowns, they always are:
/// there calls cost more than operations.
bool prefers_condensed(const Model& model, const EnginePrice& price);

}  // namespace stickslip
