/// Two-node bar of an elastoplastic material with linear isotropic hardening.
///
///   force   N = EA (e - e_p),  e the strain (core/solids/bar.hpp), e_p the plastic one
///   bound   |N| <= A (yield + hardening a),  a the equivalent plastic strain
///   flow    e_p -> e_p + d sign N,  a -> a + d,  d = (|N| - bound) / (EA + A hardening) where the bound would be
///   passed
///
/// It remembers e_p and a. Differentiable but where a bar is about to flow, or to stop. Source: [SH98] 1.4.
#pragma once

#include "core/solids/bar.hpp"
#include "core/solids/j2_plastic.hpp"

namespace stickslip {

template <class T>
struct PlasticBarLaw {
  static constexpr int memory = 2;
  using Memory = Vec<T, memory>;

  BarLaw<T> elastic;
  T yield, hardening;

  bool is_linear() const { return false; }
  /// What it is at the start.
  const BarLaw<T>& at_rest() const { return elastic; }

  /// The memory that a relative displacement d leaves of the one before. `coordinates`: D x 2.
  template <int D>
  Memory flow(const Mat<T, D, 2>& coordinates, const Vec<T, D>& d, const Memory& before) const {
    return flow_of(elastic.template strain<D>(coordinates, d), before);
  }

  /// How far the trial from a memory is beyond the bound, over that; negative within it.
  template <int D>
  double excess(const Mat<double, D, 2>& coordinates, const Vec<double, D>& d,
                const Vec<double, memory>& before) const {
    const double force = elastic.axial * (elastic.template strain<D>(coordinates, d) - before[0]);
    return std::abs(force) / (elastic.area * (yield + hardening * before[1])) - 1;
  }

  /// Equivalent plastic strain at a memory.
  static const T& plastic_strain(const Memory& memory) { return memory[1]; }

  /// Force on the second node at a memory, with no flow more; the first one has the opposite.
  template <int D>
  Vec<T, D> force(const Mat<T, D, 2>& coordinates, const Vec<T, D>& d, const Memory& memory) const {
    const T strain = elastic.template strain<D>(coordinates, d) - memory[0];
    return elastic.axial * strain * elastic.template direction<D>(coordinates, d);
  }

  /// Derivative of the force by d, with the flow from the memory before.
  template <int D>
  Mat<T, D> stiffness(const Mat<T, D, 2>& coordinates, const Vec<T, D>& d, const Memory& before) const {
    const T strain = elastic.template strain<D>(coordinates, d);
    const Memory after = flow_of(strain, before);
    const Vec<T, D> direction = elastic.template direction<D>(coordinates, d);
    const T length = norm((coordinates.col(1) - coordinates.col(0)).eval());
    const T modulus = value(after[1]) == value(before[1])
                          ? elastic.axial
                          : T(elastic.axial * elastic.area * hardening / (elastic.axial + elastic.area * hardening));
    Mat<T, D> k;
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) {
        k(i, j) = modulus * direction[i] * direction[j] / length;
        if (elastic.green && i == j) k(i, j) += elastic.axial * (strain - after[0]) / length;
      }
    return k;
  }

  template <int D>
  T energy(const Mat<T, D, 2>& coordinates, const Vec<T, D>& d, const Memory& memory) const {
    const T strain = elastic.template strain<D>(coordinates, d) - memory[0];
    return elastic.axial * norm((coordinates.col(1) - coordinates.col(0)).eval()) * strain * strain / T(2);
  }

 private:
  Memory flow_of(const T& strain, const Memory& before) const {
    const T force = elastic.axial * (strain - before[0]), bound = elastic.area * (yield + hardening * before[1]);
    const bool pulled = value(force) > 0;
    const T excess = (pulled ? force : T(-force)) - bound;
    if (!(value(excess) > 64 * unit_roundoff * value(bound))) return before;
    const T d = excess / (elastic.axial + elastic.area * hardening);
    return {before[0] + (pulled ? d : T(-d)), before[1] + d};
  }
};

template <class T>
PlasticBarLaw<T> bar_of(const J2Plastic& material, const BarLaw<T>& elastic, const Numbers<T>& numbers) {
  return {elastic, numbers(material.yield), numbers(material.hardening)};
}

}  // namespace stickslip
