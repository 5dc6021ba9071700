#include "sensitivity/differentiate.hpp"

#include "core/model/response.hpp"
#include "sensitivity/monolithic.hpp"
#include "sensitivity/penalty.hpp"
#include "sensitivity/uzawa.hpp"

namespace stickslip {
namespace {

template <class E, class M>
void run(const M& method, Differentiation<E>& problem, const Trajectory<double>& trajectory, Gradients& gradients) {
  const Model& model = problem.model;
  const State<double>* previous = &trajectory.initial;
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
              run(m, problem, trajectory, gradients);
              gradients.counters = problem.counters;
            },
            *workspace.engine);
      },
      method);
  return gradients;
}

}  // namespace stickslip
