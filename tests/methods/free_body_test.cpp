/// A body that friction alone holds: an increment may have another solution, in which it is thrown out of its contacts.
/// The one that belongs to the path is found, by every method and from every scale.
#include <gtest/gtest.h>

#include "tests/support/blocks.hpp"

namespace stickslip::free_body_test {
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
  s.bodies = {scenes::box_body("block", {0, 0}, {2, 1}, {cells, 2}),
              scenes::box_body("press", {0, 1}, {2, 2}, {cells, 2})};
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

/// One cube, or two that stand on one another, between a floor and a press that comes down until at t = 2 it touches,
/// goes up again, and at the end is `gap` / 2 deep. No number of it is one that a computer has exactly.
Scene touched_cube(double height, double gap, double friction, bool two, bool finite) {
  Scene s;
  s.finite_strain = finite;
  s.legs = {{5, 5}};
  s.bodies = {scenes::box_body("cube", {-0.5, 0}, {0.5, height}, {3, 2})};
  if (two) s.bodies.push_back(scenes::box_body("top", {-0.4, height}, {0.4, height + 0.7}, {4, 2}));
  if (finite)
    for (auto& body : s.bodies) body.material = NeoHookean{1000, 0.3, NeoHookean::Volumetric::quadratic};
  const std::string pressed = s.bodies.back().name;
  const Table way = table({{0, 0.0}, {2, -gap}, {3, -gap / 3}, {5, -1.5 * gap}});
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}},
                 {"press", Plane{{0.0, height + (two ? 0.7 : 0) + gap}, {0.0, -1.0}}, {{'y', way}}}};
  s.contacts = {contact("low", "cube.bottom", "floor"), contact("high", pressed + ".top", "press")};
  if (two) s.contacts.push_back(contact("between", "top.bottom", "cube.top"));
  for (auto& c : s.contacts) c.friction = friction;
  s.responses = {response("N", Kind::contact_force, "high", "normal")};
  return s;
}

TEST(ContactThatClosesWithoutForce, LeavesBodiesWhereTheyAreAndPressesThemLater) {
  for (const bool finite : {false, true})
    for (const bool two : {false, true})
      for (const double friction : {0.0, 0.3})
        for (const auto& [height, gap] : {std::pair{1.3, 0.02}, {0.7, 0.003}}) {
          const auto scene = touched_cube(height, gap, friction, two, finite);
          double exact = 0;
          for (const auto& method : {Method(MonolithicAL{}), Method(UzawaAL{}), Method(Penalty{})}) {
            const auto r = run(scene, method);
            const std::string what =
                std::string(name_of(method)) + (finite ? " finite" : " small") + (two ? " two" : " one");
            ASSERT_TRUE(is_converged(r.trajectory.status)) << what << r.trajectory.message << height << friction;
            EXPECT_EQ(r.trajectory.counters.cutbacks, 0) << what;
            const auto& touched = r.trajectory.increments[1];
            EXPECT_EQ(touched.newton, 0) << what;
            EXPECT_TRUE(touched.state.contact.traction.isZero(0)) << what;
            EXPECT_TRUE(touched.state.displacement.isZero(0)) << what;
            if (exact == 0) exact = r.value("N");
            EXPECT_GT(r.value("N"), 0) << what;
            const double apart = prevents_penetration(method) ? 1e-6 : 1e-2;  // Uzawa's tolerance; a penalty's overlap
            EXPECT_NEAR(r.value("N"), exact, apart * exact) << what;
          }
        }
}

TEST(BodyThatMovesAndTouchesNothing, IsConverged) {  // all of its forces are rounding, and they stop falling
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 4}};
  s.bodies = {scenes::box_body("pad", {-1.6, 0}, {-0.4, 0.8}, {12, 4})};
  s.bodies[0].material = NeoHookean{1000, 0.3, NeoHookean::Volumetric::log};
  s.obstacles = {{"floor", Plane{{0.0, -0.1}, {0.0, 1.0}}}};
  s.contacts = {contact("c", "pad.bottom", "floor")};
  s.supports = {scenes::support("pad.top", {{'x', scenes::ramp(0.0)}, {'y', scenes::ramp(-0.15)}})};
  for (const auto& method : {Method(MonolithicAL{}), Method(UzawaAL{}), Method(Penalty{})}) {
    const auto r = run(s, method);
    ASSERT_EQ(r.trajectory.increments.size(), 4u) << name_of(method) << r.trajectory.message;
    ASSERT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << r.trajectory.message;
    for (int n = 0; n < 2; ++n) {  // in the third it touches
      const auto& increment = r.trajectory.increments[n];
      EXPECT_EQ(increment.status, Status::converged) << name_of(method) << increment.time << increment.message;
    }
  }
}

}  // namespace
}  // namespace stickslip::free_body_test
