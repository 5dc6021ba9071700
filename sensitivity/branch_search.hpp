/// Search for the branches that an increment takes at its ties, for a derivative on one side of a parameter.
///
/// First all contradicted branches are changed at once, then one by one; if few points are at ties, all combinations
/// are tried. Verdicts: of contact points sensitivity/branches.hpp, of bodies sensitivity/flow_ties.hpp, of patches
/// sensitivity/vertex_ties.hpp.
#pragma once

#include <functional>
#include <limits>
#include <set>

#include "sensitivity/branches.hpp"
#include "sensitivity/flow_ties.hpp"
#include "sensitivity/schemes.hpp"
#include "sensitivity/vertex_ties.hpp"

namespace stickslip {
/// Search for the branches of one equilibrium. The derivative is that of the first direction of the first block.
class BranchSearch {
 public:
  /// `increment`: to be differentiated; `at`: its equilibrium, whose branches the search changes.
  BranchSearch(Differentiation& problem, const State<double>& previous, const Increment<double>& increment,
               State<double>& at, const std::vector<double>& factor, const SideDirection& along)
      : problem_(problem),
        previous_(previous),
        increment_(increment),
        at_(at),
        own_(adapted(initial_regularisation(problem.slots, problem.method), factor)),
        weak_(
            weak_points(problem.model, problem.slots, at, own_, cone_radius_of(problem.method), along.largest_so_far)),
        flows_(flow_ties(problem.model, problem.slots, at.displacement, previous.history.bodies)),
        vertices_(vertex_ties(problem.model, problem.slots, at, increment.time, along.largest_so_far)),
        direction_(along) {
    std::vector<double> stiffened = factor;
    for (double& f : stiffened) f *= scheme_of(problem.method).oversize;
    rho_ = regularisation_blocks(problem, stiffened)[0];
  }

  /// Runs the search. True if a derivative confirms all of its branches; it is then in the block, its branches in `at`.
  bool run() {
    if (weak_.empty() && flows_.empty() && vertices_.empty()) return follow_branches();
    set_computed_branches(problem_.model, flows_, at_);
    const State<double> found = at_;
    if (by_flipping()) return true;
    if (!diverged_) {
      at_ = found;
      hold();
      if (by_flipping() || by_enumeration()) return true;
    }
    return at_rounding();
  }

  /// Gives each point at a tie the branch that holds most. Why: a body that is held by friction alone, or by a contact
  /// about to open, then has a regular tangent.
  void hold() {
    for (const auto& w : weak_) set_branch(problem_.model, w.point, branches_of(problem_.model, w).front(), at_);
    set_computed_branches(problem_.model, flows_, at_);
    for (const auto& tie : flows_) at_.flow[tie.memory] = tie.branches.front();
  }

 private:
  /// Verdict on all branches of one choice.
  struct Consistency {
    bool possible = true;
    std::vector<std::function<void(State<double>&)>>
        contradicted;  ///< each sets the branch that the derivative points to
    double severity = 0;
    bool is_confirmed() const { return possible && contradicted.empty(); }
  };

  /// Differentiates with the branches in `at`. The pseudo-load of the bodies depends on the branches of their flows
  /// alone, so it is kept while these stay.
  bool follow_branches() {
    if (load_.empty() || load_flow_ != at_.flow) {
      load_.assign(1, pseudo_load(problem_, at_, increment_.time));
      reduce(problem_, load_);
      load_flow_ = at_.flow;
    }
    problem_.prepared = load_[0];
    const bool done = differentiate_alone(problem_, previous_, increment_);
    problem_.prepared.reset();  // (unused if the tangent is singular)
    return done;
  }

  std::optional<Consistency> differentiate() {
    problem_.status = Status::singular;
    if (!follow_branches()) {
      diverged_ |= problem_.status == Status::cap;
      return std::nullopt;
    }
    Consistency consistency;
    for (const auto& w : weak_) {
      auto verdict = branch_verdict(problem_.model, problem_.slots, problem_.blocks[0], rho_, own_,
                                    cone_radius_of(problem_.method), w, at_, direction_);
      consistency.possible &= verdict.possible;
      consistency.severity = std::max(consistency.severity, verdict.severity);
      if (!verdict.contradicts) continue;
      consistency.contradicted.push_back(
          [this, p = w.point, branch = *verdict.contradicts](auto& at) { set_branch(problem_.model, p, branch, at); });
    }
    add_flow_verdicts(consistency);
    add_vertex_verdicts(consistency);
    if (consistency.possible && consistency.severity < least_) {
      least_ = consistency.severity;
      best_ = at_;
    }
    return consistency;
  }

  void add_flow_verdicts(Consistency& consistency) const {
    const auto verdicts = flow_verdicts(problem_.model, problem_.blocks[0], flows_, at_, direction_);
    for (std::size_t k = 0; k < flows_.size(); ++k) {
      consistency.severity = std::max(consistency.severity, verdicts[k].severity);
      if (!verdicts[k].contradicts) continue;
      consistency.contradicted.push_back(
          [at_memory = flows_[k].memory, branch = *verdicts[k].contradicts](auto& at) { at.flow[at_memory] = branch; });
    }
  }

  void add_vertex_verdicts(Consistency& consistency) const {
    for (const auto& tie : vertices_) {
      const auto verdict = vertex_verdict(problem_.model, problem_.blocks[0], tie, at_, increment_.time, direction_);
      if (!verdict.contradicts) continue;
      consistency.severity = std::max(consistency.severity, verdict.severity);
      consistency.possible &= tie.crosses;
      consistency.contradicted.push_back(
          [this, &tie, patch = *verdict.contradicts](auto& at) { set_patch(problem_.model, tie, patch, at); });
    }
  }

  /// Identity of a choice: its branches, and in 2D the directions of slip.
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

  /// Changes all contradicted branches at once; if that choice was tried before, only the first of them.
  bool by_flipping() {
    const std::size_t limit = 40 + 4 * (weak_.size() + flows_.size() + vertices_.size());
    std::set<std::vector<int>> tried;
    for (std::size_t round = 0; round < limit; ++round) {
      const auto before = key();
      tried.insert(before);
      const auto consistency = differentiate();
      if (!consistency) return false;
      if (!consistency->possible) return false;
      if (consistency->is_confirmed()) return true;
      const State<double> start = at_;
      for (const auto& take : consistency->contradicted) take(at_);
      const auto after = key();
      if (after == before || !tried.count(after)) continue;  // (equal keys: a slip direction in 3D converges)
      at_ = start;
      consistency->contradicted.front()(at_);
    }
    return false;
  }

  /// Tries all combinations of branches, if there are at most 256.
  bool by_enumeration() {
    constexpr std::size_t most = 256;
    const Model& model = problem_.model;
    std::vector<std::vector<std::function<void(State<double>&)>>> of_point;
    for (const auto& w : weak_) {
      auto& branches = of_point.emplace_back();
      for (const auto& branch : branches_of(model, w))
        branches.push_back([&model, &w, branch](auto& at) { set_branch(model, w.point, branch, at); });
    }
    for (const auto& tie : flows_) {
      auto& branches = of_point.emplace_back();
      for (int branch : tie.branches) branches.push_back([&tie, branch](auto& at) { at.flow[tie.memory] = branch; });
    }
    for (const auto& tie : vertices_) {
      if (!tie.crosses) continue;
      auto& patches = of_point.emplace_back();
      for (int patch : {tie.first, tie.second})
        patches.push_back([&model, &tie, patch](auto& at) { set_patch(model, tie, patch, at); });
    }
    std::size_t count = 1;
    for (const auto& branches : of_point)
      if ((count *= branches.size()) > most) return false;
    for (std::size_t choice = 0; choice < count && !diverged_; ++choice) {
      std::size_t rest = choice;
      for (const auto& branches : of_point) {
        branches[rest % branches.size()](at_);
        rest /= branches.size();
      }
      const auto consistency = differentiate();
      if (consistency && consistency->is_confirmed()) return true;
    }
    return false;
  }

  /// Takes the choice with the least contradiction. Both branches of a point can be contradicted only by what the
  /// tolerance of the solution leaves of the tie.
  bool at_rounding() {
    constexpr double most =
        1e3;  // 1e-7 of the derivatives: a tie is recognised to 1e-8, and its derivative errs as much
    if (!(least_ <= most)) return false;
    at_ = best_;
    return follow_branches();
  }

  Differentiation& problem_;
  const State<double>& previous_;
  const Increment<double>& increment_;
  State<double>& at_;
  RegularisationField<double> own_;
  RegularisationField<Direction> rho_;
  std::vector<WeakPoint> weak_;
  std::vector<FlowTie> flows_;
  std::vector<VertexTie> vertices_;
  SideDirection direction_;
  double least_ = std::numeric_limits<double>::infinity();  ///< least severity of a choice
  State<double> best_;                                      ///< that choice
  std::vector<PseudoLoad> load_;                            ///< of the bodies; empty before the first use
  FlowBranches load_flow_;                                  ///< the branches of `load_`
  bool diverged_ = false;  ///< the passes of the scheme did not converge, nor will they for another choice
};

/// Differentiates one increment on one side of a parameter, with the branches that the derivative confirms. If no
/// choice is confirmed: false; with `held` the derivative of the branches that hold most.
inline bool differentiate_side(Differentiation& problem, const State<double>& previous, Increment<double>& increment,
                               const SideDirection& along, bool held = false) {
  const auto search = [&](const Increment<double>& of, State<double>& at, const std::vector<double>& factor) {
    BranchSearch branches(problem, previous, of, at, factor, along);
    if (branches.run()) return true;
    if (!held) return false;
    branches.hold();
    return differentiate_alone(problem, previous, of);
  };
  if (!scheme_of(problem.method).of_each_augmentation) return search(increment, increment.state, increment.rho_factor);
  // Each augmentation starts from the derivative of the one before.
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
