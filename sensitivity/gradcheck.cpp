#include "sensitivity/gradcheck.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/model/response.hpp"
#include "sensitivity/adjoint.hpp"
#include "sensitivity/one_sided.hpp"
#include "sensitivity/open_responses.hpp"
#include "sensitivity/quotients.hpp"
#include "sensitivity/vertex_margin.hpp"
#include "sensitivity/whole_states.hpp"

namespace stickslip {
namespace {

constexpr double relative_steps[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7};
constexpr double base_tolerance = 1e-8;

/// Values of one run. Rows: responses, then objectives, which have a value in the last column alone.
struct Path {
  Matrix<double> values;  ///< one column per increment
  std::vector<std::vector<ContactState>> states;
  std::vector<std::vector<bool>> flowing;  ///< per number of the bodies' memory: whether the increment changed it
  Eigen::Index usable = 0;                 ///< number of increments up to the first without a solution
};

Path run(const Model& model, const Numbers<double>& numbers, const Method& method, const RunOptions& options) {
  const auto slots = make_slots<double>(model, numbers);
  const auto trajectory = solve(model, slots, method, options);
  const auto responses = static_cast<Eigen::Index>(model.scene.responses.size());
  const auto objectives = static_cast<Eigen::Index>(model.scene.objectives.size());
  Path path;
  path.values = Matrix<double>::Zero(responses + objectives, trajectory.increments.size());
  for (std::size_t n = 0; n < trajectory.increments.size(); ++n) {
    const auto& increment = trajectory.increments[n];
    path.values.col(n).head(responses) = evaluate_responses(model, slots, increment.state, increment.time);
    path.states.push_back(increment.state.contact.state);
    const auto& before = trajectory.before(n).history.bodies;
    const auto& after = increment.state.history.bodies;
    path.flowing.emplace_back(after.size());
    for (Eigen::Index i = 0; i < after.size(); ++i) path.flowing.back()[i] = after[i] != before[i];
  }
  const bool complete = trajectory.increments.size() == options.replay.size();
  if (complete && objectives > 0)
    path.values.rightCols(1).bottomRows(objectives) = objective_values(model, slots, trajectory);
  while (path.usable < path.values.cols() && trajectory.increments[path.usable].usable() &&
         path.values.col(path.usable).allFinite())
    ++path.usable;
  if (!complete && path.usable == path.values.cols() && path.usable > 0) --path.usable;  // where it stopped
  return path;
}

/// Number of increments that two runs have in common: with solutions, and with the same states of contact and flow.
Eigen::Index in_common(const Path& a, const Path& b) {
  Eigen::Index n = 0;
  while (n < std::min(a.usable, b.usable) && a.states[n] == b.states[n] && a.flowing[n] == b.flowing[n]) ++n;
  return n;
}

/// Size of a parameter: its absolute value. If that is zero: the change that would change a response by its own size.
double parameter_size(const Parameter& parameter, const Matrix<double>& largest_response,
                      const Matrix<double>& largest_derivative, int j) {
  if (parameter.value != 0) return std::abs(parameter.value);
  double size = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < largest_response.rows(); ++i)
    if (largest_derivative(i, j) > 0 && largest_response(i, 0) > 0)
      size = std::min(size, largest_response(i, 0) / largest_derivative(i, j));
  return std::isfinite(size) ? size : 1;
}

/// Quotients of one parameter. At an increment with ties the runs of a side are those that share the states of the run
/// with the smallest step, elsewhere those that share the states of the base run.
struct Differences {
  Quotients central{2, {}, {}}, below{1, {}, {}}, above{1, {}, {}};
};

}  // namespace

bool GradientCheck::passed() const {
  const auto agrees = [](const Entry& e) { return e.verdict == Verdict::agrees; };
  const auto may_pass = [&](const Entry& e) { return agrees(e) || e.verdict == Verdict::undetermined; };
  return std::any_of(entries.begin(), entries.end(), agrees) && std::all_of(entries.begin(), entries.end(), may_pass);
}

Method as_claimed(const Method& method) {
  constexpr double tightest = 1e-14;
  constexpr int most_augmentations = 20'000;
  Method claimed = method;
  std::visit(
      [](auto& m) {
        if (m.scheme().of_each_augmentation)  // these are part of what it differentiates
          m.newton.tighten(tightest);
        else
          m.tighten(tightest, most_augmentations);
      },
      claimed);
  return claimed;
}

namespace {

/// Computed derivatives: per increment a matrix, rows of Path::values x parameters. Those of responses are zero in the
/// adjoint mode. Empty after a failure.
struct Computed {
  std::vector<Matrix<double>> derivatives;
  std::vector<Matrix<double>> below, above;  ///< the same from each side, where ties or kinks make a difference
  bool sides_known = true;                   ///< false: there are ties, and too many parameters for their sides
  std::vector<std::vector<char>> open;       ///< per increment and row, whether it is undetermined; empty: none is
  bool is_open(Eigen::Index i, Eigen::Index n) const { return !open[n].empty() && open[n][i]; }
  /// Whether the two sides of an entry differ by more than `allowed`, or a side has no derivative.
  bool has_sides(Eigen::Index i, Eigen::Index n, int j, double allowed) const {
    return !below.empty() && !(std::abs(above[n](i, j) - below[n](i, j)) <= allowed);
  }
};

/// One-sided derivatives of responses, in place of the derivatives: where a point is at a tie, the geometry has a kink,
/// or a largest value is taken of several that tie. None where there is nothing of that kind.
std::optional<OneSided> sides_of(const Model& model, const Slots<double>& slots, const Method& method,
                                 const Trajectory<double>& trajectory, Workspace<double>& workspace,
                                 const Gradients& gradients) {
  auto sides = one_sided_derivatives(model, slots, method, trajectory, workspace);
  if (!sides && !gradients.from_below.empty()) sides = OneSided{gradients.from_below, gradients.from_above};
  if (!model.slides_on_surfaces() || (sides && sides->backward.empty())) return sides;
  WholeStates states(model, slots, method, trajectory, workspace);
  for (std::size_t n = 0; n < states.count(); ++n) {
    const auto& increment = states.increment(n);
    if (integration_margin(model, slots, increment.state, increment.time) > weak_margin) continue;
    if (!sides && gradients.of_responses.empty()) sides = OneSided{};  // of an adjoint they are not known
    if (!sides) sides = OneSided{gradients.of_responses, gradients.of_responses};
    if (sides->backward.empty()) return sides;
    sides->backward[n].setConstant(std::numeric_limits<double>::quiet_NaN());  // and neither is known
    sides->forward[n] = sides->backward[n];
  }
  return sides;
}

/// Per increment, which rows of Path::values equilibrium does not determine.
std::vector<std::vector<char>> open_rows(const Model& model, const Slots<double>& slots, const Method& method,
                                         const Trajectory<double>& trajectory, Workspace<double>& workspace) {
  std::vector<std::vector<char>> open(trajectory.increments.size());
  const OpenResponses search(model, slots, method);
  if (!search.is_called_for()) return open;
  std::vector<std::pair<double, std::vector<char>>> steps;
  WholeStates states(model, slots, method, trajectory, workspace);
  for (std::size_t n = 0; n < open.size(); ++n) {
    const auto& increment = states.increment(n);
    if (!increment.requested) continue;
    const double time = trajectory.increments[n].time;
    open[n] = search.of(increment.state, time, evaluate_responses(model, slots, increment.state, time)).responses;
    steps.emplace_back(time, open[n]);
  }
  const auto objectives = open_objectives(model, slots, steps);
  open.back().resize(model.scene.responses.size(), 0);
  open.back().insert(open.back().end(), objectives.begin(), objectives.end());
  return open;
}

Computed compute(const Model& model, const Slots<double>& slots, const Method& method,
                 const Trajectory<double>& trajectory, Workspace<double>& workspace, GradientCheck& check) {
  const auto& scene = model.scene;
  const bool direct = scene.sensitivity_mode == SensitivityMode::direct;
  auto gradients = direct ? differentiate(model, slots, method, trajectory, workspace)
                          : adjoint(model, slots, method, trajectory, workspace);
  if (direct) gradients.of_objectives = objective_gradients(model, slots, trajectory, gradients.of_responses);
  const bool complete =
      direct ? gradients.of_responses.size() == trajectory.increments.size() : gradients.of_objectives.size() > 0;
  if (!complete && !gradients.message.empty()) check.message = gradients.message;
  if (!complete || scene.parameters.empty()) return {};
  const auto responses = static_cast<Eigen::Index>(scene.responses.size());
  const auto objectives = static_cast<Eigen::Index>(scene.objectives.size());
  const auto rows = [&](const std::vector<Matrix<double>>& of_responses, const Matrix<double>& of_objectives) {
    std::vector<Matrix<double>> all(trajectory.increments.size(),
                                    Matrix<double>::Zero(responses + objectives, scene.parameters.size()));
    for (std::size_t n = 0; n < of_responses.size(); ++n) all[n].topRows(responses) = of_responses[n];
    if (objectives > 0) all.back().bottomRows(objectives) = of_objectives;
    return all;
  };
  Computed computed{.derivatives = rows(gradients.of_responses, gradients.of_objectives)};
  computed.open = open_rows(model, slots, method, trajectory, workspace);
  const auto sides = sides_of(model, slots, method, trajectory, workspace, gradients);
  if (!sides) return computed;
  computed.sides_known = !sides->backward.empty();
  if (!computed.sides_known) return computed;
  std::vector<Vector<double>> values;
  WholeStates states(model, slots, method, trajectory, workspace);
  for (std::size_t n = 0; n < states.count(); ++n)
    values.push_back(evaluate_responses(model, slots, states.increment(n).state, trajectory.increments[n].time));
  const auto rows_of = [&](const std::vector<Matrix<double>>& side) {
    return rows(side, objective_gradients(model, trajectory, values, side));
  };
  computed.below = rows_of(sides->backward);
  computed.above = rows_of(sides->forward);
  return computed;
}

/// Runs the differences by parameter j. `ties`: whether the base run has increments with ties.
Differences difference(const Model& model, const Method& method, const RunOptions& replay, const Path& base, int j,
                       double size, bool ties, const std::function<void(int, int)>& progress, GradientCheck& check) {
  const Parameter& parameter = model.scene.parameters[j];
  const int total = static_cast<int>(model.scene.parameters.size() * std::size(relative_steps)) * 2;
  const auto numbers = model.scene.as<double>();
  std::vector<std::array<Path, 2>> runs;  // per step: below, above
  for (double relative : relative_steps) {
    runs.emplace_back();
    for (int s = 0; s < 2; ++s) {
      auto shifted = numbers;
      const double h = (s == 0 ? -relative : relative) * size;
      for (const auto& [slot, weight] : parameter.slots) shifted.at_slot[slot] += h * weight;
      runs.back()[s] = run(model, shifted, method, replay);
      if (in_common(runs.back()[s], base) < base.values.cols()) ++check.rejected;
      if (progress) progress(++check.runs, total);
    }
  }
  Differences differences;
  const auto unknown =
      Matrix<double>::Constant(base.values.rows(), base.values.cols(), std::numeric_limits<double>::quiet_NaN());
  const auto add = [&](Quotients& to, double step, const Path& from, const Path& till, Eigen::Index count) {
    const int steps = &from == &base || &till == &base ? 1 : 2;  // from one to the other
    to.step.push_back(step);
    to.values.push_back(unknown);
    to.values.back().leftCols(count) = (till.values.leftCols(count) - from.values.leftCols(count)) / (steps * step);
  };
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const double h = relative_steps[k] * size;
    const auto& [below, above] = runs[k];
    add(differences.central, h, below, above, std::min(in_common(below, base), in_common(above, base)));
    add(differences.below, h, below, base, in_common(below, ties ? runs.back()[0] : base));
    add(differences.above, h, base, above, in_common(above, ties ? runs.back()[1] : base));
  }
  return differences;
}

/// Comparisons of one entry, of which the worst is kept.
struct Comparisons {
  GradientCheck::Entry& worst;
  int row;
  double scheme, rounding, size;
  double excess = -1;  ///< of the worst: error over what is allowed; below zero: nothing was compared yet

  /// False if the quotients do not tell the derivative.
  bool compare(double computed, const Quotients& quotients, double noise, int side, Eigen::Index n, double time) {
    constexpr double three_digits = 1e-3;
    const int needed = side == 0 ? 2 : 3;  // of one side more terms are left in the difference
    if (quotients.count(row, n) < needed) return false;
    const auto best = extrapolate(quotients, row, n, std::max(rounding, noise));
    const double scale = worst.scale > 0 ? worst.scale : 1;
    const double error = std::abs(computed - best.value) / scale, estimate = best.estimate / scale;
    if (!(estimate <= three_digits)) return false;
    const double allowed = std::max(scheme, estimate);
    if (std::isnan(excess) || error / allowed <= excess) return true;  // NaN counts as the worst
    excess = error / allowed;
    worst.time = time;
    worst.side = side;
    worst.computed = computed;
    worst.difference = best.value;
    worst.error = error;
    worst.estimate = estimate;
    worst.allowed = allowed;
    worst.step = best.step / size;
    return true;
  }
};

/// Compares one row with its quotients at its increments.
void compare(const Differences& differences, const Computed& computed, int j, const std::vector<double>& times,
             Comparisons& comparisons) {
  auto& entry = comparisons.worst;
  const int i = comparisons.row;
  const double noises[] = {noise(differences.below, i), noise(differences.central, i), noise(differences.above, i)};
  for (Eigen::Index n = 0; n < static_cast<Eigen::Index>(times.size()); ++n) {
    if (std::isnan(times[n])) continue;
    if (computed.is_open(i, n)) {
      ++entry.undetermined;
      continue;
    }
    const auto check = [&](double derivative, const Quotients& quotients, int side) {
      return comparisons.compare(derivative, quotients, noises[side + 1], side, n, times[n]);
    };
    bool checked = false;
    // (Where the runs of both sides share the states of the base run, they tell the derivative itself: of a node that
    // faces a node they keep the pairing, and so the mean of the two sides.)
    const bool shared = differences.central.count(i, n) >= 2;
    if (!shared && computed.has_sides(i, n, j, comparisons.scheme * entry.scale)) {
      const double below = computed.below[n](i, j), above = computed.above[n](i, j);
      const bool from_below = !std::isnan(below) && check(below, differences.below, -1);
      const bool from_above = !std::isnan(above) && check(above, differences.above, 1);
      checked = from_below && from_above;
    } else {
      const double derivative = computed.derivatives[n](i, j);
      checked = check(derivative, differences.central, 0) ||
                (computed.sides_known &&
                 (check(derivative, differences.below, -1) || check(derivative, differences.above, 1)));
    }
    ++entry.steps;
    if (!checked && entry.unchecked++ == 0) entry.unchecked_at = times[n];
  }
  using Verdict = GradientCheck::Verdict;
  if (entry.steps == 0 && entry.undetermined > 0)
    entry.verdict = Verdict::undetermined;
  else if (!(comparisons.excess <= 1))
    entry.verdict = Verdict::differs;
  else if (entry.steps > 0 && entry.unchecked == 0)
    entry.verdict = Verdict::agrees;
}

}  // namespace

GradientCheck check_gradients(const Model& model, const Method& given, const RunOptions& options,
                              const std::function<void(int, int)>& progress) {
  GradientCheck check;
  const Scene& scene = model.scene;
  const Method method = as_claimed(given);
  const auto numbers = scene.as<double>();
  const auto slots = make_slots<double>(model, numbers);
  Workspace<double> workspace;
  const auto trajectory = solve(model, slots, method, options, workspace);
  check.status = trajectory.status;
  check.message = trajectory.message;
  const auto computed = compute(model, slots, method, trajectory, workspace, check);
  if (computed.derivatives.empty()) return check;
  const RunOptions replay = repeating(options, model, trajectory);
  const Path base = run(model, numbers, method, replay);

  const Matrix<double> largest_value = base.values.cwiseAbs().rowwise().maxCoeff();
  Matrix<double> largest_derivative = Matrix<double>::Zero(base.values.rows(), scene.parameters.size());
  for (const auto& g : computed.derivatives) largest_derivative = largest_derivative.cwiseMax(g.cwiseAbs());
  std::vector<double> ends(trajectory.increments.size(), std::numeric_limits<double>::quiet_NaN()), last = ends;
  for (std::size_t n = 0; n < ends.size(); ++n)
    if (trajectory.increments[n].requested) ends[n] = trajectory.increments[n].time;
  last.back() = ends.back();
  const double allowed = scheme_of(method).error, scheme = allowed > 0 ? allowed : base_tolerance;
  const int responses = static_cast<int>(scene.responses.size());
  for (int j = 0; j < static_cast<int>(scene.parameters.size()); ++j) {
    const double size = parameter_size(scene.parameters[j], largest_value, largest_derivative, j);
    const auto differences = difference(model, method, replay, base, j, size, !computed.below.empty(), progress, check);
    const int first = scene.sensitivity_mode == SensitivityMode::direct ? 0 : responses;
    for (int i = first; i < static_cast<int>(base.values.rows()); ++i) {
      const bool objective = i >= responses;
      GradientCheck::Entry entry;
      entry.response = objective ? scene.objectives[i - responses].name : scene.responses[i].name;
      entry.parameter = scene.parameters[j].name;
      entry.scale = std::max(largest_derivative(i, j), largest_value(i, 0) / size);
      Comparisons comparisons{entry, i, scheme, 1e-14 * largest_value(i, 0), size};
      compare(differences, computed, j, objective ? last : ends, comparisons);
      check.entries.push_back(entry);
    }
  }
  return check;
}

}  // namespace stickslip
