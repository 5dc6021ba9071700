/// The 1-norm of an operator that is known by what it does to vectors.
#pragma once

#include <utility>

#include "core/algebra/scalar.hpp"

namespace stickslip {

/// Estimate of the 1-norm of an operator and the vector that shows it, by apply(x) and its adjoint; a lower bound,
/// rarely off by more than 3. N. J. Higham, ACM Trans. Math. Softw. 14 (1988) 381-396, algorithm 4.1 (after Hager).
template <class T, class Apply, class Adjoint>
std::pair<double, Vector<T>> one_norm_estimate(int n, Apply apply, Adjoint adjoint) {
  const auto sign = [](const T& x) { return std::abs(x) > 0 ? x / std::abs(x) : T(1); };
  Vector<T> v = apply(Vector<T>::Constant(n, T(1.0 / n)));
  double estimate = v.template lpNorm<1>();
  if (n == 1) return {estimate, v};
  Vector<T> signs = v.unaryExpr(sign);
  Vector<T> gradient = adjoint(signs);
  Eigen::Index largest = -1;
  for (int iteration = 2; iteration <= 5; ++iteration) {
    Eigen::Index j = 0;
    const double steepest = gradient.cwiseAbs().maxCoeff(&j);
    if (largest >= 0 && steepest <= std::abs(gradient[largest])) break;
    largest = j;
    Vector<T> w = apply(Vector<T>::Unit(n, j));
    const double norm_w = w.template lpNorm<1>();
    const Vector<T> new_signs = w.unaryExpr(sign);
    if (norm_w <= estimate) break;
    estimate = norm_w;
    v = std::move(w);
    if (new_signs == signs) break;
    signs = new_signs;
    gradient = adjoint(signs);
  }
  // A vector of alternating sign catches what cancels in the ones above.
  Vector<T> alternating(n);
  for (int i = 0; i < n; ++i) alternating[i] = T((i % 2 ? -1.0 : 1.0) * (1 + static_cast<double>(i) / (n - 1)));
  Vector<T> w = apply(alternating);
  const double norm_w = 2 * w.template lpNorm<1>() / (3.0 * n);
  if (norm_w > estimate) return {norm_w, w};
  return {estimate, v};
}

}  // namespace stickslip
