#include "sensitivity/differentiate.hpp"

#include "core/model/element_nodes.hpp"
#include "core/model/storage.hpp"
#include "sensitivity/nearest_change.hpp"
#include "sensitivity/one_sided.hpp"
#include "sensitivity/response_ties.hpp"
#include "sensitivity/schemes.hpp"
#include "sensitivity/whole_states.hpp"

namespace stickslip {

namespace {

/// Dofs outside the contact whose displacements responses read, ascending; none if all are read.
std::optional<std::vector<int>> dofs_read_inside(const Model& model) {
  std::vector<char> read(model.node_count, false);
  for (std::size_t i = 0; i < model.scene.responses.size(); ++i) {
    const auto kind = model.scene.responses[i].kind;
    if (kind == Response::Kind::strain_energy) return std::nullopt;
    if (kind != Response::Kind::displacement) continue;
    for (int node : model.response_places[i].nodes) read[node] = true;
  }
  for (std::size_t b = 0; b < model.at_reactions.size(); ++b)
    for (int e : model.at_reactions[b])
      for (int node : detail::element_nodes(model.bodies[b], e)) read[node] = true;
  for (int node : model.contact_nodes) read[node] = false;
  std::vector<int> dofs;
  for (int node = 0; node < model.node_count; ++node)
    for (int i = 0; read[node] && i < model.dimension; ++i) dofs.push_back(node * model.dimension + i);
  return dofs;
}

/// Bytes of the pseudo-loads and solutions of increments.
long solve_bytes(const std::vector<Unexpanded>& increments) {
  long bytes = 0;
  for (const auto& [load, increment] : increments) {
    for (const auto& displacement : load.displacement) bytes += bytes_of(displacement);
    for (const auto* of : {&load.reduced.kept, &load.reduced.others, &increment}) bytes += bytes_of(*of);
  }
  return bytes;
}

long state_bytes(const std::vector<std::vector<State<Direction>>>& increments) {
  long bytes = 0;
  for (const auto& blocks : increments)
    for (const auto& state : blocks) bytes += state_bytes(state).all();
  return bytes;
}

}  // namespace

struct Derivatives::SoFar {
  const Model& model;
  const Slots<double>& slots;
  const Method& method;
  Workspace<double>& workspace;
  const std::optional<std::vector<int>> read_inside = dofs_read_inside(model);
  Gradients gradients = {};
  std::vector<ParameterBlock> blocks = {};
  std::size_t done = 0;    ///< number of increments differentiated
  double largest = 0;      ///< traction_scale() of those
  bool postponed = false;  ///< the remaining increments need the whole run
  bool failed = false;

  int parameters() const { return static_cast<int>(model.scene.parameters.size()); }

  void begin() {
    blocks = parameter_blocks(model);
    for (auto& block : blocks)  // displacements of the increments are expanded together
      for (auto* state : {&block.previous, &block.current}) state->displacement.resize(0);
    for (const auto& block : blocks) {
      gradients.storage.slots += slot_bytes(block.slots).all();
      if (block.stiffness) gradients.storage.stiffness += block.stiffness->bytes();
    }
  }

  /// Differentiates the increments up to `end`. As many are solved together as fit into one solve; one by one if the
  /// memory of the bodies links them. `follows`: the engine has the factor of the last of them.
  void advance(const Trajectory<double>& trajectory, std::size_t end, bool follows = false) {
    if (blocks.empty()) begin();
    const std::size_t together = model.effects.plasticity ? 1 : std::max(1, columns_together / parameters());
    while (done < end && !failed) take(trajectory, std::min(end, done + together), follows);
  }

  void take(const Trajectory<double>& trajectory, std::size_t end, bool follows) {
    Differentiation problem{method, model, slots, *workspace.engine, blocks, parameters(), {}};
    problem.follows = follows;
    const auto& increments = trajectory.increments;
    std::vector<PseudoLoad> loads;
    if (!scheme_of(method).of_each_augmentation) {  // (truncated Uzawa has a pseudo-load per augmentation)
      for (std::size_t n = done; n < end; ++n)
        loads.push_back(pseudo_load(problem, increments[n].state, increments[n].time));
      reduce(problem, loads);
    }
    std::vector<Unexpanded> unexpanded;
    std::vector<std::vector<State<Direction>>> reached;
    for (std::size_t n = done; n < end && !failed; ++n) {
      if (!loads.empty()) problem.prepared = std::move(loads[n - done]);
      const State<double>& previous = trajectory.before(n);
      failed = !differentiate_increment(problem, previous, increments[n]);
      if (failed) {
        gradients.status = problem.status;
        gradients.message = problem.message;
        break;
      }
      if (problem.record) gradients.records.push_back(*problem.record);
      unexpanded.push_back(std::move(*problem.unexpanded));
      reached.emplace_back();
      for (auto& block : blocks) {
        reached.back().push_back(block.current);
        std::swap(block.previous, block.current);
      }
    }
    gradients.counters += problem.counters;
    if (unexpanded.empty()) return;
    auto& storage = gradients.storage;
    storage.loads = std::max(storage.loads, solve_bytes(unexpanded));
    const bool is_last = !failed && end == increments.size();
    auto displacements = displacements_of(problem, std::move(unexpanded), is_last);
    for (std::size_t k = 0; k < displacements.size(); ++k) {
      for (std::size_t b = 0; b < blocks.size(); ++b) reached[k][b].displacement = std::move(displacements[k][b]);
      evaluate(reached[k], increments[done].time);
      add_nearest_change(increments[done++], reached[k]);
    }
    storage.states = std::max(storage.states, state_bytes(reached));
    if (is_last)
      gradients.last_displacement = gather(
          blocks, parameters(), [&](auto&, int b) -> auto& { return reached.back()[b].displacement; });
  }

  /// Expands the displacements of increments that a response reads, and of the last increment of the run.
  std::vector<std::vector<Vector<Direction>>> displacements_of(Differentiation& problem,
                                                               std::vector<Unexpanded> increments, bool is_last) {
    std::vector<std::vector<Vector<Direction>>> displacements;
    if (read_inside) {
      std::vector<Unexpanded> last;
      if (is_last) {
        last.push_back(std::move(increments.back()));
        increments.pop_back();
      }
      if (read_inside->empty())
        for (auto& increment : increments) displacements.push_back(without_inside(problem, std::move(increment)));
      else
        displacements = expand(problem, std::move(increments), &*read_inside);
      increments = std::move(last);
    }
    for (auto& expanded : expand(problem, std::move(increments))) displacements.push_back(std::move(expanded));
    return displacements;
  }

  void evaluate(const std::vector<State<Direction>>& at, double time) {
    std::vector<Vector<Direction>> responses;
    for (std::size_t b = 0; b < blocks.size(); ++b)
      responses.push_back(evaluate_responses(model, blocks[b].slots, at[b], time));
    gradients.of_responses.push_back(gather(
        blocks, parameters(), [&](auto&, int b) -> auto& { return responses[b]; }));
    const auto& asked = model.scene.responses;
    if (std::none_of(asked.begin(), asked.end(), can_tie)) return;
    for (auto* of : {&gradients.from_below, &gradients.from_above}) {
      of->push_back(gradients.of_responses.back());
      const Ties side = of == &gradients.from_below ? Ties::falling : Ties::growing;
      for (std::size_t b = 0; b < blocks.size(); ++b) take_side_of_ties(model, blocks[b], at[b], side, of->back());
    }
  }

  /// pre: if bodies remember, the increment is the last that the blocks have gone through.
  void add_nearest_change(const Increment<double>& increment, const std::vector<State<Direction>>& at) {
    largest = std::max(largest, traction_scale(model, slots, increment.state));
    NearestChange nearest = no_change(model);
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      std::optional<RegularisationField<Direction>> springs;
      if (!prevents_penetration(method)) springs = initial_regularisation(blocks[b].slots, method);
      const auto& before = blocks[b].current.history.bodies;  // (the blocks have gone on)
      lower_nearest_change(
          model, slots,
          {increment.state, increment.time, largest, blocks[b], at[b], before, springs ? &*springs : nullptr}, nearest);
    }
    gradients.nearest_change.push_back(std::move(nearest));
  }
};

Derivatives::Derivatives(const Model& model, const Slots<double>& slots, const Method& method,
                         Workspace<double>& workspace)
    : so_far_(model.scene.parameters.empty() ? nullptr : new SoFar{model, slots, method, workspace}) {}
Derivatives::~Derivatives() = default;

void Derivatives::follow(const Trajectory<double>& trajectory) {
  if (!so_far_ || so_far_->postponed) return;  // without parameters there is nothing to differentiate
  SoFar& now = *so_far_;
  const Stopwatch time(now.gradients.seconds);
  const bool worthwhile = scheme_of(now.method).keeps_tangents && now.workspace.engine->has_costly_factors();
  const auto& increments = trajectory.increments;
  for (std::size_t n = now.done; n < increments.size() && increments[n].usable(); ++n) {
    now.largest = std::max(now.largest, traction_scale(now.model, now.slots, increments[n].state));
    const auto& previous = trajectory.before(n);
    now.postponed |= !worthwhile || has_ties(now.model, now.slots, now.method, previous, increments[n], now.largest);
    if (now.postponed) return;
    now.advance(trajectory, n + 1, n + 1 == increments.size());
  }
}

Gradients Derivatives::finish(const Trajectory<double>& trajectory) {
  if (!so_far_) return {};
  SoFar& now = *so_far_;
  {
    const Stopwatch time(now.gradients.seconds);
    Counters search;
    std::optional<Trajectory<double>> consistent;
    {
      const Stopwatch searching(now.gradients.search_seconds);
      WholeStates states(now.model, now.slots, now.method, trajectory, now.workspace);
      const auto taken =
          consistent_at_ties(now.model, now.slots, now.method, trajectory, states, now.workspace, search);
      if (!taken.empty()) consistent = trajectory;
      for (std::size_t n = 0; n < taken.size(); ++n) taken[n].give(consistent->increments[n]);
    }
    now.advance(consistent ? *consistent : trajectory, trajectory.solved_count());
    now.gradients.search = search;
    now.gradients.counters += search;
  }
  return std::move(now.gradients);
}

Gradients differentiate(const Model& model, const Slots<double>& slots, const Method& method,
                        const Trajectory<double>& trajectory, Workspace<double>& workspace) {
  return Derivatives(model, slots, method, workspace).finish(trajectory);
}

}  // namespace stickslip
