/// Logarithm and exponential of symmetric tensors of the plane, written in what they differ from the unit tensor and
/// from zero by, so that a small strain does not vanish beside one.
///
///   A = m I + B, B without trace, B^2 = r^2 I:   ln A = ln(m^2 - r^2)/2 I + artanh(r/m)/r B
///                                              exp A = e^m (cosh r I + sinh(r)/r B)
///
/// Both are written in r^2, and functions of it are entire or their series: nothing happens where two principal values
/// are one, which a formula by principal directions has no derivative at.
#pragma once

#include "core/algebra/scalar.hpp"

namespace stickslip {

/// Components of a symmetric tensor of the plane: 00, 11, 01.
template <class T>
using PlaneTensor = Vec<T, 3>;

namespace detail {

/// sum of x^k / (2k + 1) over k, or over (2k + 1)!: `next` gives a coefficient from the one before.
template <class T, class Next>
T series(const T& x, int terms, Next&& next) {
  T sum(1), power(1);
  double coefficient = 1;
  for (int k = 1; k < terms; ++k) {
    coefficient = next(coefficient, k);
    power *= x;
    sum += power * T(coefficient);
  }
  return sum;
}

}  // namespace detail

/// sinh(sqrt x) / sqrt x. pre: x >= 0.
template <class T>
T sinh_ratio(const T& x) {
  using std::exp, std::sqrt;
  // (below 1 ten terms leave 1 / 21!)
  if (value(x) < 1) return detail::series(x, 10, [](double c, int k) { return c / (2 * k * (2 * k + 1)); });
  const T r = sqrt(x);
  return (exp(r) - exp(-r)) / (T(2) * r);
}

/// artanh(sqrt x) / sqrt x. pre: 0 <= x < 1.
template <class T>
T artanh_ratio(const T& x) {
  using std::log, std::sqrt;
  // (below 1/32 eleven terms leave 2^-55 / 23)
  if (value(x) < 1.0 / 32) return detail::series(x, 11, [](double c, int k) { return c * (2 * k - 1) / (2 * k + 1); });
  const T r = sqrt(x);
  return log((T(1) + r) / (T(1) - r)) / (T(2) * r);
}

/// x - ln(1 + x), with the digits of a small x: ln(1 + x) = 2 artanh z, z = x / (2 + x). pre: x > -1.
template <class T>
T less_log1p(const T& x) {
  const T z = x / (T(2) + x), square = z * z;
  // (artanh(z)/z - 1) / z^2: below 1/32 eleven terms leave 2^-55 / 25
  const T rest =
      value(square) < 1.0 / 32
          ? T(detail::series(square, 11, [](double c, int k) { return c * (2 * k + 1) / (2 * k + 3); }) / T(3))
          : T((artanh_ratio<T>(square) - T(1)) / square);
  return x * z - T(2) * z * square * rest;
}

/// exp(x) - 1.
template <class T>
T exp_minus_one(const T& x) {
  using std::exp;
  return x * exp(x / T(2)) * sinh_ratio<T>(x * x / T(4));
}

/// ln(I + A). pre: I + A is positive definite.
template <class T>
PlaneTensor<T> log_of_one_plus(const PlaneTensor<T>& A) {
  using std::log1p, stickslip::log1p;
  const T mean = (A[0] + A[1]) / T(2), apart = (A[0] - A[1]) / T(2), m = T(1) + mean;
  const T square = apart * apart + A[2] * A[2];
  const T share = artanh_ratio<T>(square / (m * m)) / m;
  const T middle = log1p(T(mean * (T(2) + mean) - square)) / T(2);
  return {middle + share * apart, middle - share * apart, share * A[2]};
}

/// exp(A) - I.
template <class T>
PlaneTensor<T> exp_minus_one(const PlaneTensor<T>& A) {
  using std::exp;
  const T m = (A[0] + A[1]) / T(2), apart = (A[0] - A[1]) / T(2), square = apart * apart + A[2] * A[2];
  const T grown = exp(m), half = sinh_ratio<T>(square / T(4));
  const T share = grown * sinh_ratio<T>(square);
  const T middle = exp_minus_one<T>(m) + grown * square * half * half / T(2);  // cosh r - 1 = 2 sinh(r/2)^2
  return {middle + share * apart, middle - share * apart, share * A[2]};
}

}  // namespace stickslip
