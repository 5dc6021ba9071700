#include "sensitivity/one_sided.hpp"

#include <limits>
#include <set>

#include "core/model/response.hpp"
#include "sensitivity/monolithic.hpp"
#include "sensitivity/penalty.hpp"
#include "sensitivity/uzawa.hpp"

namespace stickslip {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();

/// Largest pressure, or k / A times the largest motion: contact that has only just begun is measured by that.
double traction_scale(const Model& model, const Slots<double>& slots, const State<double>& state) {
  double largest = 0;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const double elastic = slots.stiffness[p] / slots.geometry[p].area;
    largest = std::max({largest, -state.contact.traction[model.points[p].multiplier],
                        elastic * std::abs(state.contact.gap[p] - slots.geometry[p].gap)});
    const int offset = tangential_offset(model, static_cast<int>(p));
    largest = std::max(largest, elastic * state.contact.placement.segment(offset, model.points[p].tangents).norm());
  }
  return largest;
}

double tangential_norm(const Model& model, const Vector<double>& of, int first, int p) {
  return of.segment(first, model.points[p].tangents).norm();
}

Margins margins_of(const Model& model, const Slots<double>& slots, const State<double>& state, int p, double largest) {
  const auto& point = model.points[p];
  const auto& contact = state.contact;
  const double pressure = -contact.traction[point.multiplier];
  const double elastic = slots.stiffness[p] / slots.geometry[p].area;
  const bool open = contact.state[p] == ContactState::open;
  Margins margin{largest > 0 ? (open ? elastic * contact.gap[p] : pressure) / largest : none, none};
  const double bound = slots.friction[point.contact] * pressure;
  if (open || point.tangents == 0 || !(bound > 0)) return margin;
  const double reach = contact.state[p] == ContactState::stick
                           ? bound - tangential_norm(model, contact.traction, point.multiplier + 1, p)
                           : elastic * tangential_norm(model, contact.slip, tangential_offset(model, p), p);
  margin.slip = reach / bound;
  return margin;
}

struct WeakPoint {
  int point;
  bool opens;  ///< between open and closed; else between stick and slip
};

std::vector<WeakPoint> weak_points(const Model& model, const Slots<double>& slots, const State<double>& state) {
  std::vector<WeakPoint> weak;
  const double largest = traction_scale(model, slots, state);
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const Margins margin = margins_of(model, slots, state, p, largest);
    if (margin.open <= weak_margin || margin.slip <= weak_margin) weak.push_back({p, margin.open <= weak_margin});
  }
  return weak;
}

enum class Verdict { confirmed, flip, unknown };

/// Whether the derivative of a state, in direction `side`, confirms the branch that it was found with.
Verdict judge(const Model& model, const ParameterBlock& block, const PointRegularisation<Direction>& rho,
              const WeakPoint& weak, const State<double>& at, ContactState branch, double side) {
  const auto& point = model.points[weak.point];
  const int normal = point.multiplier, offset = tangential_offset(model, weak.point);
  const auto& now = block.current;
  auto confirms = [](bool yes) { return yes ? Verdict::confirmed : Verdict::flip; };
  const Direction z_normal = now.multiplier[normal] + rho.normal * now.contact.gap[weak.point];
  if (weak.opens) {
    if (branch == ContactState::open) return confirms(side * z_normal.d[0] >= 0);
    if (side * z_normal.d[0] > 0) return Verdict::flip;
    double size = 0, tangential = 0;
    for (int a = 0; a < point.tangents; ++a) {
      size = std::max(size, std::abs(at.contact.traction[normal + 1 + a]));
      const Direction z = now.multiplier[normal + 1 + a] + rho.tangential * now.contact.slip[offset + a];
      tangential += z.d[0] * z.d[0];
    }
    const double bound = value(block.slots.friction[point.contact]) * std::abs(z_normal.d[0]);
    const bool slides = tangential_norm(model, at.contact.slip, offset, weak.point) > 0;  // the direction of its slip
    const bool leaves_apex = point.tangents > 0 && size == 0 && !slides && std::sqrt(tangential) > bound;
    return leaves_apex ? Verdict::unknown : Verdict::confirmed;
  }
  Vector<Direction> z(point.tangents);
  for (int a = 0; a < point.tangents; ++a)
    z[a] = now.multiplier[normal + 1 + a] + rho.tangential * now.contact.slip[offset + a];
  const Direction excess = norm(z) + block.slots.friction[point.contact] * z_normal;  // |z_T| - bound
  return confirms(branch == ContactState::stick ? side * excess.d[0] <= 0 : side * excess.d[0] >= 0);
}

/// The branch on the other side of a tie. A point that slides while it touches slips when it closes.
ContactState other_branch(const Model& model, const State<double>& at, const WeakPoint& weak, ContactState branch) {
  if (weak.opens && branch != ContactState::open) return ContactState::open;
  if (weak.opens) {
    const bool slides = tangential_norm(model, at.contact.slip, tangential_offset(model, weak.point), weak.point) > 0;
    return slides || model.points[weak.point].tangents == 0 ? ContactState::slip : ContactState::stick;
  }
  return branch == ContactState::stick ? ContactState::slip : ContactState::stick;
}

/// Differentiates one increment along one parameter and side; false where no set of branches is confirmed: one was
/// tried twice, or as many as a search that gets there does not need.
template <class M, class E>
bool differentiate_side(const M& method, Differentiation<E>& problem, const State<double>& previous,
                        Increment<double> increment, double side) {
  const auto weak = weak_points(problem.model, problem.slots, increment.state);
  auto& branches = increment.state.contact.state;
  constexpr std::size_t limit = 20;
  std::set<std::vector<ContactState>> tried;
  while (tried.size() < limit && tried.insert(branches).second) {
    if (!differentiate_increment(method, problem, previous, increment)) return false;
    const auto rho = regularisation_blocks(method, problem, increment.rho_factor)[0];
    auto next = branches;
    for (const auto& w : weak) {
      const auto verdict =
          judge(problem.model, problem.blocks[0], rho[w.point], w, increment.state, branches[w.point], side);
      if (verdict == Verdict::unknown) return false;
      if (verdict == Verdict::flip) next[w.point] = other_branch(problem.model, increment.state, w, branches[w.point]);
    }
    if (next == branches) return true;
    branches = next;
  }
  return false;
}

/// One side of the derivatives with respect to one parameter, as column `parameter` of `out`.
template <class M, class E>
void run_side(const M& method, E& engine, const Model& model, const Slots<double>& slots,
              const Trajectory<double>& trajectory, int parameter, double side, OneSided& sides) {
  auto& out = side < 0 ? sides.backward : sides.forward;
  std::vector<ParameterBlock> blocks{
      {make_slots<Direction>(model, seeded(model.scene, {parameter})), initial_state<Direction>(model), {}}};
  blocks[0].current = blocks[0].previous;
  Differentiation<E> problem{model, slots, engine, blocks, 1, {}};
  const State<double>* previous = &trajectory.initial;
  for (std::size_t n = 0; n < out.size(); ++n) {
    const auto& increment = trajectory.increments[n];
    if (!differentiate_side(method, problem, *previous, increment, side)) break;
    const auto responses = evaluate_responses(model, blocks[0].slots, blocks[0].current, increment.time,
                                              side < 0 ? Ties::below : Ties::above);
    for (Eigen::Index i = 0; i < responses.size(); ++i) out[n](i, parameter) = responses[i].d[0];
    std::swap(blocks[0].previous, blocks[0].current);
    previous = &increment.state;
  }
  sides.counters += problem.counters;
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

std::optional<OneSided> one_sided_derivatives(const Model& model, const Slots<double>& slots, const Method& method,
                                              const Trajectory<double>& trajectory, Workspace<double>& workspace) {
  const int parameters = static_cast<int>(model.scene.parameters.size());
  const auto* uzawa = std::get_if<UzawaAL>(&method);
  const bool truncated = uzawa && uzawa->sensitivity == UzawaAL::Sensitivity::truncated;
  bool weak = false;
  for (const auto& increment : trajectory.increments) weak |= !weak_points(model, slots, increment.state).empty();
  if (!weak || parameters == 0 || truncated) return std::nullopt;
  const auto unknown =
      Matrix<double>::Constant(model.scene.responses.size(), parameters, std::numeric_limits<double>::quiet_NaN());
  OneSided sides;
  sides.backward.assign(trajectory.increments.size(), unknown);
  sides.forward = sides.backward;
  auto both = [&](const auto& m, auto& engine) {
    for (int j = 0; j < parameters; ++j) {
      run_side(m, engine, model, slots, trajectory, j, -1, sides);
      run_side(m, engine, model, slots, trajectory, j, +1, sides);
    }
  };
  std::visit([&](const auto& m) { std::visit([&](auto& engine) { both(m, engine); }, *workspace.engine); }, method);
  return sides;
}

}  // namespace stickslip
