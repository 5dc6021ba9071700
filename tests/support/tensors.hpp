/// Tensors of a law from matrices, in each layout.
#pragma once

#include "core/solids/tensor.hpp"

namespace stickslip {

/// Of a matrix whose other entries are zero.
template <TensorLayout layout, class A>
auto tensor_of(const Eigen::MatrixBase<A>& all) {
  const auto entries = all.eval();
  Tensor<typename A::Scalar, layout> tensor;
  tensor.for_each([&](int p, int q) { tensor(p, q) = entries(p, q); });
  return tensor;
}
template <class A>
auto in_plane(const Eigen::MatrixBase<A>& all) {
  return tensor_of<TensorLayout::plane4>(all);
}
template <class A>
auto with_hoop(const Eigen::MatrixBase<A>& all) {
  return tensor_of<TensorLayout::hoop5>(all);
}
template <class A>
auto in_space(const Eigen::MatrixBase<A>& all) {
  return tensor_of<TensorLayout::full9>(all);
}

}  // namespace stickslip
