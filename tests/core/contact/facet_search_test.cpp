/// Search among the facets of a side by boxes: the answers of a comparison with all of them, and how many it compares.
#include "core/contact/facet_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "core/contact/segments.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::facet_search_test {
namespace {

using Facets = std::vector<std::vector<int>>;

/// A master and a slave side that share their points; slave facets in order.
struct Sides {
  Points<double> points;
  Facets master, slave;
};

/// A loop with bumps, solid inside, its facets in no order, within a larger ring of slave facets that look inwards.
Sides loop_in_ring(int masters, int slaves, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Sides s;
  s.points.setZero(2, masters + slaves);
  const double bumps = 1 + std::floor(3 * std::abs(uniform(random))), phase = uniform(random);
  for (int k = 0; k < masters; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.3 * uniform(random)) / masters;
    const double radius = 1 + 0.3 * std::sin(bumps * angle + phase) + 0.1 * uniform(random) / masters;
    s.points.col(k) << radius * std::cos(angle), radius * std::sin(angle);
    s.master.push_back({k, (k + 1) % masters});
  }
  for (int k = 0; k < slaves; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.1 * uniform(random)) / slaves;
    s.points.col(masters + k) << 1.35 * std::cos(angle), 1.35 * std::sin(angle);
    s.slave.push_back({masters + (k + 1) % slaves, masters + k});
  }
  std::shuffle(s.master.begin(), s.master.end(), random);
  return s;
}

/// Waves of n facets under waves of 4 n / 3, both from x = 0 to 1.
Sides waves(int n) {
  const int slaves = 4 * n / 3;
  Sides s;
  s.points.setZero(2, n + slaves + 2);
  const auto wave = [](double x) { return 0.1 * std::sin(20 * x); };
  for (int k = 0; k <= n; ++k) s.points.col(k) << double(k) / n, wave(double(k) / n);
  for (int k = 0; k <= slaves; ++k) s.points.col(n + 1 + k) << double(k) / slaves, wave(double(k) / slaves) + 0.01;
  for (int k = 0; k < n; ++k) s.master.push_back({k + 1, k});
  for (int k = 0; k < slaves; ++k) s.slave.push_back({n + 1 + k, n + 2 + k});
  return s;
}

double least_distance(const Sides& s, const Vec<double, 2>& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& facet : s.master) {
    const Vec<double, 2> c = s.points.col(facet[0]), tau = s.points.col(facet[1]) - s.points.col(facet[0]);
    const double eta = (x - c).dot(tau) / tau.squaredNorm();
    const double distance = (x - c - std::clamp(eta, 0.0, 1.0) * tau).norm();
    least = -larger(-least, -distance);
  }
  return least;
}

TEST(FacetSearch, FindsWhatAComparisonWithAllFacetsFinds) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-2, 2);
  std::size_t segments = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Sides s = loop_in_ring(3 + trial, 5 + trial / 2, random);
    const FacetSearch search(s.points, s.master);
    const std::vector<int> ends = {s.master[0][0]};
    for (const auto& facet : s.slave) {
      const std::array<int, 2> slave{facet[0], facet[1]};
      const auto found = search.facing(slave, ends);
      EXPECT_EQ(found, facing_segments(s.points, slave, s.master, ends)) << trial;
      segments += found.size();
    }
    for (int k = 0; k < 20; ++k) {
      const Vec<double, 2> x(uniform(random), uniform(random));
      EXPECT_EQ(search.nearest(x).distance, least_distance(s, x)) << trial;
    }
  }
  EXPECT_GT(segments, 5000u);
}

TEST(FacetSearch, ComparesPairsInProportionToTheFacets) {
  for (const int n : {30, 300, 3000}) {
    const Sides s = waves(n);
    const FacetSearch search(s.points, s.master);
    std::size_t pairs = 0;
    for (const auto& facet : s.slave) pairs += search.candidates({facet[0], facet[1]}).size();
    EXPECT_GE(pairs, s.slave.size()) << n;
    // The strip across a slave facet leans by 2 : 1 at most, so that it meets the waves three times at most, and each
    // time three facets.
    EXPECT_LE(pairs, 9 * s.slave.size()) << n;
  }
}

TEST(FacetSearch, FindsNothingWherePlacesAreNotFinite) {
  Sides s = waves(30);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  s.points.leftCols(31).setConstant(nan);
  const FacetSearch search(s.points, s.master);
  EXPECT_TRUE(search.facing({s.slave[0][0], s.slave[0][1]}).empty());
  EXPECT_EQ(search.nearest({0.5, 0.5}).distance, std::numeric_limits<double>::infinity());
  const Sides whole = waves(30);
  EXPECT_EQ(FacetSearch(whole.points, whole.master).nearest({nan, 0}).distance,
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(FacetSearch(whole.points, {}).nearest({0, 0}).distance, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace stickslip::facet_search_test
