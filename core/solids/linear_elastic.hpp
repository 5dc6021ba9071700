/// Isotropic linear elasticity: stress = lame tr(e) I + 2 G e, e = sym(H), H the displacement gradient.
///
///   lame = E nu / ((1+nu)(1-2nu)),  G = E / (2(1+nu))      plane strain
///   lame -> 2 lame G / (lame + 2G)                         plane stress (the thickness adapts)
///
/// Linear in H; differentiable everywhere for E > 0, -1 < nu < 1/2.
#pragma once

#include "core/model/scene.hpp"

namespace stickslip {

template <class T>
struct LinearElasticLaw {
  T lame, shear;

  LinearElasticLaw(const T& lambda, const T& G) : lame(lambda), shear(G) {}
  LinearElasticLaw(const T& E, const T& nu, Space space) {
    lame = E * nu / ((T(1) + nu) * (T(1) - T(2) * nu));
    shear = E / (T(2) * (T(1) + nu));
    if (space == Space::plane_stress) lame = T(2) * lame * shear / (lame + T(2) * shear);
  }

  /// The law with other numbers.
  template <class U>
  LinearElasticLaw<U> with(const U& lambda, const U& G) const {
    return {lambda, G};
  }

  /// Stress of a displacement gradient H (D x D), in the scalar of H: U is T, or a Dual built on T.
  template <class U, int D>
  Mat<U, D> stress(const Mat<U, D>& H) const {
    U trace = H(0, 0);
    for (int i = 1; i < D; ++i) trace += H(i, i);
    Mat<U, D> sigma;
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) {
        sigma(i, j) = (H(i, j) + H(j, i)) * U(shear);
        if (i == j) sigma(i, j) += trace * U(lame);
      }
    return sigma;
  }
};

}  // namespace stickslip
