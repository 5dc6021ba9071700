/// Uzawa: derivatives of the fixed point of the update  lambda <- t(u(lambda), lambda).
///
///   iterated        (two-phase) lambda has converged; then  D lambda <- D t(Du(D lambda), D lambda)  is repeated until
///                   D lambda converges. One factorisation, and a back-solve per parameter and pass. After m passes the
///                   error is q^m, q the contraction of the updates. rho is a constant: Dg = 0 at the fixed point
///   truncated       (piggyback) one pass per augmentation that was performed, with its own tangent. It is the exact
///                   derivative of a loop that was cut off, or that stopped at a coarse tolerance
///   oversized       one pass with kappa_s rho in place of rho, states frozen. Error O(1/kappa_s), no iteration [SZ00]
///   preconditioned  the iterated scheme with kappa_s rho in place of rho. Both have the same fixed point: there Dg = 0
///                   and D t_T = D(bound m), which do not contain rho. A pass multiplies the error by
///                   1 / (1 + kappa_s rho s_min), so four to six passes reach rounding for any q
///
/// The step D lambda <- D t is update_derivatives(): the derivative of AugmentationLoop::update (methods/uzawa.hpp).
/// Its transpose is iterate_back().
///
/// kappa_s is the option `oversize`. Its automatic value is 1e3 for the oversized scheme. For the preconditioned scheme
/// it is q / ((1 - q) 5e-4), which turns a measured contraction q into 5e-4; but kappa_s rho is at least 300 nodal
/// stiffnesses, for directions that the updates did not excite, and at most 1e5. Why these numbers: the rounding of
/// D lambda grows as kappa_s rho, and the number of passes falls with it. They give four to six passes and errors below
/// 1e-10 up to q = 0.995. With 1e-4, 1e3 and 1e6 in their place there is one pass less, and an error of 4e-10.
///
/// All schemes start from D lambda of the last increment. The adjoint transposes the same maps: the derivative l by t
/// is carried to lambda and back,  l <- l D t/D lambda.  The iterated and preconditioned schemes repeat this until the
/// rest vanishes, as a fixed point iteration with Anderson's acceleration; the truncated scheme does it once per
/// augmentation, the oversized one once. [SLK10 sec. 1], [CD20]

#include "methods/augmentation/acceleration.hpp"
#include "sensitivity/direct.hpp"
#include "sensitivity/pass_convergence.hpp"
#include "sensitivity/pull_back.hpp"
#include "sensitivity/schemes.hpp"
#include "sensitivity/ties/scales.hpp"

namespace stickslip {

namespace {

constexpr std::string_view other_scheme = ", or the preconditioned scheme";

/// Per block: the value of `multiplier` with D lambda of the last increment as its derivative.
std::vector<Vector<Direction>> carried_multiplier(Differentiation& problem, const Vector<double>& multiplier) {
  std::vector<Vector<Direction>> lambda;
  for (auto& block : problem.blocks) {
    lambda.push_back(lift(multiplier));
    for (Eigen::Index k = 0; k < multiplier.size(); ++k) lambda.back()[k].d = block.previous.contact.traction[k].d;
  }
  return lambda;
}

/// Derivative of the Uzawa update lambda <- t: sets D lambda to D t of `fields`, per block. Values stay.
void update_derivatives(std::vector<Vector<Direction>>& lambda, const std::vector<ContactField<Direction>>& fields) {
  for (std::size_t b = 0; b < lambda.size(); ++b)
    for (Eigen::Index k = 0; k < lambda[b].size(); ++k) lambda[b][k].d = fields[b].traction[k].d;
}

/// kappa_s of the preconditioned scheme. `contraction`: of the updates; 0: not measured.
double chosen_oversize(const UzawaAL& method, const Slots<double>& slots, const RegularisationField<double>& rho,
                       double contraction) {
  constexpr double target = 5e-4, least = 300, most = 1e5;  // target: a contraction; least, most: nodal stiffnesses
  if (method.oversize) return *method.oversize;
  double smallest = std::numeric_limits<double>::infinity(), largest = 0;
  for (std::size_t p = 0; p < rho.size(); ++p) {
    const double multiple = rho[p].normal * slots.geometry[p].area / slots.stiffness[p];
    smallest = std::min(smallest, multiple);
    largest = std::max(largest, multiple);
  }
  if (largest == 0) return 1;
  const double q = contraction, measured = q > 0 && q < 1 ? q / (1 - q) / target : 0;
  return std::max(1.0, std::min(std::max(measured, least / smallest), most / largest));
}

/// The state `at` with the multiplier whose trial at kappa_s rho is the traction t that was found: lambda = t - kappa_s
/// rho g. In slip that trial is on the edge of the cone. Why: with lambda of the loop, kappa_s rho would magnify the
/// violation that the augmentations left.
State<double> restated(const Model& model, State<double> at, const RegularisationField<double>& rho) {
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    if (at.contact.state[p] == ContactState::open) continue;
    const int k = model.points[p].multiplier, offset = tangential_offset(model, p);
    at.multiplier[k] = at.contact.traction[k] - rho[p].normal * at.contact.gap[p];
    const bool stick = at.contact.state[p] == ContactState::stick;
    for (int a = 0; a < model.points[p].tangents; ++a)
      at.multiplier[k + 1 + a] =
          at.contact.traction[k + 1 + a] - (stick ? rho[p].tangential * at.contact.slip[offset + a] : 0.0);
  }
  return at;
}

/// The equilibrium that the passes of a scheme linearise. It outlives what linearise() and record() return.
struct SchemeEquilibrium {
  const UzawaAL& method;
  const State<double>& of_loop;
  double oversize;                                       ///< kappa_s
  std::vector<double> rho_factor;                        ///< on the initial rho, if the scheme depends on that
  RegularisationField<double> rho;                       ///< kappa_s times that of the loop
  std::optional<State<double>> restated = std::nullopt;  ///< for the preconditioned scheme

  const State<double>& state() const { return restated ? *restated : of_loop; }

  LinearisedEquilibrium linearise(Differentiation& problem, const State<double>& previous, double time) const {
    auto blocks = method.scheme().reads_regularisation ? regularisation_blocks(problem, rho_factor)
                                                       : std::vector(problem.blocks.size(), constant<Direction>(rho));
    return LinearisedEquilibrium(problem, state(), rho, std::move(blocks), method.cone_radius(), time,
                                 method.multipliers, previous.history);
  }

  RecordedEquilibrium record(AdjointProblem& problem, const State<double>& previous, double time,
                             bool objectives) const {
    problem.tape.rewind(problem.slots_end);
    const auto recorded = method.scheme().reads_regularisation
                              ? adapted(initial_regularisation(problem.recorded, method), rho_factor)
                              : constant<Reverse>(rho);
    return RecordedEquilibrium(problem, previous, state(), recorded, method.cone_radius(), time, method.multipliers,
                               objectives);
  }
};

/// With rho of the loop times `oversize`.
SchemeEquilibrium scheme_equilibrium(const UzawaAL& method, const Slots<double>& slots, const State<double>& at,
                                     std::vector<double> rho_factor, double oversize) {
  for (double& f : rho_factor) f *= oversize;
  auto rho = adapted(initial_regularisation(slots, method), rho_factor);
  return {method, at, oversize, std::move(rho_factor), std::move(rho)};
}

/// That of all schemes but the truncated one.
template <class Problem>
SchemeEquilibrium scheme_equilibrium(const UzawaAL& method, const Problem& problem, const Increment<double>& at) {
  if (method.sensitivity != UzawaAL::Sensitivity::preconditioned)
    return scheme_equilibrium(method, problem.slots, at.state, at.rho_factor, method.scheme().oversize);
  const auto own = adapted(initial_regularisation(problem.slots, method), at.rho_factor);
  const double oversize = chosen_oversize(method, problem.slots, own, at.contraction);
  auto rho = adapted(own, std::vector<double>(own.size(), oversize));
  auto state = restated(problem.model, at.state, rho);
  return {method, at.state, oversize, {}, std::move(rho), std::move(state)};
}

/// Per parameter: what rounds as a displacement of this derivative does, length. In space a foot is a place of its
/// surface, summed up over as many as 60 vertices, so it rounds as the place of the node does, and eight times as much
/// as what has few terms. Elsewhere Dg has displacements alone, and this is zero.
Vector<double> rounding_shift(const Differentiation& problem) {
  Vector<double> largest = Vector<double>::Zero(problem.parameters);
  const Model& model = problem.model;
  if (model.dimension != 3 || model.surfaces.empty()) return largest;
  for (const auto& block : problem.blocks)
    for (std::size_t d = 0; d < block.parameters.size(); ++d)
      for (int node : model.contact_nodes)
        for (const Direction& x : block.slots.points.col(node))
          largest[block.parameters[d]] = std::max(largest[block.parameters[d]], std::abs(x.d[d]));
  return 8 * largest;
}

/// Iterates D lambda <- D t until each parameter has ended. False if the passes reach their limit, or if a tangent is
/// singular. `change`: largest change of D lambda in a pass; q: ratio of the last two changes; `floors`: what rounding
/// of rho Dg makes of a change. A parameter ends in one of four cases:
///
///   left <= enough   left = change q / (1 - q), the sum of all changes to come; enough: `tolerance` of D lambda
///   stalled          change <= floors, or change <= rounding of D lambda
///   drifts           the change is below 1e-11 of D lambda, and does not fall. Cause: constraints repeat one another,
///                    and rounding between them moves their multipliers in every pass. A mode that converges as slowly
///                    as this would have larger changes
///   rests            the least change so far is ten passes old, none since was half of it, and D lambda is no farther
///                    than four of it from where it was then. A slow mode would have moved on in one direction. So the
///                    changes are rounding of the back-solves, which the factor's condition number magnifies. It may be
///                    up to 1e-9 of D lambda, or of the traction k / A |Du| if that is larger
///
/// The rounding of Dg is that of its terms, and that of the forces that balance in it. Example: tractions do not depend
/// on a thickness, so its Dg is this rounding alone.
bool iterate(Differentiation& problem, LinearisedEquilibrium& linearised, const RegularisationField<double>& rho,
             std::vector<Vector<Direction>>& lambda, double tolerance) {
  // largest rho; largest rho over k: traction per force that rounds in a node; largest k / A: traction per motion
  double stiffest = 0, rho_over_k = 0, elastic = 0;
  for (std::size_t p = 0; p < rho.size(); ++p) {
    stiffest = std::max(stiffest, rho[p].normal);
    rho_over_k = std::max(rho_over_k, rho[p].normal / problem.slots.stiffness[p]);
    elastic = std::max(elastic, elastic_traction(problem.slots, static_cast<int>(p)));
  }
  constexpr int patience = 10;
  constexpr double far = 4, most_rounding = 1e-9;
  Eigen::ArrayXd last = Eigen::ArrayXd::Zero(problem.parameters), carried = last, least = last;
  std::vector<int> since(problem.parameters, 0);  // pass of the least change
  Matrix<double> at_least;                        // D lambda after it
  auto columns = [&](auto&& pick) { return gather(problem.blocks, problem.parameters, pick); };
  auto& record = problem.record.emplace();
  const Vector<double> shift = rounding_shift(problem);
  detail::PassConvergence convergence;
  for (int pass = 1; pass <= detail::PassConvergence::limit; ++pass) {
    const Matrix<double> before = columns([&](auto&, int b) -> auto& { return lambda[b]; });
    if (!linearised.solve(lambda)) return false;
    const Matrix<double> after = columns([&](auto&, int b) -> auto& { return linearised.fields()[b].traction; });
    update_derivatives(lambda, linearised.fields());
    const Vector<double> floors =
        8 * unit_roundoff * (stiffest * (linearised.largest_motion() + shift) + rho_over_k * linearised.load());
    bool converged = true;
    double slowest = 0;  // largest change / enough of a parameter that has not ended
    record = {.passes = pass};
    if (pass == 1) at_least = after;
    for (int j = 0; j < problem.parameters && after.rows() > 0; ++j) {
      const double change = (after.col(j) - before.col(j)).cwiseAbs().maxCoeff();
      const double size = after.col(j).cwiseAbs().maxCoeff();
      // (A zero derivative has no size of its own; that of the last increment stands in.)
      if (pass == 1) carried[j] = before.col(j).cwiseAbs().maxCoeff();
      const double q = last[j] > 0 ? change / last[j] : 1;
      const double left = q < 1 ? change * q / (1 - q) : change;
      const bool stalled = pass > 3 && change <= std::max(floors[j], 4 * unit_roundoff * std::max(size, carried[j]));
      const bool drifts = pass > 10 && q > 1 - 1e-4 && change <= 1e-11 * std::max(size, carried[j]);
      if (pass == 1 || change < least[j] / 2) {
        least[j] = change;
        since[j] = pass;
        at_least.col(j) = after.col(j);
      }
      const double natural = std::max({size, carried[j], elastic * linearised.largest_motion()[j]});
      const bool rests = pass - since[j] >= patience && least[j] <= most_rounding * natural &&
                         (after.col(j) - at_least.col(j)).cwiseAbs().maxCoeff() <= far * least[j];
      const double enough = std::max(tolerance * size, floors[j]);
      const bool ended = change == 0 || stalled || drifts || rests || (q < 1 && pass > 2 && left <= enough);
      if (!ended) slowest = std::max(slowest, change / enough);
      converged &= ended;
      if (last[j] > 0 && change > floors[j]) record.contraction = std::max(record.contraction, q);
      last[j] = change;
    }
    if (converged) return true;
    if (convergence.is_hopeless(pass, slowest, 1)) break;
  }
  problem.status = Status::cap;
  problem.message = "the derivatives would not settle in 20000 passes; try a larger scale";
  return false;
}

/// The truncated scheme: one pass per augmentation that was performed.
bool differentiate_augmentations(const UzawaAL& method, Differentiation& problem, const State<double>& previous,
                                 const Increment<double>& increment) {
  auto lambda = carried_multiplier(problem, previous.contact.traction);
  for (const auto& [at, rho_factor] : increment.augmented) {
    const auto equilibrium = scheme_equilibrium(method, problem.slots, at, rho_factor, 1);
    auto linearised = equilibrium.linearise(problem, previous, increment.time);
    for (auto& of_block : lambda)
      for (Eigen::Index k = 0; k < of_block.size(); ++k) of_block[k].v = at.multiplier[k];
    if (!linearised.solve(lambda)) return false;
    linearised.store_state(lambda);
    update_derivatives(lambda, linearised.fields());
  }
  problem.record = SchemeRecord{.passes = static_cast<int>(increment.augmented.size())};
  return true;
}

/// Carries the derivative by lambda back through all updates: finds x = c + A^T x and seeds the tractions with x. c:
/// the derivative by lambda that the outcome asks for; A: the linearised update. Anderson's extrapolation needs half
/// the passes of the series sum (A^T)^k c, or fewer. Derivatives that earlier passes have gathered are restored, so
/// those of the last pass alone remain. False if the passes reach their limit.
///
///   left         c + A^T x - x: the derivative by the lambda that the increment began with. It converges to zero,
///                except for the multiplier of a constraint that supports decide, which keeps its value of the last
///                increment
///   plain        x is the last image, not an extrapolation. Then `left` is the next term of the series, and its
///                changes tell whether the series has converged or stalled
///   contraction  of A; 0: not measured. Anderson's extrapolation hides it from the changes
bool iterate_back(AdjointProblem& problem, RecordedEquilibrium& recorded, int objective, double contraction,
                  Vector<double>& left) {
  constexpr double tolerance = 1e-14;
  constexpr double noise = 1e4 * unit_roundoff;  // changes below it that do not fall any more are rounding
  recorded.balance(objective);
  const Vector<double> asked = recorded.take_multiplier(objective);
  left = asked;
  if (left.size() == 0 || left.cwiseAbs().maxCoeff() == 0) return true;
  double area = 0, largest = 0, last = 0;
  for (const auto& geometry : problem.slots.geometry) area = std::max(area, geometry.area);
  const auto start = recorded.gathered(objective);
  Accelerator<double> accelerator(UzawaAL::Acceleration::anderson);
  Vector<double> x = asked;
  bool plain = true;
  detail::PassConvergence convergence;
  for (int pass = 1; pass <= detail::PassConvergence::limit; ++pass) {
    recorded.seed_traction(objective, x);
    recorded.balance(objective);
    const Vector<double> image = asked + recorded.take_multiplier(objective);
    const double change = (image - x - left).cwiseAbs().maxCoeff();
    left = image - x;
    largest = std::max(largest, image.cwiseAbs().maxCoeff());
    const double scale = std::max(largest, area * recorded.force_weight(objective));
    const double q = last > 0 ? change / last : 1;
    const double enough = tolerance * (1 - std::max(q, contraction < 1 ? contraction : 0.0)) * largest;
    const double negligible = std::max(enough, 4 * unit_roundoff * largest);
    const bool converged = change <= (pass > 2 ? negligible : 4 * unit_roundoff * largest);
    const bool stalled = q >= 1 && pass > 2 && change <= noise * scale;
    if (left.cwiseAbs().maxCoeff() <= negligible || (plain && (converged || stalled))) return true;
    if (convergence.is_hopeless(pass, left.cwiseAbs().maxCoeff(), negligible)) break;
    last = change;
    recorded.restore(objective, start);
    x = accelerator.next(x, image, true, q, [](Vector<double> v) { return v; });
    plain = x == image;
  }
  problem.status = Status::cap;
  problem.message = "the adjoint would not settle in 20000 passes; try a larger scale";
  return false;
}

/// Adjoint of the truncated scheme: goes back through all augmentations that were performed, the last one first.
bool pull_back_augmentations(const UzawaAL& method, AdjointProblem& problem, const State<double>& previous,
                             const Increment<double>& increment) {
  const int objectives = static_cast<int>(problem.objectives.size());
  std::vector<HistoryDerivative> gathered(objectives);
  std::vector<Vector<double>> traction(objectives);
  for (std::size_t k = increment.augmented.size(); k-- > 0;) {
    const auto& [at, rho_factor] = increment.augmented[k];
    const bool last = k + 1 == increment.augmented.size();
    const auto equilibrium = scheme_equilibrium(method, problem.slots, at, rho_factor, 1);
    auto recorded = equilibrium.record(problem, previous, increment.time, last && increment.requested);
    if (!recorded.valid()) return false;
    for (int j = 0; j < objectives; ++j) {
      if (last)
        recorded.seed_outcome(j);
      else
        recorded.seed_traction(j, traction[j]);
      recorded.balance(j);
      traction[j] = recorded.take_multiplier(j);
      const auto history = recorded.finish(j);
      if (last) {
        gathered[j] = history;
      } else {
        for_each_part([](Vector<double>& sum, const Vector<double>& part) { sum += part; }, gathered[j].local,
                      history.local);
      }
    }
  }
  for (int j = 0; j < objectives; ++j) {
    problem.objectives[j].history = gathered[j];
    problem.objectives[j].history.traction = traction[j];
  }
  return true;
}

}  // namespace

bool UzawaAL::differentiate_increment(Differentiation& problem, const State<double>& previous,
                                      const Increment<double>& increment) const {
  if (sensitivity == Sensitivity::truncated) return differentiate_augmentations(*this, problem, previous, increment);
  const bool preconditioned = sensitivity == Sensitivity::preconditioned;
  // (a pass of the preconditioned scheme divides the error by some thousand, so 1e-12 suffices)
  const double tolerance = preconditioned ? 1e-12 : 1e-13;
  const auto equilibrium = scheme_equilibrium(*this, problem, increment);
  auto linearised = equilibrium.linearise(problem, previous, increment.time);
  auto lambda = carried_multiplier(problem, equilibrium.state().multiplier);
  if (sensitivity == Sensitivity::oversized) {
    if (!linearised.solve(lambda)) return false;
    problem.record = SchemeRecord{.passes = 1};
  } else if (!iterate(problem, linearised, equilibrium.rho, lambda, tolerance)) {
    if (problem.status == Status::cap && !preconditioned) problem.message += other_scheme;
    return false;
  }
  problem.record->oversize = equilibrium.oversize;
  linearised.store_state(lambda);
  return true;
}

bool UzawaAL::pull_back_increment(AdjointProblem& problem, const State<double>& previous,
                                  const Increment<double>& increment) const {
  if (sensitivity == Sensitivity::truncated) return pull_back_augmentations(*this, problem, previous, increment);
  const bool preconditioned = sensitivity == Sensitivity::preconditioned;
  const double contraction = preconditioned ? 0 : increment.contraction;
  const auto equilibrium = scheme_equilibrium(*this, problem, increment);
  auto recorded = equilibrium.record(problem, previous, increment.time, increment.requested);
  if (!recorded.valid()) return false;
  for (int j = 0; j < static_cast<int>(problem.objectives.size()); ++j) {
    recorded.seed_outcome(j);
    Vector<double> carried;
    if (sensitivity == Sensitivity::oversized) {
      recorded.balance(j);
      carried = recorded.take_multiplier(j);
    } else if (!iterate_back(problem, recorded, j, contraction, carried)) {
      if (problem.status == Status::cap && !preconditioned) problem.message += other_scheme;
      return false;
    }
    problem.objectives[j].history = recorded.finish(j);
    problem.objectives[j].history.traction = carried;
  }
  return true;
}

}  // namespace stickslip
