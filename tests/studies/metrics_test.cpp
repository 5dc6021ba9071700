/// The method-blind error of states that are made by hand: what each component of it counts, to the last digit.
#include "studies/run/metrics.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/studies/made_states.hpp"

namespace stickslip {
namespace {

using made_states::Made;
using made_states::one_point;
using made_states::Point;
using scenes::contact;

constexpr double rounding_of_metrics = 1e-14;  // a few roundings of numbers of size one

void expect_only(const KktError& e, double KktError::*component, double wanted) {
  for (double KktError::*each : {&KktError::equilibrium, &KktError::gap, &KktError::complementarity, &KktError::cone,
                                 &KktError::stick, &KktError::slip_direction})
    EXPECT_NEAR(e.*each, each == component ? wanted : 0, rounding_of_metrics * std::max(1.0, wanted));
  EXPECT_NEAR(e.largest(), wanted, rounding_of_metrics * std::max(1.0, wanted));
}

TEST(Metrics, AreZeroOfABodyThatRests) {
  Point made;
  made.rest();
  expect_only(made.errors()[0], &KktError::gap, 0);
}

TEST(Metrics, EquilibriumIsWhatNothingBalancesOverTheLargestForce) {
  Point made;
  auto& state = made.rest();
  // spring (3, -2), less the load (0, -10), contact (-2, -7): (1, 1) is left
  state.displacement << 0.03, -0.01, 0, 0;
  state.contact.traction << -7, 2;
  EXPECT_NEAR(made.errors()[0].equilibrium, std::sqrt(2.0) / 10, rounding_of_metrics);
}

TEST(Metrics, EquilibriumCountsNoForceThatASupportTakes) {
  Scene scene = one_point();
  scene.supports = {scenes::support("a.node", {{'x', scenes::table({{0, 0.0}})}})};
  Made made(scene);
  auto& state = made.next();
  state.displacement << 0.03, -0.01, 0, 0;
  state.contact.traction << -7, 2;
  EXPECT_NEAR(made.errors()[0].equilibrium, 1.0 / 10, rounding_of_metrics);
}

/// A stiff body that its support carries a thousand lengths away could make forces of 1e9. A load of 1e-3, more than
/// their rounding, is what errors are measured by all the same.
TEST(Metrics, EquilibriumIsMeasuredByALoadHoweverSmall) {
  Scene scene = one_point();
  scene.bodies.push_back({"b", PointMesh{{3.0, 0.0}}, GroundedSpring{{{1e6, 0.0}, {0.0, 1e6}}}, "", 1.0});
  scene.loads[0].history = scenes::table({{0, 1e-4}, {4, 1e-4}});
  Made made(scene);
  auto& state = made.next();
  state.displacement << 0, 0, 0, 0, 1e3, 0, 1e3, 0;
  EXPECT_NEAR(made.errors()[0].equilibrium, 1, rounding_of_metrics);
}

TEST(Metrics, EquilibriumTakesTheWorstNodeAndTheLoadOfItsTime) {
  Scene scene = one_point();
  scene.bodies.push_back({"b", PointMesh{{3.0, 0.0}}, GroundedSpring{{{1.0, 0.0}, {0.0, 1.0}}}, "", 1.0});
  scene.loads[0].history = scenes::table({{0, 0.0}, {4, 4.0}});
  Made made(scene);
  for (int n = 1; n <= 2; ++n) {
    auto& state = made.next();
    state.displacement << 0, -0.04 * n, 0, 0, 0, 3, 0, 0;  // a misses (0, 2 n), b (0, 3)
  }
  const auto errors = made.errors();
  EXPECT_NEAR(errors[0].equilibrium, 3.0 / 10, rounding_of_metrics);
  EXPECT_NEAR(errors[1].equilibrium, 4.0 / 20, rounding_of_metrics);
}

TEST(Metrics, GapIsPenetrationOverTheLargestRelativeDisplacement) {
  Scene scene = one_point();
  scene.contacts[0].offset = 0.25;
  scene.loads.clear();
  Made made(scene);
  auto& state = made.next();
  state.contact.gap << -0.05;  // it came down by 0.3
  state.history.placement << 0.4;
  expect_only(KktError{0, made.errors()[0].gap}, &KktError::gap, 0.05 / 0.5);
  state.contact.gap << 0.05;  // open by as much
  state.history.placement << 0.15;
  EXPECT_EQ(made.errors()[0].gap, 0);
}

TEST(Metrics, GapIsMeasuredByTheElasticDisplacementOfTheTractionsToo) {
  Point made;
  auto& state = made.rest();
  state.contact.gap << -0.01;
  EXPECT_NEAR(made.errors()[0].gap, 0.01 / (10.0 / 200), rounding_of_metrics);
}

/// A bar along a floor, of two cells of length 1 and EA = 1000, hence areas 1/2, 1, 1/2 and stiffnesses (the mean of
/// those along and across) 500, 1000, 500.
Scene bar() {
  Scene s;
  s.legs = {{1, 1}};
  s.bodies = {{"bar", LineMesh{{0.0, 0.0}, {2.0, 0.0}, 2}, LinearElastic{1000, 0.0}, "bar", 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  s.contacts = {contact("sole", "bar.nodes", "floor")};
  s.contacts[0].friction = 0.5;
  return s;
}

TEST(Metrics, WeighTractionsWithAreaAndStiffness) {
  Made made(bar());
  EXPECT_NEAR(made.slots.geometry[0].area, 0.5, rounding_of_metrics);
  EXPECT_NEAR(made.slots.geometry[1].area, 1, rounding_of_metrics);
  EXPECT_NEAR(made.slots.stiffness[0], 500, 1e-10);
  EXPECT_NEAR(made.slots.stiffness[1], 1000, 1e-10);
  auto& state = made.next();
  state.contact.traction << -20, 0, -8, 0, 0, 0;
  state.contact.gap << 0, 0, -0.001;
  const auto e = made.errors()[0];
  EXPECT_NEAR(e.equilibrium, 1, rounding_of_metrics);                 // nothing balances the force, 0.5 * 20
  EXPECT_NEAR(e.gap, 0.001 / (0.5 * 20 / 500), rounding_of_metrics);  // length: A t / k = 0.02
  EXPECT_NEAR(e.complementarity, 0.001 * 500 / 0.5 / 20, rounding_of_metrics);
}

TEST(Metrics, ComplementarityIsTheSmallerOfGapAndPressureAsTractions) {
  Point made;
  auto& state = made.rest();
  const auto of = [&](double gap, double normal) {
    state.contact.gap << gap;
    state.contact.traction << normal, 0;
    state.contact.state[0] = normal < 0 ? ContactState::stick : ContactState::open;
    return made.errors()[0].complementarity;
  };
  EXPECT_NEAR(of(0.01, -10), 2.0 / 10, rounding_of_metrics);   // apart by 0.01 * 200, and pressed
  EXPECT_NEAR(of(0.1, -10), 10.0 / 10, rounding_of_metrics);   // pressed by less than 0.1 * 200
  EXPECT_NEAR(of(-0.01, -10), 2.0 / 10, rounding_of_metrics);  // a penetration
  EXPECT_NEAR(of(0.1, 10), 10.0 / 10, rounding_of_metrics);    // apart, and pulled
  EXPECT_NEAR(of(-0.01, 1), 2.0 / 1, rounding_of_metrics);     // a penetration that pulls
  EXPECT_NEAR(of(0, 5), 5.0 / 5, rounding_of_metrics);         // touching, and pulled
  EXPECT_EQ(of(0.1, 0), 0);
  EXPECT_EQ(of(0, -10), 0);
}

TEST(Metrics, ConeIsTheTractionBeyondTheBound) {
  Point made;
  auto& state = made.rest();
  const double scale = std::hypot(10.0, 6.0);
  state.contact.traction << -10, 6;
  EXPECT_NEAR(made.errors()[0].cone, 1.0 / scale, rounding_of_metrics);
  state.contact.traction << -10, -6;
  EXPECT_NEAR(made.errors()[0].cone, 1.0 / scale, rounding_of_metrics);
  state.contact.traction << -10, 5;
  EXPECT_EQ(made.errors()[0].cone, 0);
  state.contact.traction << 10, 6;  // in tension there is no bound
  EXPECT_NEAR(made.errors()[0].cone, 6.0 / scale, rounding_of_metrics);
}

TEST(Metrics, StickIsTheSlipOfAllIncrementsInsideTheCone) {
  Point made;
  for (const double slip : {0.003, 0.002, -0.001}) made.rest().contact.slip << slip;
  const auto errors = made.errors();
  expect_only(errors[0], &KktError::stick, 0.003 / 0.05);
  expect_only(errors[1], &KktError::stick, 0.005 / 0.05);
  expect_only(errors[2], &KktError::stick, 0.004 / 0.05);
}

TEST(Metrics, StickForgetsTheCreepWhereAPointSlipsOrOpens) {
  for (const bool opens : {false, true}) {
    Point made;
    made.rest().contact.slip << 0.003;
    auto& free = made.rest();
    free.contact.slip << 0.01;
    free.contact.traction << (opens ? 0 : -10), (opens ? 0 : 5);  // on its cone, which it slips along
    made.rest().contact.slip << 0.002;
    const auto errors = made.errors();
    const double length = 0.05;
    EXPECT_NEAR(errors[0].stick, 0.003 / length, rounding_of_metrics);
    EXPECT_EQ(errors[1].stick, 0) << opens;
    EXPECT_EQ(errors[1].slip_direction, 0) << opens;
    // (on the cone the traction is larger, and with it the run's length)
    EXPECT_NEAR(errors[2].stick, 0.002 / (opens ? length : std::hypot(10.0, 5.0) / 200), rounding_of_metrics) << opens;
  }
}

TEST(Metrics, APointIsOnItsConeToWithinAMillionthOfItsBound) {
  for (const double off : {5e-7, 2e-6}) {
    Point made;
    auto& state = made.rest();
    state.contact.traction << -10, 5 * (1 - off);
    state.contact.slip << -0.01;  // against the traction
    const auto e = made.errors()[0];
    const double length = state.contact.traction.norm() / 200;
    if (off < 1e-6)
      expect_only(KktError{0, 0, 0, e.cone, e.stick, e.slip_direction}, &KktError::slip_direction, 2);
    else
      expect_only(KktError{0, 0, 0, e.cone, e.stick, e.slip_direction}, &KktError::stick, 0.01 / length);
  }
}

TEST(Metrics, SlipDirectionIsNoMatterWhereNothingSlips) {
  Point made;
  auto& state = made.rest();
  state.contact.traction << -10, 5;
  const double length = state.contact.traction.norm() / 200;
  state.contact.slip << -0.9e-9 * length;
  EXPECT_EQ(made.errors()[0].slip_direction, 0);
  state.contact.slip << -1.1e-9 * length;
  EXPECT_NEAR(made.errors()[0].slip_direction, 2, rounding_of_metrics);
}

/// A point on a plane in space, friction 1/2, stiffness 10 each way, pressed by 100.
Scene point_in_space() { return scenes::dragged_point({{{0, 0, 0}}, {{1, 0, 0}}}, 1, 5); }

TEST(Metrics, InSpaceTangentialPartsAreVectors) {
  Made made(point_in_space());
  ASSERT_EQ(made.model.points[0].tangents, 2);
  auto& state = made.next();
  const double bound = 50, size = std::sqrt(1e4 + bound * bound), length = size / 10;
  // on the cone, at 60 degrees to the slip
  state.contact.state[0] = ContactState::slip;
  state.contact.traction << -100, 0.6 * bound, 0.8 * bound;
  const double c = 0.5, s = std::sqrt(3.0) / 2;
  state.contact.slip << 2 * (0.6 * c - 0.8 * s), 2 * (0.8 * c + 0.6 * s);
  EXPECT_NEAR(made.errors()[0].slip_direction, 0.5, rounding_of_metrics);
  EXPECT_NEAR(made.errors()[0].cone, 0, rounding_of_metrics);
  state.contact.slip << -2 * 0.8, 2 * 0.6;  // across
  EXPECT_NEAR(made.errors()[0].slip_direction, 1, rounding_of_metrics);
  // beyond the cone, whose radius each component alone is within
  state.contact.traction << -100, 48, 36;
  EXPECT_NEAR(made.errors()[0].cone, 10 / std::sqrt(1e4 + 3600), rounding_of_metrics);
  // inside: creep is the length of the sum
  state.contact.traction << -100, 0.6 * bound * 0.9, 0;
  state.contact.slip << 0.03, 0;
  auto& more = made.next();
  more.contact.state[0] = ContactState::stick;
  more.contact.traction = made.trajectory.increments[0].state.contact.traction;
  more.contact.slip << 0, 0.04;
  const double first = made.trajectory.increments[0].state.contact.traction.norm() / 10;
  EXPECT_NEAR(made.errors()[1].stick, 0.05 / first, rounding_of_metrics);
  EXPECT_LT(first, length);
}

TEST(Metrics, EachContactHasItsOwnFrictionAndEachPointItsOwnCreep) {
  Scene scene = one_point();
  scene.bodies.push_back({"b", PointMesh{{3.0, 0.0}}, GroundedSpring{{{1.0, 0.0}, {0.0, 400.0}}}, "", 1.0});
  scene.contacts.push_back(contact("two", "b.node", "floor"));
  scene.contacts[1].friction = 0.2;
  scene.contacts.push_back(contact("smooth", "b.node", "floor"));
  scene.loads.clear();
  Made made(scene);
  ASSERT_EQ(made.model.multiplier_count, 5);
  for (int n = 0; n < 2; ++n) {
    auto& state = made.next();
    state.contact.traction << -10, 4, -10, 2.5, -1;  // inside, 0.5 beyond the bound, frictionless
    state.contact.slip << 0.001, 0.1;
  }
  const auto e = made.errors()[1];
  const double traction = std::hypot(10.0, 4.0);
  EXPECT_NEAR(e.cone, 0.5 / traction, rounding_of_metrics);
  EXPECT_NEAR(e.stick, 0.002 / (traction / 200), rounding_of_metrics);
  EXPECT_EQ(e.slip_direction, 0);
}

TEST(Metrics, ScalesAreTheLargestOfTheRunSoFar) {
  Point made;
  made.rest().contact.gap << -0.01;
  auto& strong = made.rest();
  strong.contact.gap << -0.01;
  strong.contact.traction << -40, 0;
  auto& weak = made.rest();
  weak.contact.gap << -0.01;
  weak.contact.traction << -1, 0;
  const auto errors = made.errors();
  EXPECT_NEAR(errors[0].gap, 0.01 / 0.05, rounding_of_metrics);
  EXPECT_NEAR(errors[1].gap, 0.01 / 0.2, rounding_of_metrics);
  EXPECT_NEAR(errors[2].gap, 0.01 / 0.2, rounding_of_metrics);
  EXPECT_NEAR(errors[2].complementarity, 2.0 / 40, rounding_of_metrics);
  EXPECT_NEAR(errors[2].equilibrium, 9.0 / 40, rounding_of_metrics);
}

TEST(Metrics, WhatIsNoNumberPassesForNoSmallOne) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (const int entry : {0, 1, 2, 3}) {
    Point made;
    auto& state = made.rest();
    state.contact.traction << -10, 5;
    (entry == 0 ? state.contact.gap[0] : entry == 1 ? state.contact.slip[0] : state.contact.traction[entry - 2]) = none;
    const auto e = made.errors()[0];
    EXPECT_TRUE(std::isnan(e.largest())) << entry;
    EXPECT_EQ(std::isnan(e.gap), entry != 1) << "of what it is made of, and of its scale";
  }
  Point made;
  made.rest().displacement[0] = none;
  EXPECT_TRUE(std::isnan(made.errors()[0].equilibrium));
}

TEST(Metrics, WhatRoundingMakesOfDisplacementsPressesNothing) {
  Scene scene = one_point();
  scene.loads.clear();
  Made made(scene);
  auto& state = made.next();
  state.displacement << 1, 0, 1, 0;  // its support moved it
  state.history.placement << -1;
  state.contact.slip << -1;
  state.contact.traction << -2e-11, 1e-12;  // 1e-13 of 200: inside its cone, if that were a pressure
  const auto e = made.errors()[0];
  EXPECT_EQ(e.stick, 0);
  EXPECT_EQ(e.slip_direction, 0);
  EXPECT_LT(e.largest(), 1e-3);
  state.contact.traction << -2e-3, 1e-4;
  EXPECT_NEAR(made.errors()[0].stick, 1, rounding_of_metrics);
}

/// Contact with an elastic layer: what is left once it has taken its share.
TEST(Metrics, ALayerTakesPenetrationAndElasticSlipOfItsOwnTractionAlone) {
  Point made;
  const double normal = 1e-3, along = 4e-3;  // compliances
  const auto left = [&] {
    std::vector<PointDefects> all;
    visit_defects(
        made.model, made.slots, made.trajectory,
        [&](const auto&) {
          return ElasticLayer{{normal}, {along}};
        },
        [&](std::size_t, const KktDefects&, const auto& points) { all.push_back(points[0]); });
    return all;
  };
  auto& first = made.rest();
  first.contact.gap << -10 * normal;
  first.contact.traction << -10, 2;
  first.contact.slip << 2 * along;
  auto& second = made.rest();  // one that creeps on by more than its traction grows
  second.contact.gap << -10 * normal - 0.01;
  second.contact.traction << -10, 3;
  second.contact.slip << along + 0.02;
  auto& third = made.rest();  // on its cone: the elastic slip goes back, the plastic one forth
  third.contact.gap << -4 * normal;
  third.contact.traction << -4, 2;
  third.contact.slip << -along + 0.003;
  const auto points = left();
  EXPECT_NEAR(points[0].penetration, 0, rounding_of_metrics);
  EXPECT_NEAR(points[0].complementarity, 0, 200 * rounding_of_metrics);
  EXPECT_NEAR(points[0].creep, 0, rounding_of_metrics);
  EXPECT_NEAR(points[1].penetration, 0.01, rounding_of_metrics);
  EXPECT_NEAR(points[1].complementarity, 0.01 * 200, 200 * rounding_of_metrics);
  EXPECT_NEAR(points[1].creep, 0.02, rounding_of_metrics);
  EXPECT_NEAR(points[2].turn, 0, rounding_of_metrics);
  EXPECT_NEAR(points[2].astray, 0, rounding_of_metrics);
  // without it the same states penetrate, creep and slip against their traction
  EXPECT_NEAR(made.errors()[0].gap, 0.01 / (std::hypot(10.0, 2.0) / 200), rounding_of_metrics);
  EXPECT_NEAR(made.errors()[2].slip_direction, 2, rounding_of_metrics);
}

TEST(Metrics, SummariesAddUpTheForcesOfEachContact) {
  Scene scene = bar();
  scene.contacts.push_back(contact("end", "bar.end", "floor"));
  Made made(scene);
  auto& state = made.next();
  state.contact.traction << -20, 6, -8, -2, 0, 0, -3;
  state.contact.gap << -0.25, 0.5, 1, -0.125;
  state.contact.state = {ContactState::stick, ContactState::slip, ContactState::open, ContactState::slip};
  const auto all = summarise(made.model, made.slots, state);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ((std::vector<int>{all[0].open, all[0].stick, all[0].slip}), (std::vector<int>{1, 1, 1}));
  EXPECT_EQ(all[0].penetration, 0.25);
  EXPECT_NEAR(all[0].normal_force, 0.5 * 20 + 8, rounding_of_metrics * 20);
  // on the slave: against the traction's tangent (-1, 0)
  EXPECT_NEAR(all[0].tangential_force[0], 0.5 * 6 - 2, rounding_of_metrics);
  EXPECT_NEAR(all[0].tangential_force[1], 0, rounding_of_metrics);
  EXPECT_EQ(all[1].slip, 1);
  EXPECT_NEAR(all[1].normal_force, 3, rounding_of_metrics);  // the cross-section is 1
  EXPECT_TRUE(all[0].is_finite());
  state.contact.traction[0] = -std::numeric_limits<double>::infinity();
  EXPECT_FALSE(summarise(made.model, made.slots, state)[0].is_finite());
}

}  // namespace
}  // namespace stickslip
