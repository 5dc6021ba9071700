#include "studies/sweep/study.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "studies/run/contact_points.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

double relative(double difference, double scale) { return difference == 0 ? 0 : difference / scale; }

/// The size of a parameter: its absolute value. If that is zero, as of a shape: the least change that would change a
/// response or an objective by its own size, or by that of its kind in the run if that is larger. (A response may
/// vanish by symmetry; it would make the parameter as small as rounding.)
class ParameterSize {
 public:
  explicit ParameterSize(const Parameter& parameter) : value_(std::abs(parameter.value)) {}
  /// Takes the size of a response, with its derivative.
  void see(double response, double derivative) {
    if (response != 0 && derivative != 0) least_ = std::min(least_, std::abs(response / derivative));
  }
  double operator()() const { return value_ > 0 ? value_ : least_; }

 private:
  double value_, least_ = std::numeric_limits<double>::infinity();
};

/// What a derivative is measured by: its own size, or, where it should vanish, what the response over the size of the
/// parameter makes of it.
double derivative_scale(double exact, double response, const ParameterSize& parameter) {
  return std::max(std::abs(exact), std::abs(response) / parameter());
}

/// What the kind of its response makes of an objective (scale_of()): squared if it has a target; 0 if there is none.
double scale_of(const CaseResult& result, const Objective& objective) {
  const auto& response = result.problem->model.scene.responses[objective.response];
  const double scale = scale_of(result, response).value_or(0);
  return objective.target ? scale * scale : scale;
}

/// Sizes of the parameters, from the largest responses and derivatives of all steps, and from the objectives.
std::vector<ParameterSize> parameter_sizes(const CaseResult& result) {
  std::vector<ParameterSize> sizes;
  const auto& parameters = result.problem->model.scene.parameters;
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    ParameterSize& size = sizes.emplace_back(parameters[j]);
    for (std::size_t i = 0; i < result.problem->model.scene.responses.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      double response = scale_of(result, result.problem->model.scene.responses[i]).value_or(0), derivative = 0;
      for (const auto& step : result.steps) {
        response = larger(response, std::abs(step.responses[row]));
        if (step.sensitivities.size() > 0) derivative = larger(derivative, std::abs(step.sensitivities(row, column)));
      }
      size.see(response, derivative);
    }
    for (Eigen::Index i = 0; i < result.gradients.of_objectives.rows(); ++i)
      size.see(larger(std::abs(result.objectives[i]), scale_of(result, result.problem->model.scene.objectives[i])),
               result.gradients.of_objectives(i, column));
  }
  return sizes;
}

/// Relative L2 difference of component c (0 normal, 1 tangential) of all tractions, weighted by area.
double traction_difference(const CaseResult& result, const CaseResult& reference, int c) {
  const auto& model = result.problem->model;
  const auto& t = result.steps.back().increment->state.contact.traction;
  const auto& exact = reference.steps.back().increment->state.contact.traction;
  double difference = 0, size = 0;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    const double area = result.problem->slots.geometry[p].area;
    const int first = c == 0 ? 0 : 1, last = c == 0 ? 1 : point.components();
    for (int k = point.multiplier + first; k < point.multiplier + last; ++k) {
      difference += area * (t[k] - exact[k]) * (t[k] - exact[k]);
      size += area * exact[k] * exact[k];
    }
  }
  return std::sqrt(relative(difference, size));
}

/// Linear interpolation in a curve of ascending x; 0 outside, but for the rounding of a place at its ends.
double at(const json& x, const json& y, double where) {
  const double first = x.front(), last = x.back(), rounding = 1e-9 * (last - first);
  if (where >= first - rounding && where <= last + rounding) where = std::clamp(where, first, last);
  for (std::size_t i = 1; i < x.size(); ++i)
    if (where >= x[i - 1].get<double>() && where <= x[i].get<double>()) {
      const double s = (where - x[i - 1].get<double>()) / (x[i].get<double>() - x[i - 1].get<double>());
      return (1 - s) * y[i - 1].get<double>() + s * y[i].get<double>();
    }
  return 0;
}

/// Relative L2 difference from a curve of the closed form over the points of its contact; not finite where it is 0 at
/// them all.
double curve_difference(const CaseResult& result, const std::string& contact, const json& curve, bool normal) {
  const auto& model = result.problem->model;
  const auto& t = result.steps.back().increment->state.contact.traction;
  const int index = model.contact_index(contact);
  const auto arc = arc_of(*result.problem, index);
  const bool over_arc = curve.contains("s");
  double difference = 0, size = 0;
  std::size_t n = 0;  // of the contact's points
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    if (point.contact != index) continue;
    const double where = over_arc ? arc[n++] : result.problem->slots.points(0, point.nodes[0]);
    if (!normal && point.tangents != 1) continue;
    const double area = result.problem->slots.geometry[p].area;
    const double exact = at(curve[over_arc ? "s" : "x"], curve[normal ? "normal" : "tangential"], where);
    const double d = t[point.multiplier + (normal ? 0 : 1)] - exact;
    difference += area * d * d;
    size += area * exact * exact;
  }
  return std::sqrt(difference / size);
}

}  // namespace

Errors enforcement_errors(const CaseResult& result, const CaseResult& reference) {
  Errors errors;
  if (result.steps.size() != reference.steps.size() || result.steps.empty()) return errors;
  const auto& scene = result.problem->model.scene;
  const auto parameters = parameter_sizes(reference);
  for (std::size_t i = 0; i < scene.responses.size(); ++i) {
    double difference = 0, size = 0;
    for (std::size_t n = 0; n < result.steps.size(); ++n) {
      difference = larger(difference, std::abs(result.steps[n].responses[i] - reference.steps[n].responses[i]));
      size = larger(size, std::abs(reference.steps[n].responses[i]));
    }
    errors["response:" + scene.responses[i].name] = relative(difference, size);
    for (std::size_t j = 0; j < scene.parameters.size(); ++j) {
      double worst = 0, scale = 0;
      bool complete = true;
      for (std::size_t n = 0; n < result.steps.size(); ++n) {
        const auto& computed = result.steps[n].sensitivities;
        const auto& exact = reference.steps[n].sensitivities;
        complete = complete && computed.size() > 0 && exact.size() > 0;
        if (!complete) break;
        worst = larger(worst, std::abs(computed(i, j) - exact(i, j)));
        scale = larger(scale, derivative_scale(exact(i, j), size, parameters[j]));
      }
      if (complete)
        errors["sensitivity:" + scene.responses[i].name + "/" + scene.parameters[j].name] = relative(worst, scale);
    }
  }
  const auto &computed = result.gradients.of_objectives, &exact = reference.gradients.of_objectives;
  for (Eigen::Index i = 0; i < result.objectives.size(); ++i) {
    const auto& name = scene.objectives[i].name;
    const double value = reference.objectives[i], size = std::abs(value);
    errors["response:" + name] = relative(std::abs(result.objectives[i] - value), size);
    for (std::size_t j = 0; computed.size() > 0 && exact.size() > 0 && j < scene.parameters.size(); ++j) {
      const auto& parameter = scene.parameters[j];
      const double scale = derivative_scale(exact(i, j), size, parameters[j]);
      errors["sensitivity:" + name + "/" + parameter.name] = relative(std::abs(computed(i, j) - exact(i, j)), scale);
    }
  }
  if (result.problem->model.effects.contact)
    errors["field:normal_traction"] = traction_difference(result, reference, 0);
  if (result.problem->model.effects.friction)
    errors["field:tangential_traction"] = traction_difference(result, reference, 1);
  return errors;
}

Errors discretisation_errors(const CaseResult& result, const ReferenceValues& reference) {
  Errors errors;
  if (result.steps.empty()) return errors;
  const auto& scene = result.problem->model.scene;
  const auto& last = result.steps.back();
  const auto parameters = parameter_sizes(result);
  const auto compare = [&](const std::string& name, double computed, const auto& gradient) {
    const auto exact = reference.responses.find(name);
    double size = std::abs(computed);
    if (exact != reference.responses.end()) {
      if (exact->second != 0) size = std::abs(exact->second);
      errors["response:" + name] = relative(std::abs(computed - exact->second), size);
    }
    const auto derivatives = reference.sensitivities.find(name);
    if (derivatives == reference.sensitivities.end()) return;
    for (Eigen::Index j = 0; j < gradient.size(); ++j) {
      const auto& parameter = scene.parameters[j];
      const auto value = derivatives->second.find(parameter.name);
      if (value == derivatives->second.end()) continue;
      const double scale = derivative_scale(value->second, size, parameters[j]);
      errors["sensitivity:" + name + "/" + parameter.name] = relative(std::abs(gradient[j] - value->second), scale);
    }
  };
  const auto row_of = [](const Matrix<double>& m, std::size_t i) {
    return m.size() > 0 ? Vector<double>(m.row(static_cast<Eigen::Index>(i))) : Vector<double>();
  };
  for (std::size_t i = 0; i < scene.responses.size(); ++i)
    compare(scene.responses[i].name, last.responses[i], row_of(last.sensitivities, i));
  for (Eigen::Index i = 0; i < result.objectives.size(); ++i)
    compare(scene.objectives[i].name, result.objectives[i], row_of(result.gradients.of_objectives, i));
  for (const auto& [contact, curve] : reference.curves.items()) {
    errors["field:normal_traction"] = curve_difference(result, contact, curve, true);
    if (result.problem->model.effects.friction)
      errors["field:tangential_traction"] = curve_difference(result, contact, curve, false);
  }
  return errors;
}

std::map<std::string, ErrorScale> error_scales(const CaseResult& result, const ReferenceValues& reference) {
  std::map<std::string, ErrorScale> scales;
  const ReferenceValues own = values_of(result);
  const auto parameters = parameter_sizes(result);
  for (const auto& [name, computed] : own.responses) {
    const auto exact = reference.responses.find(name);
    const bool referred = exact != reference.responses.end();
    const double size = std::abs(referred && exact->second != 0 ? exact->second : computed);
    scales["response:" + name] = {size, referred};
    const auto derivatives = own.sensitivities.find(name);
    if (derivatives == own.sensitivities.end()) continue;
    const auto references = reference.sensitivities.find(name);
    for (std::size_t j = 0; j < parameters.size(); ++j) {
      const Parameter& parameter = result.problem->model.scene.parameters[j];
      const auto value = derivatives->second.find(parameter.name);
      if (value == derivatives->second.end()) continue;
      double derivative = value->second;
      bool known = references != reference.sensitivities.end();
      if (known) {
        const auto given = references->second.find(parameter.name);
        known = given != references->second.end();
        if (known) derivative = given->second;
      }
      scales["sensitivity:" + name + "/" + parameter.name] = {derivative_scale(derivative, size, parameters[j]), known};
    }
  }
  return scales;
}

bool asked_for(const std::string& name, const std::vector<std::string>& patterns) {
  return patterns.empty() || std::any_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) {
           if (pattern.empty() || pattern.back() != '*') return name == pattern;
           return name.compare(0, pattern.size() - 1, pattern, 0, pattern.size() - 1) == 0;
         });
}

}  // namespace stickslip
