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
/// It remembers e_p, or C_p^-1 - I, and a. In space these are seven numbers a point. In the plane and of revolution
/// they are four, 00, 11, 01 and a: the component across the plane follows, because flow keeps the volume. Not
/// differentiable if a point is about to flow, is about to stop, or ends at a corner of a table. Sources: [SH98] 3.3,
/// 3.4; exponential map and logarithmic strain: [S92].
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
  static constexpr int memory_in(TensorLayout layout) { return layout == TensorLayout::full9 ? 7 : 4; }
  static constexpr int memory = memory_in(TensorLayout::plane4);  ///< a point of a plane element
  static constexpr bool is_made_for(Kinematics, Strains) { return true; }
  template <class U, TensorLayout layout>
  using Memory = std::type_identity_t<Vec<U, memory_in(layout)>>;

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
  template <class U, TensorLayout layout>
  Memory<U, layout> flow(const Tensor<U, layout>& H, const Memory<U, layout>& before,
                         int branch = flow_branch::by_values) const {
    if (turns_over(H) || branch == flow_branch::none) return before;
    const auto trial = elastic_strain(H, before);
    const auto [flown, growth] = flow_of<layout>(trial, plastic_strain(before), branch);
    if (branch == flow_branch::by_values && value(growth) == 0) return before;
    constexpr int plastic = memory_in(layout) - 1, block = Tensor<U, layout>::block;
    Memory<U, layout> after;
    after[plastic] = before[plastic] + growth;
    if (!is_finite) {
      for (int k = 0; k < plastic; ++k) after[k] = before[k] + flown[k];
      return after;
    }
    // C_p^-1 - I = F^-1 (exp(2 e) - F F^T) F^-T
    using Part = Symmetric<U, block>;
    const Part left = stretch(H, Part(Part::Constant(U(0))));
    const Part grown = exp_minus_one<U>(Part(U(2) * (trial.template head<plastic>() - flown.template head<plastic>())));
    const Mat<U, block> between = matrix_of<U, block>(grown - left), inverse = inverse_of(H);
    const Mat<U, block> C = inverse.lazyProduct(between).eval().lazyProduct(inverse.transpose()).eval();
    after.template head<plastic>() = symmetric_of<U, block>(C);
    return after;
  }

  /// Stress of a displacement gradient, with the flow from the memory before. `after`: where it is given, takes what
  /// the flow leaves. In space the stress is that of the trial strain less what flows, which saves a logarithm and the
  /// exponential.
  template <class U, TensorLayout layout>
  Tensor<U, layout> stress_with_flow(const Tensor<U, layout>& H, const Memory<U, layout>& before, int branch,
                                     Memory<U, layout>* after = nullptr) const {
    if (layout == TensorLayout::full9 && !after && !turns_over(H)) {
      auto e = elastic_strain(H, before);
      if (branch != flow_branch::none) e -= flow_of<layout>(e, plastic_strain(before), branch).strain;
      return stress_of(H, hooke(e));
    }
    const Memory<U, layout> flown = flow(H, before, branch);
    if (after) *after = flown;
    return stress(H, flown);
  }

  /// The numbers that decide which branch the flow takes.
  template <class U, TensorLayout layout>
  FlowTrial<U> trial(const Tensor<U, layout>& H, const Memory<U, layout>& before,
                     int branch = flow_branch::by_values) const {
    using std::sqrt;
    const auto tau = hooke(elastic_strain(H, before));
    const U across = space == Space::plane_stress ? U(0) : tau[3];
    const U a = tau[0] - tau[1], b = tau[1] - across, c = across - tau[0];
    const U squares = (a * a + b * b + c * c) / U(2) + squares_of_shear(3, tau);
    return {value(squares) > 0 ? U(sqrt(squares)) : U(0), plastic_strain(before),
            plastic_strain(flow(H, before, branch)), U(T(3) * shear)};
  }
  /// FlowTrial::margin of a motion.
  template <TensorLayout layout>
  double margin(const Tensor<double, layout>& H, const Memory<double, layout>& before) const {
    return trial(H, before).margin(hardening);
  }

  /// Equivalent plastic strain at a memory.
  template <class U, int count>
  static const U& plastic_strain(const Vec<U, count>& memory) {
    return memory[count - 1];
  }

  /// Stress of a displacement gradient at a memory, with no flow more: Cauchy's, at finite strain the first
  /// Piola-Kirchhoff one.
  template <class U, TensorLayout layout>
  Tensor<U, layout> stress(const Tensor<U, layout>& H, const Memory<U, layout>& memory) const {
    if (turns_over(H)) return Tensor<U, layout>::constant(U(std::numeric_limits<double>::quiet_NaN()));
    return stress_of(H, hooke(elastic_strain(H, memory)));
  }

  /// Stretch across the plane.
  double stretch_across(const PlaneGradient<double>& H, const Vec<double, memory>& memory) const {
    if (space != Space::plane_stress) return 1;
    const double e = elastic_strain(H, memory)[3];
    return is_finite ? std::exp(e) * std::sqrt(1 + growth_of_plastic_area(memory)) : 1 + e - memory[0] - memory[1];
  }

  /// Cauchy's stress across the plane.
  double stress_across(const PlaneGradient<double>& H, const Vec<double, memory>& memory) const {
    if (space == Space::plane_stress) return 0;
    const double J = is_finite ? (1 + H(0, 0)) * (1 + H(1, 1)) - H(0, 1) * H(1, 0) : 1;
    return hooke(elastic_strain(H, memory))[3] / J;
  }

  /// Elastic energy per initial volume.
  template <class U, TensorLayout layout>
  U energy(const Tensor<U, layout>& H, const Memory<U, layout>& memory) const {
    const auto e = elastic_strain(H, memory), tau = hooke(e);
    U energy = (tau[0] * e[0] + tau[1] * e[1] + tau[3] * e[3]) / U(2) + tau[2] * e[2];
    for (int k = 4; k < e.size(); ++k) energy += tau[k] * e[k];
    return energy;
  }

 private:
  /// Of a tensor of space, symmetric: 00, 11, 01, 22; in space 02 and 12 behind them.
  template <class U, TensorLayout layout>
  using Strain = Vec<U, layout == TensorLayout::full9 ? 6 : 4>;
  template <class U, TensorLayout layout>
  struct Flow {
    Strain<U, layout> strain;  ///< the plastic part of a trial strain
    U growth;                  ///< of a
  };

  /// Stress from Kirchhoff's.
  template <class U, TensorLayout layout>
  Tensor<U, layout> stress_of(const Tensor<U, layout>& H, const Strain<U, layout>& tau) const {
    Tensor<U, layout> P;
    if constexpr (layout == TensorLayout::hoop5) P(2, 2) = is_finite ? U(tau[3] / (U(1) + H(2, 2))) : tau[3];
    if (!is_finite) {
      P.matrix() = matrix_of<U, P.block>(tau.template head<memory_in(layout) - 1>());
    } else if constexpr (layout == TensorLayout::full9) {
      P.matrix() = matrix_of<U, 3>(tau).lazyProduct(inverse_of(H).transpose());
    } else {
      const U F00 = U(1) + H(0, 0), F11 = U(1) + H(1, 1), J = F00 * F11 - H(0, 1) * H(1, 0);
      P(0, 0) = (tau[0] * F11 - tau[2] * H(0, 1)) / J;
      P(0, 1) = (tau[2] * F00 - tau[0] * H(1, 0)) / J;
      P(1, 0) = (tau[2] * F11 - tau[1] * H(0, 1)) / J;
      P(1, 1) = (tau[1] * F00 - tau[2] * H(1, 0)) / J;
    }
    return P;
  }

  /// Whether an element is inverted, and that matters.
  template <class U, TensorLayout layout>
  bool turns_over(const Tensor<U, layout>& H) const {
    return is_finite && is_inverted(H);
  }

  /// F (I + C) F^T - I.
  template <class U>
  static Symmetric<U, 3> stretch(const Tensor<U, TensorLayout::full9>& H, const Symmetric<U, 3>& C) {
    const Mat<U, 3> F = H.plus_one();
    const Mat<U, 3> grown = F.lazyProduct(matrix_of<U, 3>(C)).eval().lazyProduct(F.transpose());
    return symmetric_of<U, 3>(left_strain(H) + grown);
  }
  template <class U, TensorLayout layout>
  static Symmetric<U, 2> stretch(const Tensor<U, layout>& H, const Symmetric<U, 2>& C) {
    const U F00 = U(1) + H(0, 0), F11 = U(1) + H(1, 1), &a = H(0, 1), &b = H(1, 0);
    return {H(0, 0) * (U(2) + H(0, 0)) + a * a + F00 * F00 * C[0] + U(2) * F00 * a * C[2] + a * a * C[1],
            H(1, 1) * (U(2) + H(1, 1)) + b * b + F11 * F11 * C[1] + U(2) * F11 * b * C[2] + b * b * C[0],
            a + b + H(0, 0) * b + a * H(1, 1) + F00 * b * C[0] + (F00 * F11 + a * b) * C[2] + a * F11 * C[1]};
  }

  /// F^-1 of the components that matrix() has.
  template <class U, TensorLayout layout>
  static auto inverse_of(const Tensor<U, layout>& H) {
    Mat<U, Tensor<U, layout>::block> inverse;
    if constexpr (layout == TensorLayout::full9) {
      inverse = cofactors<U>(H.plus_one()).transpose() / (U(1) + growth(H));
    } else {
      const U J = (U(1) + H(0, 0)) * (U(1) + H(1, 1)) - H(0, 1) * H(1, 0);
      inverse << (U(1) + H(1, 1)) / J, -H(0, 1) / J, -H(1, 0) / J, (U(1) + H(0, 0)) / J;
    }
    return inverse;
  }

  template <class U, TensorLayout layout>
  Strain<U, layout> elastic_strain(const Tensor<U, layout>& H, const Memory<U, layout>& memory) const {
    using std::log1p, stickslip::log1p;
    constexpr int plastic = memory_in(layout) - 1;
    Strain<U, layout> e;
    if (is_finite) {
      e.template head<plastic>() = log_of_one_plus<U>(stretch(H, memory.template head<plastic>().eval())) / U(2);
    } else {
      for (int k = 0; k < plastic; ++k) {
        const auto [p, q] = symmetric_places[k];
        e[k] = (p == q ? H(p, q) : U((H(p, q) + H(q, p)) / U(2))) - memory[k];
      }
    }
    if constexpr (layout != TensorLayout::full9) {
      U across(0);
      if constexpr (layout == TensorLayout::hoop5) across = H(2, 2);
      if (space == Space::plane_stress)
        e[3] = -U(lame) / U(lame + T(2) * shear) * (e[0] + e[1]);  // no stress across
      else if (is_finite)
        e[3] = log1p(across) - log1p(growth_of_plastic_area(memory)) / U(2);
      else
        e[3] = across + memory[0] + memory[1];
    }
    return e;
  }

  /// det C_p^-1 - 1 in the plane; in space it is 0.
  template <class U>
  static U growth_of_plastic_area(const Vec<U, memory>& memory) {
    return memory[0] + memory[1] + memory[0] * memory[1] - memory[2] * memory[2];
  }

  template <class S>
  S hooke(const S& e) const {
    using U = typename S::Scalar;
    const U pressure = U(lame) * (e[0] + e[1] + e[3]);
    S tau = U(T(2) * shear) * e;
    for (int k : {0, 1, 3}) tau[k] += pressure;
    return tau;
  }

  /// Their sum, times a factor.
  template <class S>
  static auto squares_of_shear(int factor, const S& tau) {
    using U = typename S::Scalar;
    U sum = U(factor) * tau[2] * tau[2];
    for (int k = 4; k < tau.size(); ++k) sum += U(factor) * tau[k] * tau[k];
    return sum;
  }

  std::size_t first_row() const { return 2 * static_cast<std::size_t>(part - 1); }

  /// Whether q passes the bound by more than rounding.
  template <class U>
  static bool passes(const U& q, const U& bound) {
    return value(q) > value(bound) * (1 + 64 * unit_roundoff);
  }

  /// Plastic part of a trial strain: d n, and d; zero where it stays within the bound.
  template <TensorLayout layout, class U>
  Flow<U, layout> flow_of(const Strain<U, layout>& trial, const U& hardened, int branch) const {
    using std::sqrt;
    if constexpr (layout == TensorLayout::plane4)
      if (space == Space::plane_stress) return flow_of_plane_stress(trial, hardened, branch);
    const Flow<U, layout> none{Strain<U, layout>::Constant(U(0)), U(0)};
    const U third = (trial[0] + trial[1] + trial[3]) / U(3);
    Strain<U, layout> deviator = trial;
    for (int k : {0, 1, 3}) deviator[k] -= third;
    const U squares = deviator[0] * deviator[0] + deviator[1] * deviator[1] + deviator[3] * deviator[3] +
                      squares_of_shear(2, deviator);
    if (!(value(squares) > 0)) return none;
    const U q = U(shear) * sqrt(U(6) * squares);
    if (branch == flow_branch::by_values && !passes(q, hardening.bound(hardened))) return none;
    const auto flow_on = [&](const U& bound, const T& slope) -> U { return (q - bound) / U(T(3) * shear + slope); };
    const U d = hardening.grow(hardened, flow_on, branch).d;
    return {U(3) * U(shear) * d / q * deviator, d};
  }

  template <class U>
  Flow<U, TensorLayout::plane4> flow_of_plane_stress(const Vec<U, 4>& trial, const U& hardened, int branch) const {
    using std::sqrt;
    const Vec<U, 4> tau = hooke(trial);
    const U p = (tau[0] + tau[1]) / U(2), apart = (tau[0] - tau[1]) / U(2);
    const U stiffness = U(T(shear * (T(3) * lame + T(2) * shear) / (lame + T(2) * shear)));
    const U square = apart * apart + tau[2] * tau[2];
    const double q = std::sqrt(value(p) * value(p) + 3 * value(square));
    if (branch == flow_branch::by_values && !passes(q, value(hardening.bound(hardened))))
      return {Vec<U, 4>::Constant(U(0)), U(0)};
    const auto flow_on = [&](const U& bound, const T& slope) -> U {
      const detail::PlaneStressReturn<U> back{p, square, stiffness, U(shear), bound, U(slope)};
      const detail::PlaneStressReturn<double> plain{value(p),     value(square), value(stiffness),
                                                    value(shear), value(bound),  value(slope)};
      return solve_implicit<U>(back, root_of(plain));
    };
    const auto [d, bound, slope] = hardening.grow(hardened, flow_on, branch);
    const U m = d / (bound + U(slope) * d);
    const U mean = m * p / (U(1) + stiffness * m) / U(2), shares = U(1.5) * m / (U(1) + U(3) * U(shear) * m);
    return {Vec<U, 4>(mean + shares * apart, mean - shares * apart, shares * tau[2], -U(2) * mean), d};
  }
};

template <class T>
J2Law<T> law_of(const J2Plastic& material, Space space, Strains strains, const Numbers<T>& numbers) {
  const LinearElasticLaw<T> elastic(numbers(material.E), numbers(material.nu), Space::plane_strain);
  return {elastic.lame, elastic.shear, hardening_of(material.yield, material.hardening, material.table, numbers), space,
          strains == Strains::finite};
}

}  // namespace stickslip
