/// The stiffness that is kept with its derivatives, against the forces of the elements themselves.
#include <gtest/gtest.h>

#include "core/engine/body_matrix.hpp"
#include "sensitivity/differentiation.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::dual_stiffness_test {
namespace {

/// Forces of all bodies by the elements themselves, at motions with and without derivatives.
void expect_forces_of_elements(const Model& model, ParameterBlock& block, bool moves) {
  Vector<Direction> u = lift(derivatives::arbitrary(model.dof_count(), 3));
  if (moves)
    for (int d = 0; d < directions; ++d) {
      const auto rate = derivatives::arbitrary(model.dof_count(), 4 + d);
      for (Eigen::Index i = 0; i < u.size(); ++i) u[i].d[d] = rate[i];
    }
  const Vector<Direction> expected = bulk_forces(model, block.slots, u, {}, nullptr);
  const ElementLists touched = block.touched;
  ParameterBlock kept = block;
  kept.touched.assign(model.bodies.size(), {});
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    for (int e = 0; e < model.bodies[b].mesh.element_count(); ++e) kept.touched[b].push_back(e);
  kept.keep_stiffness(model);
  Vector<Direction> forces = bulk_forces(model, kept.slots, u, {}, &kept.touched);
  kept.stiffness->add_forces(u, forces);
  Direction::Gradient largest = Direction::Gradient::Zero();
  double force = 0;
  for (const auto& x : expected) {
    largest = largest.max(x.d.abs());
    force = larger(force, std::abs(x.v));
  }
  // some hundred terms meet in a row, and stiffness times displacement cancels to strains: in a motion at random
  // little. (A shape that moves as a whole changes no force: what is left rounds as forces do, over lengths of about
  // one.)
  constexpr double rounding = 1e-13;
  for (Eigen::Index i = 0; i < forces.size(); ++i) {
    for (int d = 0; d < directions; ++d)
      EXPECT_NEAR(forces[i].d[d], expected[i].d[d], rounding * std::max(largest[d], force)) << i;
    if (!model.framed.empty()) {
      EXPECT_NEAR(forces[i].v, expected[i].v, rounding * force) << i;
    }
  }
}

TEST(DualStiffness, GivesTheForcesOfElementsOfEveryKindWithTheirDerivatives) {
  std::vector<Scene> scenes = scenes::of_every_element();
  for (const auto& scene : scenes::all()) scenes.push_back(scene);
  for (const auto& scene : scenes::shaped()) scenes.push_back(scene);
  for (const auto& scene : scenes) {
    SCOPED_TRACE(scene.bodies[0].name);
    const Model model = make_model(scene);
    for (auto& block : parameter_blocks(model))
      for (bool moves : {false, true}) expect_forces_of_elements(model, block, moves);
  }
}

TEST(DualStiffness, IsKeptOfLinearBodiesAloneWhereItSavesWork) {
  Scene scene = scenes::two_boxes(4, 3);
  scene.parameters.resize(2);
  const auto kept_elements = [](const Scene& s) {
    const Model model = make_model(s);
    long bytes = 0, touched = 0;
    for (const auto& block : parameter_blocks(model)) {
      if (block.stiffness) bytes += block.stiffness->bytes();
      for (const auto& list : block.touched) touched += static_cast<long>(list.size());
    }
    EXPECT_EQ(bytes, kept_stiffness_bytes(model));
    return std::pair(bytes, touched);
  };
  const auto [kept, left] = kept_elements(scene);
  EXPECT_GT(kept, 0);
  EXPECT_EQ(left, 0);
  Scene brief = scene;
  brief.legs = {{1, 2}};
  EXPECT_EQ(kept_elements(brief).first, 0);
  EXPECT_GT(kept_elements(brief).second, 0);
  Scene many = scene;
  while (static_cast<int>(many.parameters.size()) <= columns_together) many.parameters.push_back(scene.parameters[1]);
  EXPECT_EQ(kept_elements(many).first, 0);
  Scene metal = scene;
  metal.bodies[1].material = J2Plastic{1500.0, 0.2, 10.0, 100.0};
  EXPECT_LT(kept_elements(metal).first, kept);
  EXPECT_GT(kept_elements(metal).second, 0);
}

}  // namespace
}  // namespace stickslip::dual_stiffness_test
