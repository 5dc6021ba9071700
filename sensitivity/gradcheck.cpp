#include "sensitivity/gradcheck.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/model/response.hpp"

namespace stickslip {
namespace {

constexpr double relative_steps[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7};
constexpr double base_tolerance = 1e-8;

/// Responses of one run, one column an increment, and what it takes to compare its path with another.
struct Path {
  Matrix<double> responses;
  std::vector<std::vector<ContactState>> states;
  bool usable = false;
};

Path run(const Model& model, const Numbers<double>& numbers, const Method& method, const RunOptions& options) {
  const auto slots = make_slots<double>(model, numbers);
  const auto trajectory = solve(model, slots, method, options);
  Path path;
  path.responses.resize(model.scene.responses.size(), trajectory.increments.size());
  for (std::size_t n = 0; n < trajectory.increments.size(); ++n) {
    const auto& increment = trajectory.increments[n];
    path.responses.col(n) = evaluate_responses(model, slots, increment.state, increment.time);
    path.states.push_back(increment.state.contact.state);
  }
  path.usable = trajectory.increments.size() == options.replay.size() && path.responses.allFinite() &&
                (is_converged(trajectory.status) || trajectory.increments.back().augmentations > 0);
  return path;
}

/// Size of a parameter: its value, or where that is zero the change that would move a response by its own size.
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

/// Best extrapolated derivative and its error estimate out of a sweep of one entry.
struct Extrapolated {
  double value = 0, estimate = std::numeric_limits<double>::infinity(), step = 0;
};

Extrapolated extrapolate(const Differences& differences, Eigen::Index i, Eigen::Index n, double rounding) {
  std::vector<double> values;  // the h^2 term taken away from each pair of neighbouring steps
  for (std::size_t k = 0; k + 1 < differences.step.size(); ++k) {
    const double ratio = differences.step[k] / differences.step[k + 1], r2 = ratio * ratio;
    values.push_back((r2 * differences.values[k + 1](i, n) - differences.values[k](i, n)) / (r2 - 1));
  }
  Extrapolated best;
  for (std::size_t k = 0; k < values.size(); ++k) {
    // what truncation (large steps) and the solver's noise (small ones) leave shows in the distance to the neighbours;
    // a pair without neighbours has only the term it took away to tell
    double spread = values.size() == 1 ? std::abs(values[k] - differences.values[k + 1](i, n)) : 0;
    if (k > 0) spread = std::max(spread, std::abs(values[k] - values[k - 1]));
    if (k + 1 < values.size()) spread = std::max(spread, std::abs(values[k] - values[k + 1]));
    const double estimate = spread + rounding / differences.step[k + 1];
    if (estimate < best.estimate) best = {values[k], estimate, differences.step[k + 1]};
  }
  return best;
}

/// What the solver's noise leaves in response i: it makes neighbouring differences disagree by noise / step, beside
/// their truncation, so the least of all pairs of steps, each at its worst increment, is an upper bound.
double noise(const Differences& differences, Eigen::Index i) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < differences.step.size(); ++k) {
    double apart = 0;
    for (Eigen::Index n = 0; n < differences.values[k].cols(); ++n)
      apart = std::max(apart, std::abs(differences.values[k](i, n) - differences.values[k + 1](i, n)));
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
  Method claimed = method;
  std::visit([](auto& m) { m.newton.tolerance = std::min(m.newton.tolerance, 1e-14); }, claimed);
  if (auto* uzawa = std::get_if<UzawaAL>(&claimed); uzawa && uzawa->sensitivity != UzawaAL::Sensitivity::truncated) {
    uzawa->tolerance = std::min(uzawa->tolerance, 1e-14);
    uzawa->max_augmentations = std::max(uzawa->max_augmentations, 20000);
  }
  return claimed;
}

GradientCheck check_gradients(const Model& model, const Method& given, const RunOptions& options,
                              const std::function<void(int, int)>& progress) {
  GradientCheck check;
  const Method method = as_claimed(given);
  const auto numbers = model.scene.as<double>();
  const auto slots = make_slots<double>(model, numbers);
  Workspace<double> workspace;
  const auto trajectory = solve(model, slots, method, options, workspace);
  check.status = trajectory.status;
  check.message = trajectory.message;
  const auto gradients = differentiate(model, slots, method, trajectory, workspace);
  const int parameters = static_cast<int>(model.scene.parameters.size());
  const int responses = static_cast<int>(model.scene.responses.size());
  const auto count = static_cast<Eigen::Index>(gradients.of.size());
  if (count == 0 || count < static_cast<Eigen::Index>(trajectory.increments.size())) {
    if (!gradients.message.empty()) check.message = gradients.message;
    return check;
  }
  RunOptions replay = options;
  replay.replay = trajectory.step_table();
  const Path base = run(model, numbers, method, replay);

  Matrix<double> largest_response = base.responses.cwiseAbs().rowwise().maxCoeff();
  Matrix<double> largest_derivative = Matrix<double>::Zero(responses, parameters);
  for (const auto& g : gradients.of) largest_derivative = largest_derivative.cwiseMax(g.cwiseAbs());
  const bool approximate = std::holds_alternative<UzawaAL>(method) &&
                           std::get<UzawaAL>(method).sensitivity == UzawaAL::Sensitivity::oversized;
  const int total = parameters * static_cast<int>(std::size(relative_steps)) * 2;
  for (int j = 0; j < parameters; ++j) {
    const Parameter& parameter = model.scene.parameters[j];
    const double size = parameter_size(parameter, largest_response, largest_derivative, j);
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
      const bool same =
          side[0].usable && side[1].usable && side[0].states == base.states && side[1].states == base.states;
      if (!same) {
        check.rejected += 2;
        continue;
      }
      differences.step.push_back(h);
      differences.values.push_back((side[1].responses - side[0].responses) / (2 * h));
    }
    for (int i = 0; i < responses; ++i) {
      GradientCheck::Entry worst;
      worst.response = model.scene.responses[i].name;
      worst.parameter = parameter.name;
      worst.scale = std::max(largest_derivative(i, j), largest_response(i, 0) / size);
      double excess = -1;
      for (Eigen::Index n = 0; n < count && differences.step.size() >= 2; ++n) {
        if (!trajectory.increments[n].requested) continue;
        const double rounding = std::max(1e-14 * largest_response(i, 0), noise(differences, i));
        const auto best = extrapolate(differences, i, n, rounding);
        const double scale = worst.scale > 0 ? worst.scale : 1;
        const double error = std::abs(gradients.of[n](i, j) - best.value) / scale, estimate = best.estimate / scale;
        const double scheme = approximate
                                  ? 10 / std::get<UzawaAL>(method).oversize.value_or(UzawaAL::automatic_oversize)
                                  : base_tolerance;
        const double allowed = std::max(scheme, estimate);
        if (error / allowed <= excess) continue;
        excess = error / allowed;
        worst.time = trajectory.increments[n].time;
        worst.computed = gradients.of[n](i, j);
        worst.difference = best.value;
        worst.error = error;
        worst.estimate = estimate;
        worst.allowed = allowed;
        worst.step = best.step / size;
        // an estimate as large as the derivative itself checks nothing
        worst.verdict = estimate > 1e-3    ? GradientCheck::Verdict::not_checked
                        : error <= allowed ? GradientCheck::Verdict::agrees
                                           : GradientCheck::Verdict::differs;
      }
      check.entries.push_back(worst);
    }
  }
  return check;
}

}  // namespace stickslip
