#include "studies/run/element_fields.hpp"

#include <cmath>

#include "core/model/loading.hpp"
#include "studies/run/strains.hpp"

namespace stickslip {

Matrix<double> element_stress(const Problem& problem, const State<double>& state) {
  const auto& model = problem.model;
  int count = 0;
  for (const auto& body : model.bodies) count += body.mesh.element_count();
  Matrix<double> stress = Matrix<double>::Zero(6, count);
  int first = 0;  // column of the body's first element
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto& law = problem.slots.laws[b].law;
    Vector<double> volumes = Vector<double>::Zero(model.bodies[b].mesh.element_count());
    for_each_strain(problem, state, b, [&](int e, const auto& H, double volume, const double* memory) {
      const auto components = stress_of(law, H, memory);
      stress.col(first + e) += volume * Eigen::Map<const Eigen::Matrix<double, 6, 1>>(components.data());
      volumes[e] += volume;
    });
    for (Eigen::Index e = 0; e < volumes.size(); ++e)
      if (volumes[e] > 0) stress.col(first + e) /= volumes[e];
    first += static_cast<int>(volumes.size());
  }
  return stress;
}

double von_mises(const Eigen::Ref<const Eigen::Matrix<double, 6, 1>>& stress) {
  const double size = stress.cwiseAbs().maxCoeff();
  if (size == 0) return 0;
  const Eigen::Matrix<double, 6, 1> s = stress / size;  // whose squares do not overflow
  const double normal = std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2);
  return size * std::sqrt(0.5 * normal + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

Matrix<double> nodal(const Model& model, const Eigen::Ref<const Vector<double>>& dofs) {
  return Eigen::Map<const Matrix<double>>(dofs.data(), model.dimension, model.node_count);
}

bool thins(const Model& model) { return model.scene.finite_strain && model.scene.space == Space::plane_stress; }

Matrix<double> element_thickness(const Problem& problem, const State<double>& state) {
  std::vector<double> means;
  for (std::size_t b = 0; b < problem.model.bodies.size(); ++b) {
    const std::size_t first = means.size();
    means.resize(first + problem.model.bodies[b].mesh.element_count(), 1);
    std::vector<double> volumes(means.size() - first, 0);
    for_each_strain(problem, state, b, [&](int e, const auto& H, double volume, const double* memory) {
      if constexpr (std::is_same_v<decltype(H), const PlaneGradient<double>&>) {
        const double stretch = thickness_stretch(problem.slots.laws[b].law, H, memory);
        volumes[e] += volume;
        means[first + e] += (stretch - means[first + e]) * volume / volumes[e];
      }
    });
  }
  return Eigen::Map<const Vector<double>>(means.data(), static_cast<Eigen::Index>(means.size())).transpose();
}

std::vector<double> mean_plastic_strains(const Problem& problem, const State<double>& state, int body) {
  std::vector<std::pair<double, double>> points;  // strain times volume, volume
  for_each_plastic_strain(problem.model, problem.slots, body, state.history.bodies,
                          [&](double strain, double volume) { points.emplace_back(strain * volume, volume); });
  std::vector<double> means(problem.model.bodies[body].mesh.element_count(), 0);
  const std::size_t each = points.size() / means.size();
  for (std::size_t e = 0; each > 0 && e < means.size(); ++e) {
    double sum = 0, volume = 0;
    for (std::size_t k = e * each; k < (e + 1) * each; ++k) {
      sum += points[k].first;
      volume += points[k].second;
    }
    means[e] = sum / volume;
  }
  return means;
}

Matrix<double> element_plastic_strain(const Problem& problem, const State<double>& state) {
  std::vector<double> means;
  for (std::size_t b = 0; b < problem.model.bodies.size(); ++b) {
    const auto of_body = mean_plastic_strains(problem, state, static_cast<int>(b));
    means.insert(means.end(), of_body.begin(), of_body.end());
  }
  return Eigen::Map<const Vector<double>>(means.data(), static_cast<Eigen::Index>(means.size())).transpose();
}

}  // namespace stickslip
