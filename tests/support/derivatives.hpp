/// The derivative of a templated function by two independent ways: dual numbers, as the program takes it, and the
/// complex step. Neither subtracts, so the two differ by rounding alone.
#pragma once

#include <complex>
#include <cstdint>

#include "core/algebra/scalar.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::derivatives {

using Complex = std::complex<double>;
inline constexpr int at_once = 4;  ///< inputs seeded together, as in direct differentiation

/// Jacobian of f at x, a column for each input. `f` takes a Vector<T> and gives a Vector<T>, for any scalar T.
template <class F>
Matrix<double> by_dual(F&& f, const Vector<double>& x) {
  Matrix<double> jacobian;
  for (Eigen::Index first = 0; first < x.size(); first += at_once) {
    const int count = static_cast<int>(std::min<Eigen::Index>(at_once, x.size() - first));
    Vector<Dual<at_once>> seeded = x.unaryExpr([](double v) { return Dual<at_once>(v); });
    for (int k = 0; k < count; ++k) seeded[first + k].d[k] = 1;
    const Vector<Dual<at_once>> y = f(seeded);
    jacobian.conservativeResize(y.size(), x.size());
    for (Eigen::Index i = 0; i < y.size(); ++i)
      for (int k = 0; k < count; ++k) jacobian(i, first + k) = y[i].d[k];
  }
  return jacobian;
}

template <class F>
Matrix<double> by_complex_step(F&& f, const Vector<double>& x) {
  constexpr double h = 1e-30;  // its square is lost beside one
  Matrix<double> jacobian;
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    Vector<Complex> shifted = x.unaryExpr([](double v) { return Complex(v); });
    shifted[j] += Complex(0, h);
    const Vector<Complex> y = f(shifted);
    jacobian.conservativeResize(y.size(), x.size());
    for (Eigen::Index i = 0; i < y.size(); ++i) jacobian(i, j) = y[i].imag() / h;
  }
  return jacobian;
}

/// Largest difference of the entries over the largest entry of `reference`; 0 where both are zero.
inline double relative_difference(const Matrix<double>& a, const Matrix<double>& reference) {
  const double largest = largest_entry(reference);
  const double difference = largest_entry(a - reference);
  return difference == 0 ? 0 : difference / largest;
}

/// Pseudo-random numbers in [-1, 1], the same in every run and on every machine.
inline Vector<double> arbitrary(int size, unsigned seed = 1) {
  Vector<double> v(size);
  std::uint64_t state = 0x9e3779b97f4a7c15ull * (seed + 1);
  for (double& x : v) {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    x = 2 * (static_cast<double>(state >> 11) / 9007199254740992.0) - 1;
  }
  return v;
}

}  // namespace stickslip::derivatives
