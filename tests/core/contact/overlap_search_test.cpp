/// Overlaps of facets in space: they cover what faces the master once, the nearest of what lies behind one another, and
/// no sliver where two sides end together.
#include "core/contact/overlap_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>

#include "core/contact/overlaps.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::overlap_search_test {
namespace {

/// Grids of facets over rectangles at heights f(x, y), whose nodes stand one behind the other.
struct Grids {
  Points<double> points = Points<double>(3, 0);

  /// `up`: the normals point along z, else against it; `jitter`: of inner nodes, as a share of a cell.
  template <class F>
  std::vector<SideFacet> add(const std::array<double, 4>& from_to, int n, int m, bool triangles, bool up, F&& f,
                             double jitter = 0) {
    std::mt19937 random(n * 100 + m);
    std::uniform_real_distribution<double> uniform(-jitter, jitter);
    const auto [x0, x1, y0, y1] = from_to;
    const int first = static_cast<int>(points.cols());
    points.conservativeResize(3, first + (n + 1) * (m + 1));
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= m; ++j) {
        const bool is_inner = i > 0 && j > 0 && i < n && j < m;
        const double x = x0 + (x1 - x0) * (i + (is_inner ? uniform(random) : 0)) / n,
                     y = y0 + (y1 - y0) * (j + (is_inner ? uniform(random) : 0)) / m;
        points.col(first + i * (m + 1) + j) << x, y, f(x, y);
      }
    std::vector<SideFacet> facets;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < m; ++j) {
        const int a = first + i * (m + 1) + j, b = a + m + 1, c = b + 1, d = a + 1;
        if (triangles) {
          facets.push_back({{a, up ? b : c, up ? c : b, 0}, 3});
          facets.push_back({{a, up ? c : d, up ? d : c, 0}, 3});
        } else {
          facets.push_back({{a, up ? b : d, c, up ? d : b}, 4});
        }
      }
    return facets;
  }
};

/// Area of overlaps, of which each is weighed by 1.
double area_of(const std::vector<Overlap>& overlaps, const Points<double>& points) {
  auto all = overlaps;
  for (auto& overlap : all) overlap.psi = {1, 1, 1, 1};
  int slave_nodes = 0;
  if (all.empty()) return 0;
  const auto nodes = nodes_of_overlaps(all[0].slave.nodes[0], all, static_cast<int>(points.cols()), slave_nodes);
  const auto place = [&](int node) -> Vec<double, 3> { return points.col(node); };
  return integrate_overlaps<double>(all, nodes, place, [](const auto&) { return PointGeometry<double>{}; }).area;
}

double area_of(const OverlapSearch& search, const std::vector<SideFacet>& slave, const Points<double>& points) {
  double area = 0;
  for (const auto& facet : slave) area += area_of(search.facing(facet), points);
  return area;
}

double flat(double, double) { return 0; }

TEST(Overlaps, CoverWhatFacesTheMasterOnce) {
  for (const bool slave_of_triangles : {false, true})
    for (const bool master_of_triangles : {false, true})
      for (const double distance : {0.0, 0.3, -0.1}) {
        Grids grids;
        const auto slave = grids.add(
            {0.1, 1.2, 0.3, 0.9}, 5, 4, slave_of_triangles, false, [&](double, double) { return distance; }, 0.2);
        const auto master = grids.add({-0.4, 1.7, -0.2, 1.1}, 7, 6, master_of_triangles, true, flat, 0.2);
        const OverlapSearch search(grids.points, master);
        EXPECT_NEAR(area_of(search, slave, grids.points), 1.1 * 0.6, 1e-13) << distance;
        // (a master that covers the part x < 0.7 of it)
        grids.points = Points<double>(3, 0);
        const auto all = grids.add({0.1, 1.2, 0.3, 0.9}, 5, 4, slave_of_triangles, false, flat, 0.2);
        const auto part = grids.add({-0.4, 0.7, -0.2, 1.1}, 7, 6, master_of_triangles, true, flat, 0.2);
        EXPECT_NEAR(area_of(OverlapSearch(grids.points, part), all, grids.points), 0.6 * 0.6, 1e-13) << distance;
      }
}

TEST(Overlaps, CoverCurvedSidesFromTheirFacets) {
  Grids grids;
  const auto bowl = [](double x, double y) { return 0.2 * (x - 0.5) * (x - 0.5) + 0.1 * y * y; };
  const auto slave = grids.add({0.1, 1.2, 0.3, 0.9}, 5, 4, true, false, bowl, 0.2);
  const auto master = grids.add({-0.4, 1.7, -0.2, 1.1}, 7, 6, true, true, bowl, 0.2);
  double whole = 0;
  for (const auto& facet : slave)
    whole += area_vector<double>(3, [&](int k) -> Vec<double, 3> { return grids.points.col(facet.nodes[k]); }).norm();
  // Seen along the normal of each facet, those of the master overlap or leave gaps at their edges by the angle between
  // them times their distance, some hundredths of a percent here; never twice the same.
  const double area = area_of(OverlapSearch(grids.points, master), slave, grids.points);
  EXPECT_NEAR(area, whole, 1e-3 * whole);
  EXPECT_LE(area, whole * (1 + 1e-12));
}

/// A table with a shelf above a part of it, both looking up: the shelf hides what is below.
TEST(Overlaps, AreWithTheNearestOfWhatLiesBehindOneAnother) {
  for (const bool triangles : {false, true}) {
    Grids grids;
    const auto slave = grids.add({0, 1, 0, 1}, 3, 2, triangles, false, [](double, double) { return 0.5; });
    auto master = grids.add({-1, 2, -1, 2}, 4, 5, triangles, true, flat);
    const int below = static_cast<int>(grids.points.cols());
    const auto shelf = grids.add({0.25, 0.65, 0.15, 3}, 2, 2, triangles, true, [](double, double) { return 0.4; });
    master.insert(master.end(), shelf.begin(), shelf.end());
    const OverlapSearch search(grids.points, master);
    double above = 0, under = 0;
    for (const auto& facet : slave)
      for (const auto& overlap : search.facing(facet))
        (overlap.master.nodes[0] >= below ? above : under) += area_of({overlap}, grids.points);
    EXPECT_NEAR(above, 0.4 * 0.85, 1e-14);
    EXPECT_NEAR(under, 1 - 0.4 * 0.85, 1e-14);
  }
}

/// A lid over a plate with two faces: seen from above the plate, what is below it is inside of nothing.
TEST(Overlaps, AreNoneWithTheFarSideOfASolid) {
  for (const double height : {1.2, 0.5}) {  // of a facet that looks up, above and inside of the plate
    Grids grids;
    const auto slave = grids.add({0, 1, 0, 1}, 2, 2, false, true, [&](double, double) { return height; });
    auto master = grids.add({-1, 0.6, -1, 2}, 3, 4, false, true, [](double, double) { return 1.0; });
    const auto below = grids.add({-1, 2, -1, 2}, 2, 5, true, false, flat);
    master.insert(master.end(), below.begin(), below.end());
    // above the plate nothing is inside where the plate has its top, for x < 0.6
    EXPECT_NEAR(area_of(OverlapSearch(grids.points, master), slave, grids.points), height > 1 ? 0.4 : 1.0, 1e-14);
  }
}

TEST(Overlaps, AreNoneWithWhatLooksTheSameWay) {
  Grids grids;
  const auto slave = grids.add({0, 1, 0, 1}, 2, 2, false, false, flat);
  const auto master = grids.add({0, 1, 0, 1}, 2, 2, false, false, flat);
  EXPECT_EQ(area_of(OverlapSearch(grids.points, master), slave, grids.points), 0);
}

/// Sides that end together, but for the rounding of coordinates in a file: each facet has one overlap, its own corners.
TEST(Overlaps, HaveNoSliversWhereSidesEndTogether) {
  for (const double size : {1e-6, 1.0, 1e6})
    for (const double off : {0.0, 3e-7, -3e-7}) {
      Grids grids;
      const auto slave = grids.add({0, 2 * size, 0, size}, 4, 2, false, false, flat);
      const auto master = grids.add({off * size / 4, 2 * size, 0, size * (1 + off / 4)}, 4, 2, false, true, flat);
      const OverlapSearch search(grids.points, master);
      for (const auto& facet : slave) {
        const auto overlaps = search.facing(facet);
        ASSERT_EQ(overlaps.size(), 1U) << size << " " << off;
        EXPECT_EQ(overlaps[0].vertices.size(), 4U);
        for (const auto& vertex : overlaps[0].vertices) {
          EXPECT_TRUE(vertex.is_node());
          EXPECT_EQ(std::count(facet.nodes.begin(), facet.nodes.end(), vertex.first[0]), 1);
        }
      }
    }
}

/// Far from the origin, along any axes and in any unit, the shares of an overlap are the same.
TEST(Overlaps, HaveTheSameSharesWhereverTheyAre) {
  Grids grids;
  const auto slave = grids.add({0.1, 1.2, 0.3, 0.9}, 3, 2, false, false, [](double x, double) { return 0.1 * x; });
  const auto master = grids.add({-0.4, 1.7, -0.2, 1.1}, 4, 3, true, true, flat, 0.2);
  const auto shares = [&](const Points<double>& points) {
    std::vector<double> all;
    for (const auto& facet : slave) {
      auto overlaps = OverlapSearch(points, master).facing(facet);
      for (auto& overlap : overlaps) overlap.psi = {1, 0, 0, 0};
      int slave_nodes = 0;
      const auto nodes = nodes_of_overlaps(facet.nodes[0], overlaps, static_cast<int>(points.cols()), slave_nodes);
      const auto place = [&](int node) -> Vec<double, 3> { return points.col(node); };
      const auto sums =
          integrate_overlaps<double>(overlaps, nodes, place, [](const auto&) { return PointGeometry<double>{}; });
      for (const double w : sums.weights) all.push_back(w / sums.area);
    }
    return all;
  };
  const auto here = shares(grids.points);
  Points<double> there = 1e3 * grids.points;
  there.row(0).swap(there.row(2));
  there.row(1).swap(there.row(2));
  there.colwise() += Vec<double, 3>(1e6, -2e6, 3e6);
  const auto moved = shares(there);
  ASSERT_EQ(moved.size(), here.size());
  for (std::size_t k = 0; k < here.size(); ++k)
    EXPECT_NEAR(moved[k], here[k], 1e-11);  // coordinates of 3e6 round by 4e-10, of facets of 300
}

/// Facets that are tilted to one another, so that integrands jump from one to the next: as nodes move, crossings do,
/// and the integrals with them.
TEST(Overlaps, MoveWithTheNodes) {
  using Complex = std::complex<double>;
  Grids grids;
  const auto slave = grids.add({0.1, 1.2, 0.3, 0.9}, 2, 2, false, false, flat, 0.2);
  const auto master = grids.add(
      {-0.4, 1.7, -0.2, 1.1}, 4, 3, true, true, [](double x, double y) { return 0.3 * x * y; }, 0.2);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Points<double> way = Points<double>::NullaryExpr(3, grids.points.cols(), [&] { return uniform(random); });
  constexpr double h = 1e-30, step = 1e-6;
  for (const auto& facet : slave) {
    auto overlaps = OverlapSearch(grids.points, master).facing(facet);
    for (auto& overlap : overlaps) overlap.psi = {1, 0, 0, 0};
    int slave_nodes = 0;
    const auto nodes = nodes_of_overlaps(facet.nodes[0], overlaps, static_cast<int>(grids.points.cols()), slave_nodes);
    const auto integrals = [&]<class T>(const T& by) {
      const auto place = [&](int node) -> Vec<T, 3> {
        return grids.points.col(node).cast<T>() + by * way.col(node).cast<T>();
      };
      const auto sums = integrate_overlaps<T>(overlaps, nodes, place, [](const auto&) { return PointGeometry<T>{}; });
      Vector<T> all(7 + sums.weights.size());
      all << sums.area, sums.gap, sums.normal, sums.weights;
      return all;
    };
    const Eigen::VectorXd exact = integrals(Complex(0, h)).imag() / h;
    const Eigen::VectorXd difference = (integrals(step) - integrals(-step)) / (2 * step);
    EXPECT_LE(largest_entry(exact - difference), 1e-8 * largest_entry(exact));  // rounding / step
  }
}

/// Shape functions of quadratic sides: 1 at their nodes, of sum 1, with slopes that are those of their values.
TEST(Overlaps, WeighSidesOfQuadraticElementsByTheirShapeFunctions) {
  for (const int nodes : {3, 4, 6, 8, 9}) {
    const int corners = corners_of_face(nodes);
    for (int a = 0; a < nodes; ++a) {
      const auto at = side_node(corners, a);
      const auto weights = side_weights<double>(nodes, at[0], at[1]);
      for (int b = 0; b < nodes; ++b) EXPECT_NEAR(weights.value[b], a == b, 1e-15) << nodes;
    }
    const double s = 0.31, t = 0.23, h = 1e-6;
    const auto weights = side_weights<double>(nodes, s, t);
    const auto to = side_weights<double>(nodes, s + h, t), back = side_weights<double>(nodes, s - h, t);
    const auto up = side_weights<double>(nodes, s, t + h), down = side_weights<double>(nodes, s, t - h);
    double sum = 0;
    for (int a = 0; a < nodes; ++a) {
      sum += weights.value[a];
      EXPECT_NEAR(weights.along_s[a], (to.value[a] - back.value[a]) / (2 * h), 1e-9) << nodes;  // rounding / h
      EXPECT_NEAR(weights.along_t[a], (up.value[a] - down.value[a]) / (2 * h), 1e-9) << nodes;
    }
    EXPECT_NEAR(sum, 1, 1e-15);
  }
}

}  // namespace
}  // namespace stickslip::overlap_search_test
