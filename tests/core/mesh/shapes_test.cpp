/// Shape functions of the elements of space: partition of unity, one node at a time, gradients; and their faces, on
/// distorted elements: node order, direction, areas.
#include "core/mesh/shapes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <limits>
#include <map>

#include "core/solids/edges.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::shapes_test {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

template <class S>
class Shapes : public testing::Test {
 protected:
  static auto at(const Vec<double, 3>& x) { return S::at(x[0], x[1], x[2], 1); }
  /// Places inside of the element.
  static std::vector<Vec<double, 3>> places() {
    std::vector<Vec<double, 3>> all;
    for (int k = 0; k < 5; ++k) {
      const Vec<double, 3> x(std::sin(k + 0.2), std::cos(2.0 * k), std::sin(3.0 * k + 1));
      all.push_back(S::is_simplex ? Vec<double, 3>((x.array() + 1) / 8) : x);
    }
    return all;
  }
  static ElementShape kind() {
    return S::nodes == 4    ? ElementShape::tet4
           : S::nodes == 8  ? ElementShape::hex8
           : S::nodes == 10 ? ElementShape::tet10
           : S::nodes == 20 ? ElementShape::hex20
                            : ElementShape::hex27;
  }
  /// The places of the nodes, moved off: no edge is straight, no face flat.
  static Nodal<double, S> distorted(double by = 0.05) {
    Nodal<double, S> X;
    for (int a = 0; a < S::nodes; ++a)
      X.col(a) = natural_node<S>(a) + by * Vec<double, 3>(std::sin(1.3 * a), std::cos(2.1 * a), std::sin(3.7 * a + 1));
    return X;
  }
};
using All = testing::Types<Tet4, Hex8, Tet10, Hex20, Hex27>;
TYPED_TEST_SUITE(Shapes, All);

TYPED_TEST(Shapes, AreOneAtTheirNodeAndZeroAtTheOthers) {
  for (int a = 0; a < TypeParam::nodes; ++a) {
    const auto N = this->at(natural_node<TypeParam>(a)).value;
    for (int b = 0; b < TypeParam::nodes; ++b) EXPECT_EQ(N[b], a == b ? 1 : 0) << a << " " << b;
  }
}

TYPED_TEST(Shapes, SumUpToOneAndHaveTheGradientsOfTheirDifferences) {
  for (const auto& x : this->places()) {
    const auto point = this->at(x);
    EXPECT_NEAR(point.value.sum(), 1, 20 * epsilon);  // of up to 27 terms below one
    EXPECT_LE(largest_entry(point.gradient.rowwise().sum()), 100 * epsilon);
    for (int i = 0; i < 3; ++i) {
      constexpr double h = 0.5;  // parabolas along each coordinate: differences are exact
      Vec<double, 3> step = Vec<double, 3>::Zero();
      step[i] = h;
      const auto slope = ((this->at(x + step).value - this->at(x - step).value) / (2 * h)).eval();
      for (int a = 0; a < TypeParam::nodes; ++a) EXPECT_NEAR(point.gradient(i, a), slope[a], 100 * epsilon);
    }
  }
}

TYPED_TEST(Shapes, HaveARuleOfTheirVolume) {
  double volume = 0;
  for (const auto& point : TypeParam::quadrature()) volume += point.weight;
  EXPECT_NEAR(volume, TypeParam::is_simplex ? 1.0 / 6 : 8, 100 * epsilon);
}

TYPED_TEST(Shapes, HaveTheNodesBetweenTheirCorners) {
  const auto& around = corners_around(this->kind());
  ASSERT_EQ(static_cast<int>(around.size()), TypeParam::nodes);
  for (int a = 0; a < TypeParam::nodes; ++a) {
    Vec<double, 3> mean = Vec<double, 3>::Zero();
    for (const int corner : around[a]) mean += natural_node<TypeParam>(corner) / static_cast<double>(around[a].size());
    EXPECT_EQ(mean, natural_node<TypeParam>(a)) << a;
  }
}

TYPED_TEST(Shapes, HaveFacesWithTheNodesInTheOrderOfTheirFunctions) {
  const auto X = this->distorted();
  for (const auto& side : sides_of(this->kind()))
    for (const auto& point : detail::face_quadrature(static_cast<int>(side.size()))) {
      Vec<double, 3> natural = Vec<double, 3>::Zero(), place = natural;
      for (std::size_t a = 0; a < side.size(); ++a) {
        natural += point.value[a] * natural_node<TypeParam>(side[a]);
        place += point.value[a] * X.col(side[a]);
      }
      EXPECT_LE((X * this->at(natural).value - place).norm(), 50 * epsilon);  // sums of up to 27 terms below two
    }
}

TYPED_TEST(Shapes, HaveFacesThatLookOutwardAndCloseOverTheirVolume) {
  const auto X = this->distorted();
  const Points<double> points = X;
  const Vec<double, 3> middle = X.rowwise().mean();
  Vec<double, 3> sum = Vec<double, 3>::Zero();
  double enclosed = 0;
  for (const auto& side : sides_of(this->kind())) {
    Vec<double, 3> whole = Vec<double, 3>::Zero(), of_facets = whole;
    for_each_side_point(points, side, Depth<double>{}, [&](const auto& values, const auto& outward, double area) {
      Vec<double, 3> place = -middle;
      for (std::size_t a = 0; a < side.size(); ++a) place += values[a] * points.col(side[a]);
      EXPECT_GT(place.dot(outward), 0);
      EXPECT_NEAR(outward.norm(), area, 10 * epsilon);
      enclosed += place.dot(outward) / 3;
      whole += outward;
    });
    sum += whole;
    for (const auto& facet : facets_of_side(side, 3))
      for_each_side_point(points, facet, Depth<double>{}, [&](const auto&, const auto& outward, double) {
        EXPECT_GT(outward.dot(whole), 0);
        of_facets += outward;
      });
    EXPECT_GT(of_facets.dot(whole), 0.9 * whole.squaredNorm());
  }
  EXPECT_LE(sum.norm(), 100 * epsilon);
  // four points are exact for a tetrahedron with flat sides; of a curved one its Jacobian is cubic
  double volume = 0;
  for (const auto& point : TypeParam::quadrature())
    volume += (X * point.gradient.transpose()).determinant() * point.weight;
  EXPECT_NEAR(enclosed, volume, TypeParam::nodes == 10 ? 0.01 * volume : 100 * epsilon);
}

/// Shares of a corner, a middle and a node within, of the facets of a flat face.
TEST(Faces, HaveFacetsThatGiveEachNodeAPositiveArea) {
  const auto shares_of = [](ElementShape shape, const Points<double>& X, bool cut) {
    const auto& side = sides_of(shape)[0];
    std::map<int, double> shares;
    const auto facets = cut ? facets_of_side(side, 3) : std::vector<std::vector<int>>{side};
    for (const auto& facet : facets) {
      const auto of_facet = side_shares(X, facet, Depth<double>{});
      for (std::size_t a = 0; a < facet.size(); ++a) shares[facet[a]] += of_facet[static_cast<Eigen::Index>(a)];
    }
    std::vector<double> in_order;
    for (const int node : side) in_order.push_back(shares.at(node));
    return in_order;
  };
  struct Case {
    ElementShape shape;
    double corner, middle, within, consistent_corner, consistent_middle, consistent_within;  // over the area
  };
  for (const Case& expected : {Case{ElementShape::tet10, 1.0 / 12, 1.0 / 4, 0, 0, 1.0 / 3, 0},
                               Case{ElementShape::hex20, 1.0 / 24, 5.0 / 24, 0, -1.0 / 12, 1.0 / 3, 0},
                               Case{ElementShape::hex27, 1.0 / 16, 1.0 / 8, 1.0 / 4, 1.0 / 36, 1.0 / 9, 4.0 / 9}}) {
    Points<double> X(3, nodes_of(expected.shape));
    with_shape(expected.shape, [&]<class Shape>(Shape) {
      if constexpr (Shape::dimension == 3)
        for (int a = 0; a < Shape::nodes; ++a) X.col(a) = natural_node<Shape>(a);
    });
    const double area = expected.shape == ElementShape::tet10 ? 0.5 : 4;
    const auto corners = static_cast<std::size_t>(corners_of_face(sides_of(expected.shape)[0].size()));
    const auto facets = shares_of(expected.shape, X, true), whole = shares_of(expected.shape, X, false);
    for (std::size_t a = 0; a < facets.size(); ++a) {
      const bool corner = a < corners, middle = a < 2 * corners;
      EXPECT_NEAR(facets[a] / area,
                  corner   ? expected.corner
                  : middle ? expected.middle
                           : expected.within,
                  10 * epsilon);
      EXPECT_NEAR(whole[a] / area,
                  corner   ? expected.consistent_corner
                  : middle ? expected.consistent_middle
                           : expected.consistent_within,
                  10 * epsilon);
    }
  }
}

}  // namespace
}  // namespace stickslip::shapes_test
