/// What drives bodies (methods/stepping/drive.hpp), and how fast they must be for a jump to be looked for.
#include "methods/stepping/drive.hpp"

#include <gtest/gtest.h>

#include "methods/stepping/jumps.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/sliding_scenes.hpp"

namespace stickslip::drive_test {
namespace {

struct Driven {
  Model model;
  Slots<double> slots;
  explicit Driven(const Scene& scene)
      : model(make_model(scene)), slots(make_slots<double>(model, scene.as<double>())) {}
  double distance(double start, double end) const {
    return largest_nodal_norm(Vector<double>(driven_motion(model, slots, end) - driven_motion(model, slots, start)),
                              model.dimension);
  }
};

TEST(DrivenMotion, IsThatOfSupports) {
  const Driven die(scenes::sliding_die());  // pressed by .15 in a unit of time, then slid by 1.4 in another
  EXPECT_NEAR(die.distance(0, 1), 0.15, 1e-15);
  EXPECT_NEAR(die.distance(1, 1.5), 0.7, 1e-15);
  EXPECT_EQ(die.distance(1, 1), 0);
}

TEST(DrivenMotion, IsThatOfObstaclesWhereSlaveNodesAre) {
  Scene scene = scenes::pressed_metal(true);
  scene.supports[0].move = scenes::support("block.top", {{'y', scenes::table({{0, 0.0}})}}).move;
  scene.obstacles[0].move = {{'x', scenes::table({{0, 0.0}, {1, 0.3}})}};
  EXPECT_NEAR(Driven(scene).distance(0, 1), 0.3, 1e-15);
  scene.obstacles[0].move.clear();
  scene.obstacles[0].rotate = Rotation{{1.07, -1.5}, {}, scenes::table({{0, 0.0}, {1, 180.0}})};
  const Driven turned(scene);  // half a turn moves the farthest slave node by twice its arm
  double arm = 0;
  for (const auto& point : turned.model.points)
    arm = larger(arm, (turned.slots.points.col(point.nodes[0]).head<2>() - Eigen::Vector2d(1.07, -1.5)).norm());
  EXPECT_NEAR(turned.distance(0, 1), 2 * arm, 1e-14);
}

TEST(Sudden, IsWhatOutrunsBothTheLastIncrementAndWhatDrives) {
  const Driven die(scenes::sliding_die());
  std::vector<Increment<double>> before(1);
  before[0].time = 1;
  before[0].pace = 0.15;  // of the pressing; sliding begins with 1.4 a unit of time
  const auto sudden = [&](double pace) { return detail::is_sudden(die.model, die.slots, before, 1.1, pace); };
  EXPECT_FALSE(sudden(0.5));
  EXPECT_FALSE(sudden(1.4));
  EXPECT_FALSE(sudden(5.5));
  EXPECT_TRUE(sudden(5.7));
  before[0].pace = 2;
  EXPECT_FALSE(sudden(5.7));
  EXPECT_TRUE(sudden(8.1));
  before.clear();
  EXPECT_FALSE(sudden(100));
}

}  // namespace
}  // namespace stickslip::drive_test
