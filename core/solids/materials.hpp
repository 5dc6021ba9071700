/// The list of materials: what a scene may name, and the law that each becomes in a scalar T.
///
/// A law of a continuum has a file of its own: its description for the scene, law_of() and the law, which says what it
/// is made for (is_finite, is_made_for), which numbers it consists of (numbers, with) and gives stress, stress across
/// the plane and energy of a displacement gradient. What it lacks does not compile. A law of two nodes (bars, springs)
/// gives force, stiffness and energy of their relative displacement.
#pragma once

#include <concepts>
#include <variant>

#include "core/solids/bar.hpp"
#include "core/solids/linear_elastic.hpp"
#include "core/solids/neo_hookean.hpp"
#include "core/solids/spring.hpp"

namespace stickslip {

using Material = std::variant<LinearElastic, NeoHookean, GroundedSpring>;

template <class T>
using Law = std::variant<LinearElasticLaw<T>, NeoHookeanLaw<T>, BarLaw<T>, SpringLaw<T>>;

template <class L>
concept ContinuumLaw = requires(const L& law, const Mat<double, 2>& H) {
  { L::is_finite } -> std::convertible_to<bool>;
  { L::is_made_for(Kinematics::plane) } -> std::same_as<bool>;
  { law.with(law.numbers()) } -> std::same_as<L>;
  { law.template stress<double, 2>(H) } -> std::same_as<Mat<double, 2>>;
  { law.stress_across(H) } -> std::same_as<double>;
  { law.template energy<double, 2>(H) } -> std::same_as<double>;
};

template <class L>
concept TwoNodeLaw = requires(const L& law, const Mat<double, 2>& X, const Vec<double, 2>& d) {
  { law.is_linear() } -> std::same_as<bool>;
  { law.template stiffness<2>(X, d) } -> std::same_as<Mat<double, 2>>;
  { law.template force<2>(X, d) } -> std::same_as<Vec<double, 2>>;
  { law.template energy<2>(X, d) } -> std::same_as<double>;
};

/// Why a material does not go with elements of a continuum, completing "MATERIAL ..."; empty where it does.
inline const char* fault_of(const Material& material, Kinematics kinematics, bool finite_strain) {
  return std::visit(
      [&]<class M>(const M& of) -> const char* {
        if constexpr (requires { law_of(of, Space::plane_strain, Numbers<double>{}); }) {
          using L = decltype(law_of(of, Space::plane_strain, Numbers<double>{}));
          static_assert(ContinuumLaw<L>, "the law of a material lacks something");
          if (L::is_finite != finite_strain)
            return L::is_finite ? "is made for finite strain" : "is made for small strain";
          return L::is_made_for(kinematics) ? "" : "is not made for this space and element";
        }
        return "holds a point";
      },
      material);
}

static_assert(ContinuumLaw<LinearElasticLaw<double>> && ContinuumLaw<NeoHookeanLaw<double>>);
static_assert(TwoNodeLaw<BarLaw<double>> && TwoNodeLaw<SpringLaw<double>>);

}  // namespace stickslip
