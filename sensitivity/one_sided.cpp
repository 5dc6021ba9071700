#include "sensitivity/one_sided.hpp"

#include <array>
#include <limits>

#include "core/model/response.hpp"
#include "sensitivity/response_ties.hpp"
#include "sensitivity/sided_geometry.hpp"
#include "sensitivity/ties/search.hpp"
#include "sensitivity/ties/tie.hpp"
#include "sensitivity/whole_states.hpp"

namespace stickslip {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();

Margins margins_of(const Model& model, const Slots<double>& slots, const State<double>& state, int p, double largest) {
  const auto& point = model.points[p];
  const auto& contact = state.contact;
  const auto tangential = [&](const Vector<double>& of, int first) { return norm(of.segment(first, point.tangents)); };
  const double pressure = -contact.traction[point.multiplier];
  const double elastic = elastic_traction(slots, p);
  const bool open = contact.state[p] == ContactState::open;
  const double distance = open ? elastic * contact.gap[p] : pressure;
  Margins margin{largest > 0                                                  ? distance / largest
                 : distance <= elastic * tie_length(point, slots.geometry[p]) ? 0
                                                                              : none,
                 none};
  const auto& law = slots.friction[point.contact];
  if (open || point.tangents == 0) return margin;
  const double bound = law.bound(pressure);
  if (!(bound > 0)) return margin;
  const double slip_distance = contact.state[p] == ContactState::stick
                                   ? bound - tangential(contact.traction, point.multiplier + 1)
                                   : elastic * tangential(contact.slip, tangential_offset(model, p));
  margin.slip = slip_distance / bound;
  if (is_slipping(contact.state[p])) margin.slip = std::min(margin.slip, law.distance_to_corner(pressure) / bound);
  return margin;
}

/// Per increment that has derivatives: largest traction_scale() of the run up to it.
std::vector<double> traction_scales(const Model& model, const Slots<double>& slots,
                                    const Trajectory<double>& trajectory) {
  std::vector<double> scales;
  for (std::size_t n = 0; n < trajectory.solved_count(); ++n) {
    const double scale = traction_scale(model, slots, trajectory.increments[n].state);
    scales.push_back(std::max(scales.empty() ? 0.0 : scales.back(), scale));
  }
  return scales;
}

/// Whether values of a response tie in an increment, so that direct differentiation would have both sides of it.
bool has_tied_responses(const Model& model, const Slots<double>& slots, WholeStates& states) {
  const auto& asked = model.scene.responses;
  if (std::none_of(asked.begin(), asked.end(), can_tie)) return false;
  for (std::size_t n = 0; n < states.count(); ++n)
    if (has_tied_responses(model, slots, states.increment(n).state)) return true;
  return false;
}

/// Index of the first increment with ties; WholeStates::count() if there is none.
std::size_t first_tie(const Model& model, const Slots<double>& slots, const Method& method,
                      const Trajectory<double>& trajectory, WholeStates& states) {
  const auto scales = traction_scales(model, slots, trajectory);
  const bool contact_decides = !model.effects.plasticity && !model.slides_on_surfaces();  // and thin states have it
  std::size_t n = 0;
  for (; n < scales.size(); ++n) {
    const auto& increment = contact_decides ? trajectory.increments[n] : states.increment(n);
    const auto& before = contact_decides ? trajectory.initial : states.before(n);
    if (has_ties(model, slots, method, before, increment, scales[n])) break;
  }
  return n;
}

/// Whether a response is a width with an infinite derivative: at most one point is closed, and another is about to
/// close.
bool widens_at_once(const Model& model, const Slots<double>& slots, const State<double>& state, std::size_t response) {
  if (model.scene.responses[response].kind != Response::Kind::contact_half_width) return false;
  const double largest = traction_scale(model, slots, state);
  const bool rings = model.scene.space == Space::axisymmetric;
  int wide = 0, weak = 0;  // closed points; points about to close
  for (int p : model.response_places[response].points) {
    const bool is_weak = margins_of(model, slots, state, p, largest).open <= weak_margin;
    const bool closed = state.contact.state[p] != ContactState::open;
    weak += is_weak;
    wide += !is_weak && closed && (!rings || slots.points(0, model.points[p].nodes[0]) > 0);
  }
  return weak > 0 && wide < (rings ? 1 : 2);
}

/// Derivative on one side of a parameter, carried from increment to increment.
struct SideRun {
  const Method& method;
  const Model& model;
  const Slots<double>& slots;
  Engine<double>& engine;
  WholeStates& states;
  double parameter;            ///< SideDirection::parameter
  std::vector<double> scales;  ///< SideDirection::largest_so_far
  std::vector<ParameterBlock> blocks;
  Counters counters;

  SideRun(const Method& m, const Model& of, const Slots<double>& s, Engine<double>& e, const Trajectory<double>& t,
          WholeStates& whole, Slots<Direction> seeded_slots, double size)
      : method(m), model(of), slots(s), engine(e), states(whole), parameter(size), scales(traction_scales(of, s, t)) {
    blocks.emplace_back(model, std::vector<int>{0}, std::move(seeded_slots));
  }

  /// Differentiates increment n, the one after the last. Then on_increment(increment) is called with the derivative in
  /// blocks[0].current and the branches in `increment`. False if it has no derivative. `unconfirmed`: as in
  /// differentiate_side().
  template <class F>
  bool advance(std::size_t n, double side, F&& on_increment, Unconfirmed unconfirmed = Unconfirmed::fails) {
    Differentiation problem{method, model, slots, engine, blocks, 1, {}};
    Increment<double> increment = states.increment(n);
    const State<double>& previous = states.before(n);
    const bool found = differentiate_side(problem, previous, increment, {side, parameter, scales[n]}, unconfirmed);
    counters += problem.counters;
    if (!found) return false;
    on_increment(increment);
    std::swap(blocks[0].previous, blocks[0].current);
    return true;
  }
};

/// Per point: whether it carries a force at some time of the run, or is about to.
std::vector<char> engaged_points(const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory) {
  std::vector<char> engaged(model.points.size(), 0);
  for (const auto& increment : trajectory.increments) {
    const double largest = traction_scale(model, slots, increment.state);
    for (std::size_t p = 0; p < engaged.size(); ++p)
      engaged[p] |= increment.state.contact.state[p] != ContactState::open ||
                    margins_of(model, slots, increment.state, static_cast<int>(p), largest).open <= weak_margin;
  }
  return engaged;
}

/// What the slave nodes face if a parameter decreases, and if it increases.
using Pairings = std::array<SidedPairing, 2>;

/// Adds the derivatives of increment n on a side, in column `parameter`.
void record_side(const Model& model, const Slots<double>& slots, const ParameterBlock& block,
                 const Increment<double>& at, double side, int parameter, Matrix<double>& out) {
  const auto& responses = model.scene.responses;
  const auto values = evaluate_responses(model, block.slots, block.current, at.time);
  Matrix<double> column(responses.size(), 1);
  for (Eigen::Index i = 0; i < column.rows(); ++i) column(i, 0) = values[i].d[0];
  take_side_of_ties(model, block, block.current, side < 0 ? Ties::falling : Ties::growing, column);
  for (std::size_t i = 0; i < responses.size(); ++i)
    if (!widens_at_once(model, slots, at.state, i)) out(i, parameter) = column(i, 0);
}

/// Both sides of the derivatives by one parameter, in column `parameter`. `first`: index of the first increment with
/// ties.
void run_sides(const Method& method, Engine<double>& engine, const Model& model, const Slots<double>& slots,
               const Trajectory<double>& trajectory, WholeStates& states, std::size_t first, int parameter,
               const Pairings& pairings, OneSided& sides) {
  const bool geometric = pairings[0].kink || pairings[1].kink;
  if (geometric) first = 0;
  SideRun start(method, model, slots, engine, trajectory, states,
                make_slots<Direction>(model, seeded(model.scene, {parameter})),
                std::abs(model.scene.parameters[parameter].value));
  const auto record = [&](const SideRun& run, double side, std::size_t n) {
    record_side(model, slots, run.blocks[0], trajectory.increments[n], side, parameter,
                (side < 0 ? sides.backward : sides.forward)[n]);
  };
  bool smooth = true;
  for (std::size_t n = 0; n < first && smooth; ++n)
    smooth = start.advance(n, 1, [&](auto&) {
      for (const double side : {-1.0, 1.0}) record(start, side, n);
    });
  sides.counters += start.counters;
  start.counters = {};
  const auto engaged = geometric ? engaged_points(model, slots, trajectory) : std::vector<char>();
  struct Sided {
    double side;
    SideRun run;
    bool found = true;  ///< whether it has derivatives so far
  };
  std::vector<Sided> runs;
  for (const double side : {-1.0, 1.0}) {
    const auto& pairing = pairings[side < 0 ? 0 : 1];
    if (!smooth) break;
    runs.push_back({side, start});
    if (pairing.kink && !take_side(model, pairing, engaged, runs.back().run.blocks[0].slots)) runs.pop_back();
  }
  // (both sides at once, so that states that were let go are solved again once)
  for (std::size_t n = first; n < states.count(); ++n)
    for (auto& [side, run, found] : runs)
      found = found && run.advance(n, side, [&, of = side, &by = run](auto&) { record(by, of, n); });
  for (const auto& sided : runs) sides.counters += sided.run.counters;
}

/// Numbers of the scene with one seed, along which all parameters grow, each by its own share of its value. The shares
/// differ, so that no two parameters cancel.
Numbers<Direction> all_growing(const Scene& scene) {
  constexpr double golden = 0.6180339887498949;
  auto numbers = scene.as<Direction>();
  for (std::size_t j = 0; j < scene.parameters.size(); ++j) {
    const auto& parameter = scene.parameters[j];
    const double size = parameter.value == 0 ? 1 : std::abs(parameter.value);
    const double share = 1 + golden * static_cast<double>(j + 1) - std::floor(golden * static_cast<double>(j + 1));
    for (const auto& [slot, weight] : parameter.slots) numbers.at_slot[slot].d[0] += weight * size * share;
  }
  return numbers;
}

}  // namespace

Margins margins(const Model& model, const Slots<double>& slots, const State<double>& state, int point) {
  return margins_of(model, slots, state, point, traction_scale(model, slots, state));
}

Margins margins(const Model& model, const Slots<double>& slots, const State<double>& state) {
  Margins least{none, none};
  const double largest = traction_scale(model, slots, state);
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const Margins of_point = margins_of(model, slots, state, p, largest);
    least = {std::min(least.open, of_point.open), std::min(least.slip, of_point.slip)};
  }
  return least;
}

bool has_ties(const Model& model, const Slots<double>& slots, const Method& method, const State<double>& previous,
              const Increment<double>& increment, double largest) {
  const auto has = [&](const State<double>& at, const std::vector<double>& rho_factor) {
    const auto rho = adapted(initial_regularisation(slots, method), rho_factor);
    return has_ties({model, slots, at, previous.history.bodies, rho, cone_radius_of(method), increment.time, largest});
  };
  if (!scheme_of(method).of_each_augmentation) return has(increment.state, increment.rho_factor);
  return std::any_of(increment.augmented.begin(), increment.augmented.end(),
                     [&](const auto& sweep) { return has(sweep.state, sweep.rho_factor); });
}

std::optional<OneSided> one_sided_derivatives(const Model& model, const Slots<double>& slots, const Method& method,
                                              const Trajectory<double>& trajectory, Workspace<double>& workspace) {
  const int parameters = static_cast<int>(model.scene.parameters.size());
  if (parameters == 0) return std::nullopt;
  WholeStates states(model, slots, method, trajectory, workspace);
  const std::size_t first = first_tie(model, slots, method, trajectory, states);
  OneSided sides;
  sides.first = first;
  bool kinks = first < states.count();
  const bool is_adjoint = model.scene.sensitivity_mode == SensitivityMode::adjoint;
  if (is_adjoint && parameters > most_sided_parameters) return kinks ? std::optional(sides) : std::nullopt;
  std::vector<Pairings> pairings;
  for (int j = 0; j < parameters; ++j) {
    pairings.push_back({sided_pairing(model, j, -1), sided_pairing(model, j, 1)});
    kinks |= pairings.back()[0].kink || pairings.back()[1].kink;
  }
  if (is_adjoint && !kinks) kinks = has_tied_responses(model, slots, states);
  if (!kinks) return std::nullopt;
  const auto unknown =
      Matrix<double>::Constant(model.scene.responses.size(), parameters, std::numeric_limits<double>::quiet_NaN());
  sides.backward.assign(states.count(), unknown);
  sides.forward = sides.backward;
  for (int j = 0; j < parameters; ++j)
    run_sides(method, *workspace.engine, model, slots, trajectory, states, first, j, pairings[j], sides);
  sides.counters += states.take_counters();
  sides.repeated = states.repeated();
  return sides;
}

TakenBranches::TakenBranches(Increment<double> of)
    : end{std::move(of.state.contact), std::move(of.state.flow)},
      foot(std::move(of.state.history.foot)),
      patch(std::move(of.state.history.patch)) {
  for (auto& sweep : of.augmented) sweeps.push_back({std::move(sweep.state.contact), std::move(sweep.state.flow)});
}

void TakenBranches::give(Increment<double>& increment) const {
  const auto give_to = [](State<double>& state, const OfState& taken) {
    state.contact = taken.contact;
    state.flow = taken.flow;
  };
  give_to(increment.state, end);
  increment.state.history.foot = foot;
  increment.state.history.patch = patch;
  for (std::size_t k = 0; k < sweeps.size(); ++k) give_to(increment.augmented[k].state, sweeps[k]);
}

std::vector<TakenBranches> consistent_at_ties(const Model& model, const Slots<double>& slots, const Method& method,
                                              const Trajectory<double>& trajectory, WholeStates& states,
                                              Workspace<double>& workspace, Counters& counters) {
  std::vector<TakenBranches> taken;
  if (first_tie(model, slots, method, trajectory, states) == states.count()) return taken;
  SideRun run(method, model, slots, *workspace.engine, trajectory, states,
              make_slots<Direction>(model, all_growing(model.scene)), 1);
  const auto take = [&](Increment<double>& increment) { taken.emplace_back(std::move(increment)); };
  while (taken.size() < states.count() && run.advance(taken.size(), 1, take, Unconfirmed::holds)) continue;
  counters += run.counters;
  return taken;
}

}  // namespace stickslip
