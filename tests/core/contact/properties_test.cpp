/// What holds for every contact point, on thousands of generated ones: the closest point of a curve, the gap and its
/// linearity, the projection on Coulomb's cone. A failure is shrunk and printed with the seed that repeats it
/// (RC_PARAMS="seed=..."; ctest fixes one, so that a run repeats).
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/contact/contact_point.hpp"
#include "core/contact/facet_search.hpp"
#include "core/contact/rigid_surfaces.hpp"
#include "core/contact/surfaces.hpp"
#include "tests/support/closest.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::properties_test {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
using Point = Vec<double, 2>;

// --- generators ----------------------------------------------------------------------------------------------------

/// Uniform in [low, high]; shrinks to low.
double real(double low, double high) {
  constexpr int steps = 1 << 30;
  return low + (high - low) * *rc::gen::inRange(0, steps + 1) / steps;
}

/// Uniform in its logarithm, over twelve orders of magnitude: any unit.
double size() { return std::pow(10.0, real(-6, 6)); }

template <int N>
Vec<double, N> vector(double largest) {
  Vec<double, N> v;
  for (double& x : v) x = real(-largest, largest);
  return v;
}

/// An open curve of facets with the solid on the left that bends by less than 60 degrees a vertex, in units of about 1.
struct Curve {
  Points<double> points;
  std::vector<std::vector<int>> facets;
  double length = 0;
};
Curve curve() {
  const int count = *rc::gen::inRange(1, 8);
  Curve c;
  c.points.setZero(2, count + 1);
  double heading = real(0, 2 * std::numbers::pi);
  for (int i = 0; i < count; ++i) {
    const double step = real(0.1, 2);
    c.points.col(i + 1) = c.points.col(i) + step * Point(std::cos(heading), std::sin(heading));
    c.facets.push_back({i, i + 1});
    c.length += step;
    heading += real(-1, 1);
  }
  return c;
}

/// A point near a curve, past one of its ends too.
Point near(const Curve& c) {
  const auto& facet = c.facets[*rc::gen::inRange<std::size_t>(0, c.facets.size())];
  const double s = real(-0.2, 1.2);
  return (1 - s) * c.points.col(facet[0]) + s * c.points.col(facet[1]) + vector<2>(0.5);
}

/// A point off a facet, to either side, by up to half the facet's length.
Point beside(const Curve& c) {
  const auto& facet = c.facets[*rc::gen::inRange<std::size_t>(0, c.facets.size())];
  const Point a = c.points.col(facet[0]), tau = Point(c.points.col(facet[1])) - a;
  return a + real(0.05, 0.95) * tau + real(-0.5, 0.5) * Point(tau[1], -tau[0]);
}

struct Motion {
  Eigen::Rotation2Dd turn{0};
  Point shift{0, 0};
  Point operator()(const Point& x) const { return turn * x + shift; }
};
Motion motion() { return {Eigen::Rotation2Dd(real(0, 2 * std::numbers::pi)), vector<2>(10)}; }

// --- closest point -------------------------------------------------------------------------------------------------

double distance(const Point& x, const Point& a, const Point& b) {
  const double s = std::clamp((x - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (x - a - s * (b - a)).norm();
}

/// Distance of x from the curve, and from the nearest of the facets that do not hold the closest point.
std::pair<double, double> two_distances(const Curve& c, const Point& x) {
  double first = std::numeric_limits<double>::infinity(), second = first;
  for (const auto& facet : c.facets) {
    const double d = distance(x, c.points.col(facet[0]), c.points.col(facet[1]));
    if (d < first - 1e-6) second = first;
    if (d > first + 1e-6) second = smaller(second, d);
    first = smaller(first, d);
  }
  return {first, second};
}

/// The place that closest_of_all() names.
Point foot(const Curve& c, const ClosestPoint& closest, const Point& x) {
  const Point a = c.points.col(c.facets[closest.facet][0]), b = c.points.col(c.facets[closest.facet][1]);
  if (closest.second >= 0) return b;  // where the first of the two ends
  const auto g = against_facet<double>(x, a, b);
  return -g.weights[1] * a - g.weights[2] * b;
}

// Coordinates are up to 16 facets of 2 from the start, and about 1e-9 of a facet counts as its end.
constexpr double close_by = 4e-9;

/// Places beside the curve, near it, far away and at its vertices, where facets tie.
Point anywhere(const Curve& c) {
  const int kind = *rc::gen::inRange(0, 4);
  if (kind == 0) return beside(c);
  if (kind == 1) return near(c);
  if (kind == 2) return vector<2>(100);
  return c.points.col(*rc::gen::inRange<Eigen::Index>(0, c.points.cols()));
}

TEST(ClosestPointProperties, TheTreeFindsWhatAComparisonWithAllFinds) {
  EXPECT_TRUE(rc::check([] {
    const auto c = curve();
    const FacetSearch search(c.points, c.facets);
    for (int i = 0; i < 8; ++i) {
      const Point x = anywhere(c);
      const auto all = closest_of_all(c.points, c.facets, x), found = search.closest(x);
      RC_ASSERT(found.has_value() == all.has_value());
      if (!all) continue;
      RC_ASSERT(found->facet == all->facet);
      RC_ASSERT(found->second == all->second);
    }
  }));
}

TEST(ClosestPointProperties, IsNoFartherThanAnySampledPointOfTheCurve) {
  EXPECT_TRUE(rc::check([] {
    const auto c = curve();
    const Point x = beside(c);
    const auto closest = closest_of_all(c.points, c.facets, x);
    RC_PRE(closest.has_value());
    const double found = (x - foot(c, *closest, x)).norm();
    for (const auto& facet : c.facets)
      for (int i = 0; i <= 50; ++i) {
        const double s = i / 50.0;
        const Point y = (1 - s) * c.points.col(facet[0]) + s * c.points.col(facet[1]);
        RC_ASSERT(found <= (x - y).norm() + close_by);
      }
  }));
}

TEST(ClosestPointProperties, IsOrthogonalInAFacetAndElseAnEnd) {
  EXPECT_TRUE(rc::check([] {
    const auto c = curve();
    const Point x = beside(c);
    const auto closest = closest_of_all(c.points, c.facets, x);
    RC_PRE(closest.has_value());
    const Point a = c.points.col(c.facets[closest->facet][0]), b = c.points.col(c.facets[closest->facet][1]);
    const Point y = foot(c, *closest, x);
    if (closest->second < 0) {
      RC_ASSERT(std::abs((x - y).dot(b - a)) <= 64 * epsilon * (b - a).norm() * (1 + c.length));
      RC_ASSERT((y - a).dot(b - a) >= -close_by * (b - a).squaredNorm());
      RC_ASSERT((y - b).dot(b - a) <= close_by * (b - a).squaredNorm());
    } else {
      RC_ASSERT(c.facets[closest->facet][1] == c.facets[closest->second][0]);
      const Point after = c.points.col(c.facets[closest->second][1]);
      RC_ASSERT((x - y).dot(b - a) >= -close_by);  // ahead of the one facet, behind the other
      RC_ASSERT((x - y).dot(after - b) <= close_by);
    }
  }));
}

TEST(ClosestPointProperties, IsMissingOnlyPastAFreeEnd) {
  EXPECT_TRUE(rc::check([] {
    const auto c = curve();
    const Point x = near(c);
    RC_PRE(!closest_of_all(c.points, c.facets, x).has_value());
    const Point first = c.points.col(0), last = c.points.rightCols(1);
    const double least = two_distances(c, x).first;
    RC_ASSERT(std::min((x - first).norm(), (x - last).norm()) <= least + close_by);
  }));
}

TEST(ClosestPointProperties, MovesWithTheCurveAndThePoint) {
  EXPECT_TRUE(rc::check([] {
    const auto c = curve();
    const Point x = beside(c);
    const auto closest = closest_of_all(c.points, c.facets, x);
    const auto [nearest, next] = two_distances(c, x);
    RC_PRE(closest.has_value() && closest->second < 0 && next - nearest > 1e-6);  // no tie that rounding may turn
    const auto facet = c.facets[closest->facet];
    const auto g = against_facet<double>(x, c.points.col(facet[0]), c.points.col(facet[1]));
    RC_PRE(-g.weights[2] > 1e-6 && -g.weights[1] > 1e-6);
    const auto move = motion();
    auto moved = c;
    for (int i = 0; i < c.points.cols(); ++i) moved.points.col(i) = move(c.points.col(i));
    const auto again = closest_of_all(moved.points, moved.facets, move(x));
    RC_ASSERT(again.has_value());
    RC_ASSERT(again->facet == closest->facet && again->second < 0);
    const auto h = against_facet<double>(move(x), moved.points.col(facet[0]), moved.points.col(facet[1]));
    // coordinates of up to 30 over facets of 0.1 at least
    const double rounding = 1e4 * epsilon;
    RC_ASSERT(std::abs(h.gap - g.gap) <= rounding);
    const Point normal = move.turn * Point(g.normal), tangent = move.turn * Point(g.tangents.col(0));
    RC_ASSERT((normal - Point(h.normal)).norm() <= rounding);
    RC_ASSERT((tangent - Point(h.tangents.col(0))).norm() <= rounding);
    RC_ASSERT(largest_entry(h.weights - g.weights) <= rounding);
  }));
}

TEST(ClosestPointProperties, DoesNotDependOnTheOrderOfTheFacets) {
  EXPECT_TRUE(rc::check([] {
    const auto c = curve();
    const Point x = near(c);
    const auto closest = closest_of_all(c.points, c.facets, x);
    auto other = c;
    std::reverse(other.facets.begin(), other.facets.end());
    const auto again = closest_of_all(other.points, other.facets, x);
    RC_ASSERT(again.has_value() == closest.has_value());
    if (closest) RC_ASSERT(foot(other, *again, x) == foot(c, *closest, x));
  }));
}

// --- gap -----------------------------------------------------------------------------------------------------------

/// A point over a facet, in any unit of length.
struct OverFacet {
  Point x, a, b;
  double unit;
};
OverFacet over_facet() {
  const double unit = size(), s = real(0, 1), angle = real(0, 2 * std::numbers::pi), length = real(0.1, 2);
  const Point tau = length * Point(std::cos(angle), std::sin(angle)), a = vector<2>(1);
  const Point x = a + s * tau + real(-0.5, 0.5) * Point(tau[1], -tau[0]);
  return {unit * x, unit * a, unit * (a + tau), unit};
}

TEST(GapProperties, IsLinearInTheDisplacementToRounding) {
  EXPECT_TRUE(rc::check([] {
    const auto p = over_facet();
    const auto g = against_facet<double>(p.x, p.a, p.b);
    const Point v = p.unit * vector<2>(1), w = p.unit * vector<2>(1);
    const double alpha = real(-2, 2), beta = real(-2, 2);
    auto opened = [&](const Point& u) {
      return evaluate_point<double, 2, 1>(g, u, {}, Vec<double, 1>(0), {1.0, 1.0}, 0, ConeRadius::augmented, 0, nullptr)
                 .gap -
             g.gap;
    };
    RC_ASSERT(std::abs(opened(alpha * v + beta * w) - alpha * opened(v) - beta * opened(w)) <= 64 * epsilon * p.unit);
  }));
}

TEST(GapProperties, HasTheDerivativeThatItsWeightsSay) {
  EXPECT_TRUE(rc::check([] {
    const auto p = over_facet();
    const auto g = against_facet<double>(p.x, p.a, p.b);
    Vector<double> all(6);
    all << p.x, p.a, p.b;
    auto gap = []<class T>(const Vector<T>& z) {
      Vector<T> out(1);
      out[0] = against_facet<T>(Vec<T, 2>(z[0], z[1]), Vec<T, 2>(z[2], z[3]), Vec<T, 2>(z[4], z[5])).gap;
      return out;
    };
    const Matrix<double> slope = derivatives::by_dual(gap, all);
    // coordinates of up to 3 over a facet of 0.1 at least: 30^2 roundings
    for (int node = 0; node < 3; ++node)
      for (int i = 0; i < 2; ++i)
        RC_ASSERT(std::abs(slope(0, 2 * node + i) - g.weights[node] * g.normal[i]) <= 1e3 * epsilon);
  }));
}

TEST(GapProperties, DoesNotOpenInATranslation) {
  EXPECT_TRUE(rc::check([] {
    const auto p = over_facet();
    const auto g = against_facet<double>(p.x, p.a, p.b);
    RC_ASSERT(std::abs(g.weights.sum()) <= 4 * epsilon);
    RC_ASSERT(std::abs(g.normal.norm() - 1) <= 4 * epsilon);
    RC_ASSERT(std::abs(g.normal.dot(g.tangents.col(0))) <= 4 * epsilon);
  }));
}

// --- Coulomb's cone ------------------------------------------------------------------------------------------------

/// A trial traction in any unit of stress, and a coefficient of friction.
template <int N>
struct Trial {
  Traction<double, N> traction;
  double mu, unit;
  double bound() const { return -mu * traction.normal; }
  /// Relative distance of |z_T| from the bound, and of z_N from zero: where the derivative jumps.
  double clearance() const {
    const double length = traction.tangential.norm();
    return std::min({std::abs(traction.normal) / unit, std::abs(length - bound()) / unit, length / unit});
  }
};
template <int N>
Trial<N> trial() {
  Trial<N> t;
  t.unit = size();
  t.mu = real(0, 2);
  t.traction.normal = t.unit * real(-1, 0.3);
  t.traction.tangential = t.unit * vector<N>(1);
  return t;
}

template <int N>
Traction<double, N> projected(const Traction<double, N>& z, double mu) {
  const double bound = -mu * z.normal;
  return project_onto_cone(z, bound, classify(z, bound, 0));
}

template <class Count>
class CoulombProperties : public testing::Test {};
using Tangents = testing::Types<std::integral_constant<int, 1>, std::integral_constant<int, 2>>;
TYPED_TEST_SUITE(CoulombProperties, Tangents);

TYPED_TEST(CoulombProperties, LiesInTheConeAndChangesNothingWhenRepeated) {
  EXPECT_TRUE(rc::check([] {
    const auto z = trial<TypeParam::value>();
    const auto once = projected(z.traction, z.mu), twice = projected(once, z.mu);
    RC_ASSERT(once.normal <= 0);
    // the band in which a tie sticks, and three roundings of a scaled direction
    RC_ASSERT(once.tangential.norm() <= -z.mu * once.normal * (1 + tie_band + 3 * epsilon));
    RC_ASSERT(twice.normal == once.normal);
    RC_ASSERT((twice.tangential - once.tangential).norm() <= 3 * epsilon * once.tangential.norm());
  }));
}

TYPED_TEST(CoulombProperties, BringsTangentialTrialsNoFartherApart) {
  EXPECT_TRUE(rc::check([] {
    const auto z = trial<TypeParam::value>();
    auto other = z.traction;
    other.tangential = z.unit * vector<TypeParam::value>(1);
    const double apart = (other.tangential - z.traction.tangential).norm();
    const double after = (projected(other, z.mu).tangential - projected(z.traction, z.mu).tangential).norm();
    RC_ASSERT(after <= apart + (tie_band + 8 * epsilon) * z.unit);  // a tie that sticks is off the disk by its band
  }));
}

TYPED_TEST(CoulombProperties, ScalesWithTheUnitOfStress) {
  EXPECT_TRUE(rc::check([] {
    const auto z = trial<TypeParam::value>();
    RC_PRE(z.clearance() > 1e-9);
    const double factor = size();
    Traction<double, TypeParam::value> scaled;
    scaled.normal = factor * z.traction.normal;
    scaled.tangential = factor * z.traction.tangential;
    const auto t = projected(z.traction, z.mu), s = projected(scaled, z.mu);
    RC_ASSERT(classify(scaled, -z.mu * scaled.normal, 0) == classify(z.traction, z.bound(), 0));
    RC_ASSERT(std::abs(s.normal - factor * t.normal) <= 2 * epsilon * factor * z.unit);
    RC_ASSERT((s.tangential - factor * t.tangential).norm() <= 16 * epsilon * factor * z.unit);
  }));
}

TYPED_TEST(CoulombProperties, TurnsWithTheTangents) {
  EXPECT_TRUE(rc::check([] {
    constexpr int n = TypeParam::value;
    const auto z = trial<n>();
    RC_PRE(z.clearance() > 1e-9);
    Mat<double, n> turn = -Mat<double, n>::Identity();  // one tangent: the other way along it
    if constexpr (n == 2) turn = Eigen::Rotation2Dd(real(0, 2 * std::numbers::pi)).toRotationMatrix();
    auto turned = z.traction;
    turned.tangential = turn * z.traction.tangential;
    const auto t = projected(z.traction, z.mu), s = projected(turned, z.mu);
    RC_ASSERT(s.normal == t.normal);
    RC_ASSERT((s.tangential - turn * t.tangential).norm() <= 16 * epsilon * z.unit);
  }));
}

/// The projection with the bound of its own normal traction, as a function of (z_N, z_T, mu).
template <int N>
struct AsFunction {
  ContactState state;
  template <class T>
  Vector<T> operator()(const Vector<T>& z) const {
    Traction<T, N> trial;
    trial.normal = z[0];
    for (int a = 0; a < N; ++a) trial.tangential[a] = z[1 + a];
    const auto t = project_onto_cone<T, N>(trial, -z[N + 1] * z[0], state);
    Vector<T> out(1 + N);
    out[0] = t.normal;
    for (int a = 0; a < N; ++a) out[1 + a] = t.tangential[a];
    return out;
  }
};

TYPED_TEST(CoulombProperties, HasTheTangentOfTheComplexStepAndOfDifferences) {
  EXPECT_TRUE(rc::check([] {
    constexpr int n = TypeParam::value;
    const auto z = trial<n>();
    RC_PRE(z.clearance() > 0.02);  // so that a difference step of 1e-5 stays in one branch
    const AsFunction<n> project{classify(z.traction, z.bound(), 0)};
    Vector<double> at(n + 2);
    at << z.traction.normal, z.traction.tangential, z.mu;
    const Matrix<double> tangent = derivatives::by_dual(project, at);
    RC_ASSERT(derivatives::relative_difference(tangent, derivatives::by_complex_step(project, at)) <= 64 * epsilon);
    for (int j = 0; j < n + 2; ++j) {
      const double step = 1e-5 * (j <= n ? z.unit : 1);
      Vector<double> plus = at, minus = at;
      plus[j] += step;
      minus[j] -= step;
      auto value_at = [&](const Vector<double>& v) {
        Traction<double, n> trial;
        trial.normal = v[0];
        trial.tangential = v.segment(1, n);
        const auto t = projected(trial, v[n + 1]);  // classified anew: the branch is right, not only its derivative
        Vector<double> out(1 + n);
        out << t.normal, t.tangential;
        return out;
      };
      const Vector<double> slope = (value_at(plus) - value_at(minus)) / (2 * step);
      // central differences: step^2 over the third derivative, 1/|z_T|^2 <= 1/0.02^2 times 2; roundings over the step
      const double scale = j <= n ? 1 : z.unit;
      RC_ASSERT(largest_entry(slope - tangent.col(j)) <=
                (1e-5 * 1e-5 * 4 / (0.02 * 0.02) + 1e2 * epsilon / 1e-5) * scale * 2);
    }
  }));
}

TEST(ContactPointProperties, ForcesTurnWithThePointInSpace) {
  EXPECT_TRUE(rc::check([] {
    const double stress = size(), length = size();
    Vec<double, 3> n = vector<3>(1);
    RC_PRE(n.norm() > 0.1);
    n.normalize();
    auto geometry = [](const Vec<double, 3>& normal, const Mat<double, 3, 2>& tangents) {
      PointGeometry<double> g;
      g.gap = 0;
      g.normal = normal;
      g.tangents = tangents;
      g.weights = Vector<double>::Ones(1);
      g.area = 1;
      return g;
    };
    const Vec<double, 3> w = length * vector<3>(1);
    const Mat<double, 3> turn =
        Eigen::AngleAxisd(real(0, 2 * std::numbers::pi), Vec<double, 3>(1, 2, -2) / 3).toRotationMatrix();
    const Mat<double, 3, 2> frame = detail::tangent_frame<double>(n);
    // the frame of the turned point is chosen anew, not turned: the force must not know
    const Vec<double, 3> m = turn * n;
    const Mat<double, 3, 2> other = detail::tangent_frame<double>(m);
    auto force = [&](const PointGeometry<double>& g, const Vec<double, 3>& u) {
      const double rho = stress / length;
      const auto point = evaluate_point<double, 3, 2>(g, u, {}, Vec<double, 2>(0, 0), {rho, rho}, 0.4,
                                                      ConeRadius::augmented, 0, nullptr);
      return point_force<double, 3, 2>(g, point.traction);
    };
    const double gap = n.dot(w), slip = (frame.transpose() * w).norm();
    RC_PRE(std::abs(gap) > 1e-9 * length && std::abs(slip + 0.4 * gap) > 1e-9 * length && slip > 1e-9 * length);
    RC_ASSERT((force(geometry(m, other), turn * w) - turn * force(geometry(n, frame), w)).norm() <=
              64 * epsilon * stress);
  }));
}

}  // namespace
}  // namespace stickslip::properties_test
