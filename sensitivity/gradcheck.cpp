#include "sensitivity/gradcheck.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/response.hpp"
#include "sensitivity/adjoint.hpp"

namespace stickslip {
namespace {

constexpr double relative_steps[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7};
constexpr double base_tolerance = 1e-8;

/// Values of one run. Rows: responses, then objectives, which have a value in the last column alone.
struct Path {
  Matrix<double> values;  ///< one column per increment
  std::vector<std::vector<ContactState>> states;
  std::vector<std::vector<bool>> flowing;  ///< per number of the bodies' memory: whether the increment changed it
  bool usable = false;
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
    const auto& before = (n == 0 ? trajectory.initial : trajectory.increments[n - 1].state).history.bodies;
    const auto& after = increment.state.history.bodies;
    path.flowing.emplace_back(after.size());
    for (Eigen::Index i = 0; i < after.size(); ++i) path.flowing.back()[i] = after[i] != before[i];
  }
  if (path.values.cols() > 0)
    path.values.rightCols(1).bottomRows(objectives) = objective_values(model, slots, trajectory);
  path.usable = trajectory.increments.size() == options.replay.size() && path.values.allFinite() &&
                std::all_of(trajectory.increments.begin(), trajectory.increments.end(),
                            [](const auto& increment) { return increment.usable(); });
  return path;
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

/// Central differences of one parameter at each usable step: responses x increments.
struct Differences {
  std::vector<double> step;  ///< absolute
  std::vector<Matrix<double>> values;
};

/// Best extrapolated derivative of one entry, and its error estimate.
struct Extrapolated {
  double value = 0, estimate = std::numeric_limits<double>::infinity(), step = 0;
};

Extrapolated extrapolate(const Differences& differences, Eigen::Index i, Eigen::Index n, double rounding) {
  std::vector<double> values;  // extrapolated from each pair of neighbouring steps
  for (std::size_t k = 0; k + 1 < differences.step.size(); ++k) {
    const double ratio = differences.step[k] / differences.step[k + 1], r2 = ratio * ratio;
    values.push_back((r2 * differences.values[k + 1](i, n) - differences.values[k](i, n)) / (r2 - 1));
  }
  Extrapolated best;
  for (std::size_t k = 0; k < values.size(); ++k) {
    // The distance to the neighbouring values shows the truncation error (large steps) and the noise of the solver
    // (small steps). A pair without neighbours has only its own correction as an estimate.
    double spread = values.size() == 1 ? std::abs(values[k] - differences.values[k + 1](i, n)) : 0;
    if (k > 0) spread = larger(spread, std::abs(values[k] - values[k - 1]));
    if (k + 1 < values.size()) spread = larger(spread, std::abs(values[k] - values[k + 1]));
    const double estimate = spread + rounding / differences.step[k + 1];
    if (estimate < best.estimate) best = {values[k], estimate, differences.step[k + 1]};
  }
  return best;
}

/// Upper bound of the solver's noise in response i. Two neighbouring differences disagree by noise / step and by
/// truncation. The bound is the least disagreement times step over all pairs, each at its worst increment.
double noise(const Differences& differences, Eigen::Index i) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < differences.step.size(); ++k) {
    double apart = 0;
    for (Eigen::Index n = 0; n < differences.values[k].cols(); ++n)
      apart = larger(apart, std::abs(differences.values[k](i, n) - differences.values[k + 1](i, n)));
    least = std::min(least, apart * differences.step[k + 1]);
  }
  return least;
}

}  // namespace

bool GradientCheck::passed() const {
  return !entries.empty() &&
         std::all_of(entries.begin(), entries.end(), [](const Entry& e) { return e.verdict == Verdict::agrees; });
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
std::vector<Matrix<double>> computed_derivatives(const Model& model, const Slots<double>& slots, const Method& method,
                                                 const Trajectory<double>& trajectory, Workspace<double>& workspace,
                                                 GradientCheck& check) {
  const auto& scene = model.scene;
  const bool direct = scene.sensitivity_mode == SensitivityMode::direct;
  auto gradients = direct ? differentiate(model, slots, method, trajectory, workspace)
                          : adjoint(model, slots, method, trajectory, workspace);
  if (direct) gradients.of_objectives = objective_gradients(model, slots, trajectory, gradients);
  const bool complete =
      direct ? gradients.of_responses.size() == trajectory.increments.size() : gradients.of_objectives.size() > 0;
  if (!complete && !gradients.message.empty()) check.message = gradients.message;
  if (!complete || scene.parameters.empty()) return {};
  const auto responses = static_cast<Eigen::Index>(scene.responses.size());
  const auto objectives = static_cast<Eigen::Index>(scene.objectives.size());
  std::vector<Matrix<double>> computed(trajectory.increments.size(),
                                       Matrix<double>::Zero(responses + objectives, scene.parameters.size()));
  for (std::size_t n = 0; n < gradients.of_responses.size(); ++n)
    computed[n].topRows(responses) = gradients.of_responses[n];
  if (objectives > 0) computed.back().bottomRows(objectives) = gradients.of_objectives;
  return computed;
}

/// Central differences by parameter j, at the steps whose runs have the states of the base run.
Differences difference(const Model& model, const Method& method, const RunOptions& replay, const Path& base, int j,
                       double size, const std::function<void(int, int)>& progress, GradientCheck& check) {
  const Parameter& parameter = model.scene.parameters[j];
  const int total = static_cast<int>(model.scene.parameters.size() * std::size(relative_steps)) * 2;
  const auto numbers = model.scene.as<double>();
  Differences differences;
  for (double relative : relative_steps) {
    const double h = relative * size;
    Path side[2];
    for (int s = 0; s < 2; ++s) {
      auto shifted = numbers;
      for (const auto& [slot, weight] : parameter.slots) shifted.at_slot[slot] += (s == 0 ? -h : h) * weight;
      side[s] = run(model, shifted, method, replay);
      if (progress) progress(++check.runs, total);
    }
    const auto is_other = [&](const Path& path) {
      return !path.usable || path.states != base.states || path.flowing != base.flowing;
    };
    if (is_other(side[0]) || is_other(side[1])) {
      check.rejected += 2;
      continue;
    }
    differences.step.push_back(h);
    differences.values.push_back((side[1].values - side[0].values) / (2 * h));
  }
  return differences;
}

/// Compares row i with its differences at its increments, and records the worst.
void compare(const Differences& differences, const std::vector<Matrix<double>>& computed, int i, int j,
             const std::vector<double>& times, double size, double largest, double scheme,
             GradientCheck::Entry& worst) {
  double excess = -1;
  for (Eigen::Index n = 0; n < static_cast<Eigen::Index>(times.size()) && differences.step.size() >= 2; ++n) {
    if (std::isnan(times[n])) continue;
    const double rounding = std::max(1e-14 * largest, noise(differences, i));
    const auto best = extrapolate(differences, i, n, rounding);
    const double scale = worst.scale > 0 ? worst.scale : 1;
    const double error = std::abs(computed[n](i, j) - best.value) / scale, estimate = best.estimate / scale;
    const double allowed = std::max(scheme, estimate);
    if (std::isnan(excess) || error / allowed <= excess) continue;  // NaN counts as the worst
    excess = error / allowed;
    worst.time = times[n];
    worst.computed = computed[n](i, j);
    worst.difference = best.value;
    worst.error = error;
    worst.estimate = estimate;
    worst.allowed = allowed;
    worst.step = best.step / size;
    // a difference of less than three digits checks nothing
    worst.verdict = estimate > 1e-3    ? GradientCheck::Verdict::not_checked
                    : error <= allowed ? GradientCheck::Verdict::agrees
                                       : GradientCheck::Verdict::differs;
  }
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
  const auto computed = computed_derivatives(model, slots, method, trajectory, workspace, check);
  if (computed.empty()) return check;
  const RunOptions replay = repeating(options, model, trajectory);
  const Path base = run(model, numbers, method, replay);

  const Matrix<double> largest_value = base.values.cwiseAbs().rowwise().maxCoeff();
  Matrix<double> largest_derivative = Matrix<double>::Zero(base.values.rows(), scene.parameters.size());
  for (const auto& g : computed) largest_derivative = largest_derivative.cwiseMax(g.cwiseAbs());
  std::vector<double> ends(trajectory.increments.size(), std::numeric_limits<double>::quiet_NaN()), last = ends;
  for (std::size_t n = 0; n < ends.size(); ++n)
    if (trajectory.increments[n].requested) ends[n] = trajectory.increments[n].time;
  last.back() = ends.back();
  const double allowed = scheme_of(method).error, scheme = allowed > 0 ? allowed : base_tolerance;
  const int responses = static_cast<int>(scene.responses.size());
  for (int j = 0; j < static_cast<int>(scene.parameters.size()); ++j) {
    const double size = parameter_size(scene.parameters[j], largest_value, largest_derivative, j);
    const auto differences = difference(model, method, replay, base, j, size, progress, check);
    const int first = scene.sensitivity_mode == SensitivityMode::direct ? 0 : responses;
    for (int i = first; i < static_cast<int>(base.values.rows()); ++i) {
      const bool objective = i >= responses;
      GradientCheck::Entry entry;
      entry.response = objective ? scene.objectives[i - responses].name : scene.responses[i].name;
      entry.parameter = scene.parameters[j].name;
      entry.scale = std::max(largest_derivative(i, j), largest_value(i, 0) / size);
      compare(differences, computed, i, j, objective ? last : ends, size, largest_value(i, 0), scheme, entry);
      check.entries.push_back(entry);
    }
  }
  return check;
}

}  // namespace stickslip
