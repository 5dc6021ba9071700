#include "sensitivity/differentiate.hpp"

#include "core/model/response.hpp"
#include "sensitivity/monolithic.hpp"
#include "sensitivity/penalty.hpp"
#include "sensitivity/uzawa.hpp"

namespace stickslip {
namespace {

/// Numbers of the scene with the parameters of one block seeded.
Numbers<Direction> seeded(const Scene& scene, int block) {
  auto numbers = scene.as<Direction>();
  for (int d = 0; d < directions; ++d) {
    const std::size_t j = static_cast<std::size_t>(block) * directions + d;
    if (j >= scene.parameters.size()) break;
    for (const auto& [slot, weight] : scene.parameters[j].slots) numbers.at_slot[slot].d[d] += weight;
  }
  return numbers;
}

template <class E, class M>
void run(const M& method, Differentiation<E>& problem, const Trajectory<double>& trajectory, Gradients& gradients) {
  const Model& model = problem.model;
  const State<double>* previous = &trajectory.initial;
  for (const auto& increment : trajectory.increments) {
    if (!differentiate_increment(method, problem, *previous, increment)) {
      gradients.status = problem.message.starts_with("the iterated") ? Status::cap : Status::singular;
      gradients.message = problem.message;
      return;
    }
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
    ParameterBlock block{make_slots<Direction>(model, seeded(model.scene, b)), initial_state<Direction>(model), {}};
    block.current = block.previous;
    blocks.push_back(std::move(block));
  }
  std::visit(
      [&](const auto& m) {
        std::visit(
            [&](auto& engine) {
              using E = std::decay_t<decltype(engine)>;
              Differentiation<E> problem{model, slots, engine, blocks, parameters, {}, {}};
              run(m, problem, trajectory, gradients);
              gradients.counters = problem.counters;
            },
            *workspace.engine);
      },
      method);
  return gradients;
}

}  // namespace stickslip
