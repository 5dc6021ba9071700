/// J2 (von Mises) plasticity with isotropic hardening, at small strain and, multiplicative, at finite strain.
///
///   e      elastic strain:  sym(H) - e_p;  at finite strain ln(F C_p^-1 F^T) / 2,  F = I + H
///   tau    lame tr(e) I + 2 G e;  stress tau, at finite strain P = tau F^-T
///   q      sqrt(3/2) |dev tau| <= bound(a),  a the equivalent plastic strain (core/solids/hardening.hpp)
///   flow   where the bound would be passed:  e -> e - d n,  a -> a + d,  n = 3/2 dev tau / q,  q on the bound again
///
/// The radial return. At finite strain the exponential map makes it the same in logarithms, C_p^-1 = F^-1 exp(2 e)
/// F^-T. In the plane and of revolution, d = (q - bound) / (3 G + slope of the bound); in plane stress, p = (tau_00 +
/// tau_11)/2 and the shear shrink apart, and d is the zero of one function (core/algebra/implicit.hpp). No stress
/// across means e_22 = -lame / (lame + 2 G) (e_00 + e_11), at finite strain too, whose thickness follows: no unknown is
/// added.
///
/// It remembers four numbers a point: 00, 11 and 01 of e_p, or of C_p^-1 - I, and a. The component across the plane
/// follows, for flow keeps the volume. Differentiable but where a point is about to flow, or to stop, or ends at a
/// corner of a table. Sources: [SH98] 3.3, 3.4; exponential map and logarithmic strain: [S92].
#pragma once

#include "core/algebra/implicit.hpp"
#include "core/solids/hardening.hpp"
#include "core/solids/linear_elastic.hpp"
#include "core/solids/logarithmic.hpp"

namespace stickslip {

struct J2Plastic {
  Number E, nu, yield, hardening;        ///< `hardening`: behind the last row of the table, where there is one
  std::vector<HardeningRow> table = {};  ///< strains increase from above 0, stresses do not fall below `yield`
};

namespace detail {

/// Plane stress on its way back to the bound: q^2 = (p / (1 + K m))^2 + 3 (s / (1 + 3 G m))^2, m = d / bound(d).
template <class T>
struct PlaneStressReturn {
  T p, square;         ///< of the trial: (tau_00 + tau_11)/2; ((tau_00 - tau_11)/2)^2 + tau_01^2
  T stiffness, shear;  ///< K = E / (2 (1 - nu)), G
  T bound, slope;      ///< before the flow

  template <class X>
  X excess(const X& d) const {
    using std::sqrt;
    const X grown = X(bound) + X(slope) * d, m = d / grown;
    const X mean = X(p) / (X(1) + X(stiffness) * m), across = X(1) + X(3) * X(shear) * m;
    return sqrt(mean * mean + X(3) * X(square) / (across * across)) - grown;
  }
};

}  // namespace detail

template <class T>
struct J2Law {
  static constexpr int memory = 4;
  static constexpr bool is_made_for(Kinematics, bool /*finite_strain*/) { return true; }
  template <class U>
  using Memory = Vec<U, memory>;

  T lame, shear;
  Hardening<T> hardening;
  Space space = Space::plane_strain;
  bool is_finite = false;
  int part = 0;  ///< which of its numbers numbers() and with() are about

  /// The numbers that it consists of, and the law with others. A table has further parts, two rows each.
  int part_count() const { return 1 + (static_cast<int>(hardening.rows.size()) + 1) / 2; }
  std::array<T, 4> numbers() const {
    if (part == 0) return {lame, shear, hardening.yield, hardening.slope};
    std::array<T, 4> numbers{T(0), T(0), T(0), T(0)};
    for (std::size_t k = 0; k < 2 && first_row() + k < hardening.rows.size(); ++k) {
      numbers[2 * k] = hardening.rows[first_row() + k].strain;
      numbers[2 * k + 1] = hardening.rows[first_row() + k].stress;
    }
    return numbers;
  }
  template <class U>
  J2Law<U> with(const std::array<U, 4>& numbers) const {
    J2Law<U> law{U(value(lame)), U(value(shear)), {U(value(hardening.yield)), U(value(hardening.slope))},
                 space,          is_finite,       part};
    for (const auto& [strain, stress] : hardening.rows)
      law.hardening.rows.push_back({U(value(strain)), U(value(stress))});
    if (part == 0) {
      std::tie(law.lame, law.shear, law.hardening.yield, law.hardening.slope) = std::tuple_cat(numbers);
    } else {
      for (std::size_t k = 0; k < 2 && first_row() + k < hardening.rows.size(); ++k)
        law.hardening.rows[first_row() + k] = {numbers[2 * k], numbers[2 * k + 1]};
    }
    return law;
  }

  /// What it is at the start.
  LinearElasticLaw<T> at_rest() const {
    return {space == Space::plane_stress ? lame_of_plane_stress(lame, shear) : lame, shear};
  }

  /// The memory that a displacement gradient H leaves of the one before. (Of an inverted element: the same.) `branch`:
  /// of flow_branch.
  template <class U, int D>
  Memory<U> flow(const Mat<U, D>& H, const Memory<U>& before, int branch = flow_branch::by_values) const {
    if (is_inverted(H) || branch == flow_branch::none) return before;
    Strain<U> e = elastic_strain<U, D>(H, before);
    const Strain<U> flown =
        space == Space::plane_stress ? flow_of_plane_stress(e, before[3], branch) : flow_of(e, before[3], branch);
    if (branch == flow_branch::by_values && value(flown[4]) == 0) return before;
    Memory<U> after;
    after[3] = before[3] + flown[4];
    if (!is_finite) {
      for (int k = 0; k < 3; ++k) after[k] = before[k] + flown[k];
      return after;
    }
    // C_p^-1 - I = F^-1 (exp(2 e) - F F^T) F^-T
    const PlaneTensor<U> left = stretch<U, D>(H, PlaneTensor<U>::Constant(U(0)));
    const PlaneTensor<U> grown =
        exp_minus_one<U>(PlaneTensor<U>(U(2) * (e.template head<3>() - flown.template head<3>())));
    Mat<U, 2> between;
    between << grown[0] - left[0], grown[2] - left[2], grown[2] - left[2], grown[1] - left[1];
    const U J = (U(1) + H(0, 0)) * (U(1) + H(1, 1)) - H(0, 1) * H(1, 0);
    Mat<U, 2> inverse;
    inverse << (U(1) + H(1, 1)) / J, -H(0, 1) / J, -H(1, 0) / J, (U(1) + H(0, 0)) / J;
    const Mat<U, 2> C = inverse.lazyProduct(between).eval().lazyProduct(inverse.transpose()).eval();
    after.template head<3>() << C(0, 0), C(1, 1), (C(0, 1) + C(1, 0)) / U(2);
    return after;
  }

  /// The numbers that decide which branch the flow takes.
  template <class U, int D>
  FlowTrial<U> trial(const Mat<U, D>& H, const Memory<U>& before, int branch = flow_branch::by_values) const {
    using std::sqrt;
    const Strain<U> tau = hooke(elastic_strain<U, D>(H, before));
    const U across = space == Space::plane_stress ? U(0) : tau[3];
    const U a = tau[0] - tau[1], b = tau[1] - across, c = across - tau[0];
    const U squares = (a * a + b * b + c * c) / U(2) + U(3) * tau[2] * tau[2];
    return {value(squares) > 0 ? U(sqrt(squares)) : U(0), before[3], flow<U, D>(H, before, branch)[3], U(T(3) * shear)};
  }
  /// FlowTrial::margin of a motion.
  template <int D>
  double margin(const Mat<double, D>& H, const Memory<double>& before) const {
    return trial<double, D>(H, before).margin(hardening);
  }

  /// Equivalent plastic strain at a memory.
  template <class U>
  static const U& plastic_strain(const Memory<U>& memory) {
    return memory[3];
  }

  /// Stress of a displacement gradient at a memory, with no flow more: Cauchy's, at finite strain the first
  /// Piola-Kirchhoff one.
  template <class U, int D>
  Mat<U, D> stress(const Mat<U, D>& H, const Memory<U>& memory) const {
    if (is_inverted(H)) return Mat<U, D>::Constant(U(std::numeric_limits<double>::quiet_NaN()));
    const Strain<U> tau = hooke(elastic_strain<U, D>(H, memory));
    Mat<U, D> sigma = Mat<U, D>::Constant(U(0));
    sigma(0, 0) = tau[0];
    sigma(1, 1) = tau[1];
    sigma(0, 1) = sigma(1, 0) = tau[2];
    if constexpr (D == 3) sigma(2, 2) = is_finite ? U(tau[3] / (U(1) + H(2, 2))) : tau[3];
    if (!is_finite) return sigma;
    const U F00 = U(1) + H(0, 0), F11 = U(1) + H(1, 1), J = F00 * F11 - H(0, 1) * H(1, 0);
    sigma(0, 0) = (tau[0] * F11 - tau[2] * H(0, 1)) / J;
    sigma(0, 1) = (tau[2] * F00 - tau[0] * H(1, 0)) / J;
    sigma(1, 0) = (tau[2] * F11 - tau[1] * H(0, 1)) / J;
    sigma(1, 1) = (tau[1] * F00 - tau[2] * H(1, 0)) / J;
    return sigma;
  }

  /// Stretch across the plane.
  double stretch_across(const Mat<double, 2>& H, const Memory<double>& memory) const {
    if (space != Space::plane_stress) return 1;
    const double e = elastic_strain<double, 2>(H, memory)[3];
    return is_finite ? std::exp(e) * std::sqrt(1 + growth_of_plastic_area(memory)) : 1 + e - memory[0] - memory[1];
  }

  /// Cauchy's stress across the plane.
  double stress_across(const Mat<double, 2>& H, const Memory<double>& memory) const {
    if (space == Space::plane_stress) return 0;
    const double J = is_finite ? (1 + H(0, 0)) * (1 + H(1, 1)) - H(0, 1) * H(1, 0) : 1;
    return hooke(elastic_strain<double, 2>(H, memory))[3] / J;
  }

  /// Elastic energy per initial volume.
  template <class U, int D>
  U energy(const Mat<U, D>& H, const Memory<U>& memory) const {
    const Strain<U> e = elastic_strain<U, D>(H, memory), tau = hooke(e);
    return (tau[0] * e[0] + tau[1] * e[1] + tau[3] * e[3]) / U(2) + tau[2] * e[2];
  }

 private:
  /// Components 00, 11, 01, 22; of a flow, the equivalent plastic strain behind them.
  template <class U>
  using Strain = Vec<U, 5>;

  template <class U, int D>
  bool is_inverted(const Mat<U, D>& H) const {
    if (!is_finite) return false;
    const double J = (1 + value(H(0, 0))) * (1 + value(H(1, 1))) - value(H(0, 1)) * value(H(1, 0));
    if constexpr (D == 3)
      if (!(value(H(2, 2)) > -1)) return true;
    return !(J > 0);
  }

  /// F (I + C) F^T - I in the plane.
  template <class U, int D>
  static PlaneTensor<U> stretch(const Mat<U, D>& H, const PlaneTensor<U>& C) {
    const U F00 = U(1) + H(0, 0), F11 = U(1) + H(1, 1), &a = H(0, 1), &b = H(1, 0);
    return {H(0, 0) * (U(2) + H(0, 0)) + a * a + F00 * F00 * C[0] + U(2) * F00 * a * C[2] + a * a * C[1],
            H(1, 1) * (U(2) + H(1, 1)) + b * b + F11 * F11 * C[1] + U(2) * F11 * b * C[2] + b * b * C[0],
            a + b + H(0, 0) * b + a * H(1, 1) + F00 * b * C[0] + (F00 * F11 + a * b) * C[2] + a * F11 * C[1]};
  }

  template <class U, int D>
  Strain<U> elastic_strain(const Mat<U, D>& H, const Memory<U>& memory) const {
    using std::log1p, stickslip::log1p;
    U across(0);
    if constexpr (D == 3) across = H(2, 2);
    Strain<U> e;
    e[4] = U(0);
    if (!is_finite) {
      e[0] = H(0, 0) - memory[0];
      e[1] = H(1, 1) - memory[1];
      e[2] = (H(0, 1) + H(1, 0)) / U(2) - memory[2];
      e[3] = space == Space::plane_stress ? elastic_across(e) : U(across + memory[0] + memory[1]);
      return e;
    }
    const PlaneTensor<U> twice = log_of_one_plus<U>(stretch<U, D>(H, memory.template head<3>()));
    for (int k = 0; k < 3; ++k) e[k] = twice[k] / U(2);
    e[3] = space == Space::plane_stress ? elastic_across(e)
                                        : U(log1p(across) - log1p(growth_of_plastic_area(memory)) / U(2));
    return e;
  }

  /// The strain across that leaves no stress there.
  template <class U>
  U elastic_across(const Strain<U>& e) const {
    return -U(lame) / U(lame + T(2) * shear) * (e[0] + e[1]);
  }

  /// det C_p^-1 - 1 in the plane; in space it is 0.
  template <class U>
  static U growth_of_plastic_area(const Memory<U>& memory) {
    return memory[0] + memory[1] + memory[0] * memory[1] - memory[2] * memory[2];
  }

  template <class U>
  Strain<U> hooke(const Strain<U>& e) const {
    const U pressure = U(lame) * (e[0] + e[1] + e[3]);
    Strain<U> tau = U(T(2) * shear) * e;
    for (int k : {0, 1, 3}) tau[k] += pressure;
    return tau;
  }

  std::size_t first_row() const { return 2 * static_cast<std::size_t>(part - 1); }

  /// Whether q passes the bound by more than rounding.
  template <class U>
  static bool passes(const U& q, const U& bound) {
    return value(q) > value(bound) * (1 + 64 * unit_roundoff);
  }

  /// Plastic part of a trial strain: d n, and d; zero where it stays within the bound.
  template <class U>
  Strain<U> flow_of(const Strain<U>& trial, const U& hardened, int branch) const {
    using std::sqrt;
    Strain<U> flown = Strain<U>::Constant(U(0));
    const U third = (trial[0] + trial[1] + trial[3]) / U(3);
    Strain<U> deviator = trial;
    for (int k : {0, 1, 3}) deviator[k] -= third;
    const U squares = deviator[0] * deviator[0] + deviator[1] * deviator[1] + deviator[3] * deviator[3] +
                      U(2) * deviator[2] * deviator[2];
    if (!(value(squares) > 0)) return flown;
    const U q = U(shear) * sqrt(U(6) * squares);
    if (branch == flow_branch::by_values && !passes(q, hardening.bound(hardened))) return flown;
    const auto flow_on = [&](const U& bound, const T& slope) -> U { return (q - bound) / U(T(3) * shear + slope); };
    const U d = hardening.grow(hardened, flow_on, branch).d;
    flown = U(3) * U(shear) * d / q * deviator;
    flown[4] = d;
    return flown;
  }

  template <class U>
  Strain<U> flow_of_plane_stress(const Strain<U>& trial, const U& hardened, int branch) const {
    using std::sqrt;
    Strain<U> flown = Strain<U>::Constant(U(0));
    const Strain<U> tau = hooke(trial);
    const U p = (tau[0] + tau[1]) / U(2), apart = (tau[0] - tau[1]) / U(2);
    const U stiffness = U(T(shear * (T(3) * lame + T(2) * shear) / (lame + T(2) * shear)));
    const U square = apart * apart + tau[2] * tau[2];
    const double q = std::sqrt(value(p) * value(p) + 3 * value(square));
    if (branch == flow_branch::by_values && !passes(q, value(hardening.bound(hardened)))) return flown;
    const auto flow_on = [&](const U& bound, const T& slope) -> U {
      const detail::PlaneStressReturn<U> back{p, square, stiffness, U(shear), bound, U(slope)};
      const detail::PlaneStressReturn<double> plain{value(p),     value(square), value(stiffness),
                                                    value(shear), value(bound),  value(slope)};
      return solve_implicit<U>(back, root_of(plain));
    };
    const auto [d, bound, slope] = hardening.grow(hardened, flow_on, branch);
    const U m = d / (bound + U(slope) * d);
    const U mean = m * p / (U(1) + stiffness * m) / U(2), shares = U(1.5) * m / (U(1) + U(3) * U(shear) * m);
    flown[0] = mean + shares * apart;
    flown[1] = mean - shares * apart;
    flown[2] = shares * tau[2];
    flown[3] = -U(2) * mean;
    flown[4] = d;
    return flown;
  }
};

template <class T>
J2Law<T> law_of(const J2Plastic& material, Space space, bool finite_strain, const Numbers<T>& numbers) {
  const LinearElasticLaw<T> elastic(numbers(material.E), numbers(material.nu), Space::plane_strain);
  return {elastic.lame, elastic.shear, hardening_of(material.yield, material.hardening, material.table, numbers), space,
          finite_strain};
}

}  // namespace stickslip
