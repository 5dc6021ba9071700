/// Which contact points a scene has: masters, unknowns, tributary areas.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/model/slots.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::contact_pairing_test {
namespace {

using testing::ElementsAre;

/// A box [0, 4] x [1, 2] of 4 x 1 cells above a master box [0, 4] x [0, 1] of `master` x 1 cells, and a floor at y = 1.
Scene boxes(int master, const std::string& slave_side = "upper.bottom") {
  Scene scene;
  scene.legs = {{1, 1}};
  BoxMesh upper, lower;
  upper.min = {0.0, 1.0};
  upper.max = {4.0, 2.0};
  upper.cells = {4, 1};
  lower.min = {0.0, 0.0};
  lower.max = {4.0, 1.0};
  lower.cells = {master, 1};
  scene.bodies = {{"upper", upper, LinearElastic{1000.0, 0.3}, "", 1.0},
                  {"lower", lower, LinearElastic{1000.0, 0.3}, "", 1.0}};
  scene.obstacles = {{"floor", Plane{{0.0, 1.0}, {0.0, 1.0}}, {}}};
  scene.contacts = {scenes::contact("touch", slave_side, "lower.top")};
  return scene;
}
Scene on_floor(const std::string& slave_side) {
  auto scene = boxes(4, slave_side);
  scene.contacts[0].master = "floor";
  return scene;
}

std::vector<double> areas(const Scene& scene) {
  const Model model = make_model(scene);
  std::vector<double> out;
  for (const auto& geometry : make_slots<double>(model, scene.as<double>()).geometry) out.push_back(geometry.area);
  return out;
}

TEST(SegmentNormals, HalveTheAngleBetweenTheTwoSurfaces) {
  Scene s;
  s.legs = {{1, 1}};
  const double slope = 0.3;
  QuadMesh upper;
  upper.corners = {{{0.5, 1.0}, {1.5, 1.0 + slope}, {1.5, 2.0}, {0.5, 2.0}}};
  upper.cells = {3, 2};
  BoxMesh lower;
  lower.min = {0.0, 0.0};
  lower.max = {2.0, 1.0};
  lower.cells = {5, 2};
  s.bodies = {{"upper", upper, LinearElastic{1.0, 0.3}, "", 1.0}, {"lower", lower, LinearElastic{1.0, 0.3}, "", 1.0}};
  s.contacts = {scenes::contact("touch", "upper.bottom", "lower.top")};
  s.contacts[0].segment = true;
  const Model model = make_model(s);
  const auto slots = make_slots<double>(model, s.as<double>());
  ASSERT_FALSE(model.points.empty());
  const double half = std::atan(slope) / 2;  // between the master's (0, 1) and the slave's reversed (-sin, cos)
  for (const auto& geometry : slots.geometry) {
    EXPECT_NEAR(geometry.normal[0], -std::sin(half), 1e-14);
    EXPECT_NEAR(geometry.normal[1], std::cos(half), 1e-14);
  }
}

TEST(ContactPairs, FaceAFacetBetweenNodesAndAVertexOnThem) {
  const Model matching = make_model(boxes(4)), staggered = make_model(boxes(3));
  ASSERT_EQ(matching.points.size(), 5u);
  using Master = ContactPoint::Master;
  EXPECT_EQ(matching.points[0].master, Master::facet);  // the ends of the master curve
  EXPECT_EQ(matching.points[1].master, Master::vertex);
  EXPECT_EQ(matching.points[4].master, Master::facet);
  ASSERT_EQ(staggered.points.size(), 5u);
  for (const auto& point : staggered.points) EXPECT_EQ(point.master, Master::facet);
}

TEST(ContactPairs, NameTheirNodesAndTheirPlacesAmongTheContactNodes) {
  for (int master : {3, 4}) {
    const Model model = make_model(boxes(master));
    EXPECT_TRUE(std::is_sorted(model.contact_nodes.begin(), model.contact_nodes.end()));
    EXPECT_EQ(model.contact_nodes.size(), 5u + master + 1);
    for (const auto& point : model.points) {
      // a facet's two nodes; a vertex and, as the slave node lies right above it, both nodes it may slide towards
      const std::size_t count = point.master == ContactPoint::Master::vertex ? 4 : 3;
      ASSERT_EQ(point.nodes.size(), count);
      ASSERT_EQ(point.places.size(), count);
      EXPECT_LT(point.nodes[0], model.bodies[1].first_node);
      for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(model.contact_nodes[point.places[i]], point.nodes[i]);
      for (std::size_t i = 1; i < count; ++i) EXPECT_GE(point.nodes[i], model.bodies[1].first_node);
    }
  }
}

TEST(ContactPairs, HaveAMultiplierForEachOfTheirComponentsInARow) {
  auto scene = boxes(3);
  scene.contacts.push_back(scenes::contact("rough", "upper.top", "floor"));
  scene.contacts[1].friction = 0.3;
  const Model model = make_model(scene);
  ASSERT_EQ(model.points.size(), 10u);
  int next = 0;
  for (const auto& point : model.points) {
    EXPECT_EQ(point.components(), point.contact == 0 ? 1 : 2);
    EXPECT_EQ(point.multiplier, next);
    next += point.components();
  }
  EXPECT_EQ(model.multiplier_count, 15);
}

TEST(ContactPairs, LeaveOutSlaveNodesBeyondTheMaster) {
  auto scene = boxes(3);
  std::get<BoxMesh>(scene.bodies[1].mesh).max[0] = 2.5;
  const Model model = make_model(scene);
  ASSERT_EQ(model.points.size(), 3u);  // at 0, 1 and 2
}

/// A rectangle that is turned.
QuadMesh turned_block(double angle, double left, double bottom, double right, double top, int cells) {
  const auto at = [c = std::cos(angle), s = std::sin(angle)](double x, double y) {
    return std::array<Number, 2>{c * x - s * y, s * x + c * y};
  };
  QuadMesh mesh;
  mesh.corners = {{at(left, bottom), at(right, bottom), at(right, top), at(left, top)}};
  mesh.cells = {cells, 2};
  return mesh;
}

/// Holds a contact of turned blocks to its number of points and to the normal of the sole.
void expect_points_of_the_sole(Scene scene, double angle, std::size_t points) {
  for (const Smoothing smoothing : {Smoothing::none, Smoothing::catmull_rom, Smoothing::b_spline}) {
    scene.contacts = {scenes::contact("touch", "lower.top", "upper.boundary")};
    scene.contacts[0].smoothing = smoothing;
    const Model model = make_model(scene);
    EXPECT_EQ(model.points.size(), points) << angle << ' ' << static_cast<int>(smoothing);
    for (const auto& geometry : make_slots<double>(model, scene.as<double>()).geometry) {
      EXPECT_NEAR(geometry.normal[0], std::sin(angle), 1e-14);  // rounding
      EXPECT_NEAR(geometry.normal[1], -std::cos(angle), 1e-14);
    }
  }
}

/// The sole of a block ends at its corners, where the block's own side begins. That side is at a right angle to the
/// floor, and rounding does not make it face the floor, however the blocks are turned. Nor does rounding put a node on
/// the sole into the block.
TEST(ContactPairs, LeaveOutSlaveNodesPastACornerOfTheMaster) {
  for (int turn = 0; turn < 12; ++turn) {
    const double angle = 0.5 * turn;
    Scene scene;
    scene.legs = {{1, 1}};
    scene.bodies = {{"upper", turned_block(angle, 1, 1, 3, 2, 3), LinearElastic{1.0, 0.3}, "", 1.0},
                    {"lower", turned_block(angle, 0, 0, 5, 1, 20), LinearElastic{1.0, 0.3}, "", 1.0}};
    expect_points_of_the_sole(scene, angle, 9);  // from 1 to 3, ends included
  }
}

TEST(ContactPairs, LeaveOutSlaveNodesPastAnEdgeOfTheMasterInSpace) {
  for (int turn = 0; turn < 12; ++turn)
    for (const char* element : {"H8", "T4"}) {
      const double angle = 0.5 * turn;
      Scene scene;
      scene.space = Space::solid;
      scene.legs = {{1, 1}};
      scene.bodies = {
          {"upper", ExtrudedMesh{turned_block(angle, 1, 1, 3, 2, 3), 1.0, 3.0, 3}, LinearElastic{1.0, 0.3}, element, 1},
          {"lower", ExtrudedMesh{turned_block(angle, 0, 0, 4, 1, 8), 0.0, 4.0, 8}, LinearElastic{1.0, 0.3}, element,
           1}};
      expect_points_of_the_sole(scene, angle, 25);  // from 1 to 3 both ways, edges included
    }
}

TEST(ContactPairs, LeaveOutSlaveNodesThatLookTheSameWayAsTheMaster) {
  EXPECT_TRUE(make_model(boxes(3, "upper.top")).points.empty());
  EXPECT_FALSE(make_model(boxes(3, "upper.bottom")).points.empty());
}

TEST(ContactPairs, TakeACornerAloneForASlaveToo) {
  EXPECT_EQ(make_model(on_floor("upper.bottom & upper.left")).points.size(), 1u);
  EXPECT_EQ(make_model(boxes(3, "upper.bottom & upper.left")).points.size(), 1u);
}

TEST(ContactPairs, TakeEverySlaveNodeAgainstAnObstacle) {
  EXPECT_EQ(make_model(on_floor("upper.bottom")).points.size(), 5u);
  EXPECT_EQ(make_model(on_floor("upper.bottom - upper.right")).points.size(), 4u);
}

TEST(ContactPairs, ThatTheSpaceHasNotAreRefused) {
  auto scene = scenes::dragged_point({{0, 0, 0}, {1, 0.1, 0}}, 1, 0.3);
  scene.obstacles[0].shape = Circle{{0.0, 0.0}, 1.0, false};
  EXPECT_THROW(make_model(scene), ModelError);
  auto unknown = boxes(3);
  unknown.contacts[0].master = "cellar";
  EXPECT_THROW(make_model(unknown), ModelError);
  auto without_facets = boxes(3);
  without_facets.contacts[0].master = "lower.top & lower.left";
  EXPECT_THROW(make_model(without_facets), ModelError);
}

TEST(TributaryAreas, AreHalfOfEachFacetAndAddUpToTheSide) {
  EXPECT_THAT(areas(on_floor("upper.bottom")), ElementsAre(0.5, 1, 1, 1, 0.5));
  auto graded = on_floor("upper.bottom");
  auto& mesh = std::get<BoxMesh>(graded.bodies[0].mesh);
  mesh.grade = {{"left", 5.0}};
  double total = 0;
  for (double area : areas(graded)) total += area;
  EXPECT_NEAR(total, 4, 1e-15 * 16);  // ten roundings of numbers up to 4
}

TEST(TributaryAreas, OfTheNodesThatAreLeftStayWhole) {
  EXPECT_THAT(areas(on_floor("upper.bottom - upper.right")), ElementsAre(0.5, 1, 1, 1));
}

TEST(TributaryAreas, OfBarsAreLengthsAlongThemAndTheCrossSectionAtAnEndAlone) {
  Scene scene;
  scene.legs = {{1, 1}};
  scene.bodies = {{"chain", LineMesh{{0.0, 0.0}, {3.0, 0.0}, 3}, LinearElastic{1.0, 0.3}, "", 0.02}};
  scene.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  scene.contacts = {scenes::contact("touch", "chain.nodes", "floor")};
  EXPECT_THAT(areas(scene), ElementsAre(0.5, 1, 1, 0.5));
  scene.contacts[0].slave = "chain.interior";
  EXPECT_THAT(areas(scene), ElementsAre(1, 1));
  scene.contacts[0].slave = "chain.end";
  EXPECT_THAT(areas(scene), ElementsAre(0.02));
}

TEST(TributaryAreas, OfAPointAreOne) { EXPECT_THAT(areas(scenes::stop()), ElementsAre(1)); }

TEST(TieLengths, AreRoundingsOfTheMeshAndOfThePlaceItStandsAt) {
  const Model here = make_model(on_floor("upper.bottom"));
  for (const auto& point : here.points) {
    EXPECT_EQ(point.mesh_size, 1);
    EXPECT_GT(point.tie_length, 0);
    EXPECT_LT(point.tie_length, 1e-11);  // of a cell of size one
  }
  auto far = on_floor("upper.bottom");
  auto& mesh = std::get<BoxMesh>(far.bodies[0].mesh);
  mesh.min[0] = 1e6;
  mesh.max[0] = 1e6 + 4;
  EXPECT_GT(make_model(far).points[0].tie_length, 1e-10);  // coordinates of 1e6 are rounded by 1e-10
}

}  // namespace
}  // namespace stickslip::contact_pairing_test
