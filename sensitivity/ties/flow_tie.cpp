#include <algorithm>

#include "sensitivity/ties/tie.hpp"

namespace stickslip {
namespace {

constexpr int branch_of_piece(int piece) { return flow_branch::first_piece + piece; }

/// Row of the hardening table whose corner a is at; -1: none.
int corner_at(const Hardening<double>& hardening, double a) {
  for (std::size_t k = 0; k < hardening.rows.size(); ++k)
    if (std::abs(a / hardening.rows[k].strain - 1) <= weak_margin) return static_cast<int>(k);
  return -1;
}

}  // namespace

void FlowTie::find(const SolvedState& of, std::vector<Tie>& ties) {
  if (!of.model.effects.plasticity) return;
  std::size_t place = 0;
  const auto add = [&](const FlowPoint<double>& point) {
    const auto& [stress, before, after, modulus] = point.trial;
    const bool yields = std::abs(stress / point.hardening.bound(before) - 1) <= weak_margin, flows = after > before;
    if (!yields && !flows) return;
    const int corner = corner_at(point.hardening, after), piece = point.hardening.piece_at(before);
    if (!yields && corner < 0) return;
    int computed = flow_branch::none;
    if (flows && corner >= 0)
      computed = branch_of_piece(after <= point.hardening.rows[corner].strain ? corner : corner + 1);
    else if (flows)
      computed = branch_of_piece(piece);
    ties.emplace_back(FlowTie{point.body, point.element, point.memory, place++, yields, corner, piece, computed});
  };
  for_each_flow_point<double>(of.model, of.slots, {of.at.displacement, of.memory}, nullptr, add);
}

std::vector<FlowPoint<Direction>> FlowTie::points_of(const std::vector<Tie>& ties, const SolvedState& of,
                                                     const ParameterBlock& block) {
  const auto is_flow = [](const Tie& tie) { return std::holds_alternative<FlowTie>(tie); };
  const auto first = std::find_if(ties.begin(), ties.end(), is_flow),
             end = std::find_if_not(first, ties.end(), is_flow);
  std::vector<FlowPoint<Direction>> points;
  if (first == end) return points;
  points.reserve(static_cast<std::size_t>(end - first));
  ElementLists elements(of.model.bodies.size());
  for (auto tie = first; tie != end; ++tie) {
    const auto& flow = std::get<FlowTie>(*tie);
    if (auto& list = elements[flow.body]; list.empty() || list.back() != flow.element) list.push_back(flow.element);
  }
  const BodyMotion<Direction> motion{block.current.displacement, block.previous.history.bodies, 0, &of.at.flow};
  auto next = first;  // ties have the order of the points
  for_each_flow_point<Direction>(of.model, block.slots, motion, &elements, [&](const FlowPoint<Direction>& point) {
    if (next == end || point.memory != std::get<FlowTie>(*next).memory) return;
    points.push_back(point);
    ++next;
  });
  return points;
}

std::vector<Choice> FlowTie::choices(const Model&) const {
  std::vector<Choice> all;
  if (yields) all.push_back({flow_branch::none});
  all.push_back({branch_of_piece(corner < 0 ? piece : corner)});
  if (corner >= 0) all.push_back({branch_of_piece(corner + 1)});
  return all;
}

Choice FlowTie::now(const Model&, const State<double>& at) const {
  const bool is_set = !at.flow.empty() && at.flow[memory] != flow_branch::by_values;
  return {is_set ? at.flow[memory] : computed};
}

void FlowTie::set(const Model& model, const Choice& choice, State<double>& at) const {
  if (at.flow.empty()) at.flow.assign(static_cast<std::size_t>(model.memory_count), flow_branch::by_values);
  at.flow[memory] = choice.branch;
}

RateScales::ByDirection negligible_of_flow(const FlowPoint<Direction>& point, const Direction& bound,
                                           const RateScales::ByDirection& corner, const RateScales& scales) {
  const auto& [stress, before, after, modulus] = point.trial;
  const RateScales::ByDirection size = stress.d.abs()
                                           .max(bound.d.abs())
                                           .max(modulus.v * corner.max(before.d.abs()).max(after.d.abs()))
                                           .max(modulus.v / point.size * scales.of_bodies);
  return scales.negligible(size / bound.v);
}

Verdict FlowTie::verdict(const SidedDerivative& derivative) const {
  const FlowPoint<Direction>& point = derivative.flows[place];
  const auto& [stress, before, after, modulus] = point.trial;
  const Direction at_corner = corner >= 0 ? point.hardening.rows[corner].strain : Direction(0);
  const auto past_corner = [&](const Direction& a) { return derivative.rate(a) - derivative.rate(at_corner); };
  const int ahead = branch_of_piece(corner), behind = branch_of_piece(corner + 1);
  const int flowing = corner < 0 ? branch_of_piece(piece) : past_corner(before) < 0 ? ahead : behind;
  const int branch = derivative.of.at.flow[memory];
  const bool rests = branch == flow_branch::none;
  const Direction bound = point.hardening.bound((rests ? flowing : branch) - flow_branch::first_piece, before);
  const double excess = (derivative.rate(stress) - derivative.rate(bound)) / bound.v;
  const double negligible = negligible_of_flow(point, bound, at_corner.d.abs(), derivative.scales)[0];
  const auto unless = [&](double rate, int other) -> Verdict {
    const double by = rate / negligible;
    return by > 1 ? Verdict{true, Choice{other}, by} : Verdict{};
  };
  if (rests) return unless(excess, flowing);
  if (yields)
    if (const auto verdict = unless(-excess, flow_branch::none); verdict.contradicts) return verdict;
  if (corner < 0) return {};
  const double end = past_corner(after) * (modulus.v / bound.v);
  return branch == ahead ? unless(end, behind) : unless(-end, ahead);
}

}  // namespace stickslip
