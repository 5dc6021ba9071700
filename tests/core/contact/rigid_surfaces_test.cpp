/// What the list of rigid surfaces does with each of them.
#include "core/contact/rigid_surfaces.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace stickslip::rigid_surfaces_test {
namespace {

const Numbers<double> no_slots;

TEST(RigidSurfaces, AreVisitedByTheGeometryOfEach) {
  const Vec<double, 2> x(3, 4);
  const RigidSurface floor = Plane{{0.0, 1.0}, {0.0, 2.0}}, disk = Circle{{0.0, 0.0}, 2.0},
                     cup = Circle{{0.0, 0.0}, 7.0, true};
  EXPECT_DOUBLE_EQ(against_rigid<double>(x, floor, no_slots).gap, 3);
  EXPECT_DOUBLE_EQ(against_rigid<double>(x, disk, no_slots).gap, 3);
  EXPECT_DOUBLE_EQ(against_rigid<double>(x, cup, no_slots).gap, 2);
}

/// Distances in space, from places beside a skew axis and a centre that are not the origin.
TEST(RigidSurfaces, OfSpaceHaveTheDistanceFromTheirAxisOrCentre) {
  const Vec<double, 3> center(1, -2, 0.5), axis = Vec<double, 3>(2, 1, -2) / 3,
                                           beside(1 / std::sqrt(5.0), -2 / std::sqrt(5.0), 0);
  const auto drum = [&](bool inside) -> RigidSurface {
    return Cylinder{{center[0], center[1], center[2]}, {4.0, 2.0, -4.0}, 1.5, inside};
  };
  const auto ball = [&](bool inside) -> RigidSurface { return Sphere{{center[0], center[1], center[2]}, 1.5, inside}; };
  for (const double along : {-3.0, 0.0, 7.0})
    for (const double away : {0.5, 1.5, 4.0}) {
      const Vec<double, 3> x = center + along * axis + away * beside;
      const auto outside = against_rigid<double>(x, drum(false), no_slots),
                 bore = against_rigid<double>(x, drum(true), no_slots);
      EXPECT_NEAR(outside.gap, away - 1.5, 1e-14 * 10);  // (places have a size of 10)
      EXPECT_NEAR(bore.gap, 1.5 - away, 1e-14 * 10);
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(outside.normal[i], beside[i], 1e-13);
        EXPECT_NEAR(bore.normal[i], -beside[i], 1e-13);
      }
      const double distance = std::hypot(along, away);
      const auto whole = against_rigid<double>(x, ball(false), no_slots),
                 cup = against_rigid<double>(x, ball(true), no_slots);
      EXPECT_NEAR(whole.gap, distance - 1.5, 1e-14 * 10);
      EXPECT_NEAR(cup.gap, 1.5 - distance, 1e-14 * 10);
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(whole.normal[i], (x - center)[i] / distance, 1e-13);
    }
  EXPECT_STREQ(ambiguity(Vec<double, 3>(center + 3 * axis), drum(false), no_slots), "cylinder/point");
  EXPECT_STREQ(ambiguity(center, ball(false), no_slots), "sphere/center");
}

TEST(RigidSurfaces, NameThePlaceFromWhichNoPartIsNearerThanAnother) {
  const RigidSurface floor = Plane{{0.0, 1.0}, {0.0, 1.0}}, disk = Circle{{0.5, 0.0}, 2.0};
  const Vec<double, 2> center(0.5, 0), beside(0.5, 1e-300);
  EXPECT_STREQ(ambiguity(center, disk, no_slots), "circle/center");
  EXPECT_EQ(ambiguity(beside, disk, no_slots), nullptr);
  EXPECT_EQ(ambiguity(center, floor, no_slots), nullptr);
}

TEST(RigidSurfaces, SayWhereTheyAreAvailable) {
  EXPECT_TRUE(is_in_space(Plane{}));
  EXPECT_FALSE(is_in_space(Circle{}));
  EXPECT_FALSE(is_in_space(Polyline{}));
  EXPECT_TRUE(is_flat(Plane{}));
  EXPECT_FALSE(is_flat(Circle{}));
}

}  // namespace
}  // namespace stickslip::rigid_surfaces_test
