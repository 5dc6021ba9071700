#include "sensitivity/flow_ties.hpp"

#include <algorithm>

#include "sensitivity/one_sided.hpp"

namespace stickslip {
namespace {

constexpr int branch_of_piece(int piece) { return flow_branch::first_piece + piece; }

/// Row of the hardening table whose corner a is at; -1: none.
int corner_at(const Hardening<double>& hardening, double a) {
  for (std::size_t k = 0; k < hardening.rows.size(); ++k)
    if (std::abs(a / hardening.rows[k].strain - 1) <= weak_margin) return static_cast<int>(k);
  return -1;
}

/// Rates of a material point along one side of a parameter, over its bound. c: strain of the corner.
struct Rates {
  double negligible;
  double excess;     ///< of the trial over the bound, on the piece of the branch
  double start = 0;  ///< of a - c before the flow
  double end = 0;    ///< of a - c after the flow, times the elastic modulus
  bool has_corner = false;
};

/// `motion`: largest derivative of a displacement.
Rates flow_rates(const FlowPoint<Direction>& point, const FlowTie& tie, int branch, double motion,
                 const SideDirection& along) {
  constexpr double share = 1e-10, rigid = 1e-3;  // as for contact points (sensitivity/branches.cpp)
  const auto& [stress, before, after, modulus] = point.trial;
  const auto rate = [&](const Direction& x) { return along.side * x.d[0]; };
  Rates rates{};
  rates.has_corner = tie.corner >= 0;
  double strain_rate = std::max(std::abs(before.d[0]), std::abs(after.d[0]));
  int piece = branch - flow_branch::first_piece;
  if (rates.has_corner) {
    const Direction& corner = point.hardening.rows[static_cast<std::size_t>(tie.corner)].strain;
    rates.start = rate(before) - rate(corner);
    rates.end = rate(after) - rate(corner);
    strain_rate = std::max(strain_rate, std::abs(corner.d[0]));
    if (branch == flow_branch::none) piece = rates.start < 0 ? tie.corner : tie.corner + 1;
  } else if (branch == flow_branch::none) {
    piece = tie.branches.back() - flow_branch::first_piece;
  }
  const Direction bound = point.hardening.bound(piece, before);
  rates.excess = (rate(stress) - rate(bound)) / bound.v;
  rates.end *= modulus.v / bound.v;
  const double size = std::max(
      {std::abs(stress.d[0]), std::abs(bound.d[0]), modulus.v * strain_rate, rigid * modulus.v * motion / point.size});
  rates.negligible = share * std::max(size / bound.v, along.parameter > 0 ? 1 / along.parameter : 0.0);
  return rates;
}

/// Verdict on a tie whose derivative was found with `branch`.
FlowVerdict flow_verdict(const FlowTie& tie, int branch, const Rates& rates) {
  const auto unless = [&](double by, int other) -> FlowVerdict {
    by /= rates.negligible;
    return by > 1 ? FlowVerdict{other, by} : FlowVerdict{};
  };
  const int ahead = branch_of_piece(tie.corner), behind = branch_of_piece(tie.corner + 1);
  if (branch == flow_branch::none) {
    const int flowing = !rates.has_corner ? tie.branches.back() : rates.start < 0 ? ahead : behind;
    return unless(rates.excess, flowing);
  }
  if (tie.yields())
    if (const auto verdict = unless(-rates.excess, flow_branch::none); verdict.contradicts) return verdict;
  if (!rates.has_corner) return {};
  return branch == ahead ? unless(rates.end, behind) : unless(-rates.end, ahead);
}

}  // namespace

std::vector<FlowTie> flow_ties(const Model& model, const Slots<double>& slots, const Vector<double>& displacement,
                               const Vector<double>& before) {
  std::vector<FlowTie> ties;
  if (!model.effects.plasticity) return ties;
  for_each_flow_point<double>(model, slots, {displacement, before}, nullptr, [&](const FlowPoint<double>& point) {
    const auto& [stress, a_before, a_after, modulus] = point.trial;
    const bool yields = std::abs(stress / point.hardening.bound(a_before) - 1) <= weak_margin;
    const bool flows = a_after > a_before;
    if (!yields && !flows) return;
    const int corner = corner_at(point.hardening, a_after);
    if (!yields && corner < 0) return;
    FlowTie tie{point.body, point.element, point.memory, {}, corner, flow_branch::none};
    if (yields) tie.branches.push_back(flow_branch::none);
    if (corner >= 0)
      for (int piece : {corner, corner + 1}) tie.branches.push_back(branch_of_piece(piece));
    else
      tie.branches.push_back(branch_of_piece(point.hardening.piece_at(a_before)));
    if (flows && corner >= 0)
      tie.now = branch_of_piece(a_after <= point.hardening.rows[corner].strain ? corner : corner + 1);
    else if (flows)
      tie.now = tie.branches.back();
    ties.push_back(std::move(tie));
  });
  return ties;
}

void set_computed_branches(const Model& model, const std::vector<FlowTie>& ties, State<double>& at) {
  if (ties.empty()) return;
  at.flow.assign(static_cast<std::size_t>(model.memory_count), flow_branch::by_values);
  for (const auto& tie : ties) at.flow[tie.memory] = tie.now;
}

std::vector<FlowVerdict> flow_verdicts(const Model& model, const ParameterBlock& block,
                                       const std::vector<FlowTie>& ties, const State<double>& at,
                                       const SideDirection& along) {
  std::vector<FlowVerdict> verdicts(ties.size());
  if (ties.empty()) return verdicts;
  ElementLists elements(model.bodies.size());
  for (const auto& tie : ties)
    if (auto& list = elements[tie.body]; list.empty() || list.back() != tie.element) list.push_back(tie.element);
  double motion = 0;
  for (const auto& u : block.current.displacement) motion = std::max(motion, std::abs(u.d[0]));
  std::size_t next = 0;  // ties have the order of the points
  const BodyMotion<Direction> of{block.current.displacement, block.previous.history.bodies, 0, &at.flow};
  for_each_flow_point<Direction>(model, block.slots, of, &elements, [&](const FlowPoint<Direction>& point) {
    if (next == ties.size() || point.memory != ties[next].memory) return;
    const int branch = at.flow[point.memory];
    verdicts[next] = flow_verdict(ties[next], branch, flow_rates(point, ties[next], branch, motion, along));
    ++next;
  });
  return verdicts;
}

}  // namespace stickslip
