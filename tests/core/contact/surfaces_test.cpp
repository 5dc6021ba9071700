/// Gap, normal, frame and weights against each master surface, and their derivatives.
#include "core/contact/surfaces.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "core/contact/rigid_surfaces.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::surfaces_test {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
/// A handful of operations on numbers of the size of one.
constexpr double rounding = 20 * epsilon;

using Point = Vec<double, 2>;
const Numbers<double> no_slots;

void expect_frame(const PointGeometry<double>& g) {
  const auto D = g.normal.size();
  EXPECT_NEAR(g.normal.norm(), 1, rounding);
  const Matrix<double> e = g.tangents;
  ASSERT_EQ(e.rows(), D);
  ASSERT_EQ(e.cols(), D - 1);
  const Matrix<double> products = e.transpose() * e;
  EXPECT_LE(largest_entry(products - Matrix<double>::Identity(D - 1, D - 1)), rounding);
  EXPECT_LE(largest_entry(e.transpose() * g.normal), rounding);
}

void expect_vector(const PointGeometry<double>& g, double x, double y) {
  EXPECT_NEAR(g.normal[0], x, rounding);
  EXPECT_NEAR(g.normal[1], y, rounding);
  EXPECT_NEAR(g.tangents(0, 0), -y, rounding);  // e = (-n_y, n_x)
  EXPECT_NEAR(g.tangents(1, 0), x, rounding);
}

TEST(AgainstPlane, MeasuresAlongANormalOfAnyLength) {
  for (double length : {1e-6, 1.0, 1e6}) {
    const Plane plane{{1.0, 2.0}, {0.6 * length, 0.8 * length}};
    const auto g = against_rigid<double>(Point(1 + 0.6 * 3 - 0.8 * 5, 2 + 0.8 * 3 + 0.6 * 5), plane, no_slots);
    EXPECT_NEAR(g.gap, 3, rounding * 8);
    expect_vector(g, 0.6, 0.8);
    ASSERT_EQ(g.weights.size(), 1);
    EXPECT_EQ(g.weights[0], 1);
  }
  EXPECT_LT(against_rigid<double>(Point(0, -0.1), Plane{{5.0, 0.0}, {0.0, 1.0}}, no_slots).gap, 0);  // penetration
}

TEST(AgainstPlane, HasARightHandedFrameForEveryNormalInSpace) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Vec<double, 3> n = derivatives::arbitrary(3, seed);
    if (seed < 3) n = Vec<double, 3>::Unit(seed);
    if (seed == 3) n = Vec<double, 3>::Ones();
    const Plane plane{{0.1, 0.2, 0.3}, {n[0], n[1], n[2]}};
    const auto g = against_rigid<double>(Vec<double, 3>(1, -2, 0.5), plane, no_slots);
    expect_frame(g);
    const Vec<double, 3> e1 = g.tangents.col(0), e2 = g.tangents.col(1), normal = g.normal;
    EXPECT_NEAR(e1.cross(e2).dot(normal), 1, rounding);
    EXPECT_NEAR(g.gap, (Vec<double, 3>(0.9, -2.2, 0.2)).dot(n) / n.norm(), rounding * 3);
  }
}

TEST(AgainstCircle, MeasuresFromTheRimOutsideAndInside) {
  const Circle disk{{1.0, 2.0}, 5.0, false}, cup{{1.0, 2.0}, 5.0, true};
  const Point above(1 + 6 * 0.6, 2 + 6 * 0.8), below(1 + 4 * 0.6, 2 + 4 * 0.8);
  const auto outside = against_rigid<double>(above, disk, no_slots),
             inside = against_rigid<double>(below, cup, no_slots);
  EXPECT_NEAR(outside.gap, 1, rounding * 6);
  expect_vector(outside, 0.6, 0.8);
  EXPECT_NEAR(inside.gap, 1, rounding * 6);
  expect_vector(inside, -0.6, -0.8);  // out of the cup's wall, to the centre
  EXPECT_LT(against_rigid<double>(below, disk, no_slots).gap, 0);
  EXPECT_LT(against_rigid<double>(above, cup, no_slots).gap, 0);
}

TEST(AgainstFacet, HasTheSolidOnTheLeftAndInterpolatesTheFoot) {
  const Point a(3, 0), b(1, 0);  // leftwards: the solid is below
  const auto g = against_facet<double>(Point(1.5, 0.25), a, b);
  EXPECT_NEAR(g.gap, 0.25, rounding);
  expect_vector(g, 0, 1);
  ASSERT_EQ(g.weights.size(), 3);
  EXPECT_EQ(g.weights[0], 1);
  EXPECT_NEAR(g.weights[1], -0.25, rounding);
  EXPECT_NEAR(g.weights[2], -0.75, rounding);
  EXPECT_LT(against_facet<double>(Point(1.5, -0.25), a, b).gap, 0);
}

TEST(AgainstFacet, HasWeightsThatReproduceTheGapVector) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Vector<double> x = derivatives::arbitrary(6, seed);
    const Point s = x.segment<2>(0), a = x.segment<2>(2), b = x.segment<2>(4);
    const auto g = against_facet<double>(s, a, b);
    expect_frame(g);
    // sum of weight and position is the gap vector; a long way from a short facet the foot is far outside it
    const double reach = 1 + std::abs(g.weights[1]) + std::abs(g.weights[2]);
    EXPECT_LE((s + g.weights[1] * a + g.weights[2] * b - g.gap * Point(g.normal)).norm(), rounding * reach);
    EXPECT_NEAR(g.weights.sum(), 0, rounding * reach);  // moved along with the master: no relative displacement
  }
}

TEST(AgainstVertex, HasTheBisectorWhateverTheLengthsOfItsFacets) {
  const Point v(1, 1);
  for (double left : {0.01, 1.0, 30.0}) {
    // A square's corner.
    const auto g = against_vertex<double>(Point(1.5, 1.5), Point(1, 1 - 2), v, Point(1 - left, 1));
    expect_vector(g, std::sqrt(0.5), std::sqrt(0.5));
    EXPECT_NEAR(g.gap, std::sqrt(0.5), rounding);
    EXPECT_EQ(g.weights, (Vec<double, 2>(1, -1)));
  }
}

TEST(AgainstVertex, AgreesWithTheFacetOfAStraightLine) {
  const Point before(2, 1), v(1, 0.5), after(-1, -0.5), x(0.9, 0.7);
  const auto vertex = against_vertex<double>(x, before, v, after), facet = against_facet<double>(x, before, v);
  EXPECT_NEAR(vertex.gap, facet.gap, rounding);
  expect_vector(vertex, facet.normal[0], facet.normal[1]);
}

TEST(AgainstVertex, TakesTheFacetThatIsThereAtAnEnd) {
  const Point v(1, 0), other(0, 0), x(1, 0.5);
  expect_vector(against_vertex<double>(x, v, v, other), 0, 1);
  expect_vector(against_vertex<double>(x, Point(2, 0), v, v), 0, 1);
}

TEST(SharedNormal, IsTheBisectorForASlaveNormalOfAnyLength) {
  const double turn = 0.4;
  for (double length : {1e-3, 1.0, 1e3}) {
    auto g = against_facet<double>(Point(0, 0.5), Point(1, 0), Point(-1, 0));
    share_normal<2, double>(g,
                            length * Point(std::sin(turn), -std::cos(turn)));  // reversed: turned from (0, 1) by `turn`
    expect_vector(g, -std::sin(turn / 2), std::cos(turn / 2));
    EXPECT_NEAR(g.weights.sum(), 0, rounding);
  }
}

TEST(SharedNormal, ChangesNothingBetweenParallelSurfaces) {
  const auto before = against_facet<double>(Point(0.2, 0.5), Point(1, 0), Point(-1, 0.3));
  auto g = before;
  share_normal<2, double>(g, -3 * Point(before.normal));
  expect_vector(g, before.normal[0], before.normal[1]);
}

TEST(SharedNormal, TreatsBothBodiesAlike) {
  const Point up(0.1, 0.995), down(-0.3, -0.954);
  PointGeometry<double> one = against_facet<double>(Point(0, 0), Point(up[1], -up[0]), Point(-up[1], up[0]));
  PointGeometry<double> other = against_facet<double>(Point(0, 0), Point(down[1], -down[0]), Point(-down[1], down[0]));
  share_normal<2, double>(one, down);
  share_normal<2, double>(other, up);
  expect_vector(one, -other.normal[0], -other.normal[1]);
}

/// All numbers of a geometry in one vector.
template <class T>
Vector<T> flat(const PointGeometry<T>& g) {
  const Eigen::Index D = g.normal.size();
  Vector<T> out(1 + D + D * (D - 1) + g.weights.size());
  Eigen::Index k = 0;
  out[k++] = g.gap;
  for (Eigen::Index i = 0; i < D; ++i) out[k++] = g.normal[i];
  for (Eigen::Index a = 0; a < D - 1; ++a)
    for (Eigen::Index i = 0; i < D; ++i) out[k++] = g.tangents(i, a);
  for (Eigen::Index i = 0; i < g.weights.size(); ++i) out[k++] = g.weights[i];
  return out;
}

template <class T>
Vec<T, 2> two(const Vector<T>& x, int first) {
  return x.template segment<2>(first);
}

/// Dual against complex step, at several inputs of the given size.
template <class F>
void expect_derivatives(F&& f, int inputs, const std::string& what) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    const Vector<double> x = derivatives::arbitrary(inputs, seed);
    const auto dual = derivatives::by_dual(f, x), exact = derivatives::by_complex_step(f, x);
    EXPECT_GT(largest_entry(exact), 0) << what;
    // some fifty operations, each rounding once; relative to the largest entry
    EXPECT_LE(derivatives::relative_difference(dual, exact), 100 * epsilon) << what << " " << seed;
  }
}

TEST(Derivatives, OfEverySurfaceAreThoseOfTheComplexStep) {
  expect_derivatives(
      [](const auto& x) {  // slave, point, normal
        using T = typename std::decay_t<decltype(x)>::Scalar;
        const Plane plane{{{0, 0}, {0, 1}}, {{0, 2}, {0, 3}}};
        const Numbers<T> numbers{{x[2], x[3], x[4], x[5]}};
        return flat(against_rigid<T>(two(x, 0), plane, numbers));
      },
      6, "plane");
  expect_derivatives(
      [](const auto& x) {
        using T = typename std::decay_t<decltype(x)>::Scalar;
        const Plane plane{{{0, 0}, {0, 1}, {0, 2}}, {{0, 3}, {0, 4}, {0, 5}}};
        const Numbers<T> numbers{{x[3], x[4], x[5], x[6], x[7], x[8]}};
        return flat(against_rigid<T>(Vec<T, 3>(x[0], x[1], x[2]), plane, numbers));
      },
      9, "plane in space");
  for (bool inside : {false, true})
    expect_derivatives(
        [inside](const auto& x) {  // slave, centre, radius
          using T = typename std::decay_t<decltype(x)>::Scalar;
          const Circle circle{{Number{0, 0}, Number{0, 1}}, {0, 2}, inside};
          return flat(against_rigid<T>(two(x, 0), circle, Numbers<T>{{x[2], x[3], x[4]}}));
        },
        5, inside ? "cup" : "circle");
  expect_derivatives(
      [](const auto& x) {
        using T = typename std::decay_t<decltype(x)>::Scalar;
        return flat(against_facet<T>(two(x, 0), two(x, 2), two(x, 4)));
      },
      6, "facet");
  expect_derivatives(
      [](const auto& x) {
        using T = typename std::decay_t<decltype(x)>::Scalar;
        return flat(against_vertex<T>(two(x, 0), two(x, 2), two(x, 4), two(x, 6)));
      },
      8, "vertex");
  expect_derivatives(
      [](const auto& x) {
        using T = typename std::decay_t<decltype(x)>::Scalar;
        auto g = against_facet<T>(two(x, 0), two(x, 2), two(x, 4));
        share_normal<2, T>(g, two(x, 6));
        return flat(g);
      },
      8, "shared normal");
}

}  // namespace
}  // namespace stickslip::surfaces_test
