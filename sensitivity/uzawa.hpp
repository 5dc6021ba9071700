/// Uzawa: the derivative of  lambda <- t(u(lambda), lambda)  mirrors the updates.
///
///   iterated        (two-phase) lambda first converges, then  D lambda <- D t(Du(D lambda), D lambda)  is repeated
///                   until settled, with one factorisation, and a back-solve a parameter and pass. After m passes the
///                   error is q^m, q the contraction of the updates. rho is a constant: Dg = 0 at the fixed point
///   truncated       (piggyback) one pass per augmentation that was performed, with its own tangent: the exact
///                   derivative of the truncated algorithm, for a loop that was cut off or stopped at a coarse
///                   tolerance
///   oversized       one pass with kappa_s rho in place of rho, states frozen: error O(1/kappa_s), no iteration [SZ00]
///   preconditioned  the iterated scheme with kappa_s rho in place of rho. Its fixed point is that of rho: Dg = 0 and
///                   D t_T = D(bound m) hold there, and rho stands in neither. A pass shrinks the error to
///                   1 / (1 + kappa_s rho s_min) of itself: four to six passes reach rounding, whatever q was
///
/// The repeated step D lambda <- D t is take_derivatives(). It is the derivative of the update lambda <- t of
/// methods/uzawa.hpp (AugmentationLoop::update). iterate_back() is its transpose.
///
/// kappa_s is `oversize`. Where it is automatic, the oversized scheme takes 1e3. The preconditioned one takes q / ((1 -
/// q) 5e-4): that turns the measured contraction q into one of 5e-4. It takes at least 300 nodal stiffnesses, for
/// directions that the updates did not excite, and at most 1e5. Why these numbers: rounding of D lambda grows as
/// kappa_s rho, and passes fall with it. They give four to six passes and errors below 1e-10 up to q = 0.995. With
/// 1e-4, 1e3 and 1e6 in their place there is one pass less, and an error of 4e-10.
///
/// All schemes begin with D lambda of the last increment as D lambda^0. Adjoint: the same maps transposed. The
/// derivative by t goes to lambda and back,  l <- l D t/D lambda,  until nothing is left (iterated; accelerated, as a
/// fixed point), augmentation by augmentation (truncated), or once. [SLK10 sec. 1], [CD20]
#pragma once

#include "methods/uzawa.hpp"
#include "sensitivity/direct.hpp"
#include "sensitivity/progress.hpp"
#include "sensitivity/pull_back.hpp"

namespace stickslip {

namespace detail {

inline constexpr std::string_view other_scheme = ", or the preconditioned scheme";

/// D lambda of the last increment on the value of `multiplier`.
template <class E>
std::vector<Vector<Direction>> carried_multiplier(Differentiation<E>& problem, const Vector<double>& multiplier) {
  std::vector<Vector<Direction>> lambda;
  for (auto& block : problem.blocks) {
    lambda.push_back(lift(multiplier));
    for (Eigen::Index k = 0; k < multiplier.size(); ++k) lambda.back()[k].d = block.previous.contact.traction[k].d;
  }
  return lambda;
}

/// D lambda <- D t of `fields`: the derivative of the update lambda <- t in methods/uzawa.hpp. Values stay.
inline void take_derivatives(std::vector<Vector<Direction>>& lambda,
                             const std::vector<ContactField<Direction>>& fields) {
  for (std::size_t b = 0; b < lambda.size(); ++b)
    for (Eigen::Index k = 0; k < lambda[b].size(); ++k) lambda[b][k].d = fields[b].traction[k].d;
}

template <class E>
LinearisedEquilibrium<E> linearise(const UzawaAL& method, Differentiation<E>& problem, const State<double>& previous,
                                   const State<double>& at, std::vector<double> factor, double oversize, double time,
                                   RegularisationField<double>& rho) {
  for (double& f : factor) f *= oversize;
  rho = adapted(initial_regularisation(problem.slots, method), factor);
  auto blocks = method.scheme().reads_regularisation ? regularisation_blocks(method, problem, factor)
                                                     : std::vector(problem.blocks.size(), constant<Direction>(rho));
  return LinearisedEquilibrium<E>(problem, at, rho, std::move(blocks), cone_radius(method), time, false,
                                  previous.history);
}

/// kappa_s of the preconditioned scheme, from the contraction of the updates (0: not measured).
inline double chosen_oversize(const UzawaAL& method, const Slots<double>& slots, const RegularisationField<double>& rho,
                              double contraction) {
  constexpr double target = 5e-4, least = 300, most = 1e5;  // contraction; the others are nodal stiffnesses
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

/// The state with another multiplier: the one whose trial, with kappa_s rho, is the traction that was found. In slip
/// the trial is on the edge of the cone. Why: kappa_s rho would magnify the violation that the augmentations left.
inline State<double> restated(const Model& model, State<double> at, const RegularisationField<double>& rho) {
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

/// Iterates D lambda <- D t, until all parameters have ended. With `change` the largest change of D lambda in a pass, q
/// the ratio of the last two changes and `floors` what rounding of rho Dg makes of a change, a parameter ends where
///
///   left <= enough   left = change q / (1 - q), the sum of all changes to come; enough: `tolerance` of D lambda
///   stalled          change <= floors, or the rounding of D lambda
///   drifts           constraints that repeat one another push each other's multiplier for ever by what rounding left
///                    between them: changes of 1e-11 that do not fall. A slow mode would need more than `limit` passes
///                    at such a q, and would not start at so small a change
///
/// Dg is rounded as its terms are, and as the forces are that balance in it. Example: tractions do not depend on a
/// thickness, so of its Dg nothing but that rounding is left.
template <class E>
bool iterate(Differentiation<E>& problem, LinearisedEquilibrium<E>& linearised, const RegularisationField<double>& rho,
             std::vector<Vector<Direction>>& lambda, std::vector<ContactField<Direction>>& fields, double tolerance) {
  double stiffest = 0, rho_over_k = 0;  // largest rho; largest rho over k: traction per force that rounds in a node
  for (std::size_t p = 0; p < rho.size(); ++p) {
    stiffest = std::max(stiffest, rho[p].normal);
    rho_over_k = std::max(rho_over_k, rho[p].normal / problem.slots.stiffness[p]);
  }
  Eigen::ArrayXd last = Eigen::ArrayXd::Zero(problem.parameters), carried = last;
  auto columns = [&](auto&& pick) { return gather(problem.blocks, problem.parameters, pick); };
  auto& record = problem.record.emplace();
  Progress progress;
  for (int pass = 1; pass <= Progress::limit; ++pass) {
    const Matrix<double> before = columns([&](auto&, int b) -> auto& { return lambda[b]; });
    if (!linearised.solve(lambda, fields)) return false;
    const Matrix<double> after = columns([&](auto&, int b) -> auto& { return fields[b].traction; });
    take_derivatives(lambda, fields);
    const Vector<double> floors =
        8 * unit_roundoff * (stiffest * linearised.largest_motion() + rho_over_k * linearised.load());
    bool settled = true;
    double slowest = 0;  // largest change / enough of a parameter that has not ended
    record = {pass, 1, 0};
    for (int j = 0; j < problem.parameters && after.rows() > 0; ++j) {
      const double change = (after.col(j) - before.col(j)).cwiseAbs().maxCoeff();
      const double size = after.col(j).cwiseAbs().maxCoeff();
      // (of a zero derivative, the size of what the last increment left tells how small that is)
      if (pass == 1) carried[j] = before.col(j).cwiseAbs().maxCoeff();
      const double q = last[j] > 0 ? change / last[j] : 1;
      const double left = q < 1 ? change * q / (1 - q) : change;
      const bool stalled = pass > 3 && change <= std::max(floors[j], 4 * unit_roundoff * std::max(size, carried[j]));
      const bool drifts = pass > 10 && q > 1 - 1e-4 && change <= 1e-11 * std::max(size, carried[j]);
      const double enough = std::max(tolerance * size, floors[j]);
      const bool ended = change == 0 || stalled || drifts || (q < 1 && pass > 2 && left <= enough);
      if (!ended) slowest = std::max(slowest, change / enough);
      settled &= ended;
      if (last[j] > 0 && change > floors[j]) record.contraction = std::max(record.contraction, q);
      last[j] = change;
    }
    if (settled) return true;
    if (progress.is_hopeless(pass, slowest, 1)) break;
  }
  problem.status = Status::cap;
  problem.message = "the derivatives would not settle in 20000 passes; try a larger scale";
  return false;
}

/// One pass for each augmentation that was performed.
template <class E>
bool differentiate_augmentations(const UzawaAL& method, Differentiation<E>& problem, const State<double>& previous,
                                 const Increment<double>& increment) {
  RegularisationField<double> rho;
  auto lambda = carried_multiplier(problem, previous.contact.traction);
  for (const auto& augmented : increment.augmented) {
    auto linearised =
        linearise(method, problem, previous, augmented.state, augmented.rho_factor, 1, increment.time, rho);
    if (!linearised.valid()) return false;
    for (std::size_t b = 0; b < lambda.size(); ++b)
      for (Eigen::Index k = 0; k < lambda[b].size(); ++k) lambda[b][k].v = augmented.state.multiplier[k];
    std::vector<ContactField<Direction>> fields;
    if (!linearised.solve(lambda, fields)) return false;
    linearised.settle(fields, lambda);
    take_derivatives(lambda, fields);
  }
  problem.record = {static_cast<int>(increment.augmented.size()), 1, 0};
  return true;
}

/// The fixed point of the recursion, with the factor of kappa_s rho.
template <class E>
bool differentiate_preconditioned(const UzawaAL& method, Differentiation<E>& problem, const State<double>& previous,
                                  const Increment<double>& increment) {
  const auto own = adapted(initial_regularisation(problem.slots, method), increment.rho_factor);
  const double oversize = chosen_oversize(method, problem.slots, own, increment.contraction);
  const auto rho = adapted(own, std::vector<double>(own.size(), oversize));
  const std::vector blocks(problem.blocks.size(), constant<Direction>(rho));
  const State<double> at = restated(problem.model, increment.state, rho);
  LinearisedEquilibrium<E> linearised(problem, at, rho, blocks, cone_radius(method), increment.time, false,
                                      previous.history);
  if (!linearised.valid()) return false;
  auto lambda = carried_multiplier(problem, at.multiplier);
  std::vector<ContactField<Direction>> fields;
  // (a pass divides the error by some thousand, so that 1e-12 is enough where other schemes ask for 1e-13)
  if (!iterate(problem, linearised, rho, lambda, fields, 1e-12)) return false;
  problem.record->oversize = oversize;
  linearised.settle(fields, lambda);
  return true;
}

}  // namespace detail

template <class E>
bool differentiate_increment(const UzawaAL& method, Differentiation<E>& problem, const State<double>& previous,
                             const Increment<double>& increment) {
  using Sensitivity = UzawaAL::Sensitivity;
  if (method.sensitivity == Sensitivity::truncated)
    return detail::differentiate_augmentations(method, problem, previous, increment);
  if (method.sensitivity == Sensitivity::preconditioned)
    return detail::differentiate_preconditioned(method, problem, previous, increment);
  const bool oversized = method.sensitivity == Sensitivity::oversized;
  const double oversize = method.scheme().oversize;
  RegularisationField<double> rho;
  auto linearised = detail::linearise(method, problem, previous, increment.state, increment.rho_factor, oversize,
                                      increment.time, rho);
  if (!linearised.valid()) return false;
  auto lambda = detail::carried_multiplier(problem, increment.state.multiplier);
  std::vector<ContactField<Direction>> fields;
  if (oversized) {
    if (!linearised.solve(lambda, fields)) return false;
    problem.record = {1, oversize, 0};
  } else if (!detail::iterate(problem, linearised, rho, lambda, fields, 1e-13)) {
    if (problem.status == Status::cap) problem.message += detail::other_scheme;
    return false;
  }
  linearised.settle(fields, lambda);
  return true;
}

namespace detail {

/// rho of the loop times `oversize`; where the scheme depends on it, recorded on the tape, which is rewound.
template <class E>
RegularisationField<Reverse> recorded_regularisation(const UzawaAL& method, AdjointProblem<E>& problem,
                                                     std::vector<double> factor, double oversize) {
  for (double& f : factor) f *= oversize;
  problem.tape.rewind(problem.slots_end);
  if (!method.scheme().reads_regularisation)
    return constant<Reverse>(adapted(initial_regularisation(problem.slots, method), factor));
  return adapted(initial_regularisation(problem.recorded, method), factor);
}

/// Moves the derivative by lambda back through all updates. c: that derivative, as the outcome asks for it; A: the
/// linearised update. Finds x = c + A^T x, and moves x. Anderson's extrapolation takes half the passes of the series
/// sum (A^T)^k c, or less. What the last pass moved stays moved; what the passes before it moved is put back.
///
///   left         c + A^T x - x: the derivative by the lambda that the increment began with. It settles at zero, but
///                for the multiplier of a constraint that supports decide: that keeps the last increment's
///   plain        x is the last image, not an extrapolation: `left` is then the next term of the series, so that its
///                changes tell whether it has settled or stalled
///   contraction  of A, as far as it is known (0: not), for changes under Anderson's extrapolation hide it
template <class E>
bool iterate_back(AdjointProblem<E>& problem, RecordedEquilibrium<E>& recorded, int objective, double contraction,
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
  Progress progress;
  for (int pass = 1; pass <= Progress::limit; ++pass) {
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
    const bool settled = change <= (pass > 2 ? negligible : 4 * unit_roundoff * largest);
    const bool stalled = q >= 1 && pass > 2 && change <= noise * scale;
    if (left.cwiseAbs().maxCoeff() <= negligible || (plain && (settled || stalled))) return true;
    if (progress.is_hopeless(pass, left.cwiseAbs().maxCoeff(), negligible)) break;
    last = change;
    recorded.restore(objective, start);
    x = accelerator.next(x, image, true, q, [](Vector<double> v) { return v; });
    plain = x == image;
  }
  problem.status = Status::cap;
  problem.message = "the adjoint would not settle in 20000 passes; try a larger scale";
  return false;
}

/// Goes back through all augmentations that were performed, the last one first.
template <class E>
bool pull_back_augmentations(const UzawaAL& method, AdjointProblem<E>& problem, const State<double>& previous,
                             const Increment<double>& increment) {
  const int objectives = static_cast<int>(problem.objectives.size());
  std::vector<HistoryDerivative> gathered(objectives);
  std::vector<Vector<double>> traction(objectives);
  for (std::size_t k = increment.augmented.size(); k-- > 0;) {
    const auto& augmented = increment.augmented[k];
    const bool last = k + 1 == increment.augmented.size();
    RecordedEquilibrium<E> recorded(problem, previous, augmented.state,
                                    recorded_regularisation(method, problem, augmented.rho_factor, 1),
                                    cone_radius(method), increment.time, false, last && increment.requested);
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

/// The fixed point, or one pass, from an equilibrium recorded with a scheme's rho.
template <class E>
bool pull_back_fixed_point(AdjointProblem<E>& problem, RecordedEquilibrium<E>& recorded, bool once,
                           double contraction) {
  if (!recorded.valid()) return false;
  for (int j = 0; j < static_cast<int>(problem.objectives.size()); ++j) {
    recorded.seed_outcome(j);
    Vector<double> carried;
    if (once) {
      recorded.balance(j);
      carried = recorded.take_multiplier(j);
    } else if (!iterate_back(problem, recorded, j, contraction, carried)) {
      return false;
    }
    problem.objectives[j].history = recorded.finish(j);
    problem.objectives[j].history.traction = carried;
  }
  return true;
}

/// The fixed point with the factor of kappa_s rho, which is a constant: the fixed point does not depend on rho.
template <class E>
bool pull_back_preconditioned(const UzawaAL& method, AdjointProblem<E>& problem, const State<double>& previous,
                              const Increment<double>& increment) {
  const auto own = adapted(initial_regularisation(problem.slots, method), increment.rho_factor);
  const double oversize = chosen_oversize(method, problem.slots, own, increment.contraction);
  const auto rho = adapted(own, std::vector<double>(own.size(), oversize));
  const State<double> at = restated(problem.model, increment.state, rho);
  problem.tape.rewind(problem.slots_end);
  RecordedEquilibrium<E> recorded(problem, previous, at, constant<Reverse>(rho), cone_radius(method), increment.time,
                                  false, increment.requested);
  return pull_back_fixed_point(problem, recorded, false, 0);
}

}  // namespace detail

template <class E>
bool pull_back_increment(const UzawaAL& method, AdjointProblem<E>& problem, const State<double>& previous,
                         const Increment<double>& increment) {
  using Sensitivity = UzawaAL::Sensitivity;
  if (method.sensitivity == Sensitivity::truncated)
    return detail::pull_back_augmentations(method, problem, previous, increment);
  if (method.sensitivity == Sensitivity::preconditioned)
    return detail::pull_back_preconditioned(method, problem, previous, increment);
  const bool oversized = method.sensitivity == Sensitivity::oversized;
  const double oversize = method.scheme().oversize;
  RecordedEquilibrium<E> recorded(problem, previous, increment.state,
                                  detail::recorded_regularisation(method, problem, increment.rho_factor, oversize),
                                  cone_radius(method), increment.time, false, increment.requested);
  const bool settled = detail::pull_back_fixed_point(problem, recorded, oversized, increment.contraction);
  if (!settled && problem.status == Status::cap) problem.message += detail::other_scheme;
  return settled;
}

}  // namespace stickslip
