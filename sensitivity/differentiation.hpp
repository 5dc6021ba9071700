/// What direct differentiation carries, and the bodies' share in it, which may be had for several increments at once:
/// the engine solves many right-hand sides for little more than one.
#pragma once

#include <optional>

#include "core/model/loading.hpp"
#include "sensitivity/differentiate.hpp"
#include "sensitivity/dual_stiffness.hpp"

namespace stickslip {

/// Numbers of the scene with up to `directions` parameters seeded, each in a direction of its own.
inline Numbers<Direction> seeded(const Scene& scene, const std::vector<int>& parameters) {
  auto numbers = scene.as<Direction>();
  for (std::size_t d = 0; d < parameters.size(); ++d)
    for (const auto& [slot, weight] : scene.parameters[parameters[d]].slots) numbers.at_slot[slot].d[d] += weight;
  return numbers;
}

/// Elements whose forces a parameter touches, body by body: by material, thickness, shape or prescribed motion. A
/// pseudo-load comes from these alone. Where nodes have frames, whose derivatives turn the forces themselves, these are
/// all elements; of a body that remembers too.
ElementLists touched_elements(const Model& model, const Slots<Direction>& slots);

/// Parameters in groups of up to `directions`, by their place in the scene: those that touch material, thickness or
/// shape of bodies first, so that few sweeps visit elements.
std::vector<std::vector<int>> parameter_groups(const Model& model);

/// Whether the stiffness of linear bodies is kept with its derivatives. A run of two steps or less would save nothing.
/// With more parameters than go into one solve it would double the memory of that.
inline bool keeps_stiffness(const Model& model) {
  return model.times.size() > 2 && static_cast<int>(model.scene.parameters.size()) <= columns_together;
}

/// Bytes of the stiffness that parameter_blocks() would keep.
long kept_stiffness_bytes(const Model& model);

/// Slots and running state of up to `directions` parameters.
struct ParameterBlock {
  std::vector<int> parameters;  ///< by direction
  Slots<Direction> slots;
  State<Direction> previous, current;
  ElementLists touched;                                   ///< those whose forces are differentiated in each increment
  std::optional<DualStiffness> stiffness = std::nullopt;  ///< of the others that parameters touch

  /// At the initial state.
  ParameterBlock(const Model& model, std::vector<int> seeds, Slots<Direction> of)
      : parameters(std::move(seeds)),
        slots(std::move(of)),
        previous(initial_state<Direction>(model, slots)),
        current(previous),
        touched(touched_elements(model, slots)) {}

  /// Takes the elements of linear bodies out of `touched`, into `stiffness`.
  void keep_stiffness(const Model& model);
};

/// Blocks of all the scene's parameters, at the initial state.
inline std::vector<ParameterBlock> parameter_blocks(const Model& model) {
  std::vector<ParameterBlock> blocks;
  for (const auto& group : parameter_groups(model)) {
    blocks.emplace_back(model, group, make_slots<Direction>(model, seeded(model.scene, group)));
    if (keeps_stiffness(model)) blocks.back().keep_stiffness(model);
  }
  return blocks;
}

/// What parameters and prescribed motions do to the bodies' balance in an increment while its free displacements are
/// held. It depends on the derivative of what bodies remember, and on no other derivative so far.
struct PseudoLoad {
  std::vector<Vector<Direction>> displacement;  ///< per block, with the derivative of prescribed motion
  Matrix<double> rows;                          ///< a column a parameter, all dofs; until it is reduced
  Reduction<double> reduced;                    ///< to the engine's rows
};

/// Derivatives of an increment's displacements, to be expanded from the engine's dofs.
struct Unexpanded {
  PseudoLoad load;
  Matrix<double> increment;  ///< engine dofs
};

/// Everything a scheme reads to differentiate one increment.
template <class E>
struct Differentiation {
  const Model& model;
  const Slots<double>& slots;
  E& engine;
  std::vector<ParameterBlock>& blocks;
  int parameters = 0;
  Counters counters;
  Status status = Status::singular;  ///< where a scheme fails: that it could not factorise, or cap
  std::string message = {};
  bool follows = false;                                 ///< the engine has a factor that may serve (reuse_factor)
  std::optional<SchemeRecord> record = std::nullopt;    ///< of the last increment
  std::optional<PseudoLoad> prepared = std::nullopt;    ///< of the next increment; empty: the scheme makes it
  std::optional<Unexpanded> unexpanded = std::nullopt;  ///< of the last increment, for expand()
};

/// A vector as dual numbers without derivative.
inline Vector<Direction> lift(const Vector<double>& v) {
  return v.unaryExpr([](double x) { return Direction(x); });
}

/// Columns of derivatives, one a parameter, out of the blocks, and back. `pick` selects the dual vector of a block.
template <class Pick>
Matrix<double> gather(std::vector<ParameterBlock>& blocks, int parameters, Pick&& pick) {
  Matrix<double> out;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Vector<Direction>& v = pick(blocks[b], static_cast<int>(b));
    if (b == 0) out.resize(v.size(), parameters);
    for (std::size_t d = 0; d < blocks[b].parameters.size(); ++d)
      for (Eigen::Index i = 0; i < v.size(); ++i) out(i, blocks[b].parameters[d]) = v[i].d[d];
  }
  return out;
}
inline void add_derivatives(Vector<Direction>& v, const Eigen::Ref<const Matrix<double>>& columns,
                            const ParameterBlock& block) {
  for (std::size_t d = 0; d < block.parameters.size(); ++d)
    for (Eigen::Index i = 0; i < v.size(); ++i) v[i].d[d] += columns(i, block.parameters[d]);
}

/// The pseudo-load of the bodies at a state, not yet reduced.
template <class E>
PseudoLoad pseudo_load(const Differentiation<E>& problem, const State<double>& at, double time) {
  const Model& model = problem.model;
  const Vector<double>& displacement = at.displacement;
  PseudoLoad load;
  std::vector<Vector<Direction>> rows;
  for (auto& block : problem.blocks) {
    Vector<Direction> u = lift(displacement);
    prescribe(model, block.slots, time, u);
    for (Eigen::Index i = 0; i < u.size(); ++i) u[i].v = displacement[i];
    const Vector<Direction> memory = bulk_flow(model, block.slots, u, block.previous.history.bodies, at.flow);
    Vector<Direction> balance = bulk_forces(model, block.slots, u, memory, &block.touched);
    if (block.stiffness) block.stiffness->add_forces(u, balance);
    balance = less_external_forces(model, block.slots, time, u, std::move(balance));
    rows.push_back(into_frames(model, block.slots.frames, Layout::all, std::move(balance)));
    load.displacement.push_back(std::move(u));
  }
  load.rows = gather(
      problem.blocks, problem.parameters, [&](auto&, int b) -> auto& { return rows[b]; });
  return load;
}

/// Reduces several pseudo-loads in one solve.
template <class E>
void reduce(Differentiation<E>& problem, std::vector<PseudoLoad>& loads) {
  const int parameters = problem.parameters, count = static_cast<int>(loads.size());
  Matrix<double> rows(problem.model.dof_count(), count * parameters);
  for (int n = 0; n < count; ++n) rows.middleCols(n * parameters, parameters) = loads[n].rows;
  const Reduction<double> reduced = problem.engine.reduce(rows);
  for (int n = 0; n < count; ++n) {
    loads[n].rows.resize(0, 0);
    loads[n].reduced = reduced.columns(n * parameters, parameters);
  }
}

/// Displacements of all dofs with their derivatives. Inside condensed bodies they are without, which saves the solve.
template <class E>
std::vector<Vector<Direction>> without_inside(const Differentiation<E>& problem, Unexpanded increment) {
  const Matrix<double> all = problem.engine.spread(increment.increment);
  auto displacements = std::move(increment.load.displacement);
  for (std::size_t b = 0; b < displacements.size(); ++b) add_derivatives(displacements[b], all, problem.blocks[b]);
  return displacements;
}

/// Displacements of all dofs with their derivatives, per increment and block, in one solve. `wanted`: dofs that are
/// read, where not all are (Condensation::expand).
template <class E>
std::vector<std::vector<Vector<Direction>>> expand(Differentiation<E>& problem, std::vector<Unexpanded> increments,
                                                   const std::vector<int>* wanted = nullptr) {
  const int parameters = problem.parameters, count = static_cast<int>(increments.size());
  if (count == 0) return {};
  const auto join = [&](double sign, auto&& part) {
    Matrix<double> all(part(increments[0]).rows(), count * parameters);
    for (int n = 0; n < count; ++n) all.middleCols(n * parameters, parameters) = sign * part(increments[n]);
    return all;
  };
  const Matrix<double> all = problem.engine.expand(join(
                                                       1, [](auto& of) -> auto& { return of.increment; }),
                                                   join(
                                                       -1, [](auto& of) -> auto& { return of.load.reduced.others; }),
                                                   wanted);
  std::vector<std::vector<Vector<Direction>>> displacements;
  for (int n = 0; n < count; ++n) {
    displacements.push_back(std::move(increments[n].load.displacement));
    for (std::size_t b = 0; b < displacements[n].size(); ++b)
      add_derivatives(displacements[n][b], all.middleCols(n * parameters, parameters), problem.blocks[b]);
  }
  return displacements;
}

}  // namespace stickslip
