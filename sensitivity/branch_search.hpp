/// The branches that an increment takes at ties along one direction: found by flipping what is contradicted, all at
/// once, then one by one, and where few points are weak by trying all (sensitivity/branches.hpp).
#pragma once

#include <limits>
#include <set>

#include "sensitivity/branches.hpp"
#include "sensitivity/monolithic.hpp"
#include "sensitivity/penalty.hpp"
#include "sensitivity/uzawa.hpp"

namespace stickslip {
namespace detail {

/// What of a method's scheme the branches depend on: the equilibrium that it differentiates, its cone, and what it
/// multiplies rho by.
template <class M>
constexpr bool is_truncated(const M&) {
  return false;
}
inline bool is_truncated(const UzawaAL& method) { return method.sensitivity == UzawaAL::Sensitivity::truncated; }
template <class M>
constexpr double oversize_of(const M&) {
  return 1;
}
inline double oversize_of(const UzawaAL& method) {
  const bool oversized = method.sensitivity == UzawaAL::Sensitivity::oversized;
  return oversized ? method.oversize.value_or(UzawaAL::automatic_oversize) : 1;
}

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
               const Along& along)
      : method_(method),
        problem_(problem),
        previous_(previous),
        increment_(increment),
        at_(at),
        own_(detail::own_rho(method, problem.slots, factor)),
        weak_(weak_points(problem.model, problem.slots, at, own_, cone_radius(method), along.largest_so_far)),
        along_(along) {
    std::vector<double> stiffened = factor;
    for (double& f : stiffened) f *= detail::oversize_of(method);
    rho_ = regularisation_blocks(method, problem, stiffened)[0];
  }

  /// Leaves the derivative with the branches that it confirms in the block, and them in `at`.
  bool run() {
    if (weak_.empty()) return follow_branches();
    const auto found = at_.contact;
    if (by_flipping()) return true;
    if (!unsettled_) {
      at_.contact = found;
      hold();
      if (by_flipping() || by_enumeration()) return true;
    }
    return at_rounding();
  }

  /// Takes the branch of each weak point that holds most: a body that only friction or a contact about to open holds
  /// has a regular tangent then.
  void hold() {
    for (const auto& w : weak_) take_branch(problem_.model, w.point, branches_of(problem_.model, w).front(), at_);
  }

 private:
  struct Standing {
    bool possible = true;
    std::vector<std::pair<int, Branch>> contradicted;  ///< by point
    double by = 0;
  };

  /// Differentiates with the branches in `at`. The bodies' pseudo-load does not depend on them: one serves all choices.
  bool follow_branches() {
    if (load_.empty()) {
      load_.push_back(pseudo_load(problem_, at_.displacement, increment_.time));
      reduce(problem_, load_);
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
      auto verdict =
          judge(problem_.model, problem_.slots, problem_.blocks[0], rho_, own_, cone_radius(method_), w, at_, along_);
      standing.possible &= verdict.possible;
      standing.by = std::max(standing.by, verdict.by);
      if (verdict.contradicts) standing.contradicted.emplace_back(w.point, *std::move(verdict.contradicts));
    }
    if (standing.possible && standing.by < least_) {
      least_ = standing.by;
      best_ = at_.contact;
    }
    return standing;
  }

  /// What tells one choice from another: branches, and in the plane the sides to which points slip.
  std::vector<int> key() const {
    std::vector<int> key;
    for (const auto& w : weak_) {
      const Branch branch = branch_of(problem_.model, at_, w.point);
      const int direction = branch.ray.size() == 2 ? (branch.ray[1] > 0 ? 1 : 2) : 0;
      key.push_back(4 * static_cast<int>(branch.state) + direction);
    }
    return key;
  }

  /// Flips all that is contradicted; where that was tried, the first alone.
  bool by_flipping() {
    const std::size_t limit = 40 + 4 * weak_.size();
    std::set<std::vector<int>> tried;
    for (std::size_t round = 0; round < limit; ++round) {
      const auto before = key();
      tried.insert(before);
      const auto standing = differentiate();
      if (!standing) return false;
      if (!standing->possible) return false;
      if (standing->contradicted.empty()) return true;
      const State<double> start = at_;
      for (const auto& [point, branch] : standing->contradicted) take_branch(problem_.model, point, branch, at_);
      const auto after = key();
      if (after == before || !tried.count(after)) continue;  // (the same: a direction in space is being found)
      at_.contact = start.contact;
      const auto& [point, branch] = standing->contradicted.front();
      take_branch(problem_.model, point, branch, at_);
    }
    return false;
  }

  /// Tries all branches of few points.
  bool by_enumeration() {
    constexpr std::size_t most = 256;
    std::vector<std::vector<Branch>> of_point;
    std::size_t count = 1;
    for (const auto& w : weak_) {
      of_point.push_back(branches_of(problem_.model, w));
      count *= of_point.back().size();
      if (count > most) return false;
    }
    for (std::size_t choice = 0; choice < count && !unsettled_; ++choice) {
      std::size_t rest = choice;
      for (std::size_t k = 0; k < weak_.size(); ++k) {
        take_branch(problem_.model, weak_[k].point, of_point[k][rest % of_point[k].size()], at_);
        rest /= of_point[k].size();
      }
      const auto standing = differentiate();
      if (standing && standing->possible && standing->contradicted.empty()) return true;
    }
    return false;
  }

  /// Where both branches of a point are contradicted, it is by what the solution's tolerance leaves of the tie: takes
  /// those that were contradicted least.
  bool at_rounding() {
    constexpr double most = 1e3;  // 1e-7 of the derivatives: a point is weak up to 1e-8, as its derivative then is
    if (!(least_ <= most)) return false;
    at_.contact = best_;
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
  Along along_;
  double least_ = std::numeric_limits<double>::infinity();  ///< least_, best_: of the choices tried, the one
                                                            ///< that was contradicted least
  ContactField<double> best_;
  std::vector<PseudoLoad> load_;  ///< of the bodies, once it is asked for
  bool unsettled_ = false;        ///< a scheme's passes did not settle: all that it takes, for each choice again
};

/// Differentiates one increment along one direction; its branches at ties become those that are confirmed. False where
/// none are; with `held` they become those that hold most then, and the derivative is theirs.
template <class M, class E>
bool differentiate_side(const M& method, Differentiation<E>& problem, const State<double>& previous,
                        Increment<double>& increment, const Along& along, bool held = false) {
  const auto search = [&](const Increment<double>& of, State<double>& at, const std::vector<double>& factor) {
    BranchSearch branches(method, problem, previous, of, at, factor, along);
    if (branches.run()) return true;
    if (!held) return false;
    branches.hold();
    return differentiate_alone(method, problem, previous, of);
  };
  if (!detail::is_truncated(method)) return search(increment, increment.state, increment.rho_factor);
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
  }
  block.previous = start;
  return found;
}

}  // namespace stickslip
