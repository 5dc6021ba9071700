#include "core/model/engine_price.hpp"

#include <cmath>

#include "core/model/body_matrix.hpp"

namespace stickslip {
namespace {

// Of an increment: tangents that are factorised (updates spare the others), and solves with them. Rounded from Cattaneo
// and Mindlin's cylinders, 1.7 and 13 an increment, and from first increments, which take more tangents.
constexpr double tangents = 3, solves = 10;
// Beside an operation of a sparse factorisation: one of a back-solve waits for memory, less so with many right-hand
// sides; one of a dense factorisation runs on large blocks. Orders of magnitude, not fitted: no bench holds them yet.
constexpr double of_solve = 3, of_block_solve = 1.2, of_dense = 1.0 / 3;
// A constrained ordering costs more than a free one; LU twice what a Cholesky factorisation does.
constexpr double free_ordering = 0.65, lu = 2;
constexpr int few_unknowns = 200;

}  // namespace

FactorSize bodies_factor(const Model& model) {
  const int D = model.dimension;
  std::vector<int> row(model.dof_count(), -1);
  int last = 0;
  for (int node : model.contact_nodes)
    for (int i = 0; i < D; ++i) row[node * D + i] = -2;
  for (int dof : model.free_dofs)
    if (row[dof] == -1) row[dof] = last++;
  const int interior = last;
  for (int node : model.contact_nodes)
    for (int i = 0; i < D; ++i) row[node * D + i] = last++;
  return predict_factor(make_pattern(last, element_rows(model, row)), last - interior);
}

EnginePrice predict_price(const Model& model, bool unknown_multipliers, Symmetry symmetry) {
  const FactorSize factor = bodies_factor(model);
  const double sparse_kind = symmetry == Symmetry::general ? lu : 1;
  const double dense_kind = symmetry == Symmetry::positive_definite ? 1 : lu;
  const double increments = static_cast<double>(model.times.size());
  const auto& scene = model.scene;
  const bool adjoint = scene.sensitivity_mode == SensitivityMode::adjoint;
  const double derivatives = static_cast<double>(scene.parameters.empty() ? 0
                                                 : adjoint                ? scene.objectives.size()
                                                                          : scene.parameters.size());
  const double linearisations = tangents + (derivatives > 0 ? 1 : 0);

  const double solve = 4 * factor.entries;  // forwards and back, an addition and a multiplication each
  EnginePrice price;
  price.sparse = increments * (linearisations * sparse_kind * free_ordering * factor.flops +
                               sparse_kind * solve * (solves * of_solve + derivatives * of_block_solve));
  const double rows = static_cast<double>(model.contact_nodes.size()) * model.dimension +
                      (unknown_multipliers ? model.multiplier_count : 0);
  const double dense = dense_kind * rows * rows * rows / 3;
  price.condensed =
      factor.flops + increments * (linearisations * of_dense * dense + 2 * solve * of_solve +
                                   solves * 2 * rows * rows * of_solve + 2 * derivatives * solve * of_block_solve);
  return price;
}

bool prefers_condensed(const Model& model, const EnginePrice& price) {
  return price.condensed < price.sparse || model.free_dofs.size() < few_unknowns;
}

}  // namespace stickslip
