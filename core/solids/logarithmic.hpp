/// Logarithm and exponential of symmetric tensors, written in what they differ from the unit tensor and from zero by,
/// so that a small strain does not vanish beside one.
///
/// Of the plane, 00 11 01,
///
///   A = m I + B, B without trace, B^2 = r^2 I:   ln A = ln(m^2 - r^2)/2 I + artanh(r/m)/r B
///                                              exp A = e^m (cosh r I + sinh(r)/r B)
///
/// Both are written in r^2, and functions of it are entire or their series: nothing happens where two principal values
/// are one, which a formula by principal directions has no derivative at. Of space, 00 11 01 22 02 12, they are series
/// of a root and of a part of A that are small enough: ln(I + A) = 2^k ln (I + A)^(1/2^k), exp A = exp(A / 2^k)^(2^k).
/// First derivatives of these are by principal directions, A = Q diag(a) Q^T [Daleckii and Krein 1965]:
///
///   Df(A)[H] = Q (s o Q^T H Q) Q^T,   s_ij = (f(a_i) - f(a_j)) / (a_i - a_j), f'(a_i) where the two are one
///
/// which is as exact where principal values are nearly one, and takes a tenth of the time of the series' derivatives.
#pragma once

#include <Eigen/Eigenvalues>

#include "core/solids/tensor.hpp"

namespace stickslip {

/// Components of a symmetric tensor of D dimensions: 00, 11, 01, and of space 22, 02, 12.
template <class T, int D>
using Symmetric = Vec<T, D*(D + 1) / 2>;
/// Row and column of each.
inline constexpr int symmetric_places[6][2] = {{0, 0}, {1, 1}, {0, 1}, {2, 2}, {0, 2}, {1, 2}};

template <class T, int D>
Mat<T, D> matrix_of(const Symmetric<T, D>& A) {
  Mat<T, D> all;
  for (int k = 0; k < A.size(); ++k) {
    const auto [p, q] = symmetric_places[k];
    all(p, q) = all(q, p) = A[k];
  }
  return all;
}
/// Of a matrix that is symmetric but for rounding.
template <class T, int D>
Symmetric<T, D> symmetric_of(const Mat<T, D>& all) {
  Symmetric<T, D> A;
  for (int k = 0; k < A.size(); ++k) {
    const auto [p, q] = symmetric_places[k];
    A[k] = p == q ? all(p, q) : T((all(p, q) + all(q, p)) / T(2));
  }
  return A;
}

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
Symmetric<T, 2> log_of_one_plus(const Symmetric<T, 2>& A) {
  using std::log1p, stickslip::log1p;
  const T mean = (A[0] + A[1]) / T(2), apart = (A[0] - A[1]) / T(2), m = T(1) + mean;
  const T square = apart * apart + A[2] * A[2];
  const T share = artanh_ratio<T>(square / (m * m)) / m;
  const T middle = log1p(T(mean * (T(2) + mean) - square)) / T(2);
  return {middle + share * apart, middle - share * apart, share * A[2]};
}

/// exp(A) - I.
template <class T>
Symmetric<T, 2> exp_minus_one(const Symmetric<T, 2>& A) {
  using std::exp;
  const T m = (A[0] + A[1]) / T(2), apart = (A[0] - A[1]) / T(2), square = apart * apart + A[2] * A[2];
  const T grown = exp(m), half = sinh_ratio<T>(square / T(4));
  const T share = grown * sinh_ratio<T>(square);
  const T middle = exp_minus_one<T>(m) + grown * square * half * half / T(2);  // cosh r - 1 = 2 sinh(r/2)^2
  return {middle + share * apart, middle - share * apart, share * A[2]};
}

namespace detail {

/// (A + I)^-1 times B, of matrices of space that commute with A.
template <class T>
Mat<T, 3> over_one_plus(const Mat<T, 3>& B, const Mat<T, 3>& A) {
  const Mat<T, 3> sum = A + Mat<T, 3>::Identity(), minors = cofactors<T>(sum);
  return (B.lazyProduct(minors.transpose()).eval() / dot(sum.row(0), minors.row(0))).eval();
}

/// Square root of I + A, less I: by Newton's method, X <- (X^2 + A) (I + X)^-1 / 2. Two steps are behind the last one
/// that changes values, since derivatives follow them.
template <class T>
Mat<T, 3> root_of_one_plus(const Mat<T, 3>& A) {
  Mat<T, 3> X = A / T(2);
  for (int left = 30, still = 0; left > 0 && still < 2; --left) {
    const Mat<T, 3> next = over_one_plus<T>(Mat<T, 3>((X.lazyProduct(X) + A) / T(2)), X);
    still = values((next - X).eval()).norm() <= 1e-14 * values(next).norm() ? still + 1 : 0;
    X = next;
  }
  return X;
}

/// Whether a scalar has first derivatives alone, in doubles.
template <class T>
inline constexpr bool is_plain_dual = false;
template <int N>
inline constexpr bool is_plain_dual<Dual<N>> = true;

/// f(A) from its value and the derivatives of A. `slope(a, b)`: (f(a) - f(b)) / (a - b), with its digits where a and b
/// are nearly one.
template <int N, class Slope>
Symmetric<Dual<N>, 3> with_derivatives(const Symmetric<double, 3>& f, const Symmetric<Dual<N>, 3>& A, Slope&& slope) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(matrix_of<double, 3>(values(A)));
  const Eigen::Matrix3d& Q = principal.eigenvectors();
  const Eigen::Vector3d& a = principal.eigenvalues();
  Eigen::Matrix<double, 6, 6> turn, back;  // from the components to those along the principal directions, and back
  for (int k = 0; k < 6; ++k) {
    const auto [i, j] = symmetric_places[k];
    for (int m = 0; m < 6; ++m) {
      const auto [p, q] = symmetric_places[m];
      turn(k, m) = p == q ? Q(p, i) * Q(p, j) : Q(p, i) * Q(q, j) + Q(q, i) * Q(p, j);
      back(m, k) = slope(a[i], a[j]) * (i == j ? Q(p, i) * Q(q, i) : Q(p, i) * Q(q, j) + Q(q, i) * Q(p, j));
    }
  }
  const Eigen::Matrix<double, 6, 6> derivative = back.lazyProduct(turn);
  Symmetric<Dual<N>, 3> out;
  for (int m = 0; m < 6; ++m) {
    out[m] = Dual<N>(f[m]);
    for (int k = 0; k < 6; ++k) out[m].d += derivative(m, k) * A[k].d;
  }
  return out;
}

}  // namespace detail

/// ln(I + A), as 2 artanh Z, Z = A (2 I + A)^-1. pre: I + A is positive definite.
template <class T>
Symmetric<T, 3> log_of_one_plus(const Symmetric<T, 3>& A) {
  if constexpr (detail::is_plain_dual<T>)
    return detail::with_derivatives(log_of_one_plus<double>(values(A)), A, [](double a, double b) {
      const double apart = (a - b) / (1 + b);
      return (apart == 0 ? 1 : std::log1p(apart) / apart) / (1 + b);
    });
  Mat<T, 3> root = matrix_of<T, 3>(A);
  double scale = 1;
  for (; values(root).norm() > 1.0 / 4; scale *= 2) root = detail::root_of_one_plus<T>(root);
  const Mat<T, 3> half = root / T(2), Z = detail::over_one_plus<T>(half, half), square = Z.lazyProduct(Z);
  Mat<T, 3> sum = Mat<T, 3>::Identity(), power = sum;
  for (int k = 1; k < 11; ++k) {  // (|Z| < 1/6: eleven terms leave 6^-22 / 23)
    power = power.lazyProduct(square).eval();
    sum += power / T(2 * k + 1);
  }
  return symmetric_of<T, 3>((T(2 * scale) * Z).lazyProduct(sum));
}

/// exp(A) - I.
template <class T>
Symmetric<T, 3> exp_minus_one(const Symmetric<T, 3>& A) {
  if constexpr (detail::is_plain_dual<T>)
    return detail::with_derivatives(exp_minus_one<double>(values(A)), A, [](double a, double b) {
      return a == b ? std::exp(b) : std::exp(b) * std::expm1(a - b) / (a - b);
    });
  Mat<T, 3> part = matrix_of<T, 3>(A);
  int doublings = 0;
  for (; values(part).norm() > 1.0 / 4; ++doublings) part = (part / T(2)).eval();
  Mat<T, 3> E = part, term = part;
  for (int k = 2; k < 13; ++k) {  // (below 1/4 twelve terms leave 4^-12 / 13! of the first)
    term = (term.lazyProduct(part) / T(k)).eval();
    E += term;
  }
  for (; doublings > 0; --doublings) E = (T(2) * E + E.lazyProduct(E)).eval();
  return symmetric_of<T, 3>(E);
}

}  // namespace stickslip
