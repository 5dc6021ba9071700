/// Derivatives from difference quotients of several steps, with an estimate of their error.
///
/// A quotient with step h is off by a series in x = h^order and by the solver's noise over h. Neville's table removes
/// the terms of the series one by one,
///
///   T_k0 = quotient k        T_km = T_k,m-1 + (T_k,m-1 - T_k-1,m-1) / (x_k-m / x_k - 1)
///
/// The error of T_km is at most about the larger distance to its two predecessors, plus the noise at its step [R82].
/// Distances alone are not enough: where noise prevails, two values may agree by chance. So the noise is measured.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/algebra/scalar.hpp"

namespace stickslip {

struct Quotients {
  int order;                           ///< of the first error term: 2 for central differences, 1 for one-sided ones
  std::vector<double> step;            ///< absolute, decreasing
  std::vector<Matrix<double>> values;  ///< per step: responses x increments; NaN where a quotient is of no use
  /// Number of steps with a quotient of an entry.
  int count(Eigen::Index response, Eigen::Index increment) const {
    return static_cast<int>(std::count_if(values.begin(), values.end(),
                                          [&](const auto& of) { return !std::isnan(of(response, increment)); }));
  }
};

namespace detail {
/// Neville's table of one entry.
struct NevilleTable {
  std::vector<std::size_t> index;         ///< of the step of each row
  std::vector<double> step;               ///< of each row
  std::vector<std::vector<double>> rows;  ///< T_k0 .. T_kk

  NevilleTable(const Quotients& quotients, Eigen::Index i, Eigen::Index n) {
    for (std::size_t k = 0; k < quotients.step.size(); ++k) {
      const double quotient = quotients.values[k](i, n);
      if (std::isnan(quotient)) continue;
      index.push_back(k);
      step.push_back(quotients.step[k]);
      std::vector<double> row{quotient};
      const std::size_t at = rows.size();
      for (std::size_t m = 1; m <= at; ++m) {
        const double ratio = std::pow(step[at - m] / step[at], quotients.order);
        row.push_back(row[m - 1] + (row[m - 1] - rows[at - 1][m - 1]) / (ratio - 1));
      }
      rows.push_back(std::move(row));
    }
  }
};

}  // namespace detail

/// Noise of a response, absolute: a quotient of step h is off by about noise / h. Neighbouring values of the table's
/// first column disagree by this much, as soon as the steps are small enough. Three such disagreements in a row, the
/// largest over all increments, are compared, so that a small one by chance does not pass for the noise.
inline double noise(const Quotients& quotients, Eigen::Index response) {
  constexpr std::size_t in_a_row = 3;
  std::vector<double> apart(quotients.step.size(), -1);  // per step; below zero: not known
  for (Eigen::Index n = 0; !quotients.values.empty() && n < quotients.values[0].cols(); ++n) {
    const detail::NevilleTable table(quotients, response, n);
    const std::size_t count = table.rows.size(), column = count > 2 ? 1 : 0;
    for (std::size_t k = column + 1; k < count; ++k) {
      double& known = apart[table.index[k]];
      known = larger(known, std::abs(table.rows[k][column] - table.rows[k - 1][column]) * table.step[k]);
    }
  }
  apart.erase(std::remove_if(apart.begin(), apart.end(), [](double a) { return a < 0; }), apart.end());
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < apart.size() && (k == 0 || k + in_a_row <= apart.size()); ++k) {
    const auto first = apart.begin() + static_cast<std::ptrdiff_t>(k);
    least = std::min(least, *std::max_element(first, first + std::min<std::ptrdiff_t>(in_a_row, apart.end() - first)));
  }
  return least;
}

struct Extrapolated {
  double value = 0, estimate = std::numeric_limits<double>::infinity(), step = 0;
};

/// The value of the table with the least error estimate. pre: at least two quotients. `noise`: absolute.
inline Extrapolated extrapolate(const Quotients& quotients, Eigen::Index response, Eigen::Index increment,
                                double noise) {
  constexpr double deviations = 2;  // the measured noise is about one standard deviation of what a value is off by
  const detail::NevilleTable table(quotients, response, increment);
  Extrapolated best;
  for (std::size_t k = 1; k < table.rows.size(); ++k)
    for (std::size_t m = 1; m <= k; ++m) {
      const double value = table.rows[k][m];
      const double spread = larger(std::abs(value - table.rows[k][m - 1]), std::abs(value - table.rows[k - 1][m - 1]));
      const double estimate = spread + deviations * noise / table.step[k];
      if (estimate < best.estimate) best = {value, estimate, table.step[k]};
    }
  return best;
}

}  // namespace stickslip
