#include "core/engine/engine_price.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/engine/body_rows.hpp"
#include "core/engine/point_elimination.hpp"

namespace stickslip {
namespace {

/// Tangents that are factorised (updates spare the others), and solves with them.
struct Iterations {
  double tangents, solves;
};
// Tangents and solves of an increment, rounded from the GRECO plate with 40 to 160 cells a side, all methods. With
// friction: 7 to 11 tangents and 43 to 140 solves where stick and slip are found from nothing; 0.1 to 0.5 and 18 to 60
// where they are followed. Without friction: 1 and 2.
constexpr Iterations first_with_friction{8, 40}, next_with_friction{0.5, 20};
constexpr Iterations first_without{1.5, 3}, next_without{0.5, 3};
// Of bodies whose stiffness changes every tangent is factorised: 4 to 6 an increment of a punch on metal, all methods.
constexpr Iterations next_changing{5, 5};
// Time of an operation, where one of a sparse factorisation takes 1. Orders of magnitude. A back-solve waits for
// memory, less so with many right-hand sides. A dense factorisation runs on large blocks.
constexpr double of_solve = 3, of_block_solve = 1.2, of_dense = 1.0 / 3;
// A constrained ordering costs more than a free one. LU costs twice a Cholesky factorisation, and so does LDL^T in
// sparse matrices, of half its operations, for it pivots in small blocks. Pattern, ordering and assembly of the bodies
// cost half a factorisation, by either engine.
constexpr double free_ordering = 0.8, lu = 2, sparse_indefinite = 2, setting_up = 0.5;
constexpr int few_unknowns = 200;
// Sets of branches that a tangent of bodies which change is solved in: 1 by Newton's method, 3 to 5 in sequence.
constexpr double branches_a_tangent = 2;

double kind_of(Symmetry symmetry) {
  return symmetry == Symmetry::general ? lu : symmetry == Symmetry::positive_definite ? 1 : sparse_indefinite;
}

/// Right-hand sides of the derivatives of an increment.
double derivatives_of(const Scene& scene) {
  const bool adjoint = scene.sensitivity_mode == SensitivityMode::adjoint;
  return static_cast<double>(scene.parameters.empty() ? 0
                             : adjoint                ? scene.objectives.size()
                                                      : scene.parameters.size());
}

/// Factor of a tangent, ordered freely; of a scene that is condensed in part, or not at all.
FactorSize tangent_factor(const Model& model, Multipliers multipliers, const MixedRows* mixed) {
  const auto displacements = (mixed ? mixed->dofs : model.free_dofs).size();
  const int size = static_cast<int>(displacements) + (multipliers == Multipliers::unknown ? model.multiplier_count : 0);
  if (size == 0) return {};
  return predict_factor(make_pattern(size, tangent_rows(model, multipliers, mixed)), 0);
}

/// The price where the tangent of some body changes in each iteration, and each derivative needs a tangent of its own.
EnginePrice price_of_changing(const Model& model, Multipliers multipliers, Symmetry symmetry,
                              const FactorSize& bodies) {
  const double increments = static_cast<double>(model.times.size()), derivatives = derivatives_of(model.scene);
  const double tangents = increments * (next_changing.tangents + (derivatives > 0 ? 1 : 0));
  const double solves = increments * (next_changing.solves * of_solve + derivatives * of_block_solve);
  const auto price_of = [&](const FactorSize& factor) {
    return (setting_up + tangents * kind_of(symmetry)) * factor.flops + kind_of(symmetry) * 4 * factor.entries * solves;
  };
  EnginePrice price{price_of(tangent_factor(model, multipliers, nullptr)), std::numeric_limits<double>::infinity()};
  if (!has_mixed_bodies(model)) return price;
  const MixedRows mixed(model);
  const double contact = static_cast<double>(mixed.contact.size());
  price.condensed = (setting_up + 1) * bodies.flops + price_of(tangent_factor(model, multipliers, &mixed)) +
                    increments * 4 * bodies.entries * (of_solve + derivatives * of_block_solve) +
                    increments * next_changing.tangents * 2 * contact * contact * of_solve;
  return price;
}

}  // namespace

FactorSize bodies_factor(const Model& model) {
  const ContactLast rows = constant_bodies(model);
  if (rows.pattern->size == 0) return {};
  return predict_factor(rows.pattern, static_cast<int>(rows.contact.size()));
}

bool factorises_multipliers(const Model& model, Multipliers multipliers) {
  if (multipliers != Multipliers::unknown) return false;
  const auto rows = static_cast<Eigen::Index>(model.contact_nodes.size()) * model.dimension + model.multiplier_count;
  return rows < large_dense_system ||
         std::any_of(model.points.begin(), model.points.end(), [](const auto& point) { return point.is_integrated(); });
}

EnginePrice predict_price(const Model& model, Multipliers multipliers, Symmetry symmetry, const FactorSize& factor) {
  if (!model.effects.linear_bulk) return price_of_changing(model, multipliers, symmetry, factor);
  const double sparse_kind = kind_of(symmetry);
  const double dense_kind = symmetry == Symmetry::positive_definite ? 1 : lu;
  const double increments = static_cast<double>(model.times.size());
  const double derivatives = derivatives_of(model.scene);
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
                      (factorises_multipliers(model, multipliers) ? model.multiplier_count : 0);
  const double dense = dense_kind * rows * rows * rows / 3;
  const double differentiated = derivatives > 0 ? increments : 0;  // each with a tangent of its own
  price.condensed = (setting_up + 1) * factor.flops + (linearisations + differentiated) * of_dense * dense +
                    solves * 2 * rows * rows * of_solve +
                    increments * solve * (of_solve + derivatives * of_block_solve);
  return price;
}

bool prefers_condensed_tangents(const FactorSize& bodies, int dense_rows, Symmetry symmetry) {
  const double dense_kind = symmetry == Symmetry::positive_definite ? 1 : lu, rows = dense_rows;
  const double dense = of_dense * dense_kind * rows * rows * rows / 3;
  return bodies.flops + branches_a_tangent * dense <
         branches_a_tangent * kind_of(symmetry) * free_ordering * bodies.flops;
}

bool prefers_condensed(const Model& model, const EnginePrice& price) {
  return price.condensed < price.sparse || (model.effects.linear_bulk && model.free_dofs.size() < few_unknowns);
}

}  // namespace stickslip
