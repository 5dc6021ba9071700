/// State of direct differentiation, and the bodies' part of it. That part can be computed for several increments at
/// once, because the engine solves many right-hand sides for little more than one.
#pragma once

#include <optional>

#include "core/model/loading.hpp"
#include "sensitivity/differentiate.hpp"
#include "sensitivity/dual_stiffness.hpp"

namespace stickslip {

/// Numbers of the scene with up to `directions` parameters seeded, one direction each.
Numbers<Direction> seeded(const Scene& scene, const std::vector<int>& parameters);

/// Elements, per body, whose forces depend on a parameter by material, thickness, shape or prescribed motion. The
/// pseudo-load comes from these alone. All elements are returned if nodes have frames, whose derivatives turn the
/// forces, and for a body with memory.
ElementLists touched_elements(const Model& model, const Slots<Direction>& slots);

/// Indices of the parameters in groups of up to `directions`. Those that change material, thickness or shape of bodies
/// come first, so that few sweeps visit elements.
std::vector<std::vector<int>> parameter_groups(const Model& model);

/// Whether the stiffness of linear bodies is kept with its derivatives. Not for runs of up to two steps, which would
/// save nothing; nor with more parameters than fit into one solve, whose memory it would double.
bool keeps_stiffness(const Model& model);

/// Bytes of the stiffness that parameter_blocks() keeps.
long kept_stiffness_bytes(const Model& model);

/// Slots and present derivatives of up to `directions` parameters.
struct ParameterBlock {
  std::vector<int> parameters;  ///< index of the parameter, per direction
  Slots<Direction> slots;
  State<Direction> previous, current;
  ElementLists touched;  ///< elements whose forces are differentiated in each increment
  std::optional<DualStiffness> stiffness = std::nullopt;  ///< of the elements taken out of `touched`

  /// Block at the initial state.
  ParameterBlock(const Model& model, std::vector<int> seeds, Slots<Direction> of)
      : parameters(std::move(seeds)),
        slots(std::move(of)),
        previous(initial_state<Direction>(model, slots)),
        current(previous),
        touched(touched_elements(model, slots)) {}

  /// Moves the elements of linear bodies from `touched` to `stiffness`.
  void keep_stiffness(const Model& model);
};

/// Blocks of all parameters of the scene, at the initial state.
std::vector<ParameterBlock> parameter_blocks(const Model& model);

/// Pseudo-load of the bodies in an increment: derivative of their balance by parameters and prescribed motion at fixed
/// free displacements. It depends on the derivative of the bodies' memory, and on no other earlier derivative.
struct PseudoLoad {
  std::vector<Vector<Direction>> displacement;  ///< per block, with the derivative of prescribed motion
  Matrix<double> rows;                          ///< one column per parameter, all dofs; empty after the reduction
  Reduction<double> reduced;                    ///< its reduction to the engine's rows
};

/// Derivatives of the displacements of an increment on the engine's dofs, to be expanded to all dofs.
struct Unexpanded {
  PseudoLoad load;
  Matrix<double> increment;  ///< engine dofs
};

/// What a scheme reads and writes to differentiate one increment.
struct Differentiation {
  const Method& method;
  const Model& model;
  const Slots<double>& slots;
  Engine<double>& engine;
  std::vector<ParameterBlock>& blocks;
  int parameters = 0;
  Counters counters;
  Status status = Status::singular;  ///< of a failure: singular tangent, or cap
  std::string message = {};
  bool follows = false;                                 ///< the engine has a factor that reuse_factor() may use
  std::optional<SchemeRecord> record = std::nullopt;    ///< of the last increment
  std::optional<PseudoLoad> prepared = std::nullopt;    ///< of the next increment; none: the scheme computes it
  std::optional<Unexpanded> unexpanded = std::nullopt;  ///< of the last increment, for expand()
};

/// A vector as dual numbers without derivative.
Vector<Direction> lift(const Vector<double>& v);

/// Derivatives as columns, one per parameter, from the blocks. `pick(block, index)`: the dual vector of a block.
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
/// Adds columns of derivatives, one per parameter, to a dual vector of a block.
void add_derivatives(Vector<Direction>& v, const Eigen::Ref<const Matrix<double>>& columns,
                     const ParameterBlock& block);

/// The pseudo-load of the bodies at a state, before its reduction.
PseudoLoad pseudo_load(const Differentiation& problem, const State<double>& at, double time);

/// Reduces several pseudo-loads by one solve.
void reduce(Differentiation& problem, std::vector<PseudoLoad>& loads);

/// Displacements of all dofs with their derivatives, per block. Inside condensed bodies derivatives are left out, which
/// saves a solve.
std::vector<Vector<Direction>> without_inside(const Differentiation& problem, Unexpanded increment);

/// Displacements of all dofs with their derivatives, per increment and block, by one solve. `wanted`: dofs that are
/// read; nullptr: all (Condensation::expand).
std::vector<std::vector<Vector<Direction>>> expand(Differentiation& problem, std::vector<Unexpanded> increments,
                                                   const std::vector<int>* wanted = nullptr);

}  // namespace stickslip
