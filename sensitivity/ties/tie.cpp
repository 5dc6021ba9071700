#include "sensitivity/ties/tie.hpp"

#include <algorithm>
#include <type_traits>

namespace stickslip {
namespace {

enum class HowMany { all, any };

/// The ties of each kind, one kind after the other. `any`: it stops where there are some.
template <class... Kind>
std::vector<Tie> found(const SolvedState& of, HowMany wanted, std::type_identity<std::variant<Kind...>>) {
  std::vector<Tie> ties;
  static_cast<void>(((Kind::find(of, ties), wanted == HowMany::any && !ties.empty()) || ...));
  return ties;
}

constexpr std::type_identity<KindOfTie> all_kinds;

}  // namespace

bool has_a_say(const SolvedState& of, int point) {
  const auto reads_gap = [](const Response& response) { return response.kind == Response::Kind::gap; };
  const auto& responses = of.model.scene.responses;
  return of.at.contact.state[point] != ContactState::open ||
         elastic_traction(of.slots, point) * of.at.contact.gap[point] <= weak_margin * of.largest ||
         std::any_of(responses.begin(), responses.end(), reads_gap);
}

bool bears(const SolvedState& of, int point) {
  return -of.at.contact.traction[of.model.points[point].multiplier] > weak_margin * of.largest;
}

std::vector<Tie> ties_of(const SolvedState& of) { return found(of, HowMany::all, all_kinds); }

bool has_ties(const SolvedState& of) { return !found(of, HowMany::any, all_kinds).empty(); }

}  // namespace stickslip
