/// What the solver takes for granted of a material and of a rigid surface, of each in the lists, at the example of its
/// schema.
#include <gtest/gtest.h>

#include "studies/input/materials.hpp"
#include "studies/input/obstacle_kinds.hpp"
#include "tests/support/largest.hpp"

namespace stickslip {
namespace {

constexpr double rounding = 1e-12;

/// What a kind reads from the example of its schema, with the numbers of the scene.
template <class Kind>
auto example_of(const Kind& kind, Numbers<double>& numbers) {
  Diagnostics diagnostics;
  MeshFiles none;
  SceneReading reading(diagnostics, {}, none);
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

/// A displacement gradient; in three rows, of revolution.
template <int rows>
Mat<double, rows> some_gradient() {
  Mat<double, rows> H = Mat<double, rows>::Zero();
  H.template topLeftCorner<2, 2>() << 0.04, -0.03, 0.02, 0.05;
  if constexpr (rows == 3) H(2, 2) = -0.06;
  return H;
}

/// Whether stress is the derivative of energy, and that of a law of small strain without memory is linear.
template <int rows, class L>
void expect_stress(const L& law) {
  using Probe = Dual<5>;
  const Mat<double, rows> H = some_gradient<rows>();
  Mat<Probe, rows> seeded = H.unaryExpr([](double x) { return Probe(x); });
  int k = 0;
  for (const auto& [p, q] : {std::pair{0, 0}, {0, 1}, {1, 0}, {1, 1}, {2, 2}})
    if (p < rows) seeded(p, q) = Probe::seed(H(p, q), k++);
  std::apply(
      [&](const auto&... memory) {
        const Mat<double, rows> stress = law.template stress<double, rows>(H, memory...);
        const Probe energy =
            law.template energy<Probe, rows>(seeded, memory.unaryExpr([](double x) { return Probe(x); }).eval()...);
        int component = 0;
        for (const auto& [p, q] : {std::pair{0, 0}, {0, 1}, {1, 0}, {1, 1}, {2, 2}}) {
          if (p >= rows) continue;
          EXPECT_NEAR(stress(p, q), energy.d[component++], rounding * largest_entry(stress)) << p << q;
        }
        const auto again = law.with(law.numbers()).template stress<double, rows>(H, memory...);
        EXPECT_EQ(largest_entry(again - stress), 0) << "of its own numbers";
        if constexpr (!Remembers<L>) {
          if (law.is_finite) return;
          const auto twice = law.template stress<double, rows>(2 * H);
          EXPECT_LE(largest_entry(twice - 2 * stress), rounding * largest_entry(stress)) << "linear";
        }
      },
      without_memory(law));
}

template <FillsContinuum M>
void expect_material(const M& material, const Numbers<double>& numbers) {
  for (const bool finite : {false, true}) {
    for (const Space space : {Space::plane_strain, Space::plane_stress})
      if (LawOf<M>::is_made_for(Kinematics::plane, finite))
        expect_stress<2>(law_of<double>(material, space, finite, numbers));
    if (LawOf<M>::is_made_for(Kinematics::revolution, finite))
      expect_stress<3>(law_of<double>(material, Space::axisymmetric, finite, numbers));
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

TEST(Kinds, OfSurfacesHaveTheNormalAlongWhichTheirGapGrows) {
  using Probe = Dual<2>;
  for (const ObstacleKind& kind : obstacle_kinds()) {
    SCOPED_TRACE(kind.key);
    Numbers<double> numbers;
    const RigidSurface surface = example_of(kind, numbers);
    Numbers<Probe> in_duals;
    for (const double x : numbers.at_slot) in_duals.at_slot.emplace_back(x);
    if (std::holds_alternative<Polyline>(surface)) continue;  // a place faces one of its facets
    for (const auto& at : {Vec<double, 2>(1.7, 2.3), Vec<double, 2>(-0.2, 0.3), Vec<double, 2>(0.4, -1.9)}) {
      ASSERT_EQ(ambiguity(at, surface, numbers), nullptr);
      const Vec<Probe, 2> x(Probe::seed(at[0], 0), Probe::seed(at[1], 1));
      const auto geometry = against_rigid<Probe>(x, surface, in_duals);
      EXPECT_NEAR(value(geometry.gap), against_rigid<double>(at, surface, numbers).gap, rounding);
      for (int i = 0; i < 2; ++i) EXPECT_NEAR(geometry.gap.d[i], value(geometry.normal[i]), rounding) << i;
      EXPECT_NEAR(std::hypot(value(geometry.normal[0]), value(geometry.normal[1])), 1, rounding);
    }
  }
}

}  // namespace
}  // namespace stickslip
