/// Two-node bar, by its initial axis A = X_2 - X_1 of length L and the relative displacement d = u_2 - u_1.
///
///   small strain   force EA (d.A) A / L^3
///   Green strain   e = (A.d + d.d/2) / L^2,   force EA e (A + d) / L,   energy EA L e^2 / 2
#pragma once

#include "core/solids/linear_elastic.hpp"

namespace stickslip {

/// `axial`: E times the cross-section (force); `green`: of Green strain.
template <class T>
struct BarLaw {
  T axial, area;
  bool green = false;

  bool is_linear() const { return !green; }

  /// `coordinates`: D x 2.
  template <int D>
  T strain(const Mat<T, D, 2>& coordinates, const Vec<T, D>& d) const {
    const Vec<T, D> axis = coordinates.col(1) - coordinates.col(0);
    return (dot(axis, d) + (green ? dot(d, d) / T(2) : T(0))) / dot(axis, axis);
  }
  /// Of the force on the second node per stress resultant: a unit vector where strains are small.
  template <int D>
  Vec<T, D> direction(const Mat<T, D, 2>& coordinates, const Vec<T, D>& d) const {
    const Vec<T, D> axis = coordinates.col(1) - coordinates.col(0);
    Vec<T, D> along;
    for (int i = 0; i < D; ++i) along[i] = (green ? T(axis[i] + d[i]) : axis[i]) / norm(axis);
    return along;
  }

  /// Derivative of the force by d. `coordinates`: D x 2.
  template <int D>
  Mat<T, D> stiffness(const Mat<T, D, 2>& coordinates, const Vec<T, D>& d) const {
    const Vec<T, D> axis = coordinates.col(1) - coordinates.col(0);
    Mat<T, D> k;
    if (!green) {
      const T length = norm(axis);
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) k(i, j) = axial * axis[i] * axis[j] / (length * length * length);
      return k;
    }
    const T square = dot(axis, axis), length = norm(axis), strain = (dot(axis, d) + dot(d, d) / T(2)) / square;
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) {
        k(i, j) = axial * (axis[i] + d[i]) * (axis[j] + d[j]) / (square * length);
        if (i == j) k(i, j) += axial * strain / length;
      }
    return k;
  }

  /// Force on the second node; the first one has the opposite.
  template <int D>
  Vec<T, D> force(const Mat<T, D, 2>& coordinates, const Vec<T, D>& d) const {
    if (!green) return stiffness<D>(coordinates, d) * d;
    const Vec<T, D> axis = coordinates.col(1) - coordinates.col(0);
    const T square = dot(axis, axis), strain = (dot(axis, d) + dot(d, d) / T(2)) / square;
    const T force = axial * strain / norm(axis);
    Vec<T, D> f;
    for (int i = 0; i < D; ++i) f[i] = force * (axis[i] + d[i]);
    return f;
  }

  template <int D>
  T energy(const Mat<T, D, 2>& coordinates, const Vec<T, D>& d) const {
    if (!green) return T(0.5) * dot(force<D>(coordinates, d), d);
    const Vec<T, D> axis = coordinates.col(1) - coordinates.col(0);
    const T strain = (dot(axis, d) + dot(d, d) / T(2)) / dot(axis, axis);
    return axial * norm(axis) * strain * strain / T(2);
  }
};

/// The law of bars of a material, `elastic` being their law where they are elastic.
template <class T>
BarLaw<T> bar_of(const LinearElastic& /*material*/, const BarLaw<T>& elastic, const Numbers<T>& /*numbers*/) {
  return elastic;
}

}  // namespace stickslip
