/// Gaps and slips of motions that are far below the rounding of coordinates: they keep the digits of the motion, and do
/// not depend on how far from the origin all is.
#include <gtest/gtest.h>

#include <cmath>

#include "core/contact/foot_in_plane.hpp"
#include "core/contact/rigid_surfaces.hpp"
#include "core/contact/segments.hpp"

namespace stickslip::small_motions_test {
namespace {

using Place = Vec<double, 2>;

const Numbers<double> no_slots;
/// Coordinates below are multiples of 1/8, which these distances leave as they are.
constexpr double distances[] = {0, 0x1p10, 0x1p20, 0x1p40};
/// What comes of a motion over its size differs between two sizes by the larger one, some times over, and by rounding.
constexpr double large = 1e-8, small = 1e-14, same = 1e2 * large;

Place far(double distance, double x, double y) { return {distance + x, distance + y}; }

TEST(SmallMotions, OnAnInclinedPlaneHaveTheirGap) {
  for (const double L : distances) {
    const Plane plane{{L + 1, L - 2}, {0.6, 0.8}};
    const Place X = far(L, 1 + 4, -2 - 3), w(3e-15, 1e-15);
    const auto start = against_rigid<double>(X, plane, no_slots), now = against<double>(X, w, plane, no_slots);
    EXPECT_NEAR(now.gap - start.gap, 2.6e-15, 4 * unit_roundoff * (2.6e-15 + std::abs(start.gap))) << L;
  }
}

TEST(SmallMotions, OnACircleHaveTheGapOfTheirSecondOrderToo) {
  for (const double L : distances)
    for (const bool inside : {false, true})
      for (const double size : {1e-3, 1e-7, 1e-14}) {
        const Circle circle{{L, L}, 5.0, inside};
        const Place X = far(L, 3, 4), w = size * Place(0.5, 2);
        const long double a = 3 + static_cast<long double>(w[0]), b = 4 + static_cast<long double>(w[1]);
        const long double grows = (6 * static_cast<long double>(w[0]) + 8 * static_cast<long double>(w[1]) +
                                   static_cast<long double>(w[0]) * w[0] + static_cast<long double>(w[1]) * w[1]) /
                                  (std::sqrt(a * a + b * b) + 5);
        const double exact = static_cast<double>(inside ? -grows : grows);
        EXPECT_NEAR(against<double>(X, w, circle, no_slots).gap, exact, 16 * unit_roundoff * std::abs(exact)) << L;
      }
}

/// Vertices on a line, as a slab's top that is moved by `size` times something.
struct Line {
  double distance, size;
  Surface<2> patches;
  Line(double L, double moved, Smoothing smoothing) : distance(L), size(moved) {
    Eigen::Matrix2Xd places(2, 5);
    std::vector<std::vector<int>> facets;
    for (int v = 0; v < 5; ++v) places.col(v) = start(v);
    for (int v = 0; v < 4; ++v) facets.push_back({v, v + 1});
    patches = make_surface<2>(facets, smoothing, 60, places);
  }
  /// The line falls by 3/4, so that its facets are no numbers that coordinates have.
  Place start(int vertex) const { return far(distance, -4.0 * vertex, 3.0 * vertex); }
  Placed<double> vertex(int v) const { return {start(v), size * Place(0.3 * v, 0.1 * v * v - 0.7)}; }
  auto where() const {
    return [this](int v) { return vertex(v); };
  }
};

struct Measured {
  double gap, slip, slip_over_vertex;
};

/// Of a node that begins on the patch 1, near its end.
Measured measured(double distance, double size, Smoothing smoothing) {
  const Line line(distance, size, smoothing);
  const Patch<2>&patch = line.patches[1], &next = line.patches[2];
  const Placed<double> x{far(distance, -8, 6), size * Place(0.4, 0.9)}, y{x.start, size * Place(-0.6, 0.8)};
  const Vec<double, 2> start(0, 0), end(1, 0);
  const auto foot = foot_on_patch<double, double>(patch, {end}, end, x, line.where());
  const auto last = foot_on_patch<double, double>(patch, {end}, end, y, line.where());
  const auto beyond = foot_on_patch<double, double>(next, {start}, start, y, line.where());
  const auto along = [&](const Vec<double, 2>& motion) { return motion.dot(Place(-0.8, 0.6)) / size; };
  return {foot.gap / size, along(foot_motion<double, double>(last.place, foot, line.where())),
          along(foot_motion<double, double>(foot.place, beyond, line.where()))};
}

TEST(SmallMotions, AlongCurvesHaveTheirGapAndSlip) {
  for (const auto smoothing : {Smoothing::none, Smoothing::catmull_rom, Smoothing::b_spline}) {
    SCOPED_TRACE(static_cast<int>(smoothing));
    const auto expected = measured(0, large, smoothing);
    EXPECT_GT(std::abs(expected.slip), 0.1);
    for (const double L : distances) {
      const auto found = measured(L, small, smoothing);
      EXPECT_NEAR(found.gap, expected.gap, same) << L;
      EXPECT_NEAR(found.slip, expected.slip, same) << L;
      EXPECT_NEAR(found.slip_over_vertex, expected.slip_over_vertex, same) << L;
    }
  }
}

TEST(SmallMotions, BetweenPatchesThatDoNotMeetAreTheVectorBetweenTheirPlaces) {
  for (const auto smoothing : {Smoothing::none, Smoothing::catmull_rom, Smoothing::b_spline}) {
    const Line line(8, 0.05, smoothing);
    const Placed<double> x{far(8, -14, 10), Place(0.1, 0.2)};
    const auto foot = foot_on_patch<double, double>(line.patches[3], {{0.25, 0}}, {0.5, 0}, x, line.where());
    const auto plain = [&](int v) -> Place { return line.vertex(v).start + line.vertex(v).moved; };
    for (const int last : {0, 1, 2, 3}) {
      const auto start = SurfacePlace<double, 2>::behind(line.patches[last], {{0.75, 0}}, Vec<double, 1>(-0.5));
      const Place motion = foot_motion<double, double>(start, foot, line.where());
      const Place from = curve_position<double>(line.patches[last], 0.25, plain),
                  to = curve_position<double>(line.patches[3], foot.place.coordinate(), plain);
      EXPECT_LE((motion - (to - from)).norm(), 1e-13) << last;  // coordinates of 20
    }
  }
}

/// Two slave facets over three of a master, both on the same line.
SegmentKinematics<double> on_segments(double distance, double size) {
  const double slave[] = {0, 5, 10}, master[] = {12, 7, 3, -2};  // along the line, in units of (4, 3)/8
  const auto place = [&](double s) { return far(distance, 0.5 * s, 0.375 * s); };
  const auto position = [&](int node) -> Placed<double> {
    if (node < 3) return {place(slave[node]), size * Place(0.4 - 0.1 * node, 0.9 + 0.2 * node * node)};
    return {place(master[node - 3]), size * Place(0.1 * node, -0.3 * node)};
  };
  Points<double> now(2, 7);
  for (int n = 0; n < 7; ++n) now.col(n) = (position(n).start - place(0)) + position(n).moved;
  std::vector<Segment> segments;
  for (int f = 0; f < 2; ++f)
    for (Segment segment : facing_segments(now, {f, f + 1}, {{3, 4}, {4, 5}, {5, 6}})) {
      segment.carrier = f == 0 ? 1 : 0;
      segments.push_back(segment);
    }
  const double begin[] = {0, 3.125, 5.625};  // lengths of 5/8 times 5 and 4
  const auto nodes = nodes_of_segments(1, segments, segments, 7);
  return segment_kinematics<double, double>(
      segments, nodes, position, Depth<double>{}, [](auto&&...) { return detail::Foot<double>{}; },
      [&](int facet) { return begin[facet] - 4.375; }, false);
}

TEST(SmallMotions, OverSegmentsHaveTheirGapAndSlip) {
  const auto expected = on_segments(0, large);
  ASSERT_GT(std::abs(expected.foot[0] / large), 0.1);
  for (const double L : distances) {
    // (the initial geometry rounds, the same for all motions)
    const auto start = on_segments(L, 0), found = on_segments(L, small);
    EXPECT_NEAR((found.geometry.gap - start.geometry.gap) / small, expected.geometry.gap / large, same) << L;
    EXPECT_NEAR((found.foot[0] - start.foot[0]) / small, expected.foot[0] / large, same) << L;
  }
}

}  // namespace
}  // namespace stickslip::small_motions_test
