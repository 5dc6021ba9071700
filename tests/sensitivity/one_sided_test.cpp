/// Derivatives at ties: one from below and one from above, by every method, against closed forms.
#include "sensitivity/one_sided.hpp"

#include <gtest/gtest.h>

#include "sensitivity/sided_geometry.hpp"
#include "tests/support/solved.hpp"
#include "tests/support/solved_run.hpp"

namespace stickslip::one_sided_test {
namespace {

using namespace scenes;

struct Sides {
  Scene scene;
  std::optional<OneSided> of;
  long factorizations = 0;

  /// {backward, forward} at increment n.
  std::pair<double, double> at(const std::string& response, const std::string& parameter, std::size_t n = 0) const {
    const auto i =
        std::find_if(scene.responses.begin(), scene.responses.end(), [&](auto& r) { return r.name == response; }) -
        scene.responses.begin();
    const auto j =
        std::find_if(scene.parameters.begin(), scene.parameters.end(), [&](auto& p) { return p.name == parameter; }) -
        scene.parameters.begin();
    return {of->backward[n](i, j), of->forward[n](i, j)};
  }
};

Sides sides(const Scene& scene, const Method& method) {
  SolvedRun run(scene, method);
  EXPECT_TRUE(is_converged(run.trajectory.status)) << run.trajectory.message;
  return {scene, run.both_sides()};
}

std::vector<Method> exact_methods() {
  UzawaAL uzawa;
  uzawa.tolerance = 1e-12;
  return {MonolithicAL{}, uzawa};
}

constexpr double rounding = 1e-9;  // of derivatives of order 1, by chains of a few unknowns

void expect_sides(const std::pair<double, double>& found, double backward, double forward, double size) {
  EXPECT_NEAR(found.first, backward, rounding * size);
  EXPECT_NEAR(found.second, forward, rounding * size);
}

TEST(OneSided, OfASpringThatJustTouchesItsStop) {
  for (const auto& method : exact_methods()) {
    const auto s = sides(stop(10, 1000, 0.01), method);
    ASSERT_TRUE(s.of) << name_of(method);
    expect_sides(s.at("u", "F"), 1e-3, 0, 1e-3);
    expect_sides(s.at("press", "F"), 0, 1, 1);
    expect_sides(s.at("u", "g0"), 1, 0, 1);  // the wall comes nearer, or goes away
    expect_sides(s.at("press", "g0"), -1000, 0, 1000);
    expect_sides(s.at("u", "k"), 0, -1e-5, 1e-5);  // a stiffer spring lets go
  }
}

TEST(OneSided, OfThePenaltyMethodArePenalised) {
  const double eps = 1e4;
  const auto s = sides(stop(10, 1000, 0.01), Penalty{absolute(eps)});
  ASSERT_TRUE(s.of);
  expect_sides(s.at("u", "F"), 1e-3, 1 / (1000 + eps), 1e-3);
  expect_sides(s.at("press", "F"), 0, eps / (1000 + eps), 1);
}

TEST(OneSided, OfABlockOnItsConeCarryTheirHistoryOn) {
  // the anchor goes to the edge of slip, U = mu N / k = 0.03, and back to 0.02, where the block sticks
  for (const auto& method : exact_methods()) {
    const auto s = sides(slider({{0, 0}, {1, 0.03}, {2, 0.02}}, 2), method);
    ASSERT_TRUE(s.of) << name_of(method);
    expect_sides(s.at("u", "U0", 0), 0, 1, 1);
    expect_sides(s.at("u", "mu", 0), -0.1, 0, 0.1);
    expect_sides(s.at("heat", "U0", 0), 0, 3, 3);
    expect_sides(s.at("u", "U0", 1), 0, 1, 1);  // what slipped stays, on one side alone
    expect_sides(s.at("u", "mu", 1), -0.1, 0, 0.1);
    expect_sides(s.at("pull", "U0", 1), 100 * 2.0 / 3, 100 * (2.0 / 3 - 1), 100);
  }
}

TEST(OneSided, AgreeWhereATieChangesNothing) {
  // slip to 0.06, then an increment in which nothing moves: the point lies on its cone without slipping
  for (const auto& method : exact_methods()) {
    const auto s = sides(slider({{0, 0}, {1, 0.06}, {2, 0.06}}, 2), method);
    ASSERT_TRUE(s.of) << name_of(method);
    for (std::size_t n : {0u, 1u}) {
      expect_sides(s.at("u", "U0", n), 1, 1, 1);
      expect_sides(s.at("u", "mu", n), -0.1, -0.1, 0.1);
    }
  }
}

TEST(OneSided, OfTwoPointsAtOnceFlipBoth) {
  // two springs under one load each reach their stops together
  Scene s = stop(10, 1000, 0.01);
  s.bodies.push_back(s.bodies[0]);
  s.bodies[1].name = "other";
  s.contacts.push_back(s.contacts[0]);
  s.contacts[1].name = "second";
  s.contacts[1].slave = "other.node";
  s.loads.push_back(s.loads[0]);
  s.loads[1].on = "other.node";
  s.responses.push_back(response("press2", Response::Kind::contact_force, "second", "normal"));
  for (const auto& method : exact_methods()) {
    const auto found = sides(s, method);
    ASSERT_TRUE(found.of) << name_of(method);
    expect_sides(found.at("press", "F"), 0, 1, 1);
    expect_sides(found.at("press2", "F"), 0, 1, 1);
    expect_sides(found.at("u", "F"), 1e-3, 0, 1e-3);
  }
}

TEST(OneSided, OfATruncatedLoopAreThoseOfTheLoop) {
  // the first solve finds the tie, and nothing is left to update: one pass, of the penalised problem
  UzawaAL loop;
  loop.sensitivity = UzawaAL::Sensitivity::truncated;
  loop.scale = absolute(3000);
  loop.adapt = false;
  const double theta = 1000.0 / (1000 + 3000);
  const auto s = sides(stop(10, 1000, 0.01), loop);
  ASSERT_TRUE(s.of);
  expect_sides(s.at("u", "F"), 1e-3, theta * 1e-3, 1e-3);
  expect_sides(s.at("press", "F"), 0, 1 - theta, 1);
}

TEST(OneSided, OfAPointThatJustRestsWithoutAForce) {
  // nothing has moved, nothing presses: the floor at a gap of zero is a tie all the same
  for (const auto& method : exact_methods()) {
    const auto s = sides(stop(0, 1000, 0), method);
    ASSERT_TRUE(s.of) << name_of(method);
    expect_sides(s.at("u", "F"), 1e-3, 0, 1e-3);
    expect_sides(s.at("press", "F"), 0, 1, 1);
  }
}

/// A point of stiffness one, in the plane or in space, that just touches a rough floor.
Scene at_its_apex(std::vector<Number> push, double mu) {
  const auto D = push.size();
  Scene s;
  s.legs = {{1, 1}};
  s.space = D == 3 ? Space::solid : Space::plane_strain;
  GroundedSpring spring;
  for (std::size_t i = 0; i < D; ++i) {
    spring.stiffness.emplace_back(D, 0.0);
    spring.stiffness[i][i] = 1.0;
  }
  std::vector<Number> normal(D, 0.0);
  normal.back() = 1.0;
  s.parameters = {{"load", {}, "/load", 0}};
  for (Number& x : push) {
    if (x.value == 0) continue;
    s.parameters[0].slots.emplace_back(static_cast<int>(s.numbers.size()), x.value);
    s.numbers.push_back(0);
    s.pointers.push_back("/push" + std::to_string(s.numbers.size()));
    x = Number(0.0, static_cast<int>(s.numbers.size()) - 1);
  }
  s.bodies = {{"p", PointMesh{std::vector<Number>(D, 0.0)}, spring, "", 1.0}};
  s.obstacles = {{"floor", Plane{std::vector<Number>(D, 0.0), normal}, {}}};
  s.contacts = {contact("sole", "p.node", "floor")};
  s.contacts[0].friction = mu;
  s.loads = {force("p.node", push)};
  s.responses = {response("x", Response::Kind::displacement, "p.node", "x"),
                 response("y", Response::Kind::displacement, "p.node", "y"),
                 response("z", Response::Kind::displacement, "p.node", D == 3 ? "z" : "y")};
  return s;
}

TEST(OneSided, OfAPointAtTheApexOfItsCone) {
  for (const auto& method : exact_methods()) {
    // pressed by 2 and pushed by 3: friction .5 takes 1 of it, slipping; lifted it moves freely
    const auto slips = sides(at_its_apex({3.0, -2.0}, 0.5), method);
    ASSERT_TRUE(slips.of) << name_of(method);
    expect_sides(slips.at("x", "load"), 3, 2, 1);
    expect_sides(slips.at("y", "load"), -2, 0, 1);
    const auto sticks = sides(at_its_apex({-0.5, -2.0}, 0.5), method);
    expect_sides(sticks.at("x", "load"), -0.5, 0, 1);
    // in space it slips along the push (3, 4): 5 of force less 1 of friction
    const auto space = sides(at_its_apex({3.0, 4.0, -2.0}, 0.5), method);
    expect_sides(space.at("x", "load"), 3, 3 * 4.0 / 5, 1);
    expect_sides(space.at("y", "load"), 4, 4 * 4.0 / 5, 1);
    expect_sides(space.at("z", "load"), -2, 0, 1);
  }
}

TEST(OneSided, OfAPointOnAVertexThatItsMasterMovesHaveNone) {
  // on a corner the normal jumps as soon as the vertex moves along; on a straight line nothing does
  for (double rise : {0.0, -0.5}) {
    Scene s = stop(0, 1000, 0);
    const Number along = parameter(s, "along", 0);
    s.loads[0] = force("block.node", {0.0, -5.0});
    s.obstacles = {{"stop", Polyline{{{-1.0, 0.0}, {along, 0.0}, {1.0, rise}}}, {}}};
    const auto found = sides(s, MonolithicAL{});
    if (rise == 0) {
      // (straight: it faces the one facet or the other, of the same normal)
      ASSERT_TRUE(found.of);
      expect_sides(found.at("u", "along"), 0, 0, 1);
      continue;
    }
    ASSERT_TRUE(found.of);
    EXPECT_TRUE(std::isnan(found.at("u", "along").first) || std::isnan(found.at("u", "along").second));
  }
}

TEST(OneSided, OfAPointOnAVertexThatRisesAreThoseOfEitherFacet) {
  // The vertex moves along (1, 1) on a straight line: the point then lies on the facet behind it, which rises, or, the
  // other way, on the one before it, which falls. The line is as high under it on both sides; its slope s is not:
  // k u_x' = -N s' and u_y' = 1 + s' u_x, with N = 5 and s' = 1 forward, -1 backward.
  constexpr double k = 1000, along = 3, press = 5;
  Scene s = stop(0, k, 0);
  const Number moved = parameter(s, "moved", 0);
  s.loads[0] = force("block.node", {along, -press});
  s.obstacles = {{"stop", Polyline{{{-1.0, 0.0}, {moved, moved}, {1.0, 0.0}}}, {}}};
  s.responses = {response("u", Response::Kind::displacement, "block.node", "x"),
                 response("v", Response::Kind::displacement, "block.node", "y")};
  for (const auto& method : exact_methods()) {
    const auto found = sides(s, method);
    ASSERT_TRUE(found.of) << name_of(method);
    expect_sides(found.at("u", "moved"), press / k, -press / k, press / k);
    expect_sides(found.at("v", "moved"), 1 - along / k, 1 + along / k, 1);
  }
}

TEST(OneSided, OfAPointWhereTheCurvatureJumpsAreThoseOfEitherPatch) {
  // A Catmull-Rom curve that is level at the vertex below the point, straight before it, and bent by y'' = 0.3 behind.
  // As the vertex moves on by h, the point is before it, where the curve is level; as it moves back, the point is
  // behind it, on the slope 0.3 |h|. As above, k u_x' = -N s' and u_y' = s' u_x.
  constexpr double k = 1000, along = 3, press = 5, bend = 0.3;
  Scene s = stop(0, k, 0);
  const Number moved = parameter(s, "moved", 0);
  s.loads[0] = force("block.node", {along, -press});
  s.obstacles = {{"stop", Polyline{{{-2.0, -0.3}, {-1.0, -0.05}, {moved, 0.0}, {1.0, -0.05}, {2.0, -0.6}}}, {}}};
  s.contacts[0].smoothing = Smoothing::catmull_rom;
  s.responses = {response("u", Response::Kind::displacement, "block.node", "x"),
                 response("v", Response::Kind::displacement, "block.node", "y")};
  for (const auto& method : exact_methods()) {
    const auto found = sides(s, method);
    ASSERT_TRUE(found.of) << name_of(method);
    expect_sides(found.at("u", "moved"), bend * press / k, 0, press / k);
    expect_sides(found.at("v", "moved"), -bend * along / k, 0, 1);
  }
}

TEST(OneSided, OfMatchingNodesFaceTheFacetThatTheyMoveTo) {
  Scene s;
  s.legs = {{1, 1}};
  BoxMesh upper, lower;
  upper.min = {parameter(s, "along", 0.0), 1.0};  // the nodes between move by the rest of their way to 1
  upper.max = {1.0, 2.0};
  upper.cells = {4, 1};
  lower.min = {0.0, 0.0};
  lower.max = {1.0, 1.0};
  lower.cells = {4, 1};
  s.bodies = {{"upper", upper, LinearElastic{1.0, 0.3}, "", 1.0}, {"lower", lower, LinearElastic{1.0, 0.3}, "", 1.0}};
  s.contacts = {contact("touch", "upper.bottom", "lower.top")};
  const Model model = make_model(s);
  const auto places = make_slots<double>(model, s.as<double>()).points;
  for (const int side : {-1, 1}) {
    const auto pairing = sided_pairing(model, 0, side);
    EXPECT_TRUE(pairing.kink);
    int between = 0;
    for (const auto& point : pairing.points) {
      const double x = places(0, point.nodes[0]);
      if (x < 0.1 || x > 0.9) continue;
      ++between;
      double farthest = 0;  // on the side that the point moves to
      for (std::size_t n = 1; n < point.nodes.size(); ++n) {
        const double way = side * (places(0, point.nodes[n]) - x);
        EXPECT_GE(way, -1e-12) << x << " " << side;
        farthest = larger(farthest, way);
      }
      EXPECT_NEAR(farthest, 0.25, 1e-12) << x << " " << side;
    }
    EXPECT_EQ(between, 3);
  }
}

TEST(OneSided, AreNotComputedWhereNoPointIsWeak) {
  for (const auto& method : exact_methods()) EXPECT_FALSE(sides(two_boxes(6, 9), method).of) << name_of(method);
}

}  // namespace
}  // namespace stickslip::one_sided_test
