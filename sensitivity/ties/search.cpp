#include "sensitivity/ties/search.hpp"

#include <limits>
#include <set>

#include "sensitivity/schemes.hpp"
#include "sensitivity/ties/tie.hpp"

namespace stickslip {
namespace {

RegularisationField<Direction> regularisation_of_scheme(const Differentiation& problem,
                                                        std::vector<double> rho_factor) {
  for (double& f : rho_factor) f *= scheme_of(problem.method).oversize;
  return std::move(regularisation_blocks(problem, rho_factor)[0]);
}

/// The search of one equilibrium. First all contradicted choices are changed at once, then one by one; if there are few
/// ties, all combinations are tried.
class TieSearch {
 public:
  /// `increment`: to be differentiated; `at`: its equilibrium, whose choices the search changes.
  TieSearch(Differentiation& problem, const State<double>& previous, const Increment<double>& increment,
            State<double>& at, const std::vector<double>& rho_factor, const SideDirection& along)
      : problem_(problem),
        previous_(previous),
        increment_(increment),
        at_(at),
        own_(adapted(initial_regularisation(problem.slots, problem.method), rho_factor)),
        of_{.model = problem.model,
            .slots = problem.slots,
            .at = at,
            .memory = previous.history.bodies,
            .rho = own_,
            .cone = cone_radius_of(problem.method),
            .time = increment.time,
            .largest = along.largest_so_far},
        ties_(ties_of(of_)),
        rho_(regularisation_of_scheme(problem, rho_factor)),
        along_(along) {}

  /// Runs the search. True if a derivative confirms all of its choices; it is then in the block, its choices in `at`.
  bool run() {
    if (ties_.empty()) return follow_choices();
    for (const auto& tie : ties_)  // (the branch that a flow took is not in its state)
      if (tie.holds()) tie.set(problem_.model, tie.now(problem_.model, at_), at_);
    const State<double> found = at_;
    if (by_flipping()) return true;
    if (!diverged_) {
      at_ = found;
      take_holding();
      if (by_flipping() || by_enumeration()) return true;
    }
    return at_rounding();
  }

  /// Takes the choices that hold most. Why: a body that is held by friction alone, or by a contact about to open, then
  /// has a regular tangent.
  void take_holding() {
    for (const auto& tie : ties_)
      if (tie.holds()) tie.set(problem_.model, tie.choices(problem_.model).front(), at_);
  }

 private:
  /// Verdict on all choices.
  struct Consistency {
    bool possible = true;
    std::vector<std::pair<const Tie*, Choice>> contradicted;  ///< with the choices that the derivative points to
    double severity = 0;
    bool is_confirmed() const { return possible && contradicted.empty(); }
  };

  /// Differentiates with the choices in `at`. The pseudo-load of the bodies depends on the branches of their flows
  /// alone, so it is kept while these stay.
  bool follow_choices() {
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
    if (!follow_choices()) {
      diverged_ |= problem_.status == Status::cap;
      return std::nullopt;
    }
    const ParameterBlock& block = problem_.blocks[0];
    const double per_size = along_.parameter > 0 ? 1 / along_.parameter : 0;
    const SidedDerivative derivative{
        of_,
        block,
        rho_,
        along_.side,
        {of_.model, of_.slots, block, block.current, Direction::Gradient::Constant(per_size), of_.largest},
        FlowTie::points_of(ties_, of_, block)};
    Consistency consistency;
    for (const auto& tie : ties_) {
      Verdict verdict = tie.verdict(derivative);
      consistency.possible &= verdict.possible;
      consistency.severity = std::max(consistency.severity, verdict.severity);
      if (verdict.contradicts) consistency.contradicted.emplace_back(&tie, std::move(*verdict.contradicts));
    }
    if (consistency.possible && consistency.severity < least_) {
      least_ = consistency.severity;
      best_ = at_;
    }
    return consistency;
  }

  /// Identity of all choices: the branches, and in 2D the directions of slip.
  std::vector<int> key() const {
    std::vector<int> key;
    for (const auto& tie : ties_) {
      const Choice choice = tie.now(problem_.model, at_);
      key.push_back(4 * choice.branch + (choice.ray.size() != 2 ? 0 : choice.ray[1] > 0 ? 1 : 2));
    }
    return key;
  }

  /// Changes all contradicted choices at once; if the result was tried before, only the first of them.
  bool by_flipping() {
    const std::size_t limit = 40 + 4 * ties_.size();
    std::set<std::vector<int>> tried;
    for (std::size_t round = 0; round < limit; ++round) {
      const auto before = key();
      tried.insert(before);
      const auto consistency = differentiate();
      if (!consistency || !consistency->possible) return false;
      if (consistency->is_confirmed()) return true;
      const State<double> start = at_;
      for (const auto& [tie, choice] : consistency->contradicted) tie->set(problem_.model, choice, at_);
      const auto after = key();
      if (after == before || !tried.count(after)) continue;  // (equal keys: a slip direction in 3D converges)
      at_ = start;
      const auto& [first, choice] = consistency->contradicted.front();
      first->set(problem_.model, choice, at_);
    }
    return false;
  }

  /// Tries all combinations of choices, if there are at most 256.
  bool by_enumeration() {
    constexpr std::size_t most = 256;
    std::vector<std::vector<Choice>> choices;
    std::size_t count = 1;
    for (const auto& tie : ties_) {
      choices.push_back(tie.choices(problem_.model));
      if ((count *= std::max<std::size_t>(1, choices.back().size())) > most) return false;
    }
    for (std::size_t combination = 0; combination < count && !diverged_; ++combination) {
      std::size_t rest = combination;
      for (std::size_t k = 0; k < ties_.size(); ++k) {
        if (choices[k].empty()) continue;
        ties_[k].set(problem_.model, choices[k][rest % choices[k].size()], at_);
        rest /= choices[k].size();
      }
      const auto consistency = differentiate();
      if (consistency && consistency->is_confirmed()) return true;
    }
    return false;
  }

  /// Takes the choices with the least contradiction. Both branches of a point can be contradicted only by what the
  /// tolerance of the solution leaves of the tie.
  bool at_rounding() {
    // 1e-7 of the derivatives: a tie is recognised to 1e-8, and its derivative errs as much.
    constexpr double most = 1e3;
    if (!(least_ <= most)) return false;
    at_ = best_;
    return follow_choices();
  }

  Differentiation& problem_;
  const State<double>& previous_;
  const Increment<double>& increment_;
  State<double>& at_;
  RegularisationField<double> own_;
  SolvedState of_;
  std::vector<Tie> ties_;
  RegularisationField<Direction> rho_;
  SideDirection along_;
  double least_ = std::numeric_limits<double>::infinity();  ///< least severity so far
  State<double> best_;                                      ///< its choices
  std::vector<PseudoLoad> load_;                            ///< of the bodies; empty before the first use
  FlowBranches load_flow_;                                  ///< the branches of `load_`
  bool diverged_ = false;  ///< the passes of the scheme did not converge, nor will they with other choices
};

}  // namespace

bool differentiate_side(Differentiation& problem, const State<double>& previous, Increment<double>& increment,
                        const SideDirection& along, Unconfirmed unconfirmed) {
  const auto search = [&](const Increment<double>& of, State<double>& at, const std::vector<double>& rho_factor) {
    TieSearch choices(problem, previous, of, at, rho_factor, along);
    if (choices.run()) return true;
    if (unconfirmed == Unconfirmed::fails) return false;
    choices.take_holding();
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
