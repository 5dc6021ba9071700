/// Statics with a closed form, by every method: each against its own closed form, never a penalty against the exact
/// solution.
#include <gtest/gtest.h>

#include "tests/support/blocks.hpp"

namespace stickslip::statics_test {
namespace {

using scenes::absolute;
using scenes::all_methods;
using scenes::box_body;
using scenes::contact;
using scenes::exact;
using scenes::exact_methods;
using scenes::ramp;
using scenes::response;
using scenes::run;
using scenes::support;
using scenes::table;
using Kind = Response::Kind;

/// A Number with slots of its own; `parameter` gets the weight of each.
Number weighted(Scene& scene, Parameter& parameter, double value, double weight) {
  scene.numbers.push_back(value);
  scene.pointers.push_back("/n" + std::to_string(scene.numbers.size()));
  const int slot = static_cast<int>(scene.numbers.size()) - 1;
  parameter.slots.emplace_back(slot, weight);
  return {value, slot};
}

// --- A5: incline -----------------------------------------------------------------------------------------------------

Scene incline(double degrees, double k) {
  const double a = degrees * M_PI / 180;
  Scene s;
  s.legs = {{1, 3}};
  const Number mu = scenes::parameter(s, "mu", 0.3), weight = scenes::parameter(s, "W", -100);
  s.parameters[1].slots[0].second = -1;
  const Number stiffness = scenes::parameter(s, "k", k);
  Parameter angle{"a", {}, "/a", a};
  const Number nx = weighted(s, angle, -std::sin(a), -std::cos(a)), ny = weighted(s, angle, std::cos(a), -std::sin(a));
  s.parameters.push_back(angle);
  s.bodies = {{"block", PointMesh{{0.0, 0.0}}, GroundedSpring{{{stiffness, 0.0}, {0.0, stiffness}}}, "", 1.0}};
  s.obstacles = {{"slope", Plane{{0.0, 0.0}, {nx, ny}}}};
  s.contacts = {contact("sole", "block.node", "slope")};
  s.contacts[0].friction = mu;
  s.loads = {{"block.node", Load::Kind::force, {0.0, weight}, ramp(1.0)}};
  s.responses = {response("x", Kind::displacement, "block.node", "x"),
                 response("press", Kind::contact_force, "sole", "normal")};
  return s;
}

TEST(Incline, ASpringHoldsTheBlockThatFrictionDoesNot) {  // (A5)
  for (const auto& method : exact_methods())
    for (double degrees : {30.0, 50.0}) {
      const double a = degrees * M_PI / 180, k = 1000, u = 100 * (std::sin(a) - 0.3 * std::cos(a)) / k;
      const auto s = run(incline(degrees, k), method);
      // the displacement is u (-cos a, -sin a)
      EXPECT_NEAR(s.value("x"), -u * std::cos(a), exact * u) << name_of(method);
      EXPECT_NEAR(s.derivative("x", "mu"), 100 * std::cos(a) / k * std::cos(a), exact);
      EXPECT_NEAR(s.derivative("x", "k"), u / k * std::cos(a), exact * u);
      EXPECT_NEAR(s.derivative("x", "W"), -u / 100 * std::cos(a), exact * u);
      const double du_da = 100 * (std::cos(a) + 0.3 * std::sin(a)) / k;
      EXPECT_NEAR(s.derivative("x", "a"), -du_da * std::cos(a) + u * std::sin(a), exact);
      EXPECT_NEAR(s.derivative("press", "a"), -100 * std::sin(a), exact * 100);
    }
}

TEST(Incline, FrictionHoldsTheBlockUpToItsAngle) {
  const double critical = std::atan(0.3) * 180 / M_PI;
  for (const auto& method : exact_methods()) {
    EXPECT_NEAR(run(incline(critical * (1 - 1e-6), 1000), method).value("x"), 0, 1e-14) << name_of(method);
    EXPECT_LT(run(incline(critical * (1 + 1e-6), 1000), method).value("x"), -1e-9) << name_of(method);
  }
}

/// An elastic block on a rough floor whose weight is turned by so many degrees: nothing else holds it.
Scene elastic_incline(double degrees) {
  const double a = degrees * M_PI / 180;
  Scene s;
  s.legs = {{1, 4}};
  s.bodies = {box_body("block", {0, 0}, {4, 1}, {8, 2})};
  s.obstacles = {{"slope", Plane{{0.0, 0.0}, {0.0, 1.0}}}};
  s.contacts = {contact("sole", "block.bottom", "slope")};
  s.contacts[0].friction = 0.3;
  s.loads = {{"block", Load::Kind::body_force, {-25 * std::sin(a), -25 * std::cos(a)}, ramp(1.0)}};
  s.responses = {response("T", Kind::contact_force, "sole", "x"), response("N", Kind::contact_force, "sole", "normal")};
  return s;
}

TEST(Incline, AnElasticBlockThatNothingElseHoldsSticksBelowTheAngleAndIsSaidToSlideAbove) {
  for (const auto& method : all_methods()) {
    const auto below = run(elastic_incline(16), method);
    ASSERT_TRUE(is_converged(below.trajectory.status)) << name_of(method) << below.trajectory.message;
    EXPECT_NEAR(below.value("T"), 100 * std::sin(16 * M_PI / 180), 1e-9);  // Newton's 1e-12 of it, a few rows
    EXPECT_NEAR(below.value("N"), 100 * std::cos(16 * M_PI / 180), 1e-9);
    const auto above = run(elastic_incline(18), method);
    EXPECT_EQ(above.trajectory.status, Status::no_equilibrium) << name_of(method) << above.trajectory.message;
    EXPECT_NE(above.trajectory.message.find("block is free to slide"), std::string::npos) << above.trajectory.message;
  }
}

/// A block on a frictionless floor, lifted off it, that supports hold but for one motion.
Scene lifted_block(std::vector<Support> supports) {
  Scene s;
  s.legs = {{1, 1}};
  s.bodies = {box_body("block", {0, 0}, {4, 1}, {8, 2})};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}}};
  s.contacts = {contact("sole", "block.bottom", "floor")};
  s.supports = std::move(supports);
  s.loads = {{"block", Load::Kind::body_force, {0.0, 5.0}, ramp(1.0)}};
  return s;
}

TEST(Statics, SayHowABodyThatSupportsHoldInPartIsFreeToMove) {
  const auto zero = scenes::table({{0, 0.0}});
  Support along_wall = scenes::support("block.left", {});
  along_wall.inclined = Inclined{{-0.6, 0.8}, zero};
  const std::vector<std::pair<Support, std::string>> cases{
      {scenes::support("block.left", {{'x', zero}}), "free to move along (0, 1)"},
      {scenes::support("block.left & block.bottom", {{'x', zero}, {'y', zero}}), "free to move about (0, 0)"},
      {along_wall, "free to move along (0.8, 0.6)"}};
  for (const auto& method : all_methods())
    for (const auto& [support, words] : cases) {
      const auto s = run(lifted_block({support}), method);
      EXPECT_EQ(s.trajectory.status, Status::no_equilibrium) << name_of(method);
      EXPECT_NE(s.trajectory.message.find("block is " + words), std::string::npos)
          << name_of(method) << ": " << s.trajectory.message;
    }
}

// --- A11: flat punch -------------------------------------------------------------------------------------------------

/// Right half of a block under a rigid punch of half width 1; cells of size h at the punch's edge, growing away.
Scene punch(double h) {
  std::vector<double> x{1}, y{0};
  for (double step = h, at = 1 - h; at > 1e-9; at = x.front() - step) {
    x.insert(x.begin(), at);
    step = std::min(1.15 * step, 0.15);
  }
  if (x.front() > 0.4 * (x[1] - x[0]))
    x.insert(x.begin(), 0);
  else
    x.front() = 0;
  for (double step = h; x.back() < 20; step = std::min(1.2 * step, 3.0)) x.push_back(x.back() + step);
  for (double step = h; y.back() > -20; step = std::min(1.2 * step, 3.0)) y.push_back(y.back() - step);
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {1.0, 1.0};
  box.cells = {static_cast<int>(x.size()) - 1, static_cast<int>(y.size()) - 1};
  ImportedMesh mesh;
  mesh.mesh = make_mesh(MeshDescription(box), "Q4", 2);
  mesh.points = make_points<double>(MeshDescription(box), Numbers<double>{}, 2);
  for (Eigen::Index n = 0; n < mesh.points.cols(); ++n) {
    mesh.points(0, n) = x[std::lround(mesh.points(0, n) * box.cells[0])];
    mesh.points(1, n) = y[y.size() - 1 - std::lround(mesh.points(1, n) * box.cells[1])];
  }
  Scene s;
  s.legs = {{1, 1}};
  s.bodies = {{"block", mesh, LinearElastic{1000.0, 0.3}, "", 1.0}};
  s.obstacles = {{"punch", Polyline{{{{1.0, 0.0}}, {{-1.0, 0.0}}}}, {{'y', table({{0, -0.01}})}}}};
  s.contacts = {contact("face", "block.top", "punch")};
  s.supports = {support("block.left", {{'x', table({{0, 0.0}})}}), support("block.bottom", {{'y', table({{0, 0.0}})}})};
  s.responses = {response("P", Kind::contact_force, "face", "normal"),
                 response("peak", Kind::contact_pressure, "face", "", Response::Take::max),
                 response("middle", Kind::contact_pressure, "face")};
  s.responses[2].at = {0.0, 0.0};
  return s;
}

TEST(Punch, ItsPressureGrowsAtTheEdgeAsTheRootOfTheMesh) {  // (A11)
  for (const auto& method : all_methods()) {
    std::vector<double> peaks;
    for (double h : {0.02, 0.01, 0.005}) {
      const auto s = run(punch(h), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
      peaks.push_back(s.value("peak"));
      const double P = 2 * s.value("P");
      EXPECT_NEAR(s.value("middle") / (P / M_PI), 1, 0.02)
          << name_of(method) << h;  // the mesh at 1 %, its edge unresolved
    }
    for (int i : {0, 1}) EXPECT_NEAR(std::log(peaks[i + 1] / peaks[i]) / std::log(0.5), -0.5, 0.1) << name_of(method);
  }
}

// --- A17: several bodies ---------------------------------------------------------------------------------------------

TEST(Stacks, PullingTheMiddleOfThreeBricksOvercomesBothOfItsFaces) {  // (A17.1)
  for (const auto& method : all_methods()) {
    Scene s;
    s.legs = {{1, 4}};
    s.bodies = {box_body("upper", {0, 2}, {1, 3}, {4, 4}), box_body("middle", {0, 1}, {1, 2}, {4, 4}),
                box_body("lower", {0, 0}, {1, 1}, {4, 4})};
    s.contacts = {contact("high", "upper.bottom", "middle.top"), contact("low", "middle.bottom", "lower.top")};
    for (auto& each : s.contacts) each.friction = 0.3;
    for (const char* body : {"upper", "middle", "lower"})
      s.loads.push_back({body, Load::Kind::body_force, {0.0, -10.0}, {}});
    s.supports = {support("lower.bottom", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}),
                  support("upper.left", {{'x', table({{0, 0.0}})}}), support("middle.right", {{'x', ramp(0.4)}})};
    s.responses = {response("T", Kind::reaction, "middle.right", "x")};
    const auto r = run(s, method);
    ASSERT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << r.trajectory.message;
    EXPECT_NEAR(r.value("T"), 9, 1e-9) << name_of(method);  // Newton's 1e-12 of forces of some ten, and Uzawa's 1e-10
  }
}

TEST(Stacks, APenaltyAddsUpItsClosureOverTheFacesOfAColumn) {  // (A17.2)
  const double P = 3, eps = 1e5;
  for (int n : {2, 5}) {
    Scene s;
    s.legs = {{1, 1}};
    for (int b = 0; b < n; ++b) {
      const std::string name = "b" + std::to_string(b);
      s.bodies.push_back(box_body(name, {0, double(b)}, {1, double(b + 1)}, {2, 2}, 1000, 0));
      s.supports.push_back(support(name + ".left", {{'x', table({{0, 0.0}})}}));
      if (b > 0)
        s.contacts.push_back(contact("c" + std::to_string(b), name + ".bottom", s.bodies[b - 1].name + ".top"));
    }
    s.supports.push_back(support("b0.bottom", {{'y', table({{0, 0.0}})}}));
    const std::string top = s.bodies.back().name + ".top";
    s.loads = {{top, Load::Kind::pressure, {P}, {}}};
    s.responses = {response("u", Kind::displacement, top, "y")};
    const double elastic = P * n / 1000;
    EXPECT_NEAR(run(s, Penalty{absolute(eps)}).value("u"), -elastic - (n - 1) * P / eps, exact * elastic);
    for (const auto& method : exact_methods()) EXPECT_NEAR(run(s, method).value("u"), -elastic, exact * elastic);
  }
}

Scene groove(double degrees, double F) {
  const double a = degrees * M_PI / 180;
  Scene s;
  s.legs = {{1, 1}};
  const Number load = scenes::parameter(s, "F", -F);
  s.bodies = {{"pin", PointMesh{{0.0, 0.0}}, GroundedSpring{{{7.0, 0.0}, {0.0, 7.0}}}, "", 1.0}};
  s.obstacles = {{"left", Plane{{0.0, 0.0}, {std::cos(a), std::sin(a)}}},
                 {"right", Plane{{0.0, 0.0}, {-std::cos(a), std::sin(a)}}}};
  s.contacts = {contact("one", "pin.node", "left"), contact("two", "pin.node", "right")};
  s.loads = {scenes::force("pin.node", {0.0, load})};
  s.responses = {response("one", Kind::contact_force, "one", "normal"),
                 response("two", Kind::contact_force, "two", "normal")};
  return s;
}

TEST(Groove, BothSidesCarryTheirShareAndTheSameInEveryRun) {  // (A17.3, C23)
  for (double degrees : {45.0, 20.0}) {
    const double share = 10 / (2 * std::sin(degrees * M_PI / 180));
    for (const auto& method : exact_methods()) {
      const auto s = run(groove(degrees, 10), method);
      EXPECT_NEAR(s.value("one"), share, exact * share) << name_of(method);
      EXPECT_NEAR(s.value("two"), share, exact * share) << name_of(method);
      EXPECT_NEAR(s.derivative("one", "F"), -share / 10, exact * share);
      for (int again = 0; again < 10; ++again) EXPECT_EQ(run(groove(degrees, 10), method).value("one"), s.value("one"));
    }
    const double eps = 1e4, sine = std::sin(degrees * M_PI / 180), u = 10 / (7 + 2 * eps * sine * sine);
    EXPECT_NEAR(run(groove(degrees, 10), Penalty{absolute(eps)}).value("two"), eps * u * sine, exact * share);
  }
}

/// The groove with friction, its pin pressed in and let go again.
Scene rough_groove(double degrees, double mu) {
  Scene s = groove(degrees, 10);
  for (auto& c : s.contacts) c.friction = mu;
  s.loads[0].history = table({{0, 0.0}, {1, 1.0}, {2, 0.0}});
  s.legs = {{2, 6}};
  return s;
}

/// (A17.3) Above the slope it jams; above the inverse slope too much for it to slip in at all, and nothing is left.
/// More constraints than unknowns where both sides stick.
TEST(Groove, JamsWhereFrictionExceedsItsSlope) {
  for (double degrees : {15.0, 30.0, 45.0, 75.0})
    for (double mu : {0.1, 0.3, 0.5, 1.5}) {
      const auto exact_run = run(rough_groove(degrees, mu), MonolithicAL{});
      const double left = exact_run.value("one"), largest = 10 / std::sin(degrees * M_PI / 180);
      const double slope = std::tan(degrees * M_PI / 180);
      EXPECT_EQ(left > 1e-6 * largest, slope < mu && mu < 1 / slope) << degrees << " " << mu << " " << left;
      for (const auto& method : all_methods()) {
        const auto s = run(rough_groove(degrees, mu), method);
        EXPECT_TRUE(is_converged(s.trajectory.status))
            << name_of(method) << " " << degrees << " " << mu << ": " << s.trajectory.message;
        EXPECT_TRUE(is_converged(s.gradients.status))
            << name_of(method) << " " << degrees << " " << mu << ": " << s.gradients.message;
        // Uzawa's multipliers settle to its tolerance of 1e-10, in each of six steps; a penalty of 1e3 springs gives in
        const double band = std::holds_alternative<Penalty>(method) ? 1e-2 : 1e-8;
        EXPECT_NEAR(s.value("one"), left, band * largest) << name_of(method) << " " << degrees << " " << mu;
      }
    }
}

}  // namespace
}  // namespace stickslip::statics_test
