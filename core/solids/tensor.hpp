/// Tensors of the second order at a point: displacement gradients H, stresses, and what is made of them.
///
/// A tensor carries in its type which of its components are not always zero, its layout. Nothing else decides that, and
/// no tensor becomes one of another layout by itself.
///
///   plane4   00 10 01 11                  a state of the plane, without what is across it
///   hoop5    00 10 01 11, 22              the plane, and the one component across it: of revolution, or of an element
///                                         with mean dilatation
///   full9    00 10 20 01 11 21 02 12 22   space
#pragma once

#include "core/algebra/scalar.hpp"
#include "core/solids/kinematics.hpp"

namespace stickslip {

template <class T, TensorLayout layout>
class Tensor {
 public:
  static constexpr bool in_space = layout == TensorLayout::full9;
  static constexpr int rows = layout == TensorLayout::plane4 ? 2 : 3;
  static constexpr int size = in_space ? 9 : 2 + rows;  ///< components
  static constexpr int block = in_space ? 3 : 2;        ///< rows of matrix()

  Tensor() = default;
  explicit Tensor(const Mat<T, rows>& all) requires(layout != TensorLayout::hoop5) : components_(all.reshaped()) {}
  static Tensor constant(const T& x) {
    Tensor all;
    all.components_.setConstant(x);
    return all;
  }

  /// Place of a component in the order above. pre: the layout has it.
  static constexpr int place(int p, int q) { return rows > block && p == 2 ? 4 : p + block * q; }
  /// Calls f(p, q) for all components in their order.
  template <class F>
  static void for_each(F&& f) {
    for (int k = 0; k < block * block; ++k) f(k % block, k / block);
    if constexpr (rows > block) f(2, 2);
  }

  T& operator()(int p, int q) { return components_[place(p, q)]; }
  const T& operator()(int p, int q) const { return components_[place(p, q)]; }
  T& operator[](int k) { return components_[k]; }
  const T& operator[](int k) const { return components_[k]; }

  /// The components that are coupled, as a matrix: those of the plane, or all of space.
  auto matrix() { return Eigen::Map<Mat<T, block>>(components_.data()); }
  auto matrix() const { return Eigen::Map<const Mat<T, block>>(components_.data()); }

  /// All components, with those that are always zero.
  Mat<T, rows> full() const {
    Mat<T, rows> all = Mat<T, rows>::Constant(T(0));
    for_each([&](int p, int q) { all(p, q) = (*this)(p, q); });
    return all;
  }
  /// F = I + H of the components that matrix() has.
  Mat<T, block> plus_one() const {
    Mat<T, block> F = matrix();
    for (int i = 0; i < block; ++i) F(i, i) += T(1);
    return F;
  }
  T trace() const {
    T sum = (*this)(0, 0);
    for (int i = 1; i < rows; ++i) sum += (*this)(i, i);
    return sum;
  }

  /// With each component f(component).
  template <class F>
  auto map(F&& f) const {
    Tensor<decltype(f((*this)[0])), layout> out;
    for (int k = 0; k < size; ++k) out[k] = f(components_[k]);
    return out;
  }

 private:
  Vec<T, size> components_;
};

/// A displacement gradient of the plane.
template <class T>
using PlaneGradient = Tensor<T, TensorLayout::plane4>;

/// Sum over all components of A_pq B_pq.
template <class T, TensorLayout layout>
T contracted(const Tensor<T, layout>& A, const Tensor<T, layout>& B) {
  T sum = A[0] * B[0];
  for (int k = 1; k < A.size; ++k) sum += A[k] * B[k];
  return sum;
}

/// Cofactors of a matrix of space: det A A^-T.
template <class T>
Mat<T, 3> cofactors(const Mat<T, 3>& A) {
  Mat<T, 3> all;
  for (int p = 0; p < 3; ++p)
    for (int q = 0; q < 3; ++q) {
      const int p1 = (p + 1) % 3, p2 = (p + 2) % 3, q1 = (q + 1) % 3, q2 = (q + 2) % 3;
      all(p, q) = A(p1, q1) * A(p2, q2) - A(p1, q2) * A(p2, q1);
    }
  return all;
}

/// What is left of det F - 1 without tr H, F = I + H: of the components that matrix() has.
template <class T, TensorLayout layout>
T nonlinear_growth(const Tensor<T, layout>& H) {
  if constexpr (Tensor<T, layout>::in_space) {
    const Mat<T, 3> A = H.matrix(), minors = cofactors<T>(A);
    return minors.trace() + dot(A.row(0), minors.row(0));
  } else {
    return H(0, 0) * H(1, 1) - H(0, 1) * H(1, 0);
  }
}

/// det F - 1, F = I + H, with the digits of a small H: of the components that matrix() has, in the plane of its area.
template <class T, TensorLayout layout>
T growth_of_matrix(const Tensor<T, layout>& H) {
  T trace = H(0, 0) + H(1, 1);
  if constexpr (Tensor<T, layout>::in_space) trace += H(2, 2);
  return trace + nonlinear_growth(H);
}

/// det F - 1 of all components.
template <class T, TensorLayout layout>
T growth(const Tensor<T, layout>& H) {
  const T j = growth_of_matrix(H);
  if constexpr (layout == TensorLayout::hoop5) return j + H(2, 2) + j * H(2, 2);
  return j;
}

/// F F^T - I of space, with the digits of a small H.
template <class T>
Mat<T, 3> left_strain(const Tensor<T, TensorLayout::full9>& H) {
  const Mat<T, 3> A = H.matrix();
  return A + A.transpose() + A.lazyProduct(A.transpose());
}

/// Whether F = I + H turns a volume inside out, or what is across the plane.
template <class T, TensorLayout layout>
bool is_inverted(const Tensor<T, layout>& H) {
  if constexpr (layout == TensorLayout::hoop5)
    if (!(value(H(2, 2)) > -1)) return true;
  return !(growth_of_matrix(H.map([](const T& x) { return value(x); })) > -1);
}

}  // namespace stickslip
