/// The scalars of stickslip: double for the solver, Dual<N> for derivatives, Reverse (reverse.hpp) for the adjoint,
/// std::complex<double> for the oracle of the tests (complex step over the whole program).
///
/// One template serves the four, so solver, derivative and oracle cannot drift apart. Two rules keep that true:
///   - branch on `value(x)`, the primal part, never on x;
///   - no implicit conversion from Dual or complex to double exists: a forgotten dependence does not compile.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <type_traits>

namespace stickslip {

/// Largest relative error of one rounding of a double, 2^-53.
inline constexpr double unit_roundoff = 0x1p-53;

/// ln(1 + x) of the oracle's scalar, with the digits of a small x.
inline std::complex<double> log1p(const std::complex<double>& x) {
  const double across = x.imag() / (1 + x.real());
  return {std::log1p(x.real()) + std::log1p(across * across) / 2, std::atan2(x.imag(), 1 + x.real())};
}

/// Forward derivative: a value and N directional derivatives. S is the scalar it is built on (double, or
/// std::complex<double> where the oracle needs a tangent of its own).
template <int N, class S = double>
struct Dual {
  using Gradient = Eigen::Array<S, N, 1>;
  S v{};
  Gradient d = Gradient::Zero();

  Dual() = default;
  Dual(const S& primal) : v(primal) {}  // NOLINT: a constant is a Dual with zero derivative
  Dual(int primal) : v(primal) {}       // NOLINT
  Dual(double primal) requires(!std::is_same_v<S, double>) : v(primal) {}  // NOLINT
  Dual(const S& primal, const Gradient& gradient) : v(primal), d(gradient) {}

  /// The value with derivative one in direction i.
  static Dual seed(const S& primal, int i) {
    Dual x(primal);
    x.d[i] = S(1);
    return x;
  }

  Dual operator-() const { return {-v, -d}; }
  Dual& operator+=(const Dual& o) {
    v += o.v;
    d += o.d;
    return *this;
  }
  Dual& operator-=(const Dual& o) {
    v -= o.v;
    d -= o.d;
    return *this;
  }
  Dual& operator*=(const Dual& o) {
    d = d * o.v + o.d * v;
    v *= o.v;
    return *this;
  }
  Dual& operator/=(const Dual& o) { return *this = *this / o; }

  friend Dual operator+(const Dual& a, const Dual& b) { return {a.v + b.v, a.d + b.d}; }
  friend Dual operator-(const Dual& a, const Dual& b) { return {a.v - b.v, a.d - b.d}; }
  friend Dual operator*(const Dual& a, const Dual& b) { return {a.v * b.v, a.d * b.v + b.d * a.v}; }
  friend Dual operator*(const Dual& a, const S& b) { return {a.v * b, a.d * b}; }
  friend Dual operator*(const S& a, const Dual& b) { return {a * b.v, a * b.d}; }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const S q = a.v / b.v;
    return {q, (a.d - b.d * q) / b.v};
  }

  friend Dual sqrt(const Dual& a) {
    using std::sqrt;
    const S root = sqrt(a.v);
    return {root, a.d / (S(2) * root)};
  }
  friend Dual exp(const Dual& a) {
    using std::exp;
    const S e = exp(a.v);
    return {e, a.d * e};
  }
  friend Dual log(const Dual& a) {
    using std::log;
    return {log(a.v), a.d / a.v};
  }
  friend Dual log1p(const Dual& a) {
    using std::log1p, stickslip::log1p;
    return {log1p(a.v), a.d / (S(1) + a.v)};
  }
  friend Dual sin(const Dual& a) {
    using std::cos, std::sin;
    return {sin(a.v), a.d * cos(a.v)};
  }
  friend Dual cos(const Dual& a) {
    using std::cos, std::sin;
    return {cos(a.v), a.d * -sin(a.v)};
  }
  friend Dual pow(const Dual& a, double exponent) {
    using std::pow;
    return {pow(a.v, exponent), a.d * (exponent * pow(a.v, exponent - 1))};
  }
};

/// Primal part: the only thing a branch may look at.
inline double value(double x) { return x; }
inline double value(const std::complex<double>& x) { return x.real(); }
template <int N, class S>
double value(const Dual<N, S>& x) {
  return value(x.v);
}

/// Whether x is zero with all its derivatives: what it multiplies may be left out.
inline bool vanishes(double x) { return x == 0; }
inline bool vanishes(const std::complex<double>& x) { return x == 0.0; }
template <int N, class S>
bool vanishes(const Dual<N, S>& x) {
  return vanishes(x.v) && (x.d == S(0)).all();
}

/// Whether no derivative rides on x: what depends on such numbers alone may be computed without.
template <int N>
bool is_constant(const Dual<N>& x) {
  return (x.d == 0).all();
}
/// The same of an array or a matrix.
template <class A>
bool are_constant(const A& entries) {
  return std::all_of(entries.data(), entries.data() + entries.size(), [](const auto& x) { return is_constant(x); });
}
/// Whether is_constant can tell.
template <class T>
inline constexpr bool tells_constants = false;
template <int N>
inline constexpr bool tells_constants<Dual<N>> = true;

/// The larger one; NaN where either is, so that what is not a number never passes for a small one.
inline double larger(double a, double b) { return std::isnan(a) || a > b ? a : b; }

template <class T>
using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;
template <class T>
using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
template <class T, int D>
using Vec = Eigen::Matrix<T, D, 1>;
template <class T, int R, int C = R>
using Mat = Eigen::Matrix<T, R, C>;

/// Sum of a_i b_i, without conjugation: analytic, so that the complex step may pass through it.
template <class A, class B>
auto dot(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  return a.cwiseProduct(b).sum();
}

/// a x b, without conjugation.
template <class T>
Vec<T, 3> cross(const Vec<T, 3>& a, const Vec<T, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Euclidean norm without conjugation; not differentiable at zero, where the caller must not use it. If squares would
/// under- or overflow, the vector is scaled by a power of two, which rounds nothing.
template <class A>
typename A::Scalar norm(const Eigen::MatrixBase<A>& a) {
  using std::sqrt;
  using T = typename A::Scalar;
  constexpr double least = 0x1p-900, most = 0x1p900;  // what a square between them loses of other squares is rounding
  const T square = dot(a, a);
  if (value(square) > least && value(square) < most) return sqrt(square);
  double largest = 0;
  for (Eigen::Index j = 0; j < a.cols(); ++j)
    for (Eigen::Index i = 0; i < a.rows(); ++i) largest = std::max(largest, std::abs(value(a.coeff(i, j))));
  if (!(largest > 0 && std::isfinite(largest))) return sqrt(square);
  const T scale(std::ldexp(1.0, -std::clamp(std::ilogb(largest), -1000, 1000)));
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> scaled = a;
  for (Eigen::Index i = 0; i < scaled.size(); ++i) scaled.coeffRef(i) *= scale;
  return sqrt(dot(scaled, scaled)) / scale;
}

/// Root of the squares of part(0) ... part(count - 1), which may be tiny or huge.
template <class Part>
double root_of_squares(int count, Part&& part) {
  double squares = 0, root = 0;
  for (int i = 0; i < count; ++i) squares += part(i) * part(i);
  if (squares > 0x1p-900 && squares < 0x1p900) return std::sqrt(squares);
  for (int i = 0; i < count; ++i) root = std::hypot(root, part(i));
  return root;
}

/// Primal parts of a vector or matrix.
template <class A>
auto values(const Eigen::MatrixBase<A>& a) {
  return a.unaryExpr([](const typename A::Scalar& x) { return value(x); }).eval();
}

}  // namespace stickslip

namespace Eigen {
template <int N, class S>
struct NumTraits<stickslip::Dual<N, S>> : NumTraits<double> {
  using Real = stickslip::Dual<N, S>;
  using NonInteger = stickslip::Dual<N, S>;
  using Nested = stickslip::Dual<N, S>;
  using Literal = stickslip::Dual<N, S>;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 1 + N,
    AddCost = 1 + N,
    MulCost = 1 + 3 * N
  };
};
template <int N, class S, class Op>
struct ScalarBinaryOpTraits<stickslip::Dual<N, S>, S, Op> {
  using ReturnType = stickslip::Dual<N, S>;
};
template <int N, class S, class Op>
struct ScalarBinaryOpTraits<S, stickslip::Dual<N, S>, Op> {
  using ReturnType = stickslip::Dual<N, S>;
};
}  // namespace Eigen
