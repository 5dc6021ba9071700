/// Each response on states made by hand, the nodal balance, and the half width of Hertz's pressure.
#include "core/model/response.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/model/contact_assembly.hpp"
#include "tests/support/compiled_slots.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::response_test {
namespace {

using scenes::response;
using Kind = Response::Kind;
using Take = Response::Take;
constexpr double epsilon = std::numeric_limits<double>::epsilon();
/// Sums of a few terms of the size of the result.
constexpr double few = 10 * epsilon;

/// A block [0, 4] x [0, 1] of 4 x 1 cells on a rough floor, its left side held along x.
struct Block {
  Scene scene;
  Model model;
  Slots<double> slots;
  State<double> state;
};
Block block(std::vector<Response> responses, std::array<double, 2> floor_normal = {0, 1}) {
  Block b;
  b.scene.legs = {{1, 1}};
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {4.0, 1.0};
  box.cells = {4, 1};
  b.scene.bodies = {{"block", box, LinearElastic{1000.0, 0.3}, "", 1.0}};
  b.scene.obstacles = {{"floor", Plane{{0.0, 0.0}, {floor_normal[0], floor_normal[1]}}, {}}};
  b.scene.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  b.scene.contacts[0].friction = 0.3;
  b.scene.supports = {scenes::support("block.left", {{'x', scenes::table({{0, 0.0}})}})};
  b.scene.responses = std::move(responses);
  b.model = make_model(b.scene);
  b.slots = make_slots<double>(b.model, b.scene.as<double>());
  b.state = initial_state<double>(b.model, b.slots);
  return b;
}

/// The first response at the block's state.
double first(const Block& b) { return evaluate_responses(b.model, b.slots, b.state, 1.0)[0]; }

/// The same model, in which nothing has the name that the scene gave it.
Model without_names(Model model) {
  for (auto& body : model.scene.bodies) body.name.clear();
  for (auto& obstacle : model.scene.obstacles) obstacle.name.clear();
  for (auto& contact : model.scene.contacts) contact.name = contact.slave = contact.master = "";
  for (auto& load : model.scene.loads) load.on.clear();
  for (auto& support : model.scene.supports) support.on.clear();
  for (auto& response : model.scene.responses) response.name = response.on = "";
  for (auto& body : model.bodies) body.mesh.sides.clear();
  return model;
}

TEST(Names, AreResolvedOnce) {
  Block b = block({response("u", Kind::displacement, "block.right", "x", Take::max),
                   response("pull", Kind::reaction, "block.left", "x"),
                   response("press", Kind::contact_force, "sole", "normal"),
                   response("half", Kind::contact_half_width, "sole"), response("slip", Kind::slip, "sole"),
                   response("heat", Kind::dissipation, "sole"), response("energy", Kind::strain_energy, "")});
  b.scene.loads = {scenes::force("block.top", {1.0, -2.0}), {"block", Load::Kind::body_force, {0.5, -3.0}, {}}};
  b.model = make_model(b.scene);
  const Model nameless = without_names(b.model);
  const auto numbers = b.scene.as<double>();
  b.slots = make_slots<double>(b.model, numbers);
  const auto slots = make_slots<double>(nameless, numbers);
  b.state.displacement = Vector<double>::LinSpaced(b.model.dof_count(), 0.1, 0.3);
  b.state.history.placement.setConstant(0.25);
  b.state.history.work[0] = 0.7;
  for (const auto& point : b.model.points) b.state.contact.traction[point.multiplier] = -2;
  const auto values = evaluate_responses(b.model, b.slots, b.state, 1.0);
  EXPECT_TRUE((values.array().abs() > 0).all());
  EXPECT_EQ(evaluate_responses(nameless, slots, b.state, 1.0), values);
  EXPECT_EQ(dead_forces(nameless, slots, 1.0), dead_forces(b.model, b.slots, 1.0));
}

TEST(DisplacementResponse, TakesMeanLargestAndSmallestOfASide) {
  for (const auto& [take, expected] : {std::pair{Take::mean, 0.25}, {Take::max, 0.8}, {Take::min, -0.3}}) {
    auto b = block({response("u", Kind::displacement, "block.right", "y", take)});
    b.state.displacement[2 * 4 + 1] = -0.3;  // the two nodes of the right side
    b.state.displacement[2 * 9 + 1] = 0.8;
    EXPECT_NEAR(first(b), expected, few);
  }
}

TEST(DisplacementResponse, InterpolatesAtAPoint) {
  auto u = response("u", Kind::displacement, "", "x");
  u.at = {1.25, 0.5};
  auto b = block({u});
  for (int node = 0; node < 10; ++node)
    b.state.displacement[2 * node] = 2.0 * (node % 5) + 3 * (node / 5);  // 2 x + 3 y
  EXPECT_NEAR(first(b), 2 * 1.25 + 3 * 0.5, few * 4);
}

TEST(ContactForceResponse, IsPositiveInCompressionAndPointsOutOfTheFloorOnTheSlave) {
  for (const auto& [component, expected] : {std::pair{"normal", 8.0}, {"y", 8.0}, {"x", 2.0}}) {
    auto b = block({response("f", Kind::contact_force, "sole", component)});
    for (const auto& point : b.model.points) {
      b.state.contact.traction[point.multiplier] = -2;
      b.state.contact.traction[point.multiplier + 1] = 0.5;  // along e = (-1, 0); the slave feels the reverse
    }
    EXPECT_NEAR(first(b), expected, 8 * few) << component;
  }
}

TEST(PressureAndGapResponses, AreMeansByAreaAndExtremes) {
  const double values[] = {1, 2, 3, 3, 6};  // areas 1/2 1 1 1 1/2: their mean is 11.5 / 4
  const struct {
    Kind kind;
    Take take;
    double expected;
  } cases[] = {{Kind::contact_pressure, Take::mean, 2.875},
               {Kind::contact_pressure, Take::max, 6},
               {Kind::contact_pressure, Take::min, 1},
               {Kind::gap, Take::mean, 0.2875},
               {Kind::gap, Take::max, 0.6},
               {Kind::gap, Take::min, 0.1}};
  for (const auto& c : cases) {
    auto b = block({response("r", c.kind, "sole", "", c.take)});
    for (std::size_t p = 0; p < b.model.points.size(); ++p) {
      b.state.contact.traction[b.model.points[p].multiplier] = -values[p];
      b.state.contact.gap[p] = 0.1 * values[p];
    }
    EXPECT_NEAR(first(b), c.expected, few);
  }
}

TEST(PressureResponse, AtAPointIsThatOfTheNearestContactPoint) {
  auto p = response("p", Kind::contact_pressure, "sole");
  p.at = {2.9, 0.0};
  auto b = block({p});
  for (std::size_t i = 0; i < 5; ++i) b.state.contact.traction[b.model.points[i].multiplier] = -1.0 - i;
  EXPECT_EQ(first(b), 4);  // the node at x = 3
}

TEST(SlipResponse, IsAlongItsTangentOrAnAxis) {
  for (const auto& [component, expected] : {std::pair{"", 0.25}, {"x", -0.25}, {"y", 0.0}}) {
    auto b = block({response("s", Kind::slip, "sole", component)});
    b.state.history.placement.setConstant(0.25);  // along e = (-1, 0)
    EXPECT_NEAR(first(b), expected, few) << component;
  }
}

TEST(DissipationResponse, IsThatOfItsContact) {
  auto b = block({response("heat", Kind::dissipation, "sole")});
  b.state.history.work[0] = 0.7;
  EXPECT_EQ(first(b), 0.7);
}

TEST(StrainEnergyResponse, IsThatOfAUniformStretch) {
  auto b = block({response("W", Kind::strain_energy, "")});
  const double stretch = 1e-3, E = 1000, nu = 0.3;
  for (int node = 0; node < 10; ++node) b.state.displacement[2 * node] = stretch * (node % 5);
  const double modulus = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
  EXPECT_NEAR(first(b), 0.5 * modulus * stretch * stretch * 4, 10 * few * first(b));  // forces that cancel inside
}

TEST(ReactionResponse, IsTheForceOfTheSupportOnTheBodyOverItsSide) {
  auto b =
      block({response("pull", Kind::reaction, "block.left", "x"), response("up", Kind::reaction, "block.left", "y")});
  const double stretch = 1e-3, E = 1000, nu = 0.3;
  for (int node = 0; node < 10; ++node) b.state.displacement[2 * node] = stretch * (node % 5);
  const double modulus = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
  EXPECT_NEAR(first(b), -modulus * stretch, 20 * few * modulus * stretch);  // stretched to the right, held to the left
  EXPECT_EQ(evaluate_responses(b.model, b.slots, b.state, 1.0)[1], 0);      // nothing holds it along y
}

TEST(Responses, OfAContactWithoutPointsAreZero) {
  auto b = block({response("f", Kind::contact_force, "sole", "normal"), response("p", Kind::contact_pressure, "sole"),
                  response("a", Kind::contact_half_width, "sole")});
  b.model.points.clear();
  for (auto& place : b.model.response_places) place.points.clear();
  EXPECT_TRUE(evaluate_responses(b.model, b.slots, b.state, 1.0).isZero(0));
}

TEST(NodalBalance, IsInternalForceMinusLoadPlusContact) {
  const Scene scene = scenes::stop(15, 1000, 0.01);
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  auto state = initial_state<double>(model, slots);
  state.displacement[1] = 0.01;
  state.contact.traction[0] = -5;  // F - k g0
  const auto balance = nodal_balance(model, slots, state, 1.0);
  EXPECT_NEAR(balance[1], 0, 15 * few);    // in equilibrium
  EXPECT_NEAR(balance[3], -10, 15 * few);  // the anchor holds the spring back
}

TEST(NodalBalance, OfTwoBodiesAddsUpToTheReverseOfTheLoad) {
  auto scene = scenes::two_boxes(5, 7);
  scene.loads = {scenes::traction("upper.left", {3.0, -2.0})};
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  auto state = initial_state<double>(model, slots);
  state.displacement = 0.01 * derivatives::arbitrary(model.dof_count());
  state.contact.traction = derivatives::arbitrary(model.multiplier_count, 2);
  const Vector<double> sum = nodal_balance(model, slots, state, 1.0).reshaped(2, model.node_count).rowwise().sum();
  // forces up to E times 0.01 that cancel, some three hundred of them
  EXPECT_NEAR(sum[0], -3, 300 * epsilon * 30);
  EXPECT_NEAR(sum[1], 2, 300 * epsilon * 30);
}

/// Half width of Hertz's pressure p0 sqrt(1 - ((x - middle)/a)^2) on a level side of `cells` cells.
double half_width_of_hertz(int cells, double a, double middle, double p0) {
  Scene scene;
  scene.legs = {{1, 1}};
  BoxMesh box;
  box.min = {middle - 2 * a, 0.0};
  box.max = {middle + 2 * a, 1.0};
  box.cells = {cells, 1};
  scene.bodies = {{"block", box, LinearElastic{1000.0, 0.3}, "", 1.0}};
  scene.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  scene.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  scene.responses = {response("a", Kind::contact_half_width, "sole")};
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  auto state = initial_state<double>(model, slots);
  for (const auto& point : model.points) {
    const double x = (slots.points(0, point.nodes[0]) - middle) / a;
    state.contact.traction[point.multiplier] = -p0 * std::sqrt(std::max(0.0, 1 - x * x));
  }
  return evaluate_responses(model, slots, state, 1.0)[0];
}

TEST(HalfWidth, IsHertzsForHisPressureAndConvergesToIt) {
  const double coarse = std::abs(half_width_of_hertz(40, 1, 0, 1) - 1),
               fine = std::abs(half_width_of_hertz(640, 1, 0, 1) - 1);
  EXPECT_LE(coarse, 0.05);
  EXPECT_LE(fine, coarse / 16);  // at least h^1: the trapezoidal rule at a square root has h^1.5
}

TEST(HalfWidth, ScalesWithLengthAloneWhereverTheContactIs) {
  const double reference = half_width_of_hertz(40, 1, 0, 1);
  EXPECT_NEAR(half_width_of_hertz(40, 1, 0, 1e6), reference, 100 * epsilon);
  EXPECT_NEAR(half_width_of_hertz(40, 1e-3, 0, 1), 1e-3 * reference, 1e-3 * 100 * epsilon);
  EXPECT_NEAR(half_width_of_hertz(40, 1, 7, 1), reference, 1e-13);  // coordinates of 7 around a width of 1
}

TEST(HalfWidth, IsMeasuredAcrossTheNormalOfTheContact) {
  // the same block before a tilted floor: arms, from a corner, are shortened by the cosine
  auto a = response("a", Kind::contact_half_width, "sole");
  a.about = {0.0, 0.0};
  auto level = block({a}), tilted = block({a}, {0.6, 0.8});
  for (auto* b : {&level, &tilted})
    for (const auto& point : b->model.points) b->state.contact.traction[point.multiplier] = -1;
  EXPECT_NEAR(first(tilted), 0.8 * first(level), few * first(level));
}

TEST(HalfWidth, IsANumberWherePressuresAreRoundingOfEitherSign) {
  auto b = block({response("a", Kind::contact_half_width, "sole")});
  const double pressures[] = {-1, 1, 1, 1, -1};  // their second moment is negative
  for (std::size_t p = 0; p < b.model.points.size(); ++p)
    b.state.contact.traction[b.model.points[p].multiplier] = -1e-12 * pressures[p];
  EXPECT_EQ(first(b), 0);
}

TEST(HalfWidth, IsZeroWithAFiniteDerivativeWhereOneNodeOrNoneTouches) {
  auto b = block({response("a", Kind::contact_half_width, "sole")});
  const auto slots = make_slots<Direction>(b.model, b.scene.as<Direction>());
  for (double pressure : {0.0, 2.0}) {
    auto state = initial_state<Direction>(b.model, slots);
    state.contact.traction[b.model.points[2].multiplier] = Direction(-pressure, Direction::Gradient(0.5));
    const auto a = evaluate_responses(b.model, slots, state, 1.0)[0];
    EXPECT_EQ(a.v, 0);
    EXPECT_TRUE(std::isfinite(a.d[0])) << pressure;
  }
}

}  // namespace
}  // namespace stickslip::response_test
