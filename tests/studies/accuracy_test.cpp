/// Runs that say they converged, and states made by hand that could: which of them pass.
#include "studies/run/accuracy.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "tests/studies/cases.hpp"
#include "tests/studies/made_states.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/solved.hpp"

namespace stickslip {
namespace {

using made_states::Made;
using made_states::one_point;
using made_states::Point;
using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

// --- states made by hand ---------------------------------------------------------------------------------------------

/// What is off in the last increment, or nothing.
std::string fault(const Made& made, const Method& method) {
  return assess(made.model, made.slots, method, made.trajectory).faults.back();
}

const std::vector<Method>& exact_methods() {
  static const std::vector<Method> methods{MonolithicAL{}, UzawaAL{}};
  return methods;
}

/// In balance: the spring takes what the tangential traction leaves.
void balance(State<double>& state) { state.displacement << state.contact.traction[1] / 100, 0, 0, 0; }

TEST(Accuracy, ABodyThatRestsIsSolved) {
  Point made;
  made.rest();
  for (const auto& method : exact_methods()) EXPECT_THAT(fault(made, method), IsEmpty()) << name_of(method);
}

TEST(Accuracy, NamesEachComponentWithItsPlaceAndValue) {
  for (const auto& method : exact_methods()) {
    Point penetrates;
    penetrates.rest().contact.gap << -0.005;
    EXPECT_THAT(fault(penetrates, method), HasSubstr("\"gap\" is 0.1 at the contact point of one at (0, 0)"));

    Point pulled;
    auto& pulls = pulled.rest();
    pulls.displacement << 0, -0.01, 0, 0;  // 0.2 of the load is left
    EXPECT_THAT(fault(pulled, method), HasSubstr("\"equilibrium\" is 0.2 at"));
    EXPECT_THAT(fault(pulled, method), HasSubstr("at the node of a at (0, 0)"));

    Point apart;
    auto& pressed = apart.rest();
    pressed.contact.gap << 0.01;  // and pressed
    EXPECT_THAT(fault(apart, method), HasSubstr("\"complementarity\" is 0.2 at"));

    Point beyond;
    beyond.rest().contact.traction << -10, 6;
    balance(beyond.trajectory.increments.back().state);
    EXPECT_THAT(fault(beyond, method), HasSubstr("\"cone\" is 0.0857493 at"));

    Point creeps;
    creeps.rest();
    creeps.rest().contact.slip << 0.005;
    EXPECT_THAT(fault(creeps, method), HasSubstr("\"stick\" is 0.1 at"));

    Point astray;
    auto& slips = astray.rest();
    slips.contact.traction << -10, 5;
    slips.contact.slip << -0.01;
    balance(slips);
    EXPECT_THAT(fault(astray, method), HasSubstr("\"slip_direction\" is 2 at"));
  }
}

TEST(Accuracy, AdvisesASmallerScaleWhereThereIsContactAlone) {
  Scene scene = one_point();
  const std::string words = "which neither the method nor rounding explains";
  Point touching;
  touching.rest().displacement << 0, -0.01, 0, 0;
  EXPECT_THAT(fault(touching, MonolithicAL{}), testing::EndsWith(words + "; try a smaller scale"));
  scene.contacts.clear();
  scene.obstacles.clear();
  Made free(scene);
  free.next().displacement << 0, -0.01, 0, 0;
  EXPECT_THAT(fault(free, MonolithicAL{}), testing::EndsWith(words));
}

TEST(Accuracy, ToleratesWhatTheMethodIsAskedForAndNoMore) {
  for (const double gap : {5e-5, 5e-2}) {
    Point made;
    made.rest().contact.gap << -0.05 * gap;
    UzawaAL loose, strict;
    loose.tolerance = 1e-4;
    EXPECT_EQ(fault(made, loose).empty(), gap < 1e-3);
    EXPECT_THAT(fault(made, strict), HasSubstr("gap"));
    EXPECT_THAT(fault(made, MonolithicAL{}), HasSubstr("gap"));
  }
}

TEST(Accuracy, AllowsACreepOfTheToleranceAnIncrement) {
  UzawaAL method;
  method.tolerance = 1e-3;
  Point made;
  for (int n = 0; n < 100; ++n) made.rest().contact.slip << 0.05 * 9e-3;
  EXPECT_THAT(fault(made, method), IsEmpty());
  made.rest().contact.slip << 0.05 * 0.5;
  EXPECT_THAT(fault(made, method), HasSubstr("stick"));
}

/// A point that a penalty of 1e4 (along: 5e3) presses by 10 and holds.
Made pressed_by_penalty(Penalty& method) {
  method.stiffness = scenes::absolute(1e4);
  method.tangential_ratio = 0.5;
  Made made(one_point());
  auto& state = made.next();
  state.contact.state[0] = ContactState::stick;
  state.contact.gap << -1e-3;
  state.contact.traction << -10, 2;
  state.contact.slip << 2 / 5e3;
  balance(state);
  return made;
}

TEST(Accuracy, APenaltyExplainsItsPenetrationAndElasticSlipAndNothingElse) {
  Penalty method;
  const auto sound = [&] { return pressed_by_penalty(method); };
  Made made = sound();
  auto& state = made.trajectory.increments.back().state;
  EXPECT_THAT(fault(made, method), IsEmpty());
  EXPECT_GT(made.errors()[0].largest(), 1e-3);
  EXPECT_THAT(fault(made, MonolithicAL{}), HasSubstr("gap"));

  state.contact.gap << -1.001e-3;  // a thousandth more than its traction makes
  EXPECT_THAT(fault(made, method), HasSubstr("\"gap\""));
  made = sound();
  made.trajectory.increments.back().state.contact.slip << 2.1 / 5e3;
  EXPECT_THAT(fault(made, method), HasSubstr("\"stick\""));
  made = sound();
  made.trajectory.increments.back().state.contact.traction << -10, 5.001;
  made.trajectory.increments.back().state.contact.slip << 5.001 / 5e3 + 1e-4;  // it slips along
  balance(made.trajectory.increments.back().state);
  EXPECT_THAT(fault(made, method), HasSubstr("\"cone\""));
  made = sound();
  made.trajectory.increments.back().state.displacement[0] += 1e-3;
  EXPECT_THAT(fault(made, method), HasSubstr("\"equilibrium\""));
  EXPECT_THAT(fault(made, method), HasSubstr("try a smaller stiffness"));

  // unloaded while it slips: the elastic part goes back, the traction does not
  made = sound();
  auto& weaker = made.next();
  weaker.contact = made.trajectory.increments.front().state.contact;
  weaker.contact.state[0] = ContactState::slip;
  weaker.contact.gap << -3e-4;
  weaker.contact.traction << -3, 1.5;
  weaker.contact.slip << -0.5 / 5e3 + 1e-5;
  weaker.displacement << 1.5 / 100, -7.0 / 200, 0, 0;
  EXPECT_GT(made.errors()[1].slip_direction, 1);
  EXPECT_THAT(fault(made, method), IsEmpty());
  weaker.contact.slip << -0.5 / 5e3 - 1e-5;  // the plastic part against the traction
  EXPECT_THAT(fault(made, method), HasSubstr("slip_direction"));
}

TEST(Accuracy, RoundingExplainsAShareThatIsSmallWhateverTheStiffness) {
  for (const double stiffness : {1e2, 1e12, 1e16}) {
    MonolithicAL method;
    method.scale = scenes::absolute(stiffness);
    for (const double off : {2e-5, 1e-3}) {
      Point made;
      made.rest().displacement << 0, -10 * off / 200, 0, 0;         // `off` of the load is left
      made.trajectory.increments.back().state.displacement[2] = 1;  // far, so that much is rounded (a held anchor)
      made.trajectory.increments.back().state.displacement[0] = 1;
      EXPECT_EQ(fault(made, method).empty(), off < most_rounding && stiffness > 1e8) << stiffness << " " << off;
    }
  }
}

TEST(Accuracy, WhereNothingPressesErrorsOfRoundingPass) {
  for (const bool presses : {false, true}) {
    Scene scene = one_point();
    scene.loads.clear();
    Made made(scene);
    auto& state = made.next();
    state.displacement << 1, 0, 1, 0;  // moved by its support, and left by rounding with forces of 1e-13 of 200
    state.history.placement << -1;
    state.contact.slip << -1;
    state.contact.state[0] = ContactState::slip;
    state.contact.traction << (presses ? -2e-3 : -2e-11), (presses ? 1e-3 : 1e-11);
    EXPECT_EQ(fault(made, Penalty{}).empty(), !presses) << fault(made, Penalty{});
    EXPECT_EQ(fault(made, MonolithicAL{}).empty(), !presses) << fault(made, MonolithicAL{});
  }
}

TEST(Accuracy, GivesStatusAndMessageToTheStepAndTheRun) {
  Made made(one_point());
  for (int n = 0; n < 4; ++n) {
    auto& state = made.next();
    state.contact.state[0] = ContactState::stick;
    state.contact.traction << -10, 0;
  }
  auto& increments = made.trajectory.increments;
  increments[1].state.contact.gap << -0.005;
  increments[1].requested = false;  // the first part of a cut step
  increments[3].status = Status::cap;
  increments[3].state.contact.gap << -0.005;
  made.trajectory.status = Status::converged_at_roundoff;
  const auto errors = check_accuracy(made.model, made.slots, MonolithicAL{}, made.trajectory);
  ASSERT_EQ(errors.size(), 4u);
  EXPECT_NEAR(errors[1].gap, 0.1, 1e-14);
  EXPECT_EQ(increments[0].status, Status::converged);
  EXPECT_EQ(increments[1].status, Status::inaccurate);
  EXPECT_EQ(increments[2].status, Status::inaccurate);
  EXPECT_EQ(increments[2].message, increments[1].message);
  EXPECT_EQ(increments[3].status, Status::cap);
  EXPECT_EQ(made.trajectory.status, Status::inaccurate);
  EXPECT_THAT(made.trajectory.message, HasSubstr("gap"));
  EXPECT_FALSE(is_converged(Status::inaccurate));
  EXPECT_EQ(name_of(Status::inaccurate), "inaccurate");
}

TEST(Accuracy, WhatIsNotFiniteIsNotSolved) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200}) {
    Point made;
    made.rest().contact.traction << -bad, bad;
    check_accuracy(made.model, made.slots, MonolithicAL{}, made.trajectory);
    // (1e200 is a number, and its square is none: errors are measured all the same)
    EXPECT_EQ(made.trajectory.status, bad == 1e200 ? Status::inaccurate : Status::not_finite) << bad;
  }
}

// --- runs ------------------------------------------------------------------------------------------------------------

/// A rough disk of radius 4 pressed into a block and moved along it.
json punch() {
  return {{"bodies",
           {{"block",
             {{"mesh", {{"box", {{"min", {-2, -2}}, {"max", {2, 0}}, {"cells", {16, 8}}}}}},
              {"material", {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}}}}}}},
          {"obstacles",
           {{"punch",
             {{"circle", {{"center", {0, 4}}, {"radius", 4}}},
              {"move", {{"x", {{0, 0}, {1, 0}, {2, 0.02}}}, {"y", {{0, 0}, {1, -0.05}, {2, -0.05}}}}}}}}},
          {"contacts", {{"face", {{"slave", "block.top"}, {"master", "punch"}, {"friction", 0.3}}}}},
          {"supports", {{{"on", "block.bottom"}, {"move", {{"x", 0}, {"y", 0}}}}}},
          {"time", {{"end", 2}, {"steps", 4}}},
          {"responses",
           {{"N", {{"contact_force", {{"contact", "face"}, {"component", "normal"}}}}},
            {"T", {{"contact_force", {{"contact", "face"}, {"component", "x"}}}}},
            {"peak", {{"contact_pressure", {{"contact", "face"}, {"take", "max"}}}}}}}};
}

struct Sweep {
  const char *method, *option;
};

/// What passes as solved is right, whatever the stiffness or scale; and what is good passes.
TEST(Accuracy, OfACurvedRoughPunchAtAnyStiffnessIsGoodOrItSaysItIsNot) {
  const auto right = cases::run(punch(), {{"monolithic_al", json::object()}}, "punch.json");
  ASSERT_EQ(right.status(), Status::converged) << right.message();
  const Vector<double>& responses = right.steps.back().responses;
  for (const Sweep& sweep : {Sweep{"penalty", "stiffness"}, {"uzawa_al", "scale"}, {"monolithic_al", "scale"}}) {
    const bool penalty = sweep.method == std::string("penalty");
    int failed = 0;
    for (const int power : {0, 3, 6, 8, 10, 11, 12, 13, 14}) {
      const double value = std::pow(10, power);
      const auto result = cases::run(punch(), {{sweep.method, {{sweep.option, value}}}}, "punch.json");
      const std::string what = std::string(sweep.method) + " 1e" + std::to_string(power) + ": " +
                               std::string(name_of(result.status())) + ", " + result.message();
      if (power <= 8) {
        EXPECT_TRUE(is_converged(result.status())) << what;
      }
      failed += !is_converged(result.status());
      if (!is_converged(result.status())) continue;
      // a penalty's own error falls as its stiffness grows (1 at 1); what else is wrong: the error of
      // the largest force that may pass, at most nodes of the contact at once
      const double allowed = (penalty ? std::min(1.0, 10 / value) : 1e-9) + (power > 8 ? 10 * most_rounding : 1e-6);
      for (Eigen::Index i = 0; i < responses.size(); ++i)
        EXPECT_NEAR(result.steps.back().responses[i], responses[i], allowed * largest_entry(responses)) << what;
    }
    EXPECT_GT(failed, 0) << sweep.method << ": none of them was too stiff, so that nothing was tried";
  }
}

TEST(Accuracy, AModeratePenaltyIsAsGoodAsItsMethodIs) {
  const auto result = cases::run(punch(), {{"penalty", {{"stiffness", 1}}}}, "punch.json");
  EXPECT_EQ(result.status(), Status::converged) << result.message();
  EXPECT_GT(result.steps.back().kkt.gap, 0.1);
}

TEST(Accuracy, AnInaccurateRunIsWrittenWithWhatToTry) {
  auto document = punch();
  document["parameters"] = {{"mu", "/contacts/face/friction"}};
  const auto result = cases::run(document, {{"penalty", {{"stiffness", 1e12}}}}, "punch.json");
  EXPECT_EQ(result.status(), Status::inaccurate) << result.message();
  EXPECT_THAT(result.message(), HasSubstr("try a smaller stiffness"));
  const auto written = result_json(result, "");
  EXPECT_EQ(written["status"], "inaccurate");
  EXPECT_EQ(written["steps"].size(), 4u);
  EXPECT_EQ(written["steps"].back()["status"], "inaccurate");
}

}  // namespace
}  // namespace stickslip
