/// From a scene to its model: steps, dofs, sides, supports, and what a response's place is.
#include "core/model/model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/generators.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::model_test {
namespace {

using scenes::support;
using scenes::table;
using testing::ElementsAre;
using testing::HasSubstr;

/// One box of 2 x 1 cells, nodes 0 1 2 below and 3 4 5 above, that nobody holds.
Scene box() {
  Scene scene;
  scene.legs = {{1, 1}};
  BoxMesh mesh;
  mesh.min = {0.0, 0.0};
  mesh.max = {2.0, 1.0};
  mesh.cells = {2, 1};
  scene.bodies = {{"block", mesh, LinearElastic{1000.0, 0.3}, "", 1.0}};
  return scene;
}

Body point(const std::string& name, double x, double y) {
  return {name, PointMesh{{x, y}}, GroundedSpring{{{1.0, 0.0}, {0.0, 1.0}}}, "", 1.0};
}

/// What make_model says against a scene, and where; fails where it says nothing.
ModelError refusal(const Scene& scene) {
  try {
    make_model(scene);
  } catch (const ModelError& error) {
    return error;
  }
  ADD_FAILURE() << "the scene was accepted";
  return ModelError("");
}

TEST(StepEnds, AreTheEqualStepsOfEachLeg) {
  auto scene = box();
  scene.legs = {{1, 4}, {3, 2}};
  EXPECT_THAT(make_model(scene).times, ElementsAre(0.25, 0.5, 0.75, 1, 2, 3));
}

TEST(StepEnds, HitTheBreakpointsOfEveryTable) {
  auto scene = box();
  scene.legs = {{2, 2}};
  scene.supports = {support("block.left", {{'x', table({{0, 0.0}, {0.3, 1.0}, {2, 0.0}})}})};
  scene.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {{'y', table({{1.5, 0.1}})}}}};
  scene.loads = {scenes::traction("block.top", {0.0, -1.0})};
  scene.loads[0].history = table({{0, 0.0}, {0.7, 1.0}, {1, 1.0}, {7, 2.0}});  // 7: after the end
  EXPECT_THAT(make_model(scene).times, ElementsAre(0.3, 0.7, 1, 1.5, 2));
}

TEST(StepEnds, TakeABreakpointARoundingBesideAStepForTheStep) {
  auto scene = box();
  scene.legs = {{1, 10}};
  scene.supports = {support("block.left", {{'x', table({{0, 0.0}, {0.1 + 0.2, 1.0}})}})};
  EXPECT_EQ(make_model(scene).times.size(), 10u);
}

TEST(StepEnds, TakeBreakpointsOfTwoTablesARoundingApartForOne) {
  auto scene = box();
  scene.supports = {support("block.left", {{'x', table({{0, 0.0}, {0.3, 1.0}})}}),
                    support("block.right", {{'x', table({{0, 0.0}, {0.1 + 0.2, 1.0}})}})};
  EXPECT_EQ(make_model(scene).times.size(), 2u);
}

TEST(Dofs, AreNodeMajorAndDividedIntoFreeAndPrescribed) {
  auto scene = box();
  scene.bodies.push_back(point("ball", 5, 5));
  scene.supports = {support("block.left", {{'x', table({{0, 0.0}})}})};
  const Model model = make_model(scene);
  EXPECT_EQ(model.node_count, 8);
  EXPECT_EQ(model.dof_count(), 16);
  EXPECT_EQ(model.bodies[1].first_node, 6);
  std::vector<int> prescribed;
  for (const auto& constraint : model.constraints) prescribed.push_back(constraint.dof);
  EXPECT_THAT(prescribed, ElementsAre(0, 6, 14, 15));  // x of nodes 0 and 3, and the anchor's two
  EXPECT_EQ(model.constraints[0].support, 0);
  EXPECT_EQ(model.constraints[0].axis, 'x');
  EXPECT_EQ(model.constraints[2].support, -1);  // nobody moves the anchor
  EXPECT_THAT(model.free_dofs, ElementsAre(1, 2, 3, 4, 5, 7, 8, 9, 10, 11, 12, 13));
  for (std::size_t i = 0; i < model.free_dofs.size(); ++i)
    EXPECT_EQ(model.free_index[model.free_dofs[i]], static_cast<int>(i));
  for (int dof : prescribed) EXPECT_EQ(model.free_index[dof], -1);
}

TEST(Dofs, OfAnAnchorBelongToTheSupportThatMovesIt) {
  Scene scene;
  scene.legs = {{1, 1}};
  scene.bodies = {point("ball", 0, 0)};
  scene.supports = {support("ball.anchor", {{'y', table({{0, 0.0}, {1, 0.1}})}})};
  const Model model = make_model(scene);
  ASSERT_EQ(model.constraints.size(), 2u);
  EXPECT_EQ(model.constraints[0].support, -1);
  EXPECT_EQ(model.constraints[1].support, 0);
  EXPECT_EQ(model.constraints[1].axis, 'y');
}

TEST(SideSets, AreInTheNumberingOfTheModel) {
  auto scene = box();
  scene.bodies.insert(scene.bodies.begin(), point("ball", 5, 5));
  const Model model = make_model(scene);
  const SideSet top = model.side("block.top");
  EXPECT_EQ(top.body, 1);
  EXPECT_THAT(top.nodes, ElementsAre(7, 6, 5));  // counter-clockwise: right to left
  EXPECT_THAT(top.facets, ElementsAre(ElementsAre(7, 6), ElementsAre(6, 5)));
  EXPECT_THAT(model.side("block.bottom & block.right").nodes, ElementsAre(4));
  EXPECT_THAT(model.side("block.bottom - block.right").nodes, ElementsAre(2, 3));
}

TEST(SideSets, ThatDoNotExistAreRefused) {
  const Model model = make_model(box());
  EXPECT_THROW(model.side("blok.left"), ModelError);
  EXPECT_THROW(model.side("block.lft"), ModelError);
  EXPECT_THROW(model.side("block"), ModelError);
  EXPECT_THROW(model.contact_index("sole"), ModelError);
}

TEST(Supports, MayShareACornerWhereTheyMoveItAlike) {
  auto scene = box();
  scene.supports = {support("block.left", {{'x', table({{0, 0.0}, {1, 0.1}})}}),
                    support("block.bottom", {{'x', table({{0, 0.0}, {1, 0.1}})}, {'y', table({{0, 0.0}})}})};
  const Model model = make_model(scene);
  EXPECT_EQ(model.constraints.size(), 2u + 3u - 1u + 3u);  // x of left and bottom without the corner twice; y of bottom
  EXPECT_EQ(model.constraints[0].support, 0);
}

TEST(Supports, ThatMoveACornerDifferentlyAreRefusedByName) {
  auto scene = box();
  scene.supports = {support("block.left", {{'x', table({{0, 0.0}, {1, 0.1}})}}),
                    support("block.bottom", {{'x', table({{0, 0.0}, {1, 0.2}})}})};
  const auto error = refusal(scene);
  EXPECT_EQ(error.pointer, "/supports/1/move/x");
  EXPECT_THAT(error.what(), HasSubstr("block.left"));
}

TEST(Supports, AlongAnAxisThatTheSpaceHasNotAreRefused) {
  for (char axis : {'z', 'w', 'a'}) {
    auto scene = box();
    scene.supports = {support("block.left", {{axis, table({{0, 0.0}})}})};
    EXPECT_EQ(refusal(scene).pointer, "/supports/0") << axis;
  }
}

TEST(Models, OfAMeshThatCannotBeMadeAreRefusedByTheBody) {
  auto scene = box();
  std::get<BoxMesh>(scene.bodies[0].mesh).cells = {0, 1};
  EXPECT_EQ(refusal(scene).pointer, "/bodies/block/mesh");
}

TEST(Models, CallForTheEffectsOfTheirScene) {
  auto scene = scenes::two_boxes(3, 4);
  auto effects = make_model(scene).effects;
  EXPECT_TRUE(effects.contact && effects.friction && effects.deformable_master && effects.sensitivity);
  scene.contacts[0].friction.reset();
  scene.parameters.clear();
  effects = make_model(scene).effects;
  EXPECT_TRUE(effects.contact && effects.deformable_master);
  EXPECT_FALSE(effects.friction || effects.sensitivity);
  effects = make_model(box()).effects;
  EXPECT_FALSE(effects.contact || effects.friction || effects.deformable_master || effects.sensitivity);
  EXPECT_FALSE(make_model(scenes::stop()).effects.deformable_master);
}

/// A response for the displacement along x at a point.
Scene with_response_at(Scene scene, double x, double y) {
  scene.responses = {scenes::response("u", Response::Kind::displacement, "", "x")};
  scene.responses[0].at = {x, y};
  return scene;
}

TEST(ResponsePlaces, InterpolateLinearFieldsInTheElementThatHoldsThem) {
  for (const char* element : {"T3", "Q4"})
    for (const auto& [x, y] : {std::pair{0.3, 0.2}, {1.7, 0.9}, {1.0, 0.5}, {2.0, 1.0}, {0.0, 0.4}}) {
      auto scene = with_response_at(box(), x, y);
      scene.bodies[0].element = element;
      const Model model = make_model(scene);
      const auto points = make_points<double>(scene.bodies[0].mesh, scene.as<double>(), 2);
      Eigen::Vector2d found(0, 0);
      double total = 0;
      const auto& place = model.response_places[0];
      for (std::size_t a = 0; a < place.nodes.size(); ++a) {
        found += place.weights[a] * points.col(place.nodes[a]);
        total += place.weights[a];
      }
      EXPECT_NEAR(found[0], x, 1e-15 * 8);  // a few roundings of numbers up to 2
      EXPECT_NEAR(found[1], y, 1e-15 * 8);
      EXPECT_NEAR(total, 1, 1e-15 * 4);
    }
}

TEST(ResponsePlaces, OutsideOfEveryBodyAreRefused) {
  for (const auto& [x, y] : {std::pair{2.1, 0.5}, {-0.01, 0.5}, {1.0, 1.001}})
    EXPECT_EQ(refusal(with_response_at(box(), x, y)).pointer, "/responses/u");
}

TEST(ResponsePlaces, OfAContactAreTheNearestContactPoint) {
  auto scene = scenes::two_boxes(4, 5);  // slave nodes at 0.2, 0.6, 1.0, 1.4, 1.8
  scene.responses = {scenes::response("p", Response::Kind::contact_pressure, "touch")};
  scene.responses[0].at = {1.3, 1.0};
  const Model model = make_model(scene);
  ASSERT_EQ(model.response_places[0].points.size(), 1);
  const int p = model.response_places[0].points[0];
  const auto points = make_points<double>(scene.bodies[0].mesh, scene.as<double>(), 2);
  EXPECT_DOUBLE_EQ(points(0, model.points[p].nodes[0]), 1.4);
}

}  // namespace
}  // namespace stickslip::model_test
