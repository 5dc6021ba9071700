/// Scalars that an equation defines: solved for in double, and given their derivatives by the implicit function
/// theorem,
///
///   x = x* - r_T(x*) / r'(x*),   r_T the equation's excess in the scalar T, r' its slope in double,
///
/// for Dual, Reverse and complex alike. A scalar of two layers (a Dual of Duals) takes a second correction.
#pragma once

#include <cmath>

#include "core/algebra/scalar.hpp"

namespace stickslip {

/// The zero of equation.excess(x), in double. The excess falls from a positive value at x = 0 to a negative one.
/// Newton's method; a step that leaves the bracket of the zero is replaced by half of the bracket.
template <class Equation>
double root_of(const Equation& equation) {
  constexpr int most = 200;
  double low = 0, high = INFINITY, x = 0;
  for (int i = 0; i < most; ++i) {
    const auto at = equation.excess(Dual<1>::seed(x, 0));
    (at.v > 0 ? low : high) = x;
    double next = x - at.v / at.d[0];
    if (!(next > low && next < high)) next = std::isinf(high) ? 2 * low : (low + high) / 2;
    if (at.v == 0 || std::abs(next - x) <= 4 * unit_roundoff * x) return x;
    x = next;
  }
  return x;
}

/// The root of an equation in the scalar T, given the one in double.
template <class T, class Equation>
T solve_implicit(const Equation& equation, double root) {
  if constexpr (std::is_same_v<T, double>) {
    return root;
  } else {
    T x(root);
    for (int layer = 0; layer < 2; ++layer) {
      const auto at = equation.excess(Dual<1, T>::seed(x, 0));
      x -= at.v / T(value(at.d[0]));
    }
    return x;
  }
}

}  // namespace stickslip
