#include "sensitivity/differentiate.hpp"

#include "core/model/response.hpp"
#include "sensitivity/monolithic.hpp"
#include "sensitivity/one_sided.hpp"
#include "sensitivity/penalty.hpp"
#include "sensitivity/uzawa.hpp"

namespace stickslip {
namespace {

/// Derivatives of an increment with those of responses that can tie replaced by what they are on one side, where that
/// is more than rounding of the motion makes of it.
Matrix<double> with_ties(const Model& model, const std::vector<ParameterBlock>& blocks, Matrix<double> of, Ties side) {
  constexpr double rounding = 1e-9;
  const auto& responses = model.scene.responses;
  for (int i = 0; i < static_cast<int>(responses.size()); ++i) {
    if (!can_tie(responses[i])) continue;
    const bool is_length = responses[i].kind != Response::Kind::contact_pressure;
    double per_length = is_length ? 1 : 0;  // what a length makes of the response
    for (std::size_t p = 0; !is_length && p < model.points.size(); ++p) {
      const auto& slots = blocks.front().slots;
      per_length = std::max(per_length, value(slots.stiffness[p]) / value(slots.geometry[p].area));
    }
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const Direction on_side = evaluate_response(model, blocks[b].slots, i, blocks[b].current, {}, side);
      const auto first = static_cast<Eigen::Index>(b) * directions;
      Direction::Gradient motion = Direction::Gradient::Zero();
      for (const auto& u : blocks[b].current.displacement) motion = motion.max(u.d.abs());
      for (Eigen::Index j = first; j < std::min(first + directions, of.cols()); ++j) {
        const double apart = std::abs(on_side.d[j - first] - of(i, j));
        if (apart > rounding * per_length * motion[j - first]) of(i, j) = on_side.d[j - first];
      }
    }
  }
  return of;
}

template <class E, class M>
void run(const M& method, Differentiation<E>& problem, const Trajectory<double>& trajectory, Gradients& gradients) {
  const Model& model = problem.model;
  const State<double>* previous = &trajectory.initial;
  const auto& asked = model.scene.responses;
  const bool ties = std::any_of(asked.begin(), asked.end(), can_tie);
  for (const auto& increment : trajectory.increments) {
    if (!differentiate_increment(method, problem, *previous, increment)) {
      gradients.status = problem.status;
      gradients.message = problem.message;
      return;
    }
    if (problem.record) gradients.records.push_back(*problem.record);
    std::vector<Vector<Direction>> responses;
    for (auto& block : problem.blocks)
      responses.push_back(evaluate_responses(model, block.slots, block.current, increment.time));
    gradients.of.push_back(gather(
        problem.blocks, problem.parameters, [&](auto&, int b) -> auto& { return responses[b]; }));
    if (ties) {
      gradients.below.push_back(with_ties(model, problem.blocks, gradients.of.back(), Ties::below));
      gradients.above.push_back(with_ties(model, problem.blocks, gradients.of.back(), Ties::above));
    }
    gradients.last_displacement = gather(
        problem.blocks, problem.parameters,
        [](ParameterBlock & block, int) -> auto& { return block.current.displacement; });
    for (auto& block : problem.blocks) std::swap(block.previous, block.current);
    previous = &increment.state;
  }
}

}  // namespace

Gradients differentiate(const Model& model, const Slots<double>& slots, const Method& method,
                        const Trajectory<double>& trajectory, Workspace<double>& workspace) {
  Gradients gradients;
  const int parameters = static_cast<int>(model.scene.parameters.size());
  if (parameters == 0) return gradients;
  const Stopwatch time(gradients.seconds);
  const auto consistent = consistent_at_ties(model, slots, method, trajectory, workspace, gradients.search);
  std::vector<ParameterBlock> blocks;
  for (int b = 0; b * directions < parameters; ++b) {
    std::vector<int> of_block;
    for (int j = b * directions; j < std::min(parameters, (b + 1) * directions); ++j) of_block.push_back(j);
    ParameterBlock block{
        make_slots<Direction>(model, seeded(model.scene, of_block)), initial_state<Direction>(model), {}};
    block.current = block.previous;
    blocks.push_back(std::move(block));
  }
  std::visit(
      [&](const auto& m) {
        std::visit(
            [&](auto& engine) {
              using E = std::decay_t<decltype(engine)>;
              Differentiation<E> problem{model, slots, engine, blocks, parameters, {}};
              run(m, problem, consistent ? *consistent : trajectory, gradients);
              gradients.counters = problem.counters;
              gradients.counters += gradients.search;
            },
            *workspace.engine);
      },
      method);
  return gradients;
}

}  // namespace stickslip
