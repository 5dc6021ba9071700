/// Errors of results that are written by hand: over all steps, and by area.
#include <gtest/gtest.h>

#include <cmath>

#include "core/model/contact_assembly.hpp"
#include "studies/sweep/references.hpp"
#include "studies/sweep/study.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip {
namespace {

/// A block of two cells over a floor: contact points with areas 1/2, 1 and 1/2.
std::shared_ptr<const Problem> block_problem() {
  Scene s;
  s.legs = {{2, 2}};
  const Number E = scenes::parameter(s, "E", 10.0);
  s.bodies = {{"block", BoxMesh{{0.0, 0.0}, {2.0, 1.0}, {2, 1}}, LinearElastic{E, 0.25}, "", 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  s.contacts[0].friction = 0.5;
  s.responses = {scenes::response("u", Response::Kind::displacement, "block.top", "y")};
  return std::make_shared<const Problem>(s);
}

/// A result of two steps, all of it zero.
CaseResult nothing(const std::shared_ptr<const Problem>& problem) {
  CaseResult result;
  result.problem = problem;
  result.trajectory.increments.resize(2);
  result.steps.resize(2);
  for (int n = 0; n < 2; ++n) {
    result.trajectory.increments[n].state = initial_state<double>(problem->model, problem->slots);
    result.steps[n].increment = &result.trajectory.increments[n];
    result.steps[n].responses = Vector<double>::Zero(1);
    result.steps[n].sensitivities = Matrix<double>::Zero(1, 1);
  }
  return result;
}

constexpr double rounding_of_errors = 1e-14;

TEST(EnforcementErrors, AreTheLargestOfAllStepsOverTheLargestOfAllSteps) {
  const auto problem = block_problem();
  CaseResult reference = nothing(problem), result = nothing(problem);
  const auto set = [](CaseResult& of, int n, double response, double derivative) {
    of.steps[n].responses[0] = response;
    of.steps[n].sensitivities(0, 0) = derivative;
  };
  set(reference, 0, -8, 3);
  set(reference, 1, 4, -6);
  set(result, 0, -7, 5);    // off by 1 and 2
  set(result, 1, 4.5, -7);  // by 1/2 and 1
  const auto errors = enforcement_errors(result, reference);
  EXPECT_NEAR(errors.at("response:u"), 1.0 / 8, rounding_of_errors);
  EXPECT_NEAR(errors.at("sensitivity:u/E"), 2.0 / 6, rounding_of_errors);
}

/// Of a parameter that is zero, as a shape is: one response tells how large it may be, and another, whose derivative
/// is zero but for rounding, is measured by that.
TEST(EnforcementErrors, OfAParameterThatIsZeroAreRelativeToWhatItDoesElsewhere) {
  Scene s = block_problem()->model.scene;
  s.responses.push_back(scenes::response("load", Response::Kind::displacement, "block.top", "x"));
  s.parameters[0].value = 0;
  const auto problem = std::make_shared<const Problem>(s);
  CaseResult reference = nothing(problem), result = nothing(problem);
  for (CaseResult* of : {&reference, &result})
    for (auto& step : of->steps) {
      step.responses = Vector<double>::Constant(2, 4);
      step.sensitivities = Matrix<double>::Zero(2, 1);
      step.sensitivities(0, 0) = 2;  // so the parameter's size is 2
    }
  result.steps[1].sensitivities(1, 0) = 1e-12;
  EXPECT_NEAR(enforcement_errors(result, reference).at("sensitivity:load/E"), 1e-12 / (4 / 2), 1e-20);
}

/// A response that vanishes, by symmetry say, does not make a parameter that is zero as small as rounding.
TEST(EnforcementErrors, DoNotTakeTheSizeOfAParameterFromAResponseThatIsRounding) {
  Scene s = block_problem()->model.scene;
  s.responses.push_back(scenes::response("sway", Response::Kind::displacement, "block.top", "x"));
  s.parameters[0].value = 0;
  const auto problem = std::make_shared<const Problem>(s);
  CaseResult reference = nothing(problem), result = nothing(problem);
  for (CaseResult* of : {&reference, &result}) {
    of->scales.reach = 4;
    for (auto& step : of->steps) {
      step.responses = Vector<double>::Constant(2, 4);
      step.responses[1] = 1e-18;
      step.sensitivities = Matrix<double>::Zero(2, 1);
      step.sensitivities(1, 0) = 1;  // so the parameter's size is 4, not 1e-18
    }
  }
  result.steps[1].sensitivities(0, 0) = 1e-3;
  EXPECT_NEAR(enforcement_errors(result, reference).at("sensitivity:u/E"), 1e-3, rounding_of_errors);
}

TEST(EnforcementErrors, WeighTractionsByArea) {
  const auto problem = block_problem();
  CaseResult reference = nothing(problem), result = nothing(problem);
  auto& of = reference.trajectory.increments[1].state.contact.traction;
  of << -4, 1, -3, 2, -2, 1;
  auto& t = result.trajectory.increments[1].state.contact.traction;
  t = of;
  t[0] += 1;  // an end, area 1/2
  t[3] += 1;  // the middle, area 1
  for (std::size_t n = 0; n < 2; ++n) {
    result.steps[n].increment = &result.trajectory.increments[n];
    reference.steps[n].increment = &reference.trajectory.increments[n];
  }
  const auto errors = enforcement_errors(result, reference);
  EXPECT_NEAR(errors.at("field:normal_traction"), std::sqrt(0.5 / (0.5 * 16 + 9 + 0.5 * 4)), rounding_of_errors);
  EXPECT_NEAR(errors.at("field:tangential_traction"), std::sqrt(1 / (0.5 * 1 + 4 + 0.5 * 1)), rounding_of_errors);
}

TEST(ReferenceValues, TakeTheModulusOfBothBodies) {
  // Hertz: b = sqrt(4 F R / (pi E*)), 1/E* = sum (1 - nu^2) / E over both bodies, in plane stress sum 1 / E
  for (const bool plane_stress : {false, true}) {
    Scene s;
    if (plane_stress) s.space = Space::plane_stress;
    s.legs = {{1, 1}};
    s.bodies = {{"upper", BoxMesh{{0.0, 1.0}, {1.0, 2.0}, {2, 1}}, LinearElastic{100.0, 0.25}, "", 1.0},
                {"lower", BoxMesh{{0.0, 0.0}, {1.0, 1.0}, {2, 1}}, LinearElastic{300.0, 0.4}, "", 1.0}};
    s.contacts = {scenes::contact("touch", "upper.bottom", "lower.top")};
    s.responses = {scenes::response("width", Response::Kind::contact_half_width, "touch")};
    CaseResult result = nothing(std::make_shared<const Problem>(s));
    for (std::size_t n = 0; n < 2; ++n) {
      result.steps[n].increment = &result.trajectory.increments[n];
      result.trajectory.increments[n].state.contact.traction.setConstant(-1);
    }
    const auto reference = reference_values(
        {{"analytic", "hertz_line"}, {"map", {{"width", "half_width"}}}, {"inputs", {{"force", 7}, {"radius", 3}}}},
        result);
    const double compliance = plane_stress ? 1 / 100.0 + 1 / 300.0 : (1 - 0.25 * 0.25) / 100 + (1 - 0.4 * 0.4) / 300;
    EXPECT_NEAR(reference.responses.at("width"), std::sqrt(4 * 7 * 3 * compliance / M_PI), 1e-12);
  }
}

}  // namespace
}  // namespace stickslip
