/// Closest places of surfaces in space: against a comparison of many places, at edges, corners and borders, and the
/// derivatives of a foot against the complex step.
#include "core/contact/face_search.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <limits>
#include <random>

#include "core/contact/surfaces.hpp"

namespace stickslip::face_search_test {
namespace {

using Faces = std::vector<std::vector<int>>;
using Corners = std::array<Vec<double, 3>, 4>;
const Vec<double, 3> none(0, 0, 0);  ///< a slave without a side

struct Surface {
  Points<double> points;
  Faces faces;
};

/// n x n quadrilaterals over [0, 1]^2 on a wavy height, or twice as many triangles; nodes jittered.
Surface hills(int n, bool triangles, std::mt19937& random, double jitter = 0.2) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Surface s;
  s.points.setZero(3, (n + 1) * (n + 1));
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const bool is_border = i == 0 || j == 0 || i == n || j == n;
      const double x = (i + (is_border ? 0 : jitter * uniform(random))) / n,
                   y = (j + (is_border ? 0 : jitter * uniform(random))) / n;
      s.points.col(i * (n + 1) + j) << x, y, 0.1 * std::sin(5 * x) * std::cos(4 * y);
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j, b = a + n + 1, c = b + 1, d = a + 1;
      if (triangles) {
        s.faces.push_back({a, b, c});
        s.faces.push_back({a, c, d});
      } else {
        s.faces.push_back({a, b, c, d});
      }
    }
  std::shuffle(s.faces.begin(), s.faces.end(), random);
  return s;
}

Corners corners_of(const Surface& s, const std::array<int, 4>& nodes, int corners) {
  Corners corner;
  for (int k = 0; k < 4; ++k) corner[k] = s.points.col(nodes[std::min(k, corners - 1)]);
  return corner;
}

Vec<double, 3> position(const Surface& s, const FacePlace& place) {
  const auto weights = face_weights<double>(place.corners, place.at[0], place.at[1]);
  return face_position(corners_of(s, place.nodes, place.corners), weights).y;
}

/// Least distance to a grid of places, no farther from the surface than h of a face.
double sampled_distance(const Surface& s, const Vec<double, 3>& x, int grid) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& face : s.faces) {
    FacePlace place;
    place.corners = static_cast<int>(face.size());
    std::copy(face.begin(), face.end(), place.nodes.begin());
    for (int i = 0; i <= grid; ++i)
      for (int j = 0; j <= (place.corners == 3 ? grid - i : grid); ++j) {
        place.at = {double(i) / grid, double(j) / grid};
        const double distance = (x - position(s, place)).norm();
        if (!(distance >= least)) least = distance;
      }
  }
  return least;
}

TEST(FaceSearch, FindsTheClosestPlace) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  constexpr int cells = 5, grid = 30;
  for (const bool triangles : {false, true}) {
    const Surface s = hills(cells, triangles, random);
    const FaceSearch search(s.points, s.faces);
    for (int k = 0; k < 60; ++k) {
      const Vec<double, 3> x(0.1 + 0.8 * uniform(random), 0.1 + 0.8 * uniform(random), 0.6 * uniform(random) - 0.3);
      const auto found = search.closest(x, none);
      ASSERT_FALSE(found.empty());
      const double distance = (x - position(s, found[0])).norm(), sampled = sampled_distance(s, x, grid);
      EXPECT_LE(distance, sampled * (1 + 1e-12));
      // a sample is at most half of a cell of the grid away from the closest place, each way
      const double away = 1.5 / cells / grid;
      EXPECT_GE(distance, std::sqrt(std::max(0.0, sampled * sampled - away * away)) - away * away);
      for (const auto& place : found) EXPECT_NEAR((position(s, place) - position(s, found[0])).norm(), 0, 1e-9);
    }
  }
}

TEST(FaceSearch, FindsTheFacesAroundANodeAndAnEdge) {
  std::mt19937 random(1);
  const Surface flat = [&] {
    Surface s = hills(4, false, random, 0);
    s.points.row(2).setZero();
    return s;
  }();
  const FaceSearch search(flat.points, flat.faces);
  EXPECT_EQ(search.closest({0.25, 0.5, 0.1}, none).size(), 4U);
  EXPECT_EQ(search.closest({0.25, 0.4, -0.1}, none).size(), 2U);
  EXPECT_EQ(search.closest({0.3, 0.4, -0.1}, none).size(), 1U);
  EXPECT_EQ(search.closest({0, 0, 0.1}, none).size(), 1U);       // at a corner of the border
  EXPECT_EQ(search.closest({0, -1e-8, 0.1}, none).size(), 1U);   // the rounding of a mesh file
  EXPECT_TRUE(search.closest({0.1, -1e-3, 0.1}, none).empty());  // past the border
  EXPECT_TRUE(search.closest({-1e-3, -1e-3, 0.1}, none).empty());
}

/// A bilinear face has two stationary places; the other one, (1.969, 2.119), lies outside (MOOSE, issue 33438).
TEST(FaceSearch, FindsThePlaceInsideOfABilinearFace) {
  const Corners corner{Vec<double, 3>{0, 0, 0}, {1, 0, 0}, {0.6, 0.6, 0}, {0, 1, 0}};
  FacePlace face;
  face.corners = 4;
  const auto found = nearest_of_face(face, corner, {0.3, 0.45, 0});
  EXPECT_EQ(found.place.part, FacePart::inside);
  EXPECT_NEAR(found.place.at[0], 0.3809, 1e-4);  // four digits are known
  EXPECT_NEAR(found.place.at[1], 0.5309, 1e-4);
  EXPECT_NEAR(found.distance, 0, 1e-15);
}

/// Geometry of a point against faces in a scalar, from 3 coordinates of the point and 3 of each corner.
template <class T>
PointGeometry<T> geometry(const std::vector<T>& coordinates, const std::vector<FacePlace>& faces, int nodes) {
  const auto place = [&](int n) {
    return Vec<T, 3>(coordinates[3 * n], coordinates[3 * n + 1], coordinates[3 * n + 2]);
  };
  std::vector<int> all(nodes);
  for (int n = 0; n < nodes; ++n) all[n] = n;
  return against_faces<T>(place(0), faces, all, place);
}

/// Derivatives of gap, normal and weights by all coordinates, against the complex step, which passes through the same
/// Newton steps, and against a difference of the search itself, which does not.
TEST(FaceSearch, ItsFootHasTheDerivativesOfTheSearch) {
  constexpr int nodes = 5;
  const std::vector<double> at{0.6, 0.35, 0.25, 0, 0, 0, 1, 0.1, 0.05, 1.1, 0.9, -0.1, -0.1, 1, 0.15};
  Surface s;
  s.points.setZero(3, nodes);
  for (int k = 0; k < 3 * nodes; ++k) s.points(k % 3, k / 3) = at[k];
  const std::vector<std::pair<Vec<double, 3>, FacePart>> cases{
      {{0.6, 0.35, 0.25}, FacePart::inside}, {{0.4, -0.3, 0.2}, FacePart::edge}, {{1.4, 1.3, 0.2}, FacePart::corner}};
  for (const int corners : {3, 4})
    for (const auto& [x, part] : cases) {
      FacePlace face;
      face.corners = corners;
      face.nodes = {1, 2, 3, 4};
      const auto found = [&](const std::vector<double>& moved) {
        Surface there;
        there.points = Eigen::Map<const Points<double>>(moved.data(), 3, nodes);
        return nearest_of_face(face, corners_of(there, face.nodes, corners), there.points.col(0));
      };
      std::vector<double> here = at;
      std::copy(x.begin(), x.end(), here.begin());
      const auto place = found(here).place;
      ASSERT_EQ(place.part, part);
      using C = std::complex<double>;
      for (int k = 0; k < 3 * nodes; ++k) {
        std::vector<C> complex(here.begin(), here.end());
        std::vector<Dual<1>> dual(here.begin(), here.end());
        complex[k] += C(0, 1e-30);
        dual[k].d[0] = 1;
        const auto by_complex = geometry<C>(complex, {place}, nodes);
        const auto by_dual = geometry<Dual<1>>(dual, {place}, nodes);
        EXPECT_NEAR(by_dual.gap.d[0], by_complex.gap.imag() / 1e-30, 1e-13);  // some roundings of numbers near 1
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(by_dual.normal[i].d[0], by_complex.normal[i].imag() / 1e-30, 1e-13);
        const auto beside = [&](double h) {
          auto moved = here;
          moved[k] += h;
          const auto there = found(moved).place;
          return geometry<double>(moved, {there}, nodes);
        };
        constexpr double h = 1e-5;  // the difference errs by h^2 and by 1e-16 / h
        const auto more = beside(h), less = beside(-h);
        EXPECT_NEAR(by_dual.gap.d[0], (more.gap - less.gap) / (2 * h), 1e-8);
        for (int n = 0; n < nodes; ++n)
          EXPECT_NEAR(by_dual.weights[n].d[0], (more.weights[n] - less.weights[n]) / (2 * h), 1e-8);
      }
    }
}

/// Over a node of a regular surface the weights change as central differences do: the mean of the sides.
TEST(FaceSearch, AtANodeDerivativesAreTheMeanOfTheSides) {
  std::mt19937 random(1);
  Surface s = hills(4, false, random, 0);
  s.points.row(2).setZero();
  const Vec<double, 3> x(0.5, 0.5, 0.1);
  const auto faces = FaceSearch(s.points, s.faces).closest(x, none);
  std::vector<int> nodes{-1};
  for (const auto& face : faces)
    for (int n : face.nodes)
      if (std::find(nodes.begin(), nodes.end(), n) == nodes.end()) nodes.push_back(n);
  ASSERT_EQ(nodes.size(), 10U);
  Vec<Dual<1>, 3> moved{Dual<1>(x[0]), Dual<1>(x[1]), Dual<1>(x[2])};
  moved[0].d[0] = 1;
  const auto g = against_faces<Dual<1>>(moved, faces, nodes, [&](int n) -> Vec<Dual<1>, 3> {
    return {Dual<1>(s.points(0, n)), Dual<1>(s.points(1, n)), Dual<1>(s.points(2, n))};
  });
  for (std::size_t n = 1; n < nodes.size(); ++n) {
    const Vec<double, 3> off = Vec<double, 3>(s.points.col(nodes[n])) - x;
    const bool is_here = off.head<2>().norm() < 1e-9, is_beside = std::abs(off[1]) < 1e-9 && !is_here;
    EXPECT_NEAR(g.weights[n].v, is_here ? -1 : 0, 1e-12);
    EXPECT_NEAR(g.weights[n].d[0], is_beside ? -2 * (off[0] > 0 ? 1 : -1) : 0, 1e-12);  // 1 / (2 h), h = 1/4
  }
  EXPECT_NEAR(g.gap.v, 0.1, 1e-15);
}

}  // namespace
}  // namespace stickslip::face_search_test
