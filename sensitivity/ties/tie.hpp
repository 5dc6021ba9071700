/// What is undecided in a state: a tie is a place at which neighbouring branches of the solution meet. They give the
/// same state, but different derivatives. On one side of a parameter, dphi = s d with s = +-1, a tie takes the choice
/// that the derivative found with it confirms. If the rate that decides is zero itself, all choices have the same
/// derivative, and each is confirmed.
///
/// A kind of tie is a file of its own, and a name in the list below. It says where it finds ties, which choices each
/// has, which one a state has, how to set it, and its verdict on a derivative. sensitivity/ties/search.hpp does the
/// rest. Ties of two other kinds need no search: what a node faces at small strain follows from the parameter alone
/// (sensitivity/sided_geometry.hpp), and of a response that is a maximum from the derivatives of its values
/// (sensitivity/response_ties.hpp).
#pragma once

#include <variant>

#include "sensitivity/ties/contact_tie.hpp"
#include "sensitivity/ties/edge_tie.hpp"
#include "sensitivity/ties/flow_tie.hpp"
#include "sensitivity/ties/vertex_tie.hpp"

namespace stickslip {

using KindOfTie = std::variant<ContactTie, FlowTie, VertexTie, EdgeTie>;

class Tie : public KindOfTie {
 public:
  using KindOfTie::KindOfTie;

  /// All choices. Empty: it cannot change.
  std::vector<Choice> choices(const Model& model) const {
    return std::visit([&](const auto& tie) { return tie.choices(model); }, kind());
  }
  /// The choice of a state.
  Choice now(const Model& model, const State<double>& at) const {
    return std::visit([&](const auto& tie) { return tie.now(model, at); }, kind());
  }
  void set(const Model& model, const Choice& choice, State<double>& at) const {
    std::visit([&](const auto& tie) { tie.set(model, choice, at); }, kind());
  }
  Verdict verdict(const SidedDerivative& derivative) const {
    return std::visit([&](const auto& tie) { return tie.verdict(derivative); }, kind());
  }
  /// Whether its choices hold a body more or less, the first one most.
  bool holds() const {
    return std::visit([](const auto& tie) { return tie.holds; }, kind());
  }

 private:
  const KindOfTie& kind() const { return *this; }
};

std::vector<Tie> ties_of(const SolvedState& of);
/// Whether there is any. It looks no further than the first kind that has one.
bool has_ties(const SolvedState& of);

}  // namespace stickslip
