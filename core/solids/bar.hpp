/// Two-node bar, small strain: axial force EA (u_2 - u_1).t / L along the initial direction t; no other stiffness.
#pragma once

#include "core/algebra/scalar.hpp"

namespace stickslip {

/// Tangent, (2 D) x (2 D), node-major; the residual of a small-strain bar is the tangent times u.
/// `coordinates`: D x 2. `axial`: E times area (force).
template <class T, int D>
Mat<T, 2 * D> bar_tangent(const Mat<T, D, 2>& coordinates, const T& axial) {
  const Vec<T, D> direction = coordinates.col(1) - coordinates.col(0);
  const T length = norm(direction);
  Mat<T, 2 * D> K;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) {
      const T k = axial * direction[i] * direction[j] / (length * length * length);
      K(i, j) = K(D + i, D + j) = k;
      K(i, D + j) = K(D + i, j) = -k;
    }
  return K;
}

}  // namespace stickslip
