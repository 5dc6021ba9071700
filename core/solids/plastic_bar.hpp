/// Two-node bar of an elastoplastic material with isotropic hardening.
///
///   force   N = EA (e - e_p),  e the strain (core/solids/bar.hpp), e_p the plastic one
///   bound   |N| <= A bound(a),  a the equivalent plastic strain (core/solids/hardening.hpp)
///   flow    e_p -> e_p + d sign N,  a -> a + d,  d = (|N| - A bound) / (EA + A slope) where the bound would be passed
///
/// It remembers e_p and a. Differentiable but where a bar is about to flow, or to stop, or ends at a corner of a table.
/// Source: [SH98] 1.4.
#pragma once

#include "core/solids/bar.hpp"
#include "core/solids/j2_plastic.hpp"

namespace stickslip {

template <class T>
struct PlasticBarLaw {
  static constexpr int memory = 2;
  using Memory = Vec<T, memory>;

  BarLaw<T> elastic;
  Hardening<T> hardening;

  bool is_linear() const { return false; }
  /// What it is at the start.
  const BarLaw<T>& at_rest() const { return elastic; }

  /// The memory that a relative displacement d leaves of the one before. `coordinates`: D x 2; `branch`: of
  /// flow_branch.
  template <int D>
  Memory flow(const Mat<T, D, 2>& coordinates, const Vec<T, D>& d, const Memory& before,
              int branch = flow_branch::by_values) const {
    return flow_of(elastic.template strain<D>(coordinates, d), before, branch).memory;
  }

  /// The numbers that decide which branch the flow takes.
  template <int D>
  FlowTrial<T> trial(const Mat<T, D, 2>& coordinates, const Vec<T, D>& d, const Memory& before,
                     int branch = flow_branch::by_values) const {
    const T strain = elastic.template strain<D>(coordinates, d), force = elastic.axial * (strain - before[0]);
    const T size = value(force) > 0 ? force : T(-force);
    return {size / elastic.area, before[1], flow_of(strain, before, branch).memory[1], elastic.axial / elastic.area};
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
  Mat<T, D> stiffness(const Mat<T, D, 2>& coordinates, const Vec<T, D>& d, const Memory& before,
                      int branch = flow_branch::by_values) const {
    const T strain = elastic.template strain<D>(coordinates, d);
    const auto [after, slope, flows] = flow_of(strain, before, branch);
    const Vec<T, D> direction = elastic.template direction<D>(coordinates, d);
    const T length = norm((coordinates.col(1) - coordinates.col(0)).eval());
    const T modulus =
        flows ? T(elastic.axial * elastic.area * slope / (elastic.axial + elastic.area * slope)) : elastic.axial;
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
  /// What a flow leaves, and the slope of the bound where it ends.
  struct Flow {
    Memory memory;
    T slope;
    bool flows;
  };
  Flow flow_of(const T& strain, const Memory& before, int branch) const {
    const T force = elastic.axial * (strain - before[0]), bound = elastic.area * hardening.bound(before[1]);
    const bool pulled = value(force) > 0;
    const T size = pulled ? force : T(-force);
    const bool passes = branch == flow_branch::by_values
                            ? value(size) - value(bound) > 64 * unit_roundoff * value(bound)
                            : branch != flow_branch::none;
    if (!passes) return {before, T(0), false};
    const auto flow_on = [&](const T& of_area, const T& slope) -> T {
      return (size - elastic.area * of_area) / (elastic.axial + elastic.area * slope);
    };
    const auto growth = hardening.grow(before[1], flow_on, branch);
    return {{before[0] + (pulled ? growth.d : T(-growth.d)), before[1] + growth.d}, growth.slope, true};
  }
};

template <class T>
PlasticBarLaw<T> bar_of(const J2Plastic& material, const BarLaw<T>& elastic, const Numbers<T>& numbers) {
  return {elastic, hardening_of(material.yield, material.hardening, material.table, numbers)};
}

}  // namespace stickslip
