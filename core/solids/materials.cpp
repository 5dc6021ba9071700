#include "core/solids/materials.hpp"

namespace stickslip {
namespace {

/// Asks for one part after the other: of a disjunction the compiler does not name what is lacking.
template <class L>
constexpr bool is_whole_law() {
  if constexpr (Remembers<L>) {
    static_assert(detail::ContinuumLawWith<L, Vec<double, memory_of<L>()>>, "the law of a material lacks something");
    static_assert(detail::Flows<L>, "the law of a material that remembers lacks something");
  } else {
    static_assert(detail::ContinuumLawWith<L>, "the law of a material lacks something");
    static_assert(ContinuumLaw<L> || !detail::ContinuumLawWith<L>, "its stretch across the plane has no derivatives");
  }
  return true;
}

template <class M>
constexpr bool is_whole() {
  static_assert(FillsContinuum<M> || HoldsPoint<M>, "a material lacks its law_of");
  if constexpr (FillsContinuum<M>) {
    static_assert(is_whole_law<LawOf<M>>());
    static_assert(std::is_constructible_v<Law<double>, LawOf<M>>, "the law of a material is not in the list of laws");
  }
  if constexpr (FillsBars<M>) {
    static_assert(TwoNodeLaw<BarLawOf<M>>, "the law of bars of a material lacks something");
    static_assert(std::is_constructible_v<Law<double>, BarLawOf<M>>, "a law of bars is not in the list of laws");
  }
  return true;
}
template <class... M>
constexpr bool are_whole_materials(const std::variant<M...>*) {
  return (is_whole<M>() && ...);
}
static_assert(are_whole_materials(static_cast<const Material*>(nullptr)));

static_assert(TwoNodeLaw<SpringLaw<double>>);

}  // namespace

const char* fault_of(const Material& material, Kinematics kinematics, Strains strains) {
  const bool finite = strains == Strains::finite;
  return std::visit(
      [&]<class M>(const M&) -> const char* {
        if constexpr (FillsContinuum<M>) {
          using L = LawOf<M>;
          if (L::is_made_for(kinematics, strains)) return "";
          if (!L::is_made_for(kinematics, strains_of(!finite))) return "is not made for this space and element";
          return finite ? "is made for small strain" : "is made for finite strain";
        }
        return "holds a point";
      },
      material);
}

int memory_of(const Material& material, TensorLayout layout) {
  return std::visit(
      [&]<class M>(const M&) {
        if constexpr (FillsContinuum<M>)
          if constexpr (Remembers<LawOf<M>>) return LawOf<M>::memory_in(layout);
        return 0;
      },
      material);
}

int memory_of_bar(const Material& material) {
  return std::visit(
      []<class M>(const M&) {
        if constexpr (FillsBars<M>) return memory_of<BarLawOf<M>>();
        return 0;
      },
      material);
}

bool flows(const Material& material) { return memory_of(material, TensorLayout::plane4) > 0; }

bool is_nearly_incompressible(const Material& material) {
  constexpr double nearly = 0.45;
  return std::visit(
      []<class M>(const M& of) {
        if constexpr (requires { of.nu; }) return of.nu.value > nearly;
        return false;
      },
      material);
}

}  // namespace stickslip
