/// Isotropic linear elasticity: stress = lame tr(e) I + 2 G e, e = sym(H), H the displacement gradient.
///
///   lame = E nu / ((1+nu)(1-2nu)),  G = E / (2(1+nu))      plane strain
///   lame -> 2 lame G / (lame + 2G)                         plane stress (the thickness adapts)
///
/// Linear in H; differentiable everywhere for E > 0, -1 < nu < 1/2.
#pragma once

#include <array>
#include <tuple>

#include "core/algebra/described.hpp"
#include "core/algebra/scalar.hpp"
#include "core/solids/tensor.hpp"

namespace stickslip {

struct LinearElastic {
  static constexpr const char *key = "linear_elastic",
                              *about = "of bars, and where strains are small of all but points",
                              *place = "fills bars, and where strains are small all but points";
  Number E, nu;

  static constexpr auto keys() {
    return std::tuple{Key{&LinearElastic::E, "E", "Young's modulus (force per area)", InRange{Range::positive, 1000}},
                      Key{&LinearElastic::nu, "nu", "Poisson's ratio", InRange{Range::poisson_ratio, 0.3}}};
  }
};

/// Lame's first constant in plane stress, where the thickness adapts.
template <class T>
T lame_of_plane_stress(const T& lame, const T& shear) {
  return T(2) * lame * shear / (lame + T(2) * shear);
}

template <class T>
struct LinearElasticLaw {
  static constexpr bool is_finite = false;
  static constexpr bool is_made_for(Kinematics, Strains strains) { return strains == Strains::small; }

  T lame, shear;
  Space space = Space::plane_strain;

  LinearElasticLaw(const T& lambda, const T& G) : lame(lambda), shear(G) {}
  LinearElasticLaw(const T& E, const T& nu, Space in) : space(in) {
    lame = E * nu / ((T(1) + nu) * (T(1) - T(2) * nu));
    shear = E / (T(2) * (T(1) + nu));
    if (space == Space::plane_stress) lame = lame_of_plane_stress(lame, shear);
  }

  /// The numbers that it consists of, and the law with others.
  std::array<T, 2> numbers() const { return {lame, shear}; }
  template <class U>
  LinearElasticLaw<U> with(const std::array<U, 2>& numbers) const {
    LinearElasticLaw<U> law(numbers[0], numbers[1]);
    law.space = space;
    return law;
  }

  /// Stress of a displacement gradient H, in the scalar of H: U is T, or a Dual built on T.
  template <class U, TensorLayout layout>
  Tensor<U, layout> stress(const Tensor<U, layout>& H) const {
    const U trace = H.trace();
    Tensor<U, layout> sigma;
    H.for_each([&](int i, int j) {
      sigma(i, j) = (H(i, j) + H(j, i)) * U(shear);
      if (i == j) sigma(i, j) += trace * U(lame);
    });
    return sigma;
  }

  /// Stretch across the plane.
  double stretch_across(const PlaneGradient<double>& H) const {
    return space == Space::plane_stress ? 1 - value(lame) / (2 * value(shear)) * H.trace() : 1;
  }

  /// Stress across the plane.
  double stress_across(const PlaneGradient<double>& H) const {
    return space == Space::plane_strain ? value(lame) * H.trace() : 0;
  }

  /// Energy per volume.
  template <class U, TensorLayout layout>
  U energy(const Tensor<U, layout>& H) const {
    return U(0.5) * contracted(stress(H), H);
  }
};

template <class T>
LinearElasticLaw<T> law_of(const LinearElastic& material, Space space, Strains /*strains*/, const Numbers<T>& numbers) {
  return {numbers(material.E), numbers(material.nu), space};
}

}  // namespace stickslip
