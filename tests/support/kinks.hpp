/// Independent one-sided derivatives: the complex step of the whole program on a path that is moved to one side of a
/// kink, extrapolated back to the kink.
#pragma once

#include <optional>

#include "tests/support/largest.hpp"
#include "tests/support/oracle.hpp"

namespace stickslip::kinks {

/// The scene with parameter j moved.
inline Scene moved(Scene scene, int j, double by) {
  for (const auto& [slot, weight] : scene.parameters[j].slots) scene.numbers[slot] += by * weight;
  return scene;
}

inline double size_of(const Parameter& parameter) { return parameter.value == 0 ? 1 : std::abs(parameter.value); }

/// Derivatives by parameter j on one side, responses x increments: at distances h, 2 h and 4 h, d(h) = d + O(h), so
/// that 2 d(h) - d(2h) is off by O(h^2), as is the same at twice the distance. None where these two differ by more than
/// `noise` of the largest: another kink is nearer than that.
inline std::optional<Matrix<double>> one_sided(const Scene& scene, const Method& method,
                                               const std::vector<double>& table, int j, double side,
                                               double noise = 1e-9, double h = 1e-6) {
  Matrix<double> at[3];
  for (int k = 0; k < 3; ++k) {
    const Scene beside = moved(scene, j, side * (1 << k) * h * size_of(scene.parameters[j]));
    at[k] = oracle::complex_step(make_model(beside), method, table, j);
    if (!at[k].allFinite() || at[k].cols() != static_cast<Eigen::Index>(table.size())) return std::nullopt;
  }
  const Matrix<double> near = 2 * at[0] - at[1], far = 2 * at[1] - at[2];
  for (Eigen::Index i = 0; i < near.rows(); ++i)
    if (largest_entry((near - far).row(i)) > noise * largest_entry(near.row(i))) return std::nullopt;
  return near;
}

}  // namespace stickslip::kinks
