/// Spring of a point to its anchor: force K d, energy d.K d / 2, d the displacement of the point from its anchor.
#pragma once

#include <vector>

#include "core/algebra/number.hpp"
#include "core/algebra/scalar.hpp"

namespace stickslip {

/// D x D, symmetric, positive definite.
struct GroundedSpring {
  std::vector<std::vector<Number>> stiffness;
};

template <class T>
struct SpringLaw {
  Matrix<T> matrix;

  bool is_linear() const { return true; }

  template <int D>
  Mat<T, D> stiffness(const Mat<T, D, 2>& /*coordinates*/, const Vec<T, D>& /*d*/) const {
    return matrix;
  }
  template <int D>
  Vec<T, D> force(const Mat<T, D, 2>& /*coordinates*/, const Vec<T, D>& d) const {
    return Mat<T, D>(matrix) * d;
  }
  template <int D>
  T energy(const Mat<T, D, 2>& coordinates, const Vec<T, D>& d) const {
    return T(0.5) * dot(force<D>(coordinates, d), d);
  }
};

template <class T>
SpringLaw<T> law_of(const GroundedSpring& spring, const Numbers<T>& numbers) {
  const int d = static_cast<int>(spring.stiffness.size());
  SpringLaw<T> law{Matrix<T>(d, d)};
  for (int i = 0; i < d; ++i)
    for (int j = 0; j < d; ++j) law.matrix(i, j) = numbers(spring.stiffness[i][j]);
  return law;
}

}  // namespace stickslip
