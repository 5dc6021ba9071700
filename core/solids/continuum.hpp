/// The element template of the continuum: residual and tangent of any shape and any material routine.
///
///   R_ia = int sigma_ij dN_a/dX_j dV        K = int dN_a/dX_j (dsigma_ij/dH_kl) dN_b/dX_l dV
///
/// The material tangent is the Dual of the stress routine; this file writes its assembly into an element once, by hand.
/// Tested against the Dual of the whole element.
#pragma once

#include "core/solids/shapes.hpp"

namespace stickslip {

/// dN/dX (one column a node) and the volume of one quadrature point. `coordinates`: D x nodes.
template <class T, class Shape>
struct Gradient {
  Mat<T, Shape::dimension, Shape::nodes> dN;
  T volume;

  Gradient(const typename Shape::Point& point, const Mat<T, Shape::dimension, Shape::nodes>& coordinates) {
    static_assert(Shape::dimension == 2);
    Mat<T, 2> J = Mat<T, 2>::Zero();  // J(i, j) = dX_i/dxi_j
    for (int a = 0; a < Shape::nodes; ++a)
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) J(i, j) += coordinates(i, a) * T(point.gradient(j, a));
    const T det = J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0);
    volume = det * T(point.weight);
    for (int a = 0; a < Shape::nodes; ++a) {
      const T gx(point.gradient(0, a)), gy(point.gradient(1, a));
      dN(0, a) = (gx * J(1, 1) - gy * J(1, 0)) / det;
      dN(1, a) = (gy * J(0, 0) - gx * J(0, 1)) / det;
    }
  }

  /// Displacement gradient H_ij = du_i/dX_j of nodal displacements (D x nodes).
  Mat<T, Shape::dimension> of(const Mat<T, Shape::dimension, Shape::nodes>& u) const {
    constexpr int D = Shape::dimension;
    Mat<T, D> H = Mat<T, D>::Zero();
    for (int a = 0; a < Shape::nodes; ++a)
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) H(i, j) += u(i, a) * dN(j, a);
    return H;
  }
};

/// Internal nodal forces, D x nodes.
template <class T, class Shape, class Law>
Mat<T, Shape::dimension, Shape::nodes> element_forces(const Law& law,
                                                      const Mat<T, Shape::dimension, Shape::nodes>& coordinates,
                                                      const Mat<T, Shape::dimension, Shape::nodes>& u) {
  constexpr int D = Shape::dimension;
  static const auto quadrature = Shape::quadrature();
  Mat<T, D, Shape::nodes> forces = Mat<T, D, Shape::nodes>::Zero();
  for (const auto& point : quadrature) {
    const Gradient<T, Shape> gradient(point, coordinates);
    const Mat<T, D> sigma = law.template stress<T, D>(gradient.of(u));
    for (int a = 0; a < Shape::nodes; ++a)
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) forces(i, a) += sigma(i, j) * gradient.dN(j, a) * gradient.volume;
  }
  return forces;
}

/// Tangent, (D nodes) x (D nodes), node-major.
template <class T, class Shape, class Law>
Mat<T, Shape::dimension * Shape::nodes> element_tangent(const Law& law,
                                                        const Mat<T, Shape::dimension, Shape::nodes>& coordinates,
                                                        const Mat<T, Shape::dimension, Shape::nodes>& u) {
  constexpr int D = Shape::dimension, n = Shape::nodes;
  using Probe = Dual<D * D, T>;
  static const auto quadrature = Shape::quadrature();
  Mat<T, D* n> K = Mat<T, D * n>::Zero();
  for (const auto& point : quadrature) {
    const Gradient<T, Shape> gradient(point, coordinates);
    const Mat<T, D> H = gradient.of(u);
    Mat<Probe, D> seeded;
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) seeded(i, j) = Probe::seed(H(i, j), i * D + j);
    const Mat<Probe, D> sigma = law.template stress<Probe, D>(seeded);
    for (int b = 0; b < n; ++b)
      for (int k = 0; k < D; ++k)
        for (int i = 0; i < D; ++i) {
          Vec<T, D> column;  // d sigma_ij / d u_kb, j = 0..D-1, times the volume
          for (int j = 0; j < D; ++j) {
            column[j] = T(0);
            for (int l = 0; l < D; ++l) column[j] += sigma(i, j).d[k * D + l] * gradient.dN(l, b);
            column[j] *= gradient.volume;
          }
          for (int a = 0; a < n; ++a)
            for (int j = 0; j < D; ++j) K(a * D + i, b * D + k) += gradient.dN(j, a) * column[j];
        }
  }
  return K;
}

/// Strain energy 1/2 int sigma : H dV of a linear law.
template <class T, class Shape, class Law>
T element_energy(const Law& law, const Mat<T, Shape::dimension, Shape::nodes>& coordinates,
                 const Mat<T, Shape::dimension, Shape::nodes>& u) {
  return T(0.5) * element_forces<T, Shape, Law>(law, coordinates, u).cwiseProduct(u).sum();
}

}  // namespace stickslip
