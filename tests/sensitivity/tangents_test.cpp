/// Tangents of every kind of element, material, space and contact against the complex step of what they are of.
#include "tests/support/tangents.hpp"

#include <gtest/gtest.h>

#include "tests/support/solved.hpp"

namespace stickslip::tangents_test {
namespace {

using scenes::table;

/// A block (its ring, of revolution) pressed into something and drawn along it by its top.
Scene block(Space space, bool finite, const Material& material, const std::string& element) {
  Scene s;
  s.space = space;
  s.finite_strain = finite;
  s.legs = {{1, 2}, {2, 2}};
  const double left = space == Space::axisymmetric ? 1 : 0;
  BoxMesh box;
  box.min = {left, 0.0};
  box.max = {left + 2, 0.8};
  box.cells = {4, 2};
  s.bodies = {{"block", box, material, element, 1.0}};
  s.obstacles = {{"floor", Circle{{left + 1.07, -1.5}, 1.5}}};
  s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  s.contacts[0].friction = 0.3;
  s.supports = {scenes::support("block.top",
                                {{'y', table({{0, 0.0}, {1, -0.11}})}, {'x', table({{0, 0.0}, {1, 0.0}, {2, 0.06}})}})};
  return s;
}

/// After the first, the third and the last of its increments. Sums of some hundred products: 1e-15 or so are found.
void expect_tangents(const Scene& scene, const std::string& what) {
  for (const Method& method : {Method(Penalty{}), Method(UzawaAL{}), Method(MonolithicAL{})}) {
    const auto s = scenes::run(scene, method);
    ASSERT_TRUE(is_converged(s.trajectory.status)) << what << name_of(method) << s.trajectory.message;
    const std::size_t count = s.trajectory.increments.size();
    for (const std::size_t n : {std::size_t{0}, count / 2, count - 1})
      EXPECT_LE(scenes::errors_of_tangent(s.model, s.slots, method, s.trajectory, n).largest(), 1e-12)
          << what << " by " << name_of(method) << ", increment " << n;
  }
}

TEST(Tangents, OfEveryElementMaterialAndSpaceAreTheComplexStep) {
  using Volumetric = NeoHookean::Volumetric;
  const J2Plastic metal{100.0, 0.3, 2.3, 12.0};
  const LinearElastic elastic{100.0, 0.3};
  for (const Space space : {Space::plane_strain, Space::plane_stress, Space::axisymmetric})
    for (const char* element : {"Q4", "Q4_mean_dilatation", "Q8", "T3", "T6"}) {
      const std::string what = std::string(element) + " in space " + std::to_string(static_cast<int>(space));
      const bool averages = std::string(element) == "Q4_mean_dilatation";
      if (averages && space == Space::plane_stress) continue;
      expect_tangents(block(space, false, elastic, element), what + ", elastic");
      expect_tangents(block(space, false, metal, element), what + ", metal");
      if (space == Space::plane_stress) continue;  // (which finite strain does not know)
      expect_tangents(block(space, true, NeoHookean{100.0, 0.3, Volumetric::quadratic}, element), what + ", rubber");
      expect_tangents(block(space, true, NeoHookean{100.0, 0.3, Volumetric::log}, element), what + ", rubber, log");
      expect_tangents(block(space, true, metal, element), what + ", metal at finite strain");
    }
}

TEST(Tangents, OfEverySurfaceAreTheComplexStep) {
  Polyline line;
  for (const auto& [x, y] : {std::pair(-1.0, -0.3), {0.3, -0.02}, {1.1, 0.0}, {1.8, -0.05}, {3.0, -0.4}})
    line.points.push_back({x, y});
  const std::vector<RigidSurface> surfaces{Plane{{0.0, 0.0}, {0.1, 1.0}}, Circle{{1.07, -1.5}, 1.5},
                                           Circle{{1.07, 40.0}, 40.0, true}, line};
  for (const bool finite : {false, true})
    for (std::size_t k = 0; k < surfaces.size(); ++k)
      for (const bool friction : {false, true})
        for (const Smoothing smoothing : {Smoothing::none, Smoothing::catmull_rom, Smoothing::b_spline}) {
          if (smoothing != Smoothing::none && k != 3) continue;
          const Material material = finite ? Material(NeoHookean{100.0, 0.3}) : Material(LinearElastic{100.0, 0.3});
          Scene s = block(Space::plane_strain, finite, material, "Q4");
          s.obstacles[0].shape = surfaces[k];
          s.obstacles[0].rotate = Rotation{{1.0, -1.0}, {}, table({{0, 0.0}, {1, 0.0}, {2, 3.0}})};
          s.contacts[0].smoothing = smoothing;
          if (!friction) s.contacts[0].friction.reset();
          expect_tangents(s, "surface " + std::to_string(k) + (finite ? ", finite" : ", small"));
        }
}

TEST(Tangents, BetweenBodiesAreTheComplexStep) {
  for (const Scene& scene : scenes::all()) expect_tangents(scene, "a small scene");
  for (const bool segment : {false, true}) {
    Scene s = scenes::two_boxes(6, 9);
    s.contacts[0].segment = segment;
    expect_tangents(s, segment ? "segment" : "node");
  }
}

}  // namespace
}  // namespace stickslip::tangents_test
