/// A body that friction alone holds: an increment may have another solution, in which it is thrown out of its contacts.
/// The one that belongs to the path is found, by every method and from every scale.
#include <gtest/gtest.h>

#include "tests/support/scenes.hpp"

namespace stickslip {
namespace {

using scenes::contact;
using scenes::response;
using scenes::run;
using scenes::support;
using scenes::table;
using Kind = Response::Kind;

/// A block of 2 x 1 on a plane of slope `tilt`, pressed by another one that moves by (across, -1/600).
Scene pressed_block(double tilt, double below, double above, double across, int cells, int steps = 1) {
  Scene s;
  s.legs = {{1, steps}};
  for (const double bottom : {0.0, 1.0}) {
    BoxMesh box;
    box.min = {0.0, bottom};
    box.max = {2.0, bottom + 1};
    box.cells = {cells, 2};
    s.bodies.push_back({bottom == 0 ? "block" : "press", box, LinearElastic{1000.0, 0.3}, "", 1.0});
  }
  s.obstacles = {{"slope", Plane{{0.0, 0.0}, {tilt, 1.0}}, {}}};
  s.contacts = {contact("sole", "block.bottom", "slope"), contact("top", "press.bottom", "block.top")};
  s.contacts[0].friction = below;
  s.contacts[1].friction = above;
  s.supports = {
      support("press.top", {{'x', table({{0, 0.0}, {1, across}})}, {'y', table({{0, 0.0}, {1, -1.0 / 600}})}})};
  s.responses = {response("N", Kind::contact_force, "sole", "normal"),
                 response("u", Kind::displacement, "block.top", "x")};
  return s;
}

TEST(BodyHeldByFriction, StaysPressedByEveryMethodFromEveryScale) {
  struct Pair {
    double below, above;  // not equal: then neither contact gives way first
  };
  for (const double tilt : {1e-4, 0.003, 0.03})
    for (const auto& [below, above] : {Pair{0.6, 0.3}, Pair{0.3, 0.15}})
      for (const double across : {-1.0 / 300, 0.006}) {
        Penalty stiff;
        stiff.stiffness = scenes::absolute(1e6);
        const auto scene = pressed_block(tilt, below, above, across, 4);
        std::vector<Method> methods{stiff, UzawaAL{}};
        for (const double scale : {0.1, 1.0, 10.0}) {
          MonolithicAL monolithic;
          monolithic.scale = scenes::relative(scale);
          methods.push_back(monolithic);
        }
        double reference = 0;
        for (const auto& method : methods) {
          const auto r = run(scene, method);
          ASSERT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << r.trajectory.message;
          if (reference == 0) reference = r.value("N");
          EXPECT_GT(r.value("N"), 0.1) << name_of(method) << tilt;
          EXPECT_LT(std::abs(r.value("u")), std::abs(across)) << name_of(method) << tilt;
          // a penalty of 1e6 against a stiffness of 1000 lets 1e-3 in
          EXPECT_NEAR(r.value("N"), reference, 2e-3 * reference) << name_of(method) << tilt << below << across;
        }
      }
}

TEST(BodyHeldByFriction, FollowsItsPathInAnyNumberOfSteps) {
  for (const int steps : {1, 2, 6}) {
    const auto scene = pressed_block(0.003, 0.6, 0.3, -1.0 / 300, 6, steps);
    const auto exact = run(scene, MonolithicAL{}), updated = run(scene, UzawaAL{});
    ASSERT_TRUE(is_converged(exact.trajectory.status)) << exact.trajectory.message;
    ASSERT_TRUE(is_converged(updated.trajectory.status)) << updated.trajectory.message;
    EXPECT_EQ(exact.trajectory.counters.cutbacks, 0);
    EXPECT_NEAR(updated.value("N"), exact.value("N"), 1e-8 * exact.value("N"))
        << "Uzawa's 1e-10 times a factor rho / k";
    EXPECT_NEAR(updated.value("u"), exact.value("u"), 1e-8 * std::abs(exact.value("u")));
  }
}

TEST(BodyThatApproaches, NeedsNoForceByEitherEngine) {
  for (const auto engine : {LinearAlgebra::Engine::sparse, LinearAlgebra::Engine::condensed})
    for (const Method& method : {Method{Penalty{}}, Method{UzawaAL{}}, Method{MonolithicAL{}}}) {
      Scene s;
      s.legs = {{1, 5}};
      BoxMesh box;
      box.min = {0.0, 0.0};
      box.max = {2.0, 1.0};
      box.cells = {8, 4};
      s.bodies = {{"block", box, LinearElastic{1000.0, 0.3}, "", 1.0}};
      s.obstacles = {{"floor", Plane{{0.0, -0.02}, {0.0, 1.0}}, {}}};
      s.contacts = {contact("sole", "block.bottom", "floor")};
      s.supports = {support("block.top", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}, {1, -0.05}})}})};
      s.responses = {response("N", Kind::contact_force, "sole", "normal"),
                     response("v", Kind::displacement, "block.bottom", "y")};
      RunOptions options;
      options.linear_algebra.engine = engine;
      const auto r = run(s, method, options);
      ASSERT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << r.trajectory.message;
      EXPECT_EQ(r.trajectory.counters.cutbacks, 0);
      EXPECT_LE(r.trajectory.increments[0].newton, 3) << "one, and two to see that nothing falls any more";
      // one fifth of the way, where it touches nothing, all of it has moved alike
      EXPECT_EQ(r.value("N", 0), 0);
      EXPECT_NEAR(r.value("v", 0), -0.01, 1e-13);
      EXPECT_GT(r.value("N"), 60);
    }
}

TEST(NodeAtTheEndOfItsMaster, KeepsItWhereRoundedCoordinatesEndShort) {
  const auto force = [](double width) {
    Scene s;
    s.legs = {{1, 1}};
    for (const double bottom : {0.0, 1.0}) {
      BoxMesh box;
      box.min = {0.0, bottom};
      box.max = {bottom == 0 ? width : 2.0, bottom + 1};
      box.cells = {4, 3};
      s.bodies.push_back({bottom == 0 ? "lower" : "upper", box, LinearElastic{1000.0, 0.3}, "", 1.0});
    }
    s.contacts = {contact("touch", "upper.bottom", "lower.top")};
    s.contacts[0].friction = 0.3;
    s.supports = {support("lower.bottom", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}),
                  support("upper.top", {{'x', table({{0, 0.001}})}, {'y', table({{0, -0.01}})}})};
    s.responses = {response("N", Kind::contact_force, "touch", "normal")};
    return run(s, MonolithicAL{}).value("N");
  };
  const double flush = force(2);
  for (const double short_by : {1e-12, 1e-9, 1e-7, -1e-9})
    EXPECT_NEAR(force(2 - short_by), flush, 10 * std::abs(short_by) * flush + 1e-11 * flush) << short_by;
  EXPECT_LT(force(2 - 1e-3), 0.95 * flush) << "beyond rounding the last node faces nothing";
}

}  // namespace
}  // namespace stickslip
