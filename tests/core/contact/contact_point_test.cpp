/// One contact point: kinematics, branches, and forces that are the work of gap and slip.
#include "core/contact/contact_point.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/contact/rigid_surfaces.hpp"
#include "core/contact/surfaces.hpp"
#include "tests/support/derivatives.hpp"

namespace stickslip::contact_point_test {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
using Point = Vec<double, 2>;

/// A slave node over a tilted facet, a third of the way.
PointGeometry<double> over_facet() {
  auto g = against_facet<double>(Point(0.4, 0.9), Point(1, 0.2), Point(-0.5, -0.1));
  g.area = 0.7;
  return g;
}

PointGeometry<double> over_plane() {
  auto g =
      against_rigid<double>(Vec<double, 3>(0.1, 0.2, 0.9), Plane{{0.0, 0.0, 0.0}, {0.3, -0.2, 1.0}}, Numbers<double>{});
  g.area = 0.7;
  return g;
}

template <class T>
PointGeometry<T> promoted(const PointGeometry<double>& g) {
  auto cast = [](double x) { return T(x); };
  PointGeometry<T> out;
  out.gap = T(g.gap);
  out.area = T(g.area);
  out.normal = g.normal.unaryExpr(cast);
  out.tangents = g.tangents.unaryExpr(cast);
  out.weights = g.weights.unaryExpr(cast);
  return out;
}

/// Gap, slip and the nodal forces of a point, as functions of nodal displacements (node-major) in the scalar T.
template <class T, int D, int Tangents>
struct Evaluated {
  PointOutcome<T, Tangents> outcome;
  Vector<T> forces;
};
template <int D, int Tangents, class T>
Evaluated<T, D, Tangents> evaluate(const PointGeometry<double>& geometry, const Vector<T>& u, ContactState state) {
  const auto g = promoted<T>(geometry);
  Vec<T, D> w = Vec<T, D>::Constant(T(0));
  for (Eigen::Index n = 0; n < g.weights.size(); ++n)
    for (int i = 0; i < D; ++i) w[i] += g.weights[n] * u[n * D + i];
  Traction<T, Tangents> lambda;
  lambda.normal = T(-3.0);
  Vec<T, Tangents> previous;
  for (int a = 0; a < Tangents; ++a) {
    lambda.tangential[a] = T(0.4 + a);
    previous[a] = T(0.1 * a - 0.2);
  }
  Evaluated<T, D, Tangents> e;
  e.outcome = evaluate_point<T, D, Tangents>(g, w, lambda, previous, {T(2.0), T(1.5)}, T(0.3), ConeRadius::augmented, 0,
                                             &state);
  const Vec<T, D> force = point_force<T, D, Tangents>(g, e.outcome.traction);
  e.forces.resize(u.size());
  for (Eigen::Index n = 0; n < g.weights.size(); ++n)
    for (int i = 0; i < D; ++i) e.forces[n * D + i] = g.weights[n] * force[i];
  return e;
}

template <int D, int Tangents>
void expect_virtual_work(const PointGeometry<double>& geometry) {
  const int size = static_cast<int>(geometry.weights.size()) * D;
  const Vector<double> u = 0.3 * derivatives::arbitrary(size);
  for (ContactState state : {ContactState::open, ContactState::stick, ContactState::slip}) {
    const auto at = evaluate<D, Tangents>(geometry, u, state);
    for (int j = 0; j < size; ++j) {
      Vector<Dual<1>> moved = u.unaryExpr([](double x) { return Dual<1>(x); });
      moved[j].d[0] = 1;
      const auto varied = evaluate<D, Tangents>(geometry, moved, state).outcome;
      double work = at.outcome.traction.normal * varied.gap.d[0];
      for (int a = 0; a < Tangents; ++a) work += at.outcome.traction.tangential[a] * varied.slip[a].d[0];
      // a dozen products of numbers up to 3
      EXPECT_NEAR(at.forces[j], geometry.area * work, 40 * epsilon) << j;
    }
  }
}

TEST(PointForce, DoesTheVirtualWorkOfGapAndSlip) {
  expect_virtual_work<2, 1>(over_facet());
  expect_virtual_work<2, 0>(over_facet());
  expect_virtual_work<3, 2>(over_plane());
  expect_virtual_work<3, 0>(over_plane());
}

TEST(PointForce, IsInBalanceBetweenSlaveAndMaster) {
  const auto at = evaluate<2, 1>(over_facet(), Vector<double>(0.2 * derivatives::arbitrary(6)), ContactState::slip);
  ASSERT_GT(at.forces.head<2>().norm(), 0.1);
  EXPECT_NEAR(at.forces[0] + at.forces[2] + at.forces[4], 0, 10 * epsilon);  // three terms of the size of one
  EXPECT_NEAR(at.forces[1] + at.forces[3] + at.forces[5], 0, 10 * epsilon);
}

TEST(PointForce, PushesTheSlaveOutOfTheMaster) {
  const auto g = over_facet();
  Traction<double, 1> pressed;
  pressed.normal = -2;
  const Point on_slave = -point_force<double, 2, 1>(g, pressed);  // the residual has the opposite sign
  EXPECT_NEAR(on_slave.dot(Point(g.normal)), 2 * g.area, 10 * epsilon);
}

/// The point with given numbers on a level floor, so that w = (slip placement reversed, gap).
PointOutcome<double, 1> on_floor(Point w, double lambda_normal, double lambda_tangential, ConeRadius cone,
                                 double tie_length = 0, const ContactState* state = nullptr) {
  auto g = against_rigid<double>(Point(0, 0.5), Plane{{0.0, 0.0}, {0.0, 1.0}}, Numbers<double>{});
  g.area = 1;
  Traction<double, 1> lambda;
  lambda.normal = lambda_normal;
  lambda.tangential[0] = lambda_tangential;
  return evaluate_point<double, 2, 1>(g, w, lambda, Vec<double, 1>(0.25), {10, 4}, 0.5, cone, tie_length, state);
}

TEST(ContactPointKinematics, MeasuresGapPlacementAndTheSlipOfThisIncrement) {
  const auto p = on_floor({-0.75, -0.625}, 0, 0, ConeRadius::augmented);
  EXPECT_EQ(p.gap, -0.125);
  EXPECT_EQ(p.placement[0], 0.75);  // e = (-1, 0) over a floor with the normal up
  EXPECT_EQ(p.slip[0], 0.5);
}

TEST(ContactPointBranches, FollowTheTrialTraction) {
  // z_N = lambda_N + 10 g_N; z_T = lambda_T + 4 dg_T; bound = -0.5 z_N
  const auto open = on_floor({-0.75, -0.25}, -2, 1, ConeRadius::augmented);
  EXPECT_EQ(open.state, ContactState::open);
  EXPECT_EQ(open.traction.normal, 0);
  EXPECT_EQ(open.slip[0], 0.5);  // the placement is followed in the air as well
  const auto stick = on_floor({-0.375, -0.75}, -2, 1, ConeRadius::augmented);
  EXPECT_EQ(stick.state, ContactState::stick);
  EXPECT_EQ(stick.traction.normal, -4.5);
  EXPECT_EQ(stick.traction.tangential[0], 1.5);
  const auto slip = on_floor({-1.25, -0.75}, -2, 1, ConeRadius::augmented);
  EXPECT_EQ(slip.state, ContactState::slip);
  EXPECT_EQ(slip.traction.tangential[0], 2.25);
  const auto backwards = on_floor({1.25, -0.75}, -2, 1, ConeRadius::augmented);
  EXPECT_EQ(backwards.state, ContactState::slip);
  EXPECT_EQ(backwards.traction.tangential[0], -2.25);
}

TEST(ContactPointBranches, AreThoseThatAreAskedFor) {
  const ContactState asked = ContactState::stick;
  const auto p = on_floor({-1.25, -0.25}, -2, 1, ConeRadius::augmented, 0, &asked);
  EXPECT_EQ(p.state, ContactState::stick);
  EXPECT_EQ(p.traction.normal, 0.5);  // tension, as the branch has it
  EXPECT_EQ(p.traction.tangential[0], 5);
}

TEST(ContactPointBranches, CloseWithinTheTieLength) {
  const double gap = 0.0625;
  EXPECT_EQ(on_floor({0, gap - 0.5}, 0, 0, ConeRadius::augmented, gap).state, ContactState::slip);
  EXPECT_EQ(on_floor({0, gap - 0.5}, 0, 0, ConeRadius::augmented, 0.99 * gap).state, ContactState::open);
}

TEST(ConeRadiusOfTheMultiplier, ReadsLambdaInPlaceOfTheTrial) {
  EXPECT_EQ(on_floor({-1.25, -0.75}, -2, 1, ConeRadius::multiplier).traction.tangential[0], 1);  // 0.5 * 2
  for (double lambda : {0.0, 1.0}) {  // no pressure yet: no radius, neither stick nor traction
    const auto p = on_floor({-1.25, -0.75}, lambda, 1, ConeRadius::multiplier);
    EXPECT_EQ(p.state, ContactState::slip);
    EXPECT_EQ(p.traction.tangential[0], 0);
  }
}

TEST(ContactPointDerivatives, AreThoseOfTheComplexStepInEveryBranchForAllItReads) {
  for (ConeRadius cone : {ConeRadius::augmented, ConeRadius::multiplier})
    for (ContactState state : {ContactState::open, ContactState::stick, ContactState::slip}) {
      auto f = [&](const auto& x) {  // w, lambda, previous placement, rho, mu; gap, area
        using T = typename std::decay_t<decltype(x)>::Scalar;
        auto g = promoted<T>(over_plane());
        g.gap = x[11];
        g.area = x[12];
        Traction<T, 2> lambda;
        lambda.normal = x[3];
        lambda.tangential << x[4], x[5];
        const auto p = evaluate_point<T, 3, 2>(g, Vec<T, 3>(x[0], x[1], x[2]), lambda, Vec<T, 2>(x[6], x[7]),
                                               {x[8], x[9]}, x[10], cone, 0, &state);
        const Vec<T, 3> force = point_force<T, 3, 2>(g, p.traction);
        Vector<T> out(11);
        out << p.gap, p.placement, p.slip, p.traction.normal, p.traction.tangential, force;
        return out;
      };
      Vector<double> x(13);
      x << 0.1, -0.2, -0.5, -2.0, 0.3, 0.9, 0.05, -0.1, 3.0, 2.0, 0.4, -0.1, 0.7;
      const auto dual = derivatives::by_dual(f, x), exact = derivatives::by_complex_step(f, x);
      EXPECT_LE(derivatives::relative_difference(dual, exact), 50 * epsilon);  // some thirty operations
    }
}

}  // namespace
}  // namespace stickslip::contact_point_test
