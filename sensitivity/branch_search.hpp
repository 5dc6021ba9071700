/// The branches that an increment takes at ties along one direction: found by flipping what is contradicted, all at
/// once, then one by one, and where few points are weak by trying all (sensitivity/branches.hpp, of the bodies
/// sensitivity/flow_ties.hpp).
#pragma once

#include <functional>
#include <limits>
#include <set>

#include "sensitivity/all_methods.hpp"
#include "sensitivity/branches.hpp"
#include "sensitivity/flow_ties.hpp"
#include "sensitivity/vertex_ties.hpp"

namespace stickslip {
namespace detail {

template <class M>
RegularisationField<double> own_rho(const M& method, const Slots<double>& slots, const std::vector<double>& factor) {
  return adapted(initial_regularisation(slots, method), factor);
}

}  // namespace detail

/// Search for the branches of one equilibrium along one direction, the first of the first block.
template <class M, class E>
class BranchSearch {
 public:
  /// `increment`: what is differentiated; `at`: its equilibrium, whose branches change.
  BranchSearch(const M& method, Differentiation<E>& problem, const State<double>& previous,
               const Increment<double>& increment, State<double>& at, const std::vector<double>& factor,
               const SideDirection& along)
      : method_(method),
        problem_(problem),
        previous_(previous),
        increment_(increment),
        at_(at),
        own_(detail::own_rho(method, problem.slots, factor)),
        weak_(weak_points(problem.model, problem.slots, at, own_, cone_radius(method), along.largest_so_far)),
        flows_(flow_ties(problem.model, problem.slots, at.displacement, previous.history.bodies)),
        vertices_(vertex_ties(problem.model, problem.slots, at, increment.time, along.largest_so_far)),
        direction_(along) {
    std::vector<double> stiffened = factor;
    for (double& f : stiffened) f *= method.scheme().oversize;
    rho_ = regularisation_blocks(method, problem, stiffened)[0];
  }

  /// Leaves the derivative with the branches that it confirms in the block, and them in `at`.
  bool run() {
    if (weak_.empty() && flows_.empty() && vertices_.empty()) return follow_branches();
    take_values(problem_.model, flows_, at_);
    const State<double> found = at_;
    if (by_flipping()) return true;
    if (!unsettled_) {
      at_ = found;
      hold();
      if (by_flipping() || by_enumeration()) return true;
    }
    return at_rounding();
  }

  /// Takes that branch of each weak point that holds most, so that a body which only friction, or a contact about to
  /// open, holds has a regular tangent.
  void hold() {
    for (const auto& w : weak_) take_branch(problem_.model, w.point, branches_of(problem_.model, w).front(), at_);
    take_values(problem_.model, flows_, at_);
    for (const auto& tie : flows_) at_.flow[tie.memory] = tie.branches.front();
  }

 private:
  struct Standing {
    bool possible = true;
    std::vector<std::function<void(State<double>&)>> contradicted;  ///< each takes the branch that is pointed to
    double severity = 0;
    bool is_confirmed() const { return possible && contradicted.empty(); }
  };

  /// Differentiates with the branches in `at`. The bodies' pseudo-load depends on the branches of their flows alone, so
  /// one serves all choices of the others.
  bool follow_branches() {
    if (load_.empty() || load_flow_ != at_.flow) {
      load_.assign(1, pseudo_load(problem_, at_, increment_.time));
      reduce(problem_, load_);
      load_flow_ = at_.flow;
    }
    problem_.prepared = load_[0];
    const bool done = differentiate_alone(method_, problem_, previous_, increment_);
    problem_.prepared.reset();  // (a tangent without a factor leaves it there)
    return done;
  }

  std::optional<Standing> differentiate() {
    problem_.status = Status::singular;
    if (!follow_branches()) {
      unsettled_ |= problem_.status == Status::cap;
      return std::nullopt;
    }
    Standing standing;
    for (const auto& w : weak_) {
      auto verdict = judge(problem_.model, problem_.slots, problem_.blocks[0], rho_, own_, cone_radius(method_), w, at_,
                           direction_);
      standing.possible &= verdict.possible;
      standing.severity = std::max(standing.severity, verdict.severity);
      if (!verdict.contradicts) continue;
      standing.contradicted.push_back(
          [this, p = w.point, branch = *verdict.contradicts](auto& at) { take_branch(problem_.model, p, branch, at); });
    }
    judge_flows(standing);
    judge_vertices(standing);
    if (standing.possible && standing.severity < least_) {
      least_ = standing.severity;
      best_ = at_;
    }
    return standing;
  }

  void judge_flows(Standing& standing) const {
    const auto verdicts = judge(problem_.model, problem_.blocks[0], flows_, at_, direction_);
    for (std::size_t k = 0; k < flows_.size(); ++k) {
      standing.severity = std::max(standing.severity, verdicts[k].severity);
      if (!verdicts[k].contradicts) continue;
      standing.contradicted.push_back(
          [at_memory = flows_[k].memory, branch = *verdicts[k].contradicts](auto& at) { at.flow[at_memory] = branch; });
    }
  }

  void judge_vertices(Standing& standing) const {
    for (const auto& tie : vertices_) {
      const auto verdict = judge(problem_.model, problem_.blocks[0], tie, at_, increment_.time, direction_);
      if (!verdict.contradicts) continue;
      standing.severity = std::max(standing.severity, verdict.severity);
      standing.possible &= tie.crosses;
      standing.contradicted.push_back(
          [this, &tie, patch = *verdict.contradicts](auto& at) { take_patch(problem_.model, tie, patch, at); });
    }
  }

  /// What tells one choice from another: the branches, and in the plane the directions of slip.
  std::vector<int> key() const {
    std::vector<int> key;
    for (const auto& w : weak_) {
      const Branch branch = branch_of(problem_.model, at_, w.point);
      const int direction = branch.ray.size() == 2 ? (branch.ray[1] > 0 ? 1 : 2) : 0;
      key.push_back(4 * static_cast<int>(branch.state) + direction);
    }
    for (const auto& tie : flows_) key.push_back(at_.flow[tie.memory]);
    for (const auto& tie : vertices_) key.push_back(at_.contact.facing[tie.point].patch);
    return key;
  }

  /// Flips all that is contradicted at once; where that choice was tried before, only the first.
  bool by_flipping() {
    const std::size_t limit = 40 + 4 * (weak_.size() + flows_.size() + vertices_.size());
    std::set<std::vector<int>> tried;
    for (std::size_t round = 0; round < limit; ++round) {
      const auto before = key();
      tried.insert(before);
      const auto standing = differentiate();
      if (!standing) return false;
      if (!standing->possible) return false;
      if (standing->is_confirmed()) return true;
      const State<double> start = at_;
      for (const auto& take : standing->contradicted) take(at_);
      const auto after = key();
      if (after == before || !tried.count(after)) continue;  // (the same: a direction in space is being found)
      at_ = start;
      standing->contradicted.front()(at_);
    }
    return false;
  }

  /// Tries all branches of few points.
  bool by_enumeration() {
    constexpr std::size_t most = 256;
    const Model& model = problem_.model;
    std::vector<std::vector<std::function<void(State<double>&)>>> of_point;
    for (const auto& w : weak_) {
      auto& branches = of_point.emplace_back();
      for (const auto& branch : branches_of(model, w))
        branches.push_back([&model, &w, branch](auto& at) { take_branch(model, w.point, branch, at); });
    }
    for (const auto& tie : flows_) {
      auto& branches = of_point.emplace_back();
      for (int branch : tie.branches) branches.push_back([&tie, branch](auto& at) { at.flow[tie.memory] = branch; });
    }
    for (const auto& tie : vertices_) {
      if (!tie.crosses) continue;
      auto& patches = of_point.emplace_back();
      for (int patch : {tie.first, tie.second})
        patches.push_back([&model, &tie, patch](auto& at) { take_patch(model, tie, patch, at); });
    }
    std::size_t count = 1;
    for (const auto& branches : of_point)
      if ((count *= branches.size()) > most) return false;
    for (std::size_t choice = 0; choice < count && !unsettled_; ++choice) {
      std::size_t rest = choice;
      for (const auto& branches : of_point) {
        branches[rest % branches.size()](at_);
        rest /= branches.size();
      }
      const auto standing = differentiate();
      if (standing && standing->is_confirmed()) return true;
    }
    return false;
  }

  /// Where both branches of a point are contradicted, that is by what the solution's tolerance leaves of the tie. Takes
  /// the branches that were contradicted least.
  bool at_rounding() {
    constexpr double most = 1e3;  // 1e-7 of the derivatives: a point is weak up to 1e-8, as its derivative then is
    if (!(least_ <= most)) return false;
    at_ = best_;
    return follow_branches();
  }

  const M& method_;
  Differentiation<E>& problem_;
  const State<double>& previous_;
  const Increment<double>& increment_;
  State<double>& at_;
  RegularisationField<double> own_;
  RegularisationField<Direction> rho_;
  std::vector<WeakPoint> weak_;
  std::vector<FlowTie> flows_;
  std::vector<VertexTie> vertices_;
  SideDirection direction_;
  double least_ = std::numeric_limits<double>::infinity();  ///< least_, best_: of the choices tried, the one
                                                            ///< that was contradicted least
  State<double> best_;
  std::vector<PseudoLoad> load_;  ///< of the bodies, once it is asked for
  FlowBranches load_flow_;        ///< the branches that it is of
  bool unsettled_ = false;        ///< a scheme's passes did not settle: all that it takes, for each choice again
};

/// Differentiates one increment along one direction; its branches at ties become those that are confirmed. Where none
/// are: false; or, with `held`, the branches that hold most, with their derivative.
template <class M, class E>
bool differentiate_side(const M& method, Differentiation<E>& problem, const State<double>& previous,
                        Increment<double>& increment, const SideDirection& along, bool held = false) {
  const auto search = [&](const Increment<double>& of, State<double>& at, const std::vector<double>& factor) {
    BranchSearch branches(method, problem, previous, of, at, factor, along);
    if (branches.run()) return true;
    if (!held) return false;
    branches.hold();
    return differentiate_alone(method, problem, previous, of);
  };
  if (!method.scheme().of_each_augmentation) return search(increment, increment.state, increment.rho_factor);
  // each augmentation starts from the derivative that the one before left
  auto& block = problem.blocks[0];
  const State<Direction> start = block.previous;
  bool found = true;
  for (auto& sweep : increment.augmented) {
    Increment<double> alone;
    alone.time = increment.time;
    alone.augmented = {sweep};
    auto& only = alone.augmented[0];
    found = search(alone, only.state, only.rho_factor);
    if (!found) break;
    sweep = std::move(only);
    block.previous.contact.traction = block.current.contact.traction;
    increment.state.history.patch = sweep.state.history.patch;
    increment.state.history.foot = sweep.state.history.foot;
  }
  block.previous = start;
  return found;
}

}  // namespace stickslip
