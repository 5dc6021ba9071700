/// Master curves: smooth ones against what they interpolate, feet against their definition, search against trying all.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "core/contact/foot_in_plane.hpp"
#include "core/contact/surface_search.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::curve_test {
namespace {

using Place = Vec<double, 2>;

/// Facets around a circle, solid inside, counter-clockwise; open: without the last one.
struct Ring {
  explicit Ring(int count, bool closed = true) : places(2, count) {
    for (int v = 0; v < count; ++v) {
      const double angle = 2 * std::numbers::pi * v / count;
      places.col(v) = Place(std::cos(angle), std::sin(angle));
      if (closed || v + 1 < count) facets.push_back({v, (v + 1) % count});
    }
  }
  Surface<2> patches(Smoothing smoothing, double corner = 180) const {
    return make_surface<2>(facets, smoothing, corner, places);
  }
  Place at(const Patch<2>& patch, double xi) const { return curve_position<double>(patch, xi, where()); }
  std::function<Place(int)> where() const {
    return [this](int v) -> Place { return places.col(v); };
  }
  Eigen::Matrix2Xd places;
  std::vector<std::vector<int>> facets;
};

constexpr std::array<Smoothing, 3> kinds{Smoothing::none, Smoothing::catmull_rom, Smoothing::b_spline};

TEST(Curve, WeightsSumToOneAndTheirSlopesAreDerivatives) {
  constexpr double step = 1e-30;
  const Ring ring(7, false);
  for (const Smoothing kind : kinds)
    for (const Patch<2>& patch : ring.patches(kind))
      for (double xi : {0.0, 0.3, 1.0, 1.2}) {
        const auto w = detail::patch_weights<double>(patch, xi);
        const auto c = detail::patch_weights<std::complex<double>>(patch, {xi, step});
        double sum = 0;
        for (int i = 0; i < 4; ++i) {
          sum += w.value[i];
          EXPECT_NEAR(w.slope[i], c.value[i].imag() / step, 1e-14);
          EXPECT_NEAR(w.bend[i], c.slope[i].imag() / step, 1e-14);
        }
        EXPECT_NEAR(sum, 1, 1e-15);
      }
}

TEST(Curve, SmoothPatchesMeetWithTheirNormalsAndSplinesWithTheirCurvatures) {  // C14
  const Ring ring(9);
  for (const Smoothing kind : {Smoothing::catmull_rom, Smoothing::b_spline}) {
    const auto patches = ring.patches(kind);
    for (const Patch<2>& patch : patches) {
      const auto end = detail::patch_weights<double>(patch, 1.0);
      const auto start = detail::patch_weights<double>(patches[patch.across[1]], 0.0);
      const auto gap = [&](const auto& a, const auto& b) {
        return (detail::on_patch<double>(patch, a, ring.where()) -
                detail::on_patch<double>(patches[patch.across[1]], b, ring.where()))
            .norm();
      };
      EXPECT_LE(gap(end.value, start.value), 1e-15);
      EXPECT_LE(gap(end.slope, start.slope), 1e-15);
      if (kind == Smoothing::b_spline) {
        EXPECT_LE(gap(end.bend, start.bend), 1e-15);
      } else {
        EXPECT_GT(gap(end.bend, start.bend), 0.01);  // the slope goes on, and no more
        EXPECT_LE((ring.at(patch, 0) - ring.places.col(patch.corner(0))).norm(), 1e-15);
      }
    }
  }
}

TEST(Curve, ApproachesACircleByTheOrderOfItsKind) {
  // largest distance from the circle on 16 and on 32 facets: facets and B-splines are second order, Catmull-Rom fourth
  const auto farthest = [](int count, Smoothing kind) {
    const Ring ring(count);
    double most = 0;
    for (const Patch<2>& patch : ring.patches(kind))
      for (int k = 0; k <= 10; ++k) most = larger(most, std::abs(ring.at(patch, 0.1 * k).norm() - 1));
    return most;
  };
  for (const auto& [kind, order] :
       {std::pair{Smoothing::none, 2.0}, {Smoothing::catmull_rom, 4.0}, {Smoothing::b_spline, 2.0}})
    EXPECT_NEAR(std::log2(farthest(16, kind) / farthest(32, kind)), order, 0.1);
}

/// Vertices on the unit circle whose facets are long and short in turns, their angles in that ratio.
Ring uneven_ring(int pairs, double ratio) {
  Ring ring(2 * pairs);
  const double both = 2 * std::numbers::pi / pairs;
  for (int k = 0; k < pairs; ++k)
    for (int end : {0, 1}) {
      const double angle = both * (k + end * ratio / (1 + ratio));
      ring.places.col(2 * k + end) = Place(std::cos(angle), std::sin(angle));
    }
  return ring;
}

TEST(Curve, OfUnevenFacetsNeitherFoldsNorTurnsAtVertices) {
  for (const double ratio : {1.0, 1.5, 2.0, 3.0, 10.0, 100.0}) {
    const Ring ring = uneven_ring(24, ratio);
    const auto patches = ring.patches(Smoothing::catmull_rom);
    for (const Patch<2>& patch : patches) {
      const auto slope = [&](const Patch<2>& of, double xi) {
        return detail::on_patch<double>(of, detail::patch_weights<double>(of, xi).slope, ring.where());
      };
      const Place chord = ring.places.col(patch.corner(1)) - ring.places.col(patch.corner(0));
      // along the chord the ends have at most (1 + 1.62) / 2 of it, so the middle has 1.5 - 1.31 / 2; no end goes back
      for (int k = 0; k <= 20; ++k) EXPECT_GT(slope(patch, 0.05 * k).dot(chord), 0) << ratio;
      EXPECT_GT(slope(patch, 0.5).dot(chord), 0.75 * chord.squaredNorm()) << ratio;
      const Place before = slope(patch, 1).normalized(), after = slope(patches[patch.across[1]], 0).normalized();
      EXPECT_LE((before - after).norm(), 1e-14) << ratio;
      // at a vertex it is along the chord between the neighbours
      const auto& next = patches[patch.across[1]];
      const Place across = ring.places.col(next.corner(1)) - ring.places.col(patch.corner(0));
      EXPECT_LE((before - across.normalized()).norm(), 1e-14) << ratio;
    }
  }
}

TEST(Curve, OfAShortRampBetweenLongFlatsGoesUpSteadily) {
  Eigen::Matrix2Xd profile(2, 4);
  profile << 4, 1.7, 1.2, -3, 0.06, 0.06, 0, 0;  // from right to left, the solid below
  const auto where = [&](int v) -> Place { return profile.col(v); };
  for (const Patch<2>& patch : make_surface<2>({{0, 1}, {1, 2}, {2, 3}}, Smoothing::catmull_rom, 30, profile))
    for (int k = 0; k <= 50; ++k) {
      const Place at = curve_position<double>(patch, 0.02 * k, where);
      const auto w = detail::patch_weights<double>(patch, 0.02 * k);
      EXPECT_LT(detail::on_patch<double>(patch, w.slope, where)[0], 0);
      // flats are left by 4/27 of the slope's length, .56 at most, times its angle to them, .022 at most
      EXPECT_GT(at[1], -0.00183);
      EXPECT_LT(at[1], 0.06183);
    }
}

TEST(Curve, HasFeetAllAlongALongPatchBesideAShortOne) {  // its slope grows fast from the short one on
  for (const double ramp : {0.5, 0.05, 0.005}) {
    Eigen::Matrix2Xd profile(2, 4);
    profile << 4, 1.2 + ramp, 1.2, -3, 0.1 * ramp, 0.1 * ramp, 0, 0;
    const auto where = [&](int v) -> Place { return profile.col(v); };
    const auto patches = make_surface<2>({{0, 1}, {1, 2}, {2, 3}}, Smoothing::catmull_rom, 30, profile);
    const SurfaceSearch<2> search(patches, profile);
    for (int k = 1; k < 140; ++k)
      for (const double height : {-0.02 * ramp, 0.0, 0.5}) {
        const Place x(-3 + 0.05 * k, (-3 + 0.05 * k > 1.2 ? 0.1 * ramp : 0) + height);
        if (x[0] > 1.2 - ramp && x[0] < 1.2 + 2 * ramp) continue;
        const Facing facing = search.facing({x, Place::Zero()});
        ASSERT_NE(facing.patch, no_patch) << ramp << " " << x.transpose();
        const auto foot = foot_on_patch<double>(patches[facing.patch], facing.at, x, where);
        EXPECT_NEAR(foot.gap, height, 0.01 * ramp) << x.transpose();  // flats are left by 0.003 of the ramp
      }
  }
}

TEST(Curve, GoesStraightAtFreeEndsAndKeepsCorners) {
  Eigen::Matrix2Xd square(2, 8);
  square << 0, 1, 2, 2, 2, 1, 0, 0, 0, 0, 0, 1, 2, 2, 2, 1;
  std::vector<std::vector<int>> facets;
  for (int v = 0; v < 8; ++v) facets.push_back({v, (v + 1) % 8});
  const auto where = [&](int v) -> Place { return square.col(v); };
  for (const Smoothing kind : {Smoothing::catmull_rom, Smoothing::b_spline}) {
    for (const Patch<2>& patch : make_surface<2>(facets, kind, 60, square))  // straight sides stay as they are
      for (double xi : {0.0, 0.4, 1.0}) {
        const Place at = curve_position<double>(patch, xi, where);
        const Place a = square.col(patch.corner(0)), b = square.col(patch.corner(1));
        EXPECT_NEAR(std::abs((at - a)[0] * (b - a)[1] - (at - a)[1] * (b - a)[0]), 0, 1e-15);
      }
    bool round = false;
    for (const Patch<2>& patch : make_surface<2>(facets, kind, 120, square))
      round |= patch.goes_on(0) && patch.goes_on(1);
    EXPECT_TRUE(round);
  }
}

TEST(Curve, FeetAreAtRightAnglesAndDifferentiateThroughTheirDefinition) {
  constexpr double step = 1e-30;
  using C = std::complex<double>;
  const Ring ring(11);
  for (const Smoothing kind : kinds) {
    const auto patches = ring.patches(kind);
    const SurfaceSearch<2> search(patches, ring.places);
    for (double angle : {0.1, 1.3, 4.0})
      for (double radius : {0.97, 1.05}) {
        const Place x(radius * std::cos(angle), radius * std::sin(angle));
        const Facing facing = search.facing({x, Place::Zero()});
        ASSERT_NE(facing.patch, no_patch);
        const Patch<2>& patch = patches[facing.patch];
        const auto foot = foot_on_patch<double>(patch, facing.at, x, ring.where());
        EXPECT_NEAR((x - ring.at(patch, foot.place.coordinate()) - foot.gap * foot.normal).norm(), 0, 1e-14);
        EXPECT_NEAR(foot.gap, radius - 1, 0.1);
        // by x: dg = n . dx; complex step through two Newton steps against a difference of feet found anew
        for (int i : {0, 1}) {
          Vec<C, 2> moved(x[0], x[1]);
          moved[i] += C(0, step);
          const auto c = foot_on_patch<C>(patch, facing.at, moved,
                                          [&](int v) -> Vec<C, 2> { return ring.places.col(v).cast<C>(); });
          EXPECT_NEAR(c.gap.imag() / step, foot.normal[i], 1e-13);
          const auto xi_at = [&](double h) {
            Place y = x;
            y[i] += h;
            const Facing there = search.foot_on(facing.patch, {y, Place::Zero()});
            return foot_on_patch<double>(patch, there.at, y, ring.where()).place.coordinate();
          };
          const double difference = (xi_at(1e-5) - xi_at(-1e-5)) / 2e-5;  // errs by 1e-10 f''' and rounding
          EXPECT_NEAR(c.place.coordinate().imag() / step, difference, 1e-7);
        }
      }
  }
}

TEST(CurveSearch, FindsWhatTryingAllFinds) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in_box(-2, 2);
  for (const bool closed : {true, false}) {
    const Ring ring(37, closed);
    const auto patches = ring.patches(Smoothing::none);
    const SurfaceSearch<2> search(patches, ring.places);
    int found = 0;
    for (int n = 0; n < 2000; ++n) {
      const Place x(in_box(random), in_box(random));
      double least = 1e9;
      for (const auto& facet : ring.facets) {
        const Place a = ring.places.col(facet[0]), tau = ring.places.col(facet[1]) - a;
        const double xi = std::clamp((x - a).dot(tau) / tau.squaredNorm(), 0.0, 1.0);
        if (const double distance = (x - a - xi * tau).norm(); distance < least) least = distance;
      }
      const Facing facing = search.facing({x, Place::Zero()});
      if (facing.patch == no_patch) {
        EXPECT_NEAR(facing.distance, least, 1e-14);
        continue;
      }
      ++found;
      const Place at = ring.at(patches[facing.patch], std::clamp(facing.at[0], 0.0, 1.0));
      EXPECT_NEAR((x - at).norm(), least, 1e-14);
    }
    EXPECT_GT(found, closed ? 1999 : 1500);
  }
}

TEST(CurveSearch, HasAContinuousGapAroundCornersOfBothKinds) {  // C24
  // a step: convex at (1, 1), concave at (1, 0); solid on the left of right to left
  Eigen::Matrix2Xd places(2, 4);
  places << 3, 1, 1, -1, 0, 0, 1, 1;
  const auto patches = make_surface<2>({{0, 1}, {1, 2}, {2, 3}}, Smoothing::none, 60, places);
  const SurfaceSearch<2> search(patches, places);
  const auto where = [&](int v) -> Place { return places.col(v); };
  const auto gap_at = [&](const Place& x) {
    const Facing facing = search.facing({x, Place::Zero()});
    return foot_on_patch<double>(patches[facing.patch], facing.at, x, where).gap;
  };
  for (const Place& corner : {Place(1, 1), Place(1, 0)})
    for (double radius : {1e-3, 0.1, 0.3}) {
      double last = gap_at(corner + Place(radius, 0));
      constexpr int count = 3600;
      for (int n = 1; n <= count; ++n) {
        const double angle = 2 * std::numbers::pi * n / count;
        const double gap = gap_at(corner + radius * Place(std::cos(angle), std::sin(angle)));
        EXPECT_LE(std::abs(gap - last), 1.1 * radius * 2 * std::numbers::pi / count) << corner[1] << " " << angle;
        last = gap;
      }
    }
}

TEST(CurveSearch, IgnoresSidesThatLookTheSameWayAndWhatLiesPastAnEnd) {
  Eigen::Matrix2Xd strip(2, 4);  // two faces of a thin strip: the lower one looks down, the upper one up
  strip << 0, 1, 1, 0, 0, 0, 0.01, 0.01;
  const auto patches = make_surface<2>({{0, 1}, {2, 3}}, Smoothing::none, 60, strip);
  const SurfaceSearch<2> search(patches, strip);
  const Place just_in(0.5, 0.004);
  EXPECT_EQ(search.facing({just_in, Place(0, -1)}).patch, 1);  // of a side that looks down: the upper face
  EXPECT_EQ(search.facing({just_in, Place(0, 1)}).patch, 0);
  EXPECT_EQ(search.facing({just_in, Place::Zero()}).patch, 0);  // the nearer one
  EXPECT_EQ(search.facing({Place(1.1, 0.01), Place(0, -1)}).patch, no_patch);
  EXPECT_EQ(search.facing({Place(1 + 1e-7, 0.01), Place(0, -1)}).patch, 1);
}

TEST(CurveSearch, FacesNothingWhereATrialIsOutOfBounds) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), huge = 1e308;
  const Ring ring(12);
  for (const Smoothing kind : kinds) {
    const auto patches = ring.patches(kind);
    const SurfaceSearch<2> search(patches, ring.places);
    for (const Place& x : {Place(nan, 0), Place(0, -nan), Place(std::numeric_limits<double>::infinity(), 0)}) {
      const Facing facing = search.facing({x, Place::Zero()});
      EXPECT_EQ(facing.patch, no_patch);
      EXPECT_FALSE(std::isfinite(facing.distance));
    }
    for (const double bad : {nan, huge}) {
      Eigen::Matrix2Xd places = ring.places;
      places(0, 3) = bad;
      places(0, 7) = -bad;
      EXPECT_EQ(SurfaceSearch<2>(patches, places).facing({Place(1.1, 0), Place::Zero()}).patch, no_patch);
    }
    const Eigen::Matrix2Xd collapsed = Eigen::Matrix2Xd::Ones(2, 12);
    EXPECT_EQ(SurfaceSearch<2>(patches, collapsed).facing({Place(1.1, 0), Place::Zero()}).patch, no_patch);
  }
}

}  // namespace
}  // namespace stickslip::curve_test
