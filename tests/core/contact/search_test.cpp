/// The closest point of a faceted curve: facets, vertices, free ends, and that no numbering decides.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "tests/support/closest.hpp"

namespace stickslip::search_test {
namespace {

using Facets = std::vector<std::vector<int>>;

/// Columns from (x, y) pairs.
Points<double> points_of(const std::vector<std::array<double, 2>>& xy) {
  Points<double> points(2, xy.size());
  for (std::size_t i = 0; i < xy.size(); ++i) points.col(i) << xy[i][0], xy[i][1];
  return points;
}

/// A roof, then a valley: nodes 0 to 4 from right to left, the solid below.
Points<double> roof_and_valley() { return points_of({{4, 0}, {3, 1}, {2, 0}, {1, 1}, {0, 0}}); }
const Facets in_order = {{0, 1}, {1, 2}, {2, 3}, {3, 4}};

/// Nodes of the facet, or the vertex of two facets: what is found, apart from the facets' numbers.
std::vector<int> found(const Points<double>& points, const Facets& facets, double x, double y) {
  const auto closest = closest_of_all(points, facets, {x, y});
  if (!closest) return {};
  if (closest->second < 0) return facets[closest->facet];
  EXPECT_EQ(facets[closest->facet][1], facets[closest->second][0]);
  return {facets[closest->facet][1]};
}

TEST(ClosestPoint, IsTheFacetThatThePointFaces) {
  const auto points = roof_and_valley();
  EXPECT_EQ(found(points, in_order, 4.0, 1.0), (std::vector{0, 1}));  // above
  EXPECT_EQ(found(points, in_order, 3.4, 0.5), (std::vector{0, 1}));  // below: it penetrates
  EXPECT_EQ(found(points, in_order, 1.4, 0.8), (std::vector{2, 3}));
}

TEST(ClosestPoint, IsTheVertexBetweenTwoFacetsWhereBothLookPast) {
  const auto points = roof_and_valley();
  EXPECT_EQ(found(points, in_order, 3.0, 2.0), (std::vector{1}));
  EXPECT_EQ(found(points, in_order, 3.2, 1.5), (std::vector{1}));
  EXPECT_EQ(found(points, in_order, 3.0, 1.0), (std::vector{1}));  // on it
  EXPECT_EQ(found(points, in_order, 2.0, 0.0), (std::vector{2}));  // on the valley's floor
}

TEST(ClosestPoint, NamesTheFacetThatEndsAtAVertexFirst) {
  const auto closest = closest_of_all(roof_and_valley(), {{1, 2}, {0, 1}}, {3.0, 2.0});
  ASSERT_TRUE(closest.has_value());
  EXPECT_EQ(closest->facet, 1);
  EXPECT_EQ(closest->second, 0);
}

TEST(ClosestPoint, TakesARoundingBesideAVertexForTheVertex) {
  const auto points = points_of({{2, 0}, {1, 0}, {0, 0}});
  const Facets facets = {{0, 1}, {1, 2}};
  for (double shift : {-1e-12, 0.0, 1e-12}) EXPECT_EQ(found(points, facets, 1 + shift, 0.5), (std::vector{1}));
  EXPECT_EQ(found(points, facets, 1 + 1e-6, 0.5), (std::vector{0, 1}));
  EXPECT_EQ(found(points, facets, 1 - 1e-6, 0.5), (std::vector{1, 2}));
}

TEST(ClosestPoint, IsNoneBeyondAFreeEndAndTheLastFacetOnIt) {
  const auto points = points_of({{2, 0}, {1, 0}, {0, 0}});
  const Facets facets = {{0, 1}, {1, 2}};
  EXPECT_TRUE(found(points, facets, 2.01, 0.3).empty());
  EXPECT_TRUE(found(points, facets, -0.01, 0.3).empty());
  EXPECT_EQ(found(points, facets, 2.0, 0.3), (std::vector{0, 1}));
  EXPECT_EQ(found(points, facets, 0.0, 0.3), (std::vector{1, 2}));
  EXPECT_EQ(found(points, facets, 2 + 1e-12, 0.3), (std::vector{0, 1}));  // rounding of a coordinate
  EXPECT_FALSE(closest_of_all(points, {}, {1, 1}).has_value());
}

TEST(ClosestPoint, HasNoFreeEndOnAClosedCurve) {
  const auto points = points_of({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  const Facets facets = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  EXPECT_EQ(found(points, facets, -0.3, -0.2), (std::vector{0}));
  EXPECT_EQ(found(points, facets, 1.3, 1.2), (std::vector{2}));
}

/// Calls check(facets) for every order of the facets.
template <class Check>
void for_every_order(const Facets& facets, Check&& check) {
  std::vector<int> order(facets.size());
  std::iota(order.begin(), order.end(), 0);
  do {
    Facets shuffled;
    for (int f : order) shuffled.push_back(facets[f]);
    check(shuffled);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(ClosestPoint, DoesNotDependOnTheOrderOfTheFacets) {
  const auto points = roof_and_valley();
  for (double x = -0.5; x < 4.5; x += 0.13)  // steps that meet no line of symmetry
    for (double y = -0.5; y < 2; y += 0.17) {
      const auto expected = found(points, in_order, x, y);
      for_every_order(in_order,
                      [&](const Facets& facets) { EXPECT_EQ(found(points, facets, x, y), expected) << x << " " << y; });
    }
}

TEST(ClosestPoint, DoesNotDependOnTheOrderOfTheFacetsInTheMiddleOfAValley) {
  // as far from both slopes: geometry alone must choose, whichever facet comes first
  const auto points = roof_and_valley();
  std::set<std::vector<int>> answers;
  for_every_order(in_order, [&](const Facets& facets) { answers.insert(found(points, facets, 2.0, 0.5)); });
  EXPECT_EQ(answers.size(), 1u);
}

TEST(ClosestPoint, IsTheSameInUnitsOfAnySize) {
  const auto points = roof_and_valley();
  for (double unit : {1e-9, 1e9})
    for (double x = -0.5; x < 4.5; x += 0.13)
      EXPECT_EQ(found(unit * points, in_order, unit * x, unit * 0.7), found(points, in_order, x, 0.7)) << x;
}

}  // namespace
}  // namespace stickslip::search_test
