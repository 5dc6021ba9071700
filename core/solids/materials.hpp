/// The list of materials: what a scene may name, and the law that each becomes in a scalar T.
///
/// A law of a continuum has a file of its own: its description for the scene, law_of() and the law, which says what it
/// is made for (is_finite, is_made_for), which numbers it consists of (numbers, with; of more than one part: part,
/// part_count) and gives stress, stretch and stress across the plane, and energy of a displacement gradient. What it
/// lacks does not compile. A law of two nodes (bars, springs) gives force, stiffness and energy of their relative
/// displacement.
///
/// A law that remembers says how many numbers a point (memory), how a motion changes them (flow), what says which
/// branch that takes (trial, hardening), the plastic strain in them, and the law that it is at the start (at_rest);
/// stress, force and energy are then those at a memory. At the start all numbers are zero.
#pragma once

#include <concepts>
#include <variant>

#include "core/solids/j2_plastic.hpp"
#include "core/solids/neo_hookean.hpp"
#include "core/solids/plastic_bar.hpp"
#include "core/solids/spring.hpp"

namespace stickslip {

using Material = std::variant<LinearElastic, NeoHookean, J2Plastic, GroundedSpring>;

template <class T>
using Law = std::variant<LinearElasticLaw<T>, NeoHookeanLaw<T>, J2Law<T>, BarLaw<T>, PlasticBarLaw<T>, SpringLaw<T>>;

/// Numbers that a law remembers at a point.
template <class L>
constexpr int memory_of() {
  if constexpr (requires { L::memory; }) return L::memory;
  return 0;
}
template <class L>
concept Remembers = memory_of<L>()
> 0;

namespace detail {

/// Whether a law has what it takes, with `memory...` the memory behind the motion where it remembers.
template <class L, class... Memory>
concept ContinuumLawWith = requires(const L& law, const Mat<double, 2>& H, const Memory&... memory) {
  { law.is_finite } -> std::convertible_to<bool>;
  { L::is_made_for(Kinematics::plane, true) } -> std::same_as<bool>;
  { law.with(law.numbers()) } -> std::same_as<L>;
  { law.template stress<double, 2>(H, memory...) } -> std::same_as<Mat<double, 2>>;
  { law.stretch_across(H, memory...) } -> std::same_as<double>;
  { law.stress_across(H, memory...) } -> std::same_as<double>;
  { law.template energy<double, 2>(H, memory...) } -> std::same_as<double>;
};
template <class L, class... Memory>
concept TwoNodeLawWith = requires(const L& law, const Mat<double, 2>& X, const Vec<double, 2>& d,
                                  const Memory&... memory) {
  { law.is_linear() } -> std::same_as<bool>;
  { law.template stiffness<2>(X, d, memory...) } -> std::same_as<Mat<double, 2>>;
  { law.template force<2>(X, d, memory...) } -> std::same_as<Vec<double, 2>>;
  { law.template energy<2>(X, d, memory...) } -> std::same_as<double>;
};
template <class L>
concept Flows = requires(const L& law, const Mat<double, 2>& H, const Vec<double, memory_of<L>()>& memory) {
  { law.template flow<double, 2>(H, memory) } -> std::same_as<Vec<double, memory_of<L>()>>;
  { law.template trial<double, 2>(H, memory) } -> std::same_as<FlowTrial<double>>;
  { law.hardening.piece_count() } -> std::same_as<int>;
  { L::plastic_strain(memory) } -> std::convertible_to<double>;
  { law.at_rest().template stress<double, 2>(H) } -> std::same_as<Mat<double, 2>>;
};
template <class L>
concept TwoNodesFlow = requires(const L& law, const Mat<double, 2>& X, const Vec<double, 2>& d,
                                const Vec<double, memory_of<L>()>& memory) {
  { law.template flow<2>(X, d, memory) } -> std::same_as<Vec<double, memory_of<L>()>>;
  { law.template trial<2>(X, d, memory) } -> std::same_as<FlowTrial<double>>;
  { law.hardening.piece_count() } -> std::same_as<int>;
  { L::plastic_strain(memory) } -> std::convertible_to<double>;
};

}  // namespace detail

template <class L>
concept ContinuumLaw = (!Remembers<L> && detail::ContinuumLawWith<L>) ||
                       (Remembers<L> && detail::ContinuumLawWith<L, Vec<double, memory_of<L>()>> && detail::Flows<L>);
template <class L>
concept TwoNodeLaw = (!Remembers<L> && detail::TwoNodeLawWith<L>) ||
                     (Remembers<L> && detail::TwoNodeLawWith<L, Vec<double, memory_of<L>()>> &&
                      detail::TwoNodesFlow<L>);

/// Why a material does not go with elements of a continuum, completing "MATERIAL ..."; empty where it does.
inline const char* fault_of(const Material& material, Kinematics kinematics, bool finite_strain) {
  return std::visit(
      [&]<class M>(const M& of) -> const char* {
        if constexpr (requires { law_of(of, Space::plane_strain, false, Numbers<double>{}); }) {
          using L = decltype(law_of(of, Space::plane_strain, false, Numbers<double>{}));
          static_assert(ContinuumLaw<L>, "the law of a material lacks something");
          if (L::is_made_for(kinematics, finite_strain)) return "";
          if (!L::is_made_for(kinematics, !finite_strain)) return "is not made for this space and element";
          return finite_strain ? "is made for small strain" : "is made for finite strain";
        }
        return "holds a point";
      },
      material);
}

/// Numbers that a point of a body of a material remembers. `bars`: it consists of them.
inline int memory_of(const Material& material, bool bars) {
  if (!std::holds_alternative<J2Plastic>(material)) return 0;
  return bars ? memory_of<PlasticBarLaw<double>>() : memory_of<J2Law<double>>();
}

static_assert(ContinuumLaw<LinearElasticLaw<double>> && ContinuumLaw<NeoHookeanLaw<double>>);
static_assert(ContinuumLaw<J2Law<double>>);
static_assert(TwoNodeLaw<BarLaw<double>> && TwoNodeLaw<PlasticBarLaw<double>> && TwoNodeLaw<SpringLaw<double>>);

}  // namespace stickslip
