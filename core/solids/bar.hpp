/// Two-node bar, by its initial axis A = X_2 - X_1 of length L and the relative displacement d = u_2 - u_1.
///
///   small strain   force EA (d.A) A / L^3
///   Green strain   e = (A.d + d.d/2) / L^2,   force EA e (A + d) / L,   energy EA L e^2 / 2
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

/// Force of a bar of Green strain on its second node; the first one has the opposite.
template <class T, int D>
Vec<T, D> green_bar_force(const Mat<T, D, 2>& coordinates, const T& axial, const Vec<T, D>& d) {
  const Vec<T, D> axis = coordinates.col(1) - coordinates.col(0);
  const T square = dot(axis, axis), strain = (dot(axis, d) + dot(d, d) / T(2)) / square;
  const T force = axial * strain / norm(axis);
  Vec<T, D> f;
  for (int i = 0; i < D; ++i) f[i] = force * (axis[i] + d[i]);
  return f;
}

/// Tangent of a bar of Green strain, (2 D) x (2 D), node-major.
template <class T, int D>
Mat<T, 2 * D> green_bar_tangent(const Mat<T, D, 2>& coordinates, const T& axial, const Vec<T, D>& d) {
  const Vec<T, D> axis = coordinates.col(1) - coordinates.col(0);
  const T square = dot(axis, axis), length = norm(axis), strain = (dot(axis, d) + dot(d, d) / T(2)) / square;
  Mat<T, 2 * D> K;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) {
      T k = axial * (axis[i] + d[i]) * (axis[j] + d[j]) / (square * length);
      if (i == j) k += axial * strain / length;
      K(i, j) = K(D + i, D + j) = k;
      K(i, D + j) = K(D + i, j) = -k;
    }
  return K;
}

/// Energy of a bar of Green strain.
template <class T, int D>
T green_bar_energy(const Mat<T, D, 2>& coordinates, const T& axial, const Vec<T, D>& d) {
  const Vec<T, D> axis = coordinates.col(1) - coordinates.col(0);
  const T strain = (dot(axis, d) + dot(d, d) / T(2)) / dot(axis, axis);
  return axial * norm(axis) * strain * strain / T(2);
}

}  // namespace stickslip
