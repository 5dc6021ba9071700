/// What the list of rigid surfaces does with each of them.
#include "core/contact/rigid_surfaces.hpp"

#include <gtest/gtest.h>

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
