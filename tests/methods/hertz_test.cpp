/// Hertz and Cattaneo-Mindlin in the plane: two equal cylinders, pressed and then sheared.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/largest.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::hertz_test {
namespace {

constexpr double pi = 3.14159265358979323846, radius = 8, E = 200, nu = 0.3;
constexpr double reduced = E / (2 * (1 - nu * nu)), relative_radius = radius / 2;

double half_width(double force) { return std::sqrt(4 * force * relative_radius / (pi * reduced)); }

/// Half disks whose diameters approach until the force is near that of A8, P = 10; then they move sideways by `shear`.
/// `cells` along a quarter of the arc, graded: those in the contact are `grade` times smaller than those at the rim.
Scene cylinders(int cells, double mu, double shear) {
  Scene s;
  s.legs = shear > 0 ? std::vector<Leg>{{1, 4}, {2, 8}} : std::vector<Leg>{{1, 4}};
  HalfDiskMesh upper, lower;
  upper.center = {0.0, radius};
  upper.radius = radius;
  upper.cells = {cells, cells};
  upper.grade = 40.0;
  lower = upper;
  lower.center = {0.0, -radius};
  lower.facing = HalfDiskMesh::Facing::up;
  s.bodies = {{"upper", upper, LinearElastic{E, nu}, "", 1.0}, {"lower", lower, LinearElastic{E, nu}, "", 1.0}};
  s.contacts = {scenes::contact("touch", "upper.arc", "lower.arc")};
  if (mu > 0) s.contacts[0].friction = scenes::parameter(s, "mu", mu);
  const Number down = scenes::parameter(s, "down", -0.16);
  s.supports = {scenes::support("lower.flat", {{'x', scenes::table({{0, 0.0}})}, {'y', scenes::table({{0, 0.0}})}}),
                scenes::support("upper.flat", {{'x', scenes::table({{1, 0.0}, {2, shear}})},
                                               {'y', scenes::table({{0, 0.0}, {1, down}})}})};
  s.responses = {scenes::response("press", Response::Kind::contact_force, "touch", "normal"),
                 scenes::response("up", Response::Kind::contact_force, "touch", "y"),
                 scenes::response("held", Response::Kind::reaction, "upper.flat", "y"),
                 scenes::response("shear", Response::Kind::reaction, "upper.flat", "x"),
                 scenes::response("peak", Response::Kind::contact_pressure, "touch", "", Response::Take::max),
                 scenes::response("width", Response::Kind::contact_half_width, "touch")};
  return s;
}

/// Size of a slave cell in the contact.
double cell_size(const scenes::Solved& s) {
  const auto nodes = s.model.side("upper.arc").nodes;
  double least = radius;
  for (std::size_t n = 1; n < nodes.size(); ++n)
    least = smaller(least, (s.slots.points.col(nodes[n]) - s.slots.points.col(nodes[n - 1])).norm());
  return least;
}

TEST(HertzLine, FormulaHasTheNumbersOfA8) {
  EXPECT_NEAR(half_width(10), 0.6807783738, 1e-10);
  EXPECT_NEAR(2 * 10 / (pi * half_width(10)), 9.3513512890, 1e-9);
}

TEST(HertzLine, PeakAndHalfWidthFollowTheForce) {
  for (const Method& method : {Method(MonolithicAL{}), Method(UzawaAL{}), Method(Penalty{})}) {
    const auto s = scenes::run(cylinders(40, 0, 0), method);
    const double P = s.value("press"), b = half_width(P), h = cell_size(s);
    EXPECT_NEAR(P, 10, 3);                                   // the contact is as wide as A8's
    EXPECT_NEAR(s.value("up"), -s.value("held"), 1e-8 * P);  // what goes in comes out
    EXPECT_NEAR(s.value("peak"), 2 * P / (pi * b), 0.02 * 2 * P / (pi * b)) << name_of(method) << " h/b " << h / b;
    EXPECT_NEAR(s.value("width"), b, h + 0.01 * b) << name_of(method);
    // at fixed geometry b and the peak both go with the root of P
    const double dP = s.derivative("press", "down");
    EXPECT_NEAR(s.derivative("width", "down") / dP, b / (2 * P), 0.05 * b / (2 * P)) << name_of(method);
  }
}

TEST(HertzLine, PressureConvergesWithTheMesh) {
  double before = 0;
  for (int cells : {10, 20, 40}) {  // beyond, what half disks are short of half-spaces shows
    const auto s = scenes::run(cylinders(cells, 0, 0), MonolithicAL{});
    const double P = s.value("press"), b = half_width(P), p0 = 2 * P / (pi * b);
    const auto& state = s.trajectory.increments.back().state;
    double error = 0, size = 0;
    for (std::size_t p = 0; p < s.model.points.size(); ++p) {
      const double x = s.slots.points(0, s.model.points[p].nodes[0]), area = s.slots.geometry[p].area;
      const double exact = std::abs(x) < b ? p0 * std::sqrt(1 - x * x / (b * b)) : 0;
      error += area * std::pow(-state.contact.traction[s.model.points[p].multiplier] - exact, 2);
      size += area * exact * exact;
    }
    error = std::sqrt(error / size);
    // order about one: the edge of the contact lies inside a cell
    if (before > 0) {
      EXPECT_LT(error, 0.7 * before) << cells;
    }
    before = error;
  }
  EXPECT_LT(before, 0.02);
}

TEST(CattaneoMindlin, StickZoneAndTractionFollowTheForces) {
  const double mu = 0.2;
  for (const Method& method : {Method(MonolithicAL{}), Method(UzawaAL{})}) {
    const auto s = scenes::run(cylinders(60, mu, 0.012), method);
    const double P = s.value("press"), Q = std::abs(s.value("shear")), b = half_width(P), h = cell_size(s);
    ASSERT_GT(Q, 0.2 * mu * P);
    ASSERT_LT(Q, 0.9 * mu * P);  // partial slip
    const double c = b * std::sqrt(1 - Q / (mu * P)), p0 = 2 * P / (pi * b);
    const auto& state = s.trajectory.increments.back().state;
    double stick = 0, worst = 0;
    for (std::size_t p = 0; p < s.model.points.size(); ++p) {
      const int k = s.model.points[p].multiplier;
      const double x = s.slots.points(0, s.model.points[p].nodes[0]);
      if (state.contact.state[p] == ContactState::stick) stick = larger(stick, std::abs(x));
      if (std::abs(x) >= b - h) continue;
      double exact = std::sqrt(1 - x * x / (b * b));
      if (std::abs(x) < c) exact -= c / b * std::sqrt(1 - x * x / (c * c));
      if (std::abs(std::abs(x) - c) > 2 * h)  // the cusp at the edge of the stick zone is smeared over its cells
        worst = larger(worst, std::abs(std::abs(state.contact.traction[k + 1]) / (mu * p0) - exact));
    }
    EXPECT_NEAR(stick, c, 2 * h) << name_of(method) << " b " << b << " h " << h;
    // the theory leaves out what shear does to the gap, and lets each half disk be a half-space: 5 % of the peak
    EXPECT_LT(worst, 0.05) << name_of(method);
  }
}

TEST(CattaneoMindlin, ForcesRaisedTogetherLeaveNoSlip) {
  Scene together = cylinders(30, 0.2, 0);
  together.supports[1].move['x'] = scenes::table({{0, 0.0}, {1, 0.004}});
  const auto s = scenes::run(together, MonolithicAL{});
  const auto& state = s.trajectory.increments.back().state;
  ASSERT_LT(std::abs(s.value("shear")), 0.1 * s.value("press"));
  int slipping = 0, closed = 0;
  for (ContactState of_point : state.contact.state) {
    closed += of_point != ContactState::open;
    slipping += of_point == ContactState::slip;
  }
  EXPECT_GT(closed, 8);
  EXPECT_LE(slipping, 2);  // a point at either end, which touches with no pressure yet
}

}  // namespace
}  // namespace stickslip::hertz_test
