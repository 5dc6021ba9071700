/// Compressible neo-Hookean material at finite strain, in plane strain and of revolution.
///
///   W = G ((tr C - 3)/2 - ln J) + U(J),   U = lame/2 (J - 1)^2 (quadratic) or lame/2 (ln J)^2 (log)
///   P = dW/dF = G (F - F^-T) + J U'(J) F^-T,   F = I + H,   C = F^T F,   J = det F
///
///   lame = E nu / ((1+nu)(1-2nu)),  G = E / (2(1+nu)): Hooke's law at small H, for both U
///
/// Both are written in H, so that a small strain does not vanish beside one. In the plane j = J - 1 = tr H + det H,
/// F^-T is the cofactor matrix over J, and J F - cof F = j F + (F - cof F). Of revolution the hoop stretch F_22 = 1 + h
/// stands beside the plane, whose j and J these then are: the volume is J F_22. An element with J <= 0 or F_22 <= 0 is
/// inverted: its stress is not a number, so that no residual passes it. Differentiable where neither is. Source: [W06].
#pragma once

#include <limits>

#include "core/solids/linear_elastic.hpp"

namespace stickslip {

struct NeoHookean {
  enum class Volumetric { quadratic, log };
  Number E, nu;
  Volumetric volumetric = Volumetric::quadratic;
};

template <class T>
struct NeoHookeanLaw {
  static constexpr bool is_finite = true;
  static constexpr bool is_made_for(Kinematics, bool finite_strain) { return finite_strain; }

  T lame, shear;
  NeoHookean::Volumetric volumetric = NeoHookean::Volumetric::quadratic;

  NeoHookeanLaw(const T& lambda, const T& G, NeoHookean::Volumetric kind) : lame(lambda), shear(G), volumetric(kind) {}

  /// The numbers that it consists of, and the law with others.
  std::array<T, 2> numbers() const { return {lame, shear}; }
  template <class U>
  NeoHookeanLaw<U> with(const std::array<U, 2>& numbers) const {
    return {numbers[0], numbers[1], volumetric};
  }

  /// What it is at the start.
  LinearElasticLaw<T> at_rest() const { return {lame, shear}; }

  /// First Piola-Kirchhoff stress of a displacement gradient H (2 x 2, or 3 x 3 with nothing but H_22 out of the
  /// plane), in the scalar of H: U is T, or a Dual built on T.
  template <class U, int D>
  Mat<U, D> stress(const Mat<U, D>& H) const {
    using std::log1p, stickslip::log1p;
    const U j = plane_growth(H), J = U(1) + j;
    bool inverted = !(value(J) > 0);
    if constexpr (D == 3) inverted |= !(value(H(2, 2)) > -1);
    if (inverted) return Mat<U, D>::Constant(U(std::numeric_limits<double>::quiet_NaN()));
    const bool quadratic = volumetric == NeoHookean::Volumetric::quadratic;
    const U shear_over_J = U(shear) / J, F00 = U(1) + H(0, 0), F11 = U(1) + H(1, 1), apart = H(0, 0) - H(1, 1),
            sheared = H(0, 1) + H(1, 0);
    U across;  // J_3 U'(J_3) / J, J_3 the volume
    if constexpr (D == 2)
      across = quadratic ? U(U(lame) * j) : U(U(lame) * log1p(j) / J);
    else
      across = quadratic ? U(U(lame) * growth(H) * (U(1) + H(2, 2))) : U(U(lame) * log1p(growth(H)) / J);
    Mat<U, D> P;
    if constexpr (D == 3) {
      const U h = H(2, 2), F22 = U(1) + h;
      P.setConstant(U(0));
      P(2, 2) = U(shear) * h * (U(2) + h) / F22 + across * J / F22;
    }
    P(0, 0) = shear_over_J * (j * F00 + apart) + across * F11;
    P(1, 1) = shear_over_J * (j * F11 - apart) + across * F00;
    P(0, 1) = shear_over_J * (j * H(0, 1) + sheared) - across * H(1, 0);
    P(1, 0) = shear_over_J * (j * H(1, 0) + sheared) - across * H(0, 1);
    return P;
  }

  /// Cauchy's stress across the plane, U'(J).
  double stress_across(const Mat<double, 2>& H) const {
    const double j = plane_growth(H);
    return volumetric == NeoHookean::Volumetric::quadratic ? value(lame) * j : value(lame) * std::log1p(j) / (1 + j);
  }

  /// Energy per initial volume.
  template <class U, int D>
  U energy(const Mat<U, D>& H) const {
    using std::log1p, stickslip::log1p;
    const U j = growth(H), logarithm = log1p(j);
    U squares{};
    for (int k = 0; k < D * D; ++k) squares += H.data()[k] * H.data()[k];
    U half = H(0, 0) + H(1, 1) + squares / U(2);  // (tr C - 3)/2
    if constexpr (D == 3) half += H(2, 2);
    const U change = volumetric == NeoHookean::Volumetric::quadratic ? j : logarithm;
    return U(shear) * (half - logarithm) + U(lame) / U(2) * change * change;
  }

 private:
  /// J - 1 in the plane.
  template <class U, int D>
  static U plane_growth(const Mat<U, D>& H) {
    return H(0, 0) + H(1, 1) + (H(0, 0) * H(1, 1) - H(0, 1) * H(1, 0));
  }
  /// The volume's.
  template <class U, int D>
  static U growth(const Mat<U, D>& H) {
    const U j = plane_growth(H);
    if constexpr (D == 2) return j;
    if constexpr (D == 3) return j + H(2, 2) + j * H(2, 2);
  }
};

template <class T>
NeoHookeanLaw<T> law_of(const NeoHookean& material, Space, bool /*finite_strain*/, const Numbers<T>& numbers) {
  const LinearElasticLaw<T> small(numbers(material.E), numbers(material.nu), Space::plane_strain);
  return {small.lame, small.shear, material.volumetric};
}

}  // namespace stickslip
