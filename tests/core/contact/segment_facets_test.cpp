/// Places along the curved facets of quadratic sides.
#include "core/contact/segment_facets.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/algebra/scalar.hpp"

namespace stickslip::segment_facets_test {
namespace {

/// Both ways along it, from nearly folded at one end to nearly folded at the other: the place with its derivatives, as
/// exact as rounding and its condition permit.
TEST(AlongBulge, FindsThePlaceHoweverUnevenTheSideIs) {
  for (const double straight : {0.37, -0.37})
    for (const double share : {-0.98, -0.6, -0.1, 0.0, 0.3, 0.9, 0.98})
      for (double s = 0; s <= 1; s += 1.0 / 64) {
        const double bent = share * straight, way = s * straight + s * (1 - s) * bent;
        const double slope = straight + (1 - 2 * s) * bent;
        const auto found = detail::along_bulge(Dual<3>(0.0), Dual<3>::seed(way, 0), Dual<3>::seed(straight, 1),
                                               Dual<3>::seed(bent, 2));
        const double rounding = 1e-15 * std::abs(straight / slope);  // a few in way, times what a place moves by it
        EXPECT_NEAR(found.v, s, rounding) << straight << share;
        EXPECT_NEAR(found.d[0] * slope, 1, 10 * rounding * std::abs(straight / slope)) << straight << share << s;
        EXPECT_NEAR(found.d[1] * slope, -s, 10 * rounding * std::abs(straight / slope)) << straight << share << s;
        EXPECT_NEAR(found.d[2] * slope, -s * (1 - s), 10 * rounding * std::abs(straight / slope)) << share << s;
      }
}

/// Of a side that turns back before its first end or its second, as seen along the slave's normal, the part that runs
/// on: there the way grows as it does on the straight side.
TEST(AlongBulge, FindsThePartThatRunsOn) {
  for (const double straight : {0.37, -0.37})
    for (const double share : {-3.0, -1.5, 1.5, 3.0})
      for (double s = 0; s <= 1; s += 1.0 / 64) {
        const double bent = share * straight, growth = 1 + (1 - 2 * s) * share;
        if (growth < 0.05) continue;  // (runs back, or is about to)
        const double way = s * straight + s * (1 - s) * bent;
        EXPECT_NEAR(detail::along_bulge<double>(0, way, straight, bent), s, 1e-14 / growth) << straight << share;
      }
}

/// From a place other than the first end: a small way along a side that hardly bends has the digits of the way, and not
/// those of its place.
TEST(AlongBulge, KeepsTheDigitsOfASmallWay) {
  const double straight = 0.37;
  for (const double from : {-0.2, 0.1, 0.5, 0.9})
    for (const double bent : {0.0, 1e-9, -1e-6})
      for (const double shift : {1e-12, -1e-8, 1e-3}) {
        const double way = from * (1 - from) * bent + shift * (straight + (1 - 2 * from - shift) * bent);
        // a few roundings of the sum, whose parts are of different sign
        const double rounding = 1e-15 * (std::abs(shift) + std::abs(bent));
        EXPECT_NEAR(detail::along_bulge<double>(from, way, straight, bent), shift, rounding) << from << bent;
      }
}

/// Beyond where a folded side turns back there is no place: what is found is that on the straight facet.
TEST(AlongBulge, IsFiniteWhereTheSideDoesNotReach) { EXPECT_EQ(detail::along_bulge<double>(0, 3, 2, 4), 1.5); }

}  // namespace
}  // namespace stickslip::segment_facets_test
