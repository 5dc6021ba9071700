/// Statics with a closed form, and hard cases of bodies, loads and obstacles, by every method: each method against its
/// own closed form, never a penalty against the exact solution.
#include <gtest/gtest.h>

#include <random>

#include "tests/support/scenes.hpp"

namespace stickslip {
namespace {

using scenes::absolute;
using scenes::contact;
using scenes::response;
using scenes::run;
using scenes::support;
using scenes::table;
using Kind = Response::Kind;

std::vector<Method> all_methods() { return {Penalty{}, UzawaAL{}, MonolithicAL{}}; }
/// Those that enforce the constraint to their tolerance. Uzawa's is set to what "exact" asks for.
std::vector<Method> exact_methods() {
  UzawaAL uzawa;
  uzawa.tolerance = 1e-12;
  return {uzawa, MonolithicAL{}};
}
constexpr double exact = 1e-10;  // of a closed form: Uzawa's tolerance times a factor rho / k

Body box_body(const std::string& name, std::array<double, 2> min, std::array<double, 2> max, std::array<int, 2> cells,
              double E = 1000, double nu = 0.3) {
  BoxMesh box;
  box.min = {min[0], min[1]};
  box.max = {max[0], max[1]};
  box.cells = cells;
  return {name, box, LinearElastic{E, nu}, "", 1.0};
}

Table ramp(const Number& value) { return table({{0, 0.0}, {1, value}}); }

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
      EXPECT_EQ(s.trajectory.status, Status::singular) << name_of(method);
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

// --- hard cases ------------------------------------------------------------------------------------------------------

Scene stop_again(int copies) {
  Scene s = scenes::stop();
  const Contact touch = s.contacts[0];
  s.contacts.clear();
  s.responses.resize(1);
  for (int i = 0; i < copies; ++i) {
    s.contacts.push_back(touch);
    s.contacts.back().name = "touch" + std::to_string(i);
    s.responses.push_back(response("press" + std::to_string(i), Kind::contact_force, s.contacts.back().name, "normal"));
  }
  return s;
}

double sum_of_presses(const scenes::Solved& s, int copies, const char* derivative = nullptr) {
  double sum = 0;
  for (int i = 0; i < copies; ++i) {
    const std::string name = "press" + std::to_string(i);
    sum += derivative ? s.derivative(name, derivative) : s.value(name);
  }
  return sum;
}

TEST(Redundant, ConstraintsThatRepeatOneAnotherShareTheForce) {  // (C6)
  const double k = 1000, rho = 1e4, lambda = 5;
  for (int n : {2, 5}) {
    const auto penalty = run(stop_again(n), Penalty{absolute(rho)});
    EXPECT_NEAR(sum_of_presses(penalty, n), lambda * n * rho / (k + n * rho), exact);
    UzawaAL method;
    method.scale = absolute(rho);
    method.adapt = false;
    method.tolerance = 1e-12;
    const auto uzawa = run(stop_again(n), method);
    EXPECT_NEAR(sum_of_presses(uzawa, n), lambda, exact);
    method.tolerance = 1e-7;  // the last updates above their rounding
    EXPECT_NEAR(run(stop_again(n), method).trajectory.increments.back().contraction, k / (k + n * rho), 1e-6);
    const auto monolithic = run(stop_again(n), MonolithicAL{});
    ASSERT_TRUE(is_converged(monolithic.trajectory.status));
    EXPECT_NEAR(sum_of_presses(monolithic, n), lambda, exact);
    EXPECT_NEAR(monolithic.value("u"), 0.01, exact * 0.01);
    EXPECT_NE(monolithic.trajectory.increments.back().message.find("repeat one another"), std::string::npos);
    for (const auto* s : {&uzawa, &monolithic}) {
      EXPECT_NEAR(sum_of_presses(*s, n, "F"), 1, exact);
      EXPECT_NEAR(sum_of_presses(*s, n, "g0"), -k, exact * k);
    }
  }
}

TEST(Redundant, ACornerThatASupportHoldsMayBeInContactToo) {  // (C7)
  double pull = 0;
  for (const auto& method : all_methods()) {
    Scene s;
    s.legs = {{2, 4}};
    s.bodies = {box_body("block", {0, 0}, {2, 1}, {4, 2})};
    s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}}};
    s.contacts = {contact("sole", "block.bottom", "floor")};
    s.contacts[0].friction = 0.3;
    s.supports = {support("block.left", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}})};
    s.loads = {{"block.top", Load::Kind::pressure, {10.0}, ramp(1.0)},
               {"block.right", Load::Kind::traction, {1.0, 0.0}, table({{1, 0.0}, {2, 1.0}})}};
    for (const char* axis : {"x", "y"}) {
      s.responses.push_back(response(std::string("R") + axis, Kind::reaction, "block.left", axis));
      s.responses.push_back(response(std::string("C") + axis, Kind::contact_force, "sole", axis));
    }
    const auto r = run(s, method);
    ASSERT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << r.trajectory.message;
    // the reaction balances everything at the corner, contact included: the sum is that of the loads
    EXPECT_NEAR(r.value("Rx") + r.value("Cx"), -1, 1e-8) << name_of(method);
    EXPECT_NEAR(r.value("Ry") + r.value("Cy"), 20, 1e-8) << name_of(method);
    if (!std::holds_alternative<Penalty>(method)) {
      if (pull != 0) {
        EXPECT_NEAR(r.value("Cx"), pull, 1e-6) << "Uzawa's tolerance";
      }
      pull = r.value("Cx");
    }
  }
}

TEST(HardCases, AnInitialPenetrationIsPushedOutInAnyNumberOfSteps) {  // (C11)
  for (const auto& method : exact_methods())
    for (int steps : {1, 10}) {
      Scene s = scenes::stop(15, 1000, -0.01);
      s.legs = {{1, steps}};
      const auto r = run(s, method);
      EXPECT_NEAR(r.value("press"), 25, exact * 25) << name_of(method);
      EXPECT_NEAR(r.value("u"), -0.01, exact * 0.01);
    }
}

TEST(HardCases, JustTouchingToTheLastBitNeitherFlipsNorPushes) {  // (C12)
  std::mt19937 random(7);
  std::uniform_real_distribution<double> g0(0.001, 0.1), k(1, 1e4), bit(-1, 1);
  for (const auto& method : all_methods())
    for (int i = 0; i < 100; ++i) {
      const double gap = g0(random), stiffness = k(random), force = stiffness * gap * (1 + 1e-14 * bit(random));
      const auto s = run(scenes::stop(force, stiffness, gap), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method);
      EXPECT_LE(s.trajectory.increments.back().newton, 3) << name_of(method) << " " << force << " " << stiffness;
      EXPECT_LE(s.value("press"), 1e-12 * force) << name_of(method);
      EXPECT_NEAR(s.value("u"), gap, 1e-12 * gap);
    }
}

TEST(HardCases, BeyondTheEdgeOfAMasterThereIsNoGhostForce) {  // (C13; small strain: by the place at the start)
  for (const auto& method : exact_methods())
    for (double x : {0.9, 1.0, 1.1}) {
      Scene s;
      s.legs = {{1, 2}};
      s.bodies = {{"p", PointMesh{{x, 0.0}}, GroundedSpring{{{1000.0, 0.0}, {0.0, 1000.0}}}, "", 1.0}};
      s.obstacles = {{"ledge", Polyline{{{{0.0, 0.0}}, {{1.0, 0.0}}}}}};
      s.contacts = {contact("touch", "p.node", "ledge")};
      s.loads = {scenes::force("p.node", {0.0, -10.0})};
      s.responses = {response("press", Kind::contact_force, "touch", "normal"),
                     response("u", Kind::displacement, "p.node", "y")};
      const auto r = run(s, method);
      EXPECT_EQ(r.model.points.size(), x > 1 ? 0u : 1u);
      EXPECT_NEAR(r.value("press"), x > 1 ? 0 : 10, exact * 10) << x;
      EXPECT_NEAR(r.value("u"), x > 1 ? -0.01 : 0, exact * 0.01) << x;
    }
}

TEST(HardCases, ATinyFrictionIsNone) {  // (C20)
  for (const auto& method : all_methods()) {
    const auto none = run(scenes::greco_plate(8, 0), method);
    for (double mu : {1e-300, 1e-100, 1e-16, 1e-8}) {
      const auto s = run(scenes::greco_plate(8, mu), method);
      // a point at its apex sticks first, however small its friction, so that friction may hold a body: two more
      EXPECT_LE(s.trajectory.increments.back().newton, none.trajectory.increments.back().newton + 2)
          << name_of(method) << " " << mu;
      for (const char* name : {"u0", "u4", "reaction"})
        EXPECT_NEAR(s.value(name), none.value(name), (1e-12 + 10 * mu) * std::abs(none.value(name))) << mu;
      EXPECT_TRUE(std::isfinite(s.derivative("u0", "mu"))) << mu;
    }
  }
}

TEST(HardCases, AnIncrementInWhichNothingHappensChangesNothing) {  // (C21)
  for (const auto& method : all_methods()) {
    auto scene = scenes::slider({{0, 0}, {1, 0.1}, {2, 0.1}}, 4);
    const auto s = run(scene, method);
    ASSERT_EQ(s.trajectory.increments.size(), 4u);
    const auto &before = s.trajectory.increments[1], &after = s.trajectory.increments[3];
    EXPECT_LE(after.newton, 1) << name_of(method);
    if (after.newton == 0) {
      EXPECT_EQ(after.state.displacement, before.state.displacement) << "to the last bit";
    }
    for (const auto& r : scene.responses) {
      EXPECT_NEAR(s.value(r.name), s.value(r.name, 1), 1e-9 * std::abs(s.value(r.name)))
          << "1e3 times Newton's 1e-12: it moves by its own conditioning";
      for (const char* of : {"mu", "N", "k"})
        EXPECT_NEAR(s.derivative(r.name, of), s.derivative(r.name, of, 1),
                    1e-9 * std::max(1e-3, std::abs(s.derivative(r.name, of, 1))))
            << name_of(method) << " " << r.name << "/" << of;
    }
  }
}

TEST(HardCases, ASlaveAtTheCentreOfACircleIsRefusedForItFacesNoPlaceOfIt) {  // (C23)
  Scene s = scenes::stop();
  s.obstacles = {{"stop", Circle{{0.0, 0.0}, 1.0, true}, {}}};
  try {
    make_model(s);
    FAIL() << "no direction is nearer than another";
  } catch (const ModelError& error) {
    EXPECT_EQ(error.pointer, "/obstacles/stop/circle/center");
  }
}

TEST(HardCases, AWholeFaceThatLandsInOneStepLandsAtOnce) {  // (C33)
  for (const auto& method : all_methods()) {
    Scene s;
    s.legs = {{1, 1}};
    s.bodies = {box_body("upper", {0, 1.001}, {1, 2}, {8, 4}), box_body("lower", {0, 0}, {1, 1}, {8, 4})};
    s.contacts = {contact("touch", "upper.bottom", "lower.top")};
    s.supports = {support("lower.bottom", {{'y', table({{0, 0.0}})}}), support("upper.top", {{'y', ramp(-0.011)}})};
    for (const char* side : {"lower.left", "upper.left"})
      s.supports.push_back(support(side, {{'x', table({{0, 0.0}})}}));
    s.responses = {response("P", Kind::contact_force, "touch", "normal")};
    const auto r = run(s, method);
    const auto& last = r.trajectory.increments.back();
    EXPECT_LE(last.newton / std::max(1, last.augmentations), 4) << name_of(method);
    EXPECT_EQ(last.cutbacks, 0);
    for (ContactState state : last.state.contact.state) EXPECT_EQ(state, ContactState::slip) << "closed, frictionless";
    const double stress = 0.01 / 1.999 * 1000 / (1 - 0.09);
    EXPECT_NEAR(r.value("P"), stress, (std::holds_alternative<Penalty>(method) ? 1e-3 : 1e-7) * stress);
  }
}

TEST(HardCases, ABodyThatNothingHoldsButTheContactItIsAboutToMakeLands) {  // (C33, by its load)
  for (double gap : {1e-12, 1e-3, 0.3})
    for (const auto& method : all_methods()) {
      Scene s;
      s.legs = {{1, 1}};
      s.bodies = {box_body("upper", {0, 1 + gap}, {1, 2 + gap}, {8, 4}), box_body("lower", {0, 0}, {1, 1}, {8, 4})};
      s.contacts = {contact("touch", "upper.bottom", "lower.top")};
      s.contacts[0].friction = 0.3;
      s.supports = {support("lower.bottom", {{'y', table({{0, 0.0}})}}),
                    support("lower.left", {{'x', table({{0, 0.0}})}})};
      s.loads = {{"upper.top", Load::Kind::pressure, {10.0}, {}}};
      s.responses = {response("P", Kind::contact_force, "touch", "normal"),
                     response("fall", Kind::displacement, "upper.top", "y")};
      const auto r = run(s, method);
      const auto& last = r.trajectory.increments.back();
      EXPECT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << gap << r.trajectory.message;
      EXPECT_EQ(last.cutbacks, 0);
      EXPECT_LE(last.history[0].open, 9);
      const auto first = std::count_if(last.history.begin(), last.history.end(),
                                       [](const IterationRecord& i) { return i.augmentation <= 1; });
      EXPECT_LE(first, 6) << name_of(method) << gap;  // with the start: one to land, one or two to stick, one to see it
      for (ContactState state : last.state.contact.state) EXPECT_EQ(state, ContactState::stick);
      EXPECT_NEAR(r.value("P"), 10, 1e-10 * 10);  // the load, whatever the method
      // two blocks of height 1 in plane strain, free to widen alike
      const double fall = gap + 2 * 10 * (1 - 0.09) / 1000;
      EXPECT_NEAR(r.value("fall"), -fall, (std::holds_alternative<Penalty>(method) ? 1e-3 : 1e-9) * fall);
    }
}

TEST(HardCases, ABodyThatNothingPressesSlidesWithoutTraction) {
  // (all forces of a penalty are rounding then, which has nothing to be measured by: not in every step count)
  for (const auto& method : exact_methods())
    for (int steps : {1, 2, 7}) {
      Scene s;
      s.legs = {{1, steps}};
      s.bodies = {box_body("block", {0, 0}, {4, 2}, {4, 2})};
      s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
      s.contacts = {contact("sole", "block.bottom", "floor")};
      s.contacts[0].friction = 0.3;
      s.supports = {support("block.left", {{'x', ramp(0.001)}})};
      s.responses = {response("press", Kind::contact_force, "sole", "normal"),
                     response("u", Kind::displacement, "block.right", "x")};
      const auto r = run(s, method);
      EXPECT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << steps << r.trajectory.message;
      EXPECT_NEAR(r.value("press"), 0, 1e-10 * 1000 * 0.001) << "of E u, what a unit depth could bear";
      EXPECT_NEAR(r.value("u"), 0.001, 1e-10);
    }
}

TEST(HardCases, APointThatSupportsDriveIntoAnObstacleIsNamed) {  // (C8)
  Scene s;
  s.legs = {{1, 1}};
  s.bodies = {box_body("block", {0, 0}, {4, 2}, {4, 2})};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  s.contacts = {contact("sole", "block.bottom", "floor")};
  s.supports = {support("block.top", {{'x', table({{0, 0.0}})}}), support("block.bottom", {{'y', ramp(-0.001)}})};
  s.responses = {response("press", Kind::contact_force, "sole", "normal")};
  for (const auto& method : exact_methods()) {
    const auto r = run(s, method);
    EXPECT_EQ(r.trajectory.status, Status::infeasible) << name_of(method) << r.trajectory.message;
    EXPECT_NE(r.trajectory.message.find("sole at (0, 0) penetrates by 0.001, and supports prescribe"),
              std::string::npos)
        << r.trajectory.message;
  }
}

}  // namespace
}  // namespace stickslip
