/// Compressible neo-Hookean material at finite strain: in space, in the plane and of revolution.
///
///   W = G ((tr C - 3)/2 - ln J) + U(J),   U = lame/2 (J - 1)^2 (quadratic) or lame/2 (ln J)^2 (log)
///   P = dW/dF = G (F - F^-T) + J U'(J) F^-T,   F = I + H,   C = F^T F,   J = det F
///
///   lame = E nu / ((1+nu)(1-2nu)),  G = E / (2(1+nu)): Hooke's law at small H, for both U
///
/// Both are written in H, so that a small strain does not vanish beside one:
///
///   space         P = (G (F F^T - I) + J U' I) F^-T
///   plane         j = J - 1 = tr H + det H, F^-T is the cofactor matrix over J, J F - cof F = j F + (F - cof F)
///   revolution    the same with the hoop stretch F_22 = 1 + h beside the plane, whose j and J these then are: the
///                 volume is J F_22
///
/// An element with J <= 0 or F_22 <= 0 is inverted: its stress is not a number, so that no residual passes it.
/// Differentiable if neither holds. Source: [W06].
///
/// In plane stress F_22 is the stretch of the thickness that leaves P_22 = 0,
///
///   G (F_22^2 - 1) + V U'(V) = 0,  V = J F_22,   hence   P = G (F - F_22^2 F^-T) in the plane
///
/// which is quadratic in F_22 where U is, and with U of the logarithm has one unknown, ln F_22
/// (core/algebra/implicit.hpp). For nu >= 0 there is one root. Below, the larger one is the stable one, and where there
/// is none the element counts as inverted.
#pragma once

#include <limits>
#include <optional>

#include "core/algebra/implicit.hpp"
#include "core/solids/linear_elastic.hpp"
#include "core/solids/logarithmic.hpp"

namespace stickslip {

struct NeoHookean {
  static constexpr const char *key = "neo_hookean", *about = "of all but bars and points where strains are finite",
                              *place = "fills all but bars and points where strains are finite";
  enum class Volumetric { quadratic, log };
  Number E, nu;
  Volumetric volumetric = Volumetric::quadratic;

  static constexpr auto keys() {
    return std::tuple{
        Key{&NeoHookean::E, "E", "Young's modulus of small strains (force per area)", InRange{Range::positive, 1000}},
        Key{&NeoHookean::nu, "nu", "Poisson's ratio of small strains", InRange{Range::poisson_ratio, 0.3}},
        Key{&NeoHookean::volumetric, "volumetric", "energy of a change of volume: lame/2 (J - 1)^2, or lame/2 (ln J)^2",
            std::array{"quadratic", "log"}}};
  }
};

namespace detail {

/// Plane stress of the logarithmic law: x = |ln F_22|, whose sign is given; the stress across, over the shear modulus
/// and against the sign, falls to zero.
template <class T>
struct LogarithmicThickness {
  double sign;
  T ratio, area;  ///< lame / G; ln J

  template <class X>
  X excess(const X& x) const {
    return X(-sign) * exp_minus_one<X>(X(2 * sign) * x) - X(ratio) * (x + X(sign) * X(area));
  }
};

}  // namespace detail

template <class T>
struct NeoHookeanLaw {
  static constexpr bool is_finite = true;
  static constexpr bool is_made_for(Kinematics, Strains strains) { return strains == Strains::finite; }

  T lame, shear;
  NeoHookean::Volumetric volumetric = NeoHookean::Volumetric::quadratic;
  Space space = Space::plane_strain;

  NeoHookeanLaw(const T& lambda, const T& G, NeoHookean::Volumetric kind, Space in = Space::plane_strain)
      : lame(lambda), shear(G), volumetric(kind), space(in) {}

  /// The numbers that it consists of, and the law with others.
  std::array<T, 2> numbers() const { return {lame, shear}; }
  template <class U>
  NeoHookeanLaw<U> with(const std::array<U, 2>& numbers) const {
    return {numbers[0], numbers[1], volumetric, space};
  }

  /// What it is at the start.
  LinearElasticLaw<T> at_rest() const {
    return {space == Space::plane_stress ? lame_of_plane_stress(lame, shear) : lame, shear};
  }

  /// First Piola-Kirchhoff stress of a displacement gradient H, in the scalar of H: U is T, or a Dual built on T.
  template <class U, TensorLayout layout>
  Tensor<U, layout> stress(const Tensor<U, layout>& H) const {
    if (is_inverted(H)) return Tensor<U, layout>::constant(U(std::numeric_limits<double>::quiet_NaN()));
    if constexpr (layout == TensorLayout::full9)
      return stress_in_space(H);
    else
      return stress_about_plane(H);
  }

  /// Stretch across the plane; not a number where plane stress has none.
  template <class U>
  U stretch_across(const PlaneGradient<U>& H) const {
    return space == Space::plane_stress ? U(U(1) + thickening(growth(H))) : U(1);
  }

  /// Cauchy's stress across the plane, U'(J).
  double stress_across(const PlaneGradient<double>& H) const {
    return space == Space::plane_stress ? 0 : value(slope(T(growth(H))));
  }

  /// Energy per initial volume. The first invariant counts what is left of it without the growth of the volume,
  /// (tr C - 3)/2 - (J - 1), for both are of the first order in H and the energy is of the second.
  template <class U, TensorLayout layout>
  U energy(const Tensor<U, layout>& H) const {
    using std::log1p, stickslip::log1p;
    U j = growth_of_matrix(H), half = contracted(H, H) / U(2) - nonlinear_growth(H);
    const auto thicken = [&](const U& h) {
      half -= j * h;
      j += h + j * h;
    };
    if constexpr (layout == TensorLayout::hoop5) thicken(H(2, 2));
    if (layout == TensorLayout::plane4 && space == Space::plane_stress) {
      const U h = thickening(j);
      half += h * h / U(2);
      thicken(h);
    }
    const U change = volumetric == NeoHookean::Volumetric::quadratic ? j : U(log1p(j));
    return U(shear) * (half + less_log1p<U>(j)) + U(lame) / U(2) * change * change;
  }

 private:
  /// U'(J), j = J - 1.
  template <class U>
  U slope(const U& j) const {
    using std::log1p, stickslip::log1p;
    return volumetric == NeoHookean::Volumetric::quadratic ? U(U(lame) * j) : U(U(lame) * log1p(j) / (U(1) + j));
  }

  /// P = (G (F F^T - I) + J U'(J) I) F^-T.
  template <class U>
  Tensor<U, TensorLayout::full9> stress_in_space(const Tensor<U, TensorLayout::full9>& H) const {
    const U j = growth(H), J = U(1) + j;
    Mat<U, 3> tau = U(shear) * left_strain(H);
    for (int i = 0; i < 3; ++i) tau(i, i) += J * slope(j);
    return Tensor<U, TensorLayout::full9>(tau.lazyProduct(cofactors<U>(H.plus_one())).eval() / J);
  }

  /// Of the plane, and of what stands apart from it.
  template <class U, TensorLayout layout>
  Tensor<U, layout> stress_about_plane(const Tensor<U, layout>& H) const {
    using std::log1p, stickslip::log1p;
    const U j = growth_of_matrix(H), J = U(1) + j;
    const U shear_over_J = U(shear) / J, F00 = U(1) + H(0, 0), F11 = U(1) + H(1, 1), apart = H(0, 0) - H(1, 1),
            sheared = H(0, 1) + H(1, 0);
    U across;  // J_3 U'(J_3) / J, J_3 the volume
    Tensor<U, layout> P;
    if constexpr (layout == TensorLayout::plane4) {
      if (space == Space::plane_stress) {
        const U h = thickening(j);
        across = -shear_over_J * h * (U(2) + h);
      } else {
        across = slope(j);
      }
    } else {
      const U h = H(2, 2), F22 = U(1) + h;
      const bool quadratic = volumetric == NeoHookean::Volumetric::quadratic;
      across = quadratic ? U(U(lame) * growth(H) * F22) : U(U(lame) * log1p(growth(H)) / J);
      P(2, 2) = U(shear) * h * (U(2) + h) / F22 + across * J / F22;
    }
    P(0, 0) = shear_over_J * (j * F00 + apart) + across * F11;
    P(1, 1) = shear_over_J * (j * F11 - apart) + across * F00;
    P(0, 1) = shear_over_J * (j * H(0, 1) + sheared) - across * H(1, 0);
    P(1, 0) = shear_over_J * (j * H(1, 0) + sheared) - across * H(0, 1);
    return P;
  }
  /// F_22 - 1 of plane stress, where the plane grows by j; not a number where there is none.
  template <class U>
  U thickening(const U& j) const {
    using std::sqrt;
    const U none(std::numeric_limits<double>::quiet_NaN());
    if (volumetric == NeoHookean::Volumetric::log) return logarithmic_thickening(j).value_or(none);
    // a h^2 + b h + c = 0
    const U J = U(1) + j, stiff = U(lame) * J, a = U(shear) + stiff * J, b = U(2) * a - stiff, c = stiff * j;
    const U square = stiff * stiff + U(4) * U(shear) * a;  // b^2 - 4 a c
    if (!(value(square) > 0)) return none;
    const U root = sqrt(square);
    return value(b) > 0 ? U(-U(2) * c / (b + root)) : U((root - b) / (U(2) * a));
  }
  template <class U>
  std::optional<U> logarithmic_thickening(const U& j) const {
    using std::log1p, stickslip::log1p;
    const U area = log1p(j), ratio = U(lame) / U(shear);
    const double r = value(ratio), c = value(area);
    // r < 0: the stress across is least at exp(2 ln F_22) = -r/2, and must be negative there
    if (!std::isfinite(c) || (r < 0 && !(-r / 2 - 1 + r * (std::log(-r / 2) / 2 + c) < 0))) return std::nullopt;
    const double sign = r * c > 0 ? -1 : 1;
    const double x = root_of(detail::LogarithmicThickness<double>{sign, r, c});
    return exp_minus_one<U>(U(sign) * solve_implicit<U>(detail::LogarithmicThickness<U>{sign, ratio, area}, x));
  }
};

template <class T>
NeoHookeanLaw<T> law_of(const NeoHookean& material, Space space, Strains /*strains*/, const Numbers<T>& numbers) {
  const LinearElasticLaw<T> small(numbers(material.E), numbers(material.nu), Space::plane_strain);
  return {small.lame, small.shear, material.volumetric, space};
}

}  // namespace stickslip
