/// What a facet or a node faces of a wall: only what opposes its side, by a weight that begins at nothing, and nothing
/// through the body.
#include <gtest/gtest.h>

#include <cmath>

#include "core/contact/segments.hpp"
#include "core/contact/surface_search.hpp"

namespace stickslip::walls_test {
namespace {

/// Cosine with which a wall of this angle, in degrees, opposes what is above a floor.
double cosine(double degrees) { return std::cos(degrees * std::acos(-1.0) / 180); }

/// A slave facet of length 1 from (0, 1), and below its middle a wall that is turned from the floor, 8 long.
Points<double> facet_over_a_wall(double degrees) {
  const double c = cosine(degrees), s = std::sqrt(1 - c * c);
  Points<double> points(2, 4);
  points.col(0) << 0, 1;
  points.col(1) << 1, 1;
  points.col(2) << 0.5 + 4 * c, -1 - 4 * s;
  points.col(3) << 0.5 - 4 * c, -1 + 4 * s;
  return points;
}

/// Share of the facet's area that counts.
double counted(double degrees) {
  const auto points = facet_over_a_wall(degrees);
  double sum = 0;
  for (const int carrier : {0, 1}) {
    auto segments = facing_segments(points, {0, 1}, {{2, 3}});
    for (Segment& segment : segments) segment.carrier = carrier;
    const auto position = [&](int node) -> Placed<double> { return {points.col(node), {0, 0}}; };
    sum += integrate_segments<double, double>(
               segments, nodes_of_segments(carrier, segments, segments, 4), position, Depth<double>{},
               [](const auto&...) { return detail::Foot<double>{}; }, [](auto&&...) {})
               .area;
  }
  return sum;
}

TEST(Walls, GiveSegmentsToFacetsThatTheyOppose) {
  for (const double degrees : {0.0, 30.0, 70.0, 75.0})
    EXPECT_EQ(facing_segments(facet_over_a_wall(degrees), {0, 1}, {{2, 3}}).size(), 1u) << degrees;
  for (const double degrees : {76.0, 80.0, 89.0})
    EXPECT_TRUE(facing_segments(facet_over_a_wall(degrees), {0, 1}, {{2, 3}}).empty()) << degrees;
}

TEST(Walls, CountByTheirAngle) {
  for (const double degrees : {0.0, 30.0, 59.0}) EXPECT_NEAR(counted(degrees), 1, 1e-14) << degrees;
  for (const double degrees : {62.0, 66.0, 70.0, 75.0}) {
    const double s = cosine(degrees) / least_against_a_side - 1;
    EXPECT_NEAR(counted(degrees), s * s * (3 - 2 * s), 1e-14) << degrees;
  }
}

/// The corner of a block, its sole below and a wall on its right; both end. Above the end of the wall no place of them
/// is nearest, and the sole alone opposes what looks up: through the block.
TEST(Walls, AreNotPassedThroughToTheSoleBehind) {
  Places<2> places(2, 3);
  places.col(0) << 0, 0;
  places.col(1) << 1, 0;
  places.col(2) << 1, 1;
  const auto patches = make_surface<2>({{0, 1}, {1, 2}}, Smoothing::none, 30, places);
  const SurfaceSearch<2> search(patches, places);
  const Vec<double, 2> up(0, 1);
  EXPECT_EQ(search.facing({{1.1, 1.5}, up}).patch, no_patch);
  EXPECT_EQ(search.facing({{0.5, -0.1}, up}).patch, 0);  // from below
  EXPECT_EQ(search.facing({{0.5, 0.1}, up}).patch, 0);   // a little inside
}

}  // namespace
}  // namespace stickslip::walls_test
