/// The list of materials that a scene may name, and the list of the laws that they become in a scalar T.
///
/// A material has a file of its own, with its description: its numbers, its keys (core/algebra/described.hpp), and what
/// it is for, a verb first (place); with its law; and with what makes the law of the description,
///
///   law_of(material, space, strains, numbers)         where it fills a continuum
///   bar_of(material, elastic, numbers)                where it fills bars too: elastic is the law of bars of its E
///   law_of(material, numbers)                         where it holds a point
///
/// A law of a continuum says what it is made for (is_finite, is_made_for), which numbers it consists of (numbers, with;
/// of more than one part: part, part_count) and gives stress, stretch and stress across the plane, and energy of a
/// displacement gradient; made for finite strain, the stretch in dual numbers too. A law of two nodes (bars, springs)
/// gives force, stiffness and energy of their relative displacement.
///
/// A law that remembers says how many numbers a point (memory), how a motion changes them (flow), what says which
/// branch that takes (trial, hardening), the plastic strain in them, and the law that it is at the start (at_rest);
/// stress, force and energy are then those at a memory. At the start all numbers are zero.
///
/// What is lacking does not compile.
#pragma once

#include <concepts>
#include <variant>

#include "core/solids/j2_plastic.hpp"
#include "core/solids/neo_hookean.hpp"
#include "core/solids/plastic_bar.hpp"
#include "core/solids/spring.hpp"

namespace stickslip {

using Material = std::variant<LinearElastic, NeoHookean, J2Plastic, GroundedSpring>;

/// Why a material does not go with elements of a continuum, completing "MATERIAL ..."; empty where it does.
const char* fault_of(const Material& material, Kinematics kinematics, Strains strains);

/// Numbers that a point of a continuum of a material remembers, and a bar of it.
int memory_of(const Material& material, TensorLayout layout);
int memory_of_bar(const Material& material);

/// Whether bodies of a material remember how they flowed.
bool flows(const Material& material);

/// Whether a continuum of a material hardly changes its volume.
bool is_nearly_incompressible(const Material& material);

template <class T>
using Law = std::variant<LinearElasticLaw<T>, NeoHookeanLaw<T>, J2Law<T>, BarLaw<T>, PlasticBarLaw<T>, SpringLaw<T>>;

/// Of a body. (A class, so that Slots need not name the list.)
template <class T>
struct BodyLaw {
  Law<T> law;
};

/// Numbers that a law remembers at a point.
template <class L>
constexpr int memory_of() {
  if constexpr (requires { L::memory; }) return L::memory;
  return 0;
}
template <class L>
concept Remembers = (memory_of<L>() > 0);

namespace detail {

/// Whether a law has what it takes, with `memory...` the memory behind the motion where it remembers.
template <class L, class... Memory>
concept ContinuumLawWith = requires(const L& law, const PlaneGradient<double>& H, const Memory&... memory) {
  { law.is_finite } -> std::convertible_to<bool>;
  { L::is_made_for(Kinematics::plane, Strains::finite) } -> std::same_as<bool>;
  { law.with(law.numbers()) } -> std::same_as<L>;
  { law.stress(H, memory...) } -> std::same_as<PlaneGradient<double>>;
  { law.stretch_across(H, memory...) } -> std::same_as<double>;
  { law.stress_across(H, memory...) } -> std::same_as<double>;
  { law.energy(H, memory...) } -> std::same_as<double>;
};
/// Whether the stretch across the plane has derivatives: loads at finite strain act on areas that follow it.
template <class L, class Probe = Dual<4, double>>
concept StretchHasDerivatives = requires(const L& law, const PlaneGradient<Probe>& H) {
  { law.stretch_across(H) } -> std::same_as<Probe>;
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
concept Flows = requires(const L& law, const PlaneGradient<double>& H, const Vec<double, memory_of<L>()>& memory) {
  { law.flow(H, memory) } -> std::same_as<Vec<double, memory_of<L>()>>;
  { law.stress_with_flow(H, memory, 0) } -> std::same_as<PlaneGradient<double>>;
  { law.trial(H, memory) } -> std::same_as<FlowTrial<double>>;
  { law.hardening.piece_count() } -> std::same_as<int>;
  { L::plastic_strain(memory) } -> std::convertible_to<double>;
  { law.at_rest().stress(H) } -> std::same_as<PlaneGradient<double>>;
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
concept ContinuumLaw = (!Remembers<L> && detail::ContinuumLawWith<L> &&
                        (!L::is_made_for(Kinematics::plane, Strains::finite) || detail::StretchHasDerivatives<L>)) ||
                       (Remembers<L> && detail::ContinuumLawWith<L, Vec<double, memory_of<L>()>> && detail::Flows<L>);
template <class L>
concept TwoNodeLaw = (!Remembers<L> && detail::TwoNodeLawWith<L>) ||
                     (Remembers<L> && detail::TwoNodeLawWith<L, Vec<double, memory_of<L>()>> &&
                      detail::TwoNodesFlow<L>);

template <class M>
concept FillsContinuum = requires(const M& of, const Numbers<double>& numbers) {
  law_of<double>(of, Space::plane_strain, Strains::small, numbers);
};
template <class M>
concept FillsBars = requires(const M& of, const BarLaw<double>& elastic, const Numbers<double>& numbers) {
  bar_of<double>(of, elastic, numbers);
};
template <class M>
concept HoldsPoint = requires(const M& of, const Numbers<double>& numbers) {
  law_of<double>(of, numbers);
};

/// The law of a continuum, and of bars, of a material.
template <FillsContinuum M>
using LawOf =
    decltype(law_of<double>(std::declval<const M&>(), Space::plane_strain, Strains::small, Numbers<double>{}));
template <FillsBars M>
using BarLawOf = decltype(bar_of<double>(std::declval<const M&>(), BarLaw<double>{}, Numbers<double>{}));

}  // namespace stickslip
