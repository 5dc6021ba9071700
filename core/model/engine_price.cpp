#include "core/model/engine_price.hpp"

#include <cmath>

#include "core/model/body_matrix.hpp"

namespace stickslip {
namespace {

/// Tangents that are factorised (updates spare the others), and solves with them.
struct Iterations {
  double tangents, solves;
};
// Rounded from the GRECO plate with 40 to 160 cells a side, all methods: 7 to 11 and 43 to 140 in an increment that
// finds stick and slip from nothing, 0.1 to 0.5 and 18 to 60 in one that follows it; without friction 1 and 2.
constexpr Iterations first_with_friction{8, 40}, next_with_friction{0.5, 20};
constexpr Iterations first_without{1.5, 3}, next_without{0.5, 3};
// Beside an operation of a sparse factorisation: one of a back-solve waits for memory, less so with many right-hand
// sides; one of a dense factorisation runs on large blocks. Orders of magnitude.
constexpr double of_solve = 3, of_block_solve = 1.2, of_dense = 1.0 / 3;
// A constrained ordering costs more than a free one; LU twice what a Cholesky factorisation does. Pattern, ordering and
// assembly of the bodies, by either engine: half a factorisation.
constexpr double free_ordering = 0.8, lu = 2, setting_up = 0.5;
constexpr int few_unknowns = 200;

}  // namespace

FactorSize bodies_factor(const Model& model) {
  const ContactLast rows = with_contact_last(model);
  return predict_factor(rows.pattern, static_cast<int>(rows.contact.size()));
}

EnginePrice predict_price(const Model& model, bool unknown_multipliers, Symmetry symmetry, const FactorSize& factor) {
  const double sparse_kind = symmetry == Symmetry::general ? lu : 1;
  const double dense_kind = symmetry == Symmetry::positive_definite ? 1 : lu;
  const double increments = static_cast<double>(model.times.size());
  const auto& scene = model.scene;
  const bool adjoint = scene.sensitivity_mode == SensitivityMode::adjoint;
  const double derivatives = static_cast<double>(scene.parameters.empty() ? 0
                                                 : adjoint                ? scene.objectives.size()
                                                                          : scene.parameters.size());
  const bool friction = model.effects.friction;
  const Iterations first = friction ? first_with_friction : first_without;
  const Iterations next = friction ? next_with_friction : next_without;
  const double linearisations = first.tangents + (increments - 1) * next.tangents;
  const double solves = first.solves + (increments - 1) * next.solves;

  const double solve = 4 * factor.entries;  // forwards and back, an addition and a multiplication each
  EnginePrice price;
  price.sparse = setting_up * factor.flops + linearisations * sparse_kind * free_ordering * factor.flops +
                 sparse_kind * solve * (solves * of_solve + increments * derivatives * of_block_solve);
  const double rows = static_cast<double>(model.contact_nodes.size()) * model.dimension +
                      (unknown_multipliers ? model.multiplier_count : 0);
  const double dense = dense_kind * rows * rows * rows / 3;
  const double differentiated = derivatives > 0 ? increments : 0;  // each with a tangent of its own
  price.condensed = (setting_up + 1) * factor.flops + (linearisations + differentiated) * of_dense * dense +
                    solves * 2 * rows * rows * of_solve +
                    increments * solve * (of_solve + derivatives * of_block_solve);
  return price;
}

bool prefers_condensed(const Model& model, const EnginePrice& price) {
  return price.condensed < price.sparse || model.free_dofs.size() < few_unknowns;
}

}  // namespace stickslip
