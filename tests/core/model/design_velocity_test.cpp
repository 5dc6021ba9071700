/// Shape parameters against the design velocities that generators have of their own.
#include "core/model/design_velocity.hpp"

#include <gtest/gtest.h>

#include "tests/support/compiled_slots.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::design_velocity_test {
namespace {

/// Rounding of a Laplace solve on a few dozen nodes.
constexpr double rounding = 1e-13;

Scene boxes() { return scenes::two_boxes(5, 4); }

TEST(DesignVelocity, OfAWholeSideOverAFixedOneIsThatOfTheBox) {
  Scene scene = boxes();
  scenes::shape(scene, "up", {0, "upper.top", "upper.bottom", {0, 1}, -1, 0});
  const Model model = make_model(scene);
  ASSERT_EQ(model.velocities.size(), 1u);
  const auto& mesh = model.bodies[0];
  const auto points = initial_points(model, scene.as<double>());
  const Vector<double> share = model.velocities[0].share();
  for (int n = 0; n < mesh.mesh.node_count; ++n)  // free sides: straight lines from the one to the other
    EXPECT_NEAR(share[n], points(1, mesh.first_node + n) - 1, rounding);
}

TEST(DesignVelocity, OfAllNodesOfASideAddUpToThatOfTheSide) {
  for (const std::string element : {"Q4", "T3", "Q8", "T6"}) {
    Scene scene = scenes::two_boxes(5, 4, element);
    scenes::shape(scene, "all", {0, "upper.bottom", "upper.top", {0, 1}, -1, 0});
    const auto nodes = make_model(boxes()).side("upper.bottom").nodes.size();
    const auto count = element == "Q8" || element == "T6" ? 2 * nodes - 1 : nodes;
    for (std::size_t n = 0; n < count; ++n)
      scenes::shape(scene, "one", {0, "upper.bottom", "upper.top", {0, 1}, static_cast<int>(n), 0});
    const Model model = make_model(scene);
    Vector<double> sum = Vector<double>::Zero(model.bodies[0].mesh.node_count);
    for (std::size_t v = 1; v < model.velocities.size(); ++v) sum += model.velocities[v].share();
    EXPECT_LE(largest_entry(sum - model.velocities[0].share()), rounding) << element;
  }
}

TEST(DesignVelocity, LeavesAllOtherSidesWhereTheyAreUnlessToldWhatStays) {
  Scene scene = boxes();
  scenes::shape(scene, "bump", {0, "upper.bottom", "", {0, 1}, 2, 0});
  const Model model = make_model(scene);
  const Vector<double> share = model.velocities[0].share();
  for (const char* side : {"upper.top", "upper.left", "upper.right"})
    for (int node : model.side(side).nodes) EXPECT_EQ(share[node], 0) << side;
  EXPECT_EQ(share[model.side("upper.bottom").nodes[2]], 1);
  EXPECT_GE(share.minCoeff<Eigen::PropagateNaN>(), 0);  // the maximum principle, on this mesh of near squares
  EXPECT_GT(share.sum(), 1.1);                          // the inside follows
}

TEST(DesignVelocity, IsHowCoordinatesDependOnTheParameter) {
  const Scene scene = scenes::shaped_boxes(5, 4, "Q4", false);
  const Model model = make_model(scene);
  auto numbers = scene.as<Direction>();
  const auto& velocity = model.velocities[1];
  numbers.at_slot[velocity.slot].d[0] = 1;
  const auto points = initial_points(model, numbers);
  const Vector<double> share = velocity.share();
  for (Eigen::Index n = 0; n < share.size(); ++n)
    for (int i = 0; i < 2; ++i) EXPECT_EQ(points(i, n).d[0], share[n] * velocity.direction[i]);
  EXPECT_TRUE(make_model(boxes()).velocities.empty());  // nothing where no shape is a parameter
}

TEST(ShapeExtension, PullsBackWhatItExtends) {
  const Scene scene = scenes::shaped_boxes(5, 4, "T3", false);
  const Model model = make_model(scene);
  const auto& extension = *model.velocities[1].extension;
  const auto nodes = static_cast<Eigen::Index>(extension.given().size());
  Vector<double> values = Vector<double>::Zero(nodes), by(nodes);
  for (Eigen::Index n = 0; n < nodes; ++n) {
    by[n] = std::sin(1.0 + 3.0 * static_cast<double>(n));
    if (extension.given()[n]) values[n] = std::cos(static_cast<double>(n));
  }
  const double there = by.dot(extension.extend(values)), back = extension.pull_back(by).dot(values);
  EXPECT_NEAR(there, back, rounding * by.norm() * values.norm());
}

TEST(ShapeExtension, IsSharedByTheNodesOfASide) {
  Scene scene = boxes();
  for (int n = 0; n < 4; ++n) scenes::shape(scene, "one", {0, "upper.bottom", "", {0, 1}, n, 0});
  const Model model = make_model(scene);
  for (const auto& velocity : model.velocities) EXPECT_EQ(velocity.extension, model.velocities[0].extension);
}

}  // namespace
}  // namespace stickslip::design_velocity_test
