/// What the solver takes for granted of a material and of a rigid surface, of each in the lists, at the example of its
/// schema.
#include <gtest/gtest.h>

#include "core/solids/materials.hpp"
#include "studies/input/materials.hpp"
#include "studies/input/obstacle_kinds.hpp"
#include "tests/support/largest.hpp"

namespace stickslip {
namespace {

constexpr double rounding = 1e-12;

/// What a kind reads from the example of its schema in a space, with the numbers of the scene.
template <class Kind>
auto example_of(const Kind& kind, Numbers<double>& numbers, Space space = Space::plane_strain) {
  Diagnostics diagnostics;
  MeshFiles none;
  SceneReading reading(diagnostics, {}, none);
  reading.scene.space = space;
  const auto document = JsonDocument::of(kind.schema()["examples"][0], "example");
  const auto read = kind.read(JsonNode(document, diagnostics), reading);
  EXPECT_TRUE(read && !diagnostics.has_errors()) << kind.key;
  numbers.at_slot = reading.scene.numbers;
  return *read;
}

template <class L>
auto without_memory(const L&) {
  if constexpr (Remembers<L>) return std::tuple(Vec<double, memory_of<L>()>(Vec<double, memory_of<L>()>::Zero()));
  if constexpr (!Remembers<L>) return std::tuple();
}

/// A displacement gradient of the plane, or of revolution.
template <TensorLayout layout>
Tensor<double, layout> some_gradient() {
  constexpr double components[5] = {0.04, 0.02, -0.03, 0.05, -0.06};
  Tensor<double, layout> H;
  for (int k = 0; k < H.size; ++k) H[k] = components[k];
  return H;
}

/// Whether stress is the derivative of energy, and that of a law of small strain without memory is linear.
template <TensorLayout layout, class L>
void expect_stress(const L& law) {
  using Probe = Dual<5>;
  const auto H = some_gradient<layout>();
  auto seeded = H.map([](double x) { return Probe(x); });
  for (int k = 0; k < H.size; ++k) seeded[k] = Probe::seed(H[k], k);
  std::apply(
      [&](const auto&... memory) {
        const auto stress = law.stress(H, memory...);
        const double largest = largest_entry(stress.full());
        const Probe energy = law.energy(seeded, memory.unaryExpr([](double x) { return Probe(x); }).eval()...);
        for (int k = 0; k < H.size; ++k) EXPECT_NEAR(stress[k], energy.d[k], rounding * largest) << k;
        const auto again = law.with(law.numbers()).stress(H, memory...);
        EXPECT_EQ(largest_entry(again.full() - stress.full()), 0) << "of its own numbers";
        if constexpr (!Remembers<L>) {
          if (law.is_finite) return;
          const auto twice = law.stress(H.map([](double x) { return 2 * x; }));
          EXPECT_LE(largest_entry(twice.full() - 2 * stress.full()), rounding * largest) << "linear";
        }
      },
      without_memory(law));
}

template <FillsContinuum M>
void expect_material(const M& material, const Numbers<double>& numbers) {
  for (const bool finite : {false, true}) {
    for (const Space space : {Space::plane_strain, Space::plane_stress})
      if (LawOf<M>::is_made_for(Kinematics::plane, strains_of(finite)))
        expect_stress<TensorLayout::plane4>(law_of<double>(material, space, strains_of(finite), numbers));
    if (LawOf<M>::is_made_for(Kinematics::revolution, strains_of(finite)))
      expect_stress<TensorLayout::hoop5>(law_of<double>(material, Space::axisymmetric, strains_of(finite), numbers));
  }
}
template <class M>
void expect_material(const M&, const Numbers<double>&) {}

TEST(Kinds, OfMaterialsHaveTheStressOfTheirEnergy) {
  for (const MaterialKind& kind : material_kinds()) {
    SCOPED_TRACE(kind.key);
    Numbers<double> numbers;
    const Material material = example_of(kind, numbers);
    std::visit([&](const auto& of) { expect_material(of, numbers); }, material);
  }
}

/// Whether the gap of a surface grows along its normal at places of D coordinates.
template <int D>
void expect_normal(const RigidSurface& surface, const Numbers<double>& numbers) {
  using Probe = Dual<D>;
  Numbers<Probe> in_duals;
  for (const double x : numbers.at_slot) in_duals.at_slot.emplace_back(x);
  constexpr double places[3][3] = {{1.7, 2.3, -0.4}, {-0.2, 0.3, 0.8}, {0.4, -1.9, 2.6}};
  for (const auto& place : places) {
    const Vec<double, D> at = Eigen::Map<const Vec<double, D>>(place);
    ASSERT_EQ(ambiguity(at, surface, numbers), nullptr);
    Vec<Probe, D> x;
    for (int i = 0; i < D; ++i) x[i] = Probe::seed(at[i], i);
    const auto geometry = against_rigid<Probe>(x, surface, in_duals);
    EXPECT_NEAR(value(geometry.gap), against_rigid<double>(at, surface, numbers).gap, rounding);
    for (int i = 0; i < D; ++i) EXPECT_NEAR(geometry.gap.d[i], value(geometry.normal[i]), rounding) << i;
    EXPECT_NEAR(values(geometry.normal).norm(), 1, rounding);
  }
}

TEST(Kinds, OfSurfacesHaveTheNormalAlongWhichTheirGapGrows) {
  for (const ObstacleKind& kind : obstacle_kinds()) {
    SCOPED_TRACE(kind.key);
    if (std::string(kind.key) == "stl") continue;  // its facets are in a file (rigid_facets_test.cpp)
    Numbers<double> numbers;
    const RigidSurface surface = example_of(kind, numbers, kind.is_in_plane ? Space::plane_strain : Space::solid);
    if (has_facets(surface)) continue;  // a place faces one of its facets
    if (kind.is_in_plane)
      expect_normal<2>(surface, numbers);
    else
      expect_normal<3>(surface, numbers);
  }
}

}  // namespace
}  // namespace stickslip
