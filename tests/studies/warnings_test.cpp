#include "studies/warnings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/cases.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A block of 4 x 1 on another one of 8 x 1, pressed by `press` and pushed along by `push`.
json blocks(double press, double push, double friction) {
  const json material = {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}};
  const auto box = [&](double left, double bottom, double right, int cells) {
    return json{{"mesh", {{"box", {{"min", {left, bottom}}, {"max", {right, bottom + 1}}, {"cells", {cells, 2}}}}}},
                {"material", material}};
  };
  return {{"bodies", {{"lower", box(0, 0, 8, 15)}, {"upper", box(2, 1, 6, 8)}}},
          {"contacts", {{"sole", {{"slave", "upper.bottom"}, {"master", "lower.top"}, {"friction", friction}}}}},
          {"supports",
           {{{"on", "lower.bottom"}, {"move", {{"x", 0}, {"y", 0}}}},
            {{"on", "upper.top"},
             {"move", {{"x", {{0, 0}, {1, 0}, {2, push}}}, {"y", {{0, 0}, {1, -press}, {2, -press}}}}}}}},
          {"time", {{"end", 2}, {"steps", 4}}}};
}

std::vector<std::string> warnings(const json& document) {
  return warnings_of(cases::run(document, {{"monolithic_al", json::object()}}, "blocks.json"));
}

TEST(Warnings, AreNoneWhereSmallStrainHolds) { EXPECT_THAT(warnings(blocks(0.002, 0.02, 0.1)), IsEmpty()); }

TEST(Warnings, NameSlidingBeyondHalfAnElementWithItsLength) {
  // elements of 0.5; the sole lags behind the top by its shear, some 0.1 of it
  EXPECT_THAT(warnings(blocks(0.002, 1.0, 0.1)), ElementsAre(HasSubstr("sole: a point slides by 2 elements")));
}

TEST(Warnings, NameStrainAndRotation) {
  const auto found = warnings(blocks(0.3, 0.02, 0.1));
  EXPECT_THAT(found, testing::Contains(HasSubstr("upper is strained by up to")));
  EXPECT_THAT(warnings(blocks(0.002, 0.02, 0.1)), IsEmpty());
  // a bar of 4 x 1 whose end turns by 6 degrees about its corner: without strain, but for what the support takes
  json turned = blocks(0.002, 0.02, 0.1);
  turned["contacts"] = json::object();
  turned["supports"] = {{{"on", "lower.bottom"}, {"move", {{"x", 0}, {"y", 0}}}},
                        {{"on", "upper.top"}, {"rotate", {{"center", {2, 2}}, {"angle", {{0, 0}, {2, 6}}}}}}};
  EXPECT_THAT(warnings(turned), testing::Contains(HasSubstr("upper rotates by up to 6")));
}

TEST(Warnings, NameFrictionThatNeverSlips) {
  EXPECT_THAT(
      warnings(blocks(0.002, 0, 5)),
      ElementsAre("sole: no point slipped in any step, so that the friction coefficient of 5 has no influence"));
}

TEST(Warnings, AreNotLookedForInWhatDidNotConverge) {
  json floating = blocks(0.002, 1.0, 0.1);
  floating["supports"].erase(1);
  floating["loads"] = {{{"on", "upper.top"}, {"traction", {0, 1}}}};
  EXPECT_THAT(warnings(floating), IsEmpty());
}

TEST(Warnings, SayWhatCutStepsMeanWithFriction) {
  // slip runs over 20 nodes in one step; a node an iteration
  const auto problem = std::make_shared<const Problem>(scenes::pull_out(30, {0, 1}, 1));
  for (const int iterations : {3, 100}) {
    MonolithicAL method;
    method.newton.max_iterations = iterations;
    std::shared_ptr<Condensation<double>> condensation;
    const auto result = run_case(problem, method, {}, condensation);
    ASSERT_TRUE(is_converged(result.status())) << result.message();
    const bool cut = result.trajectory.counters.cutbacks > 0;
    EXPECT_EQ(cut, iterations == 3);
    EXPECT_EQ(warnings_of(result).size(), cut ? 1 : 0);
    if (cut) {
      EXPECT_THAT(warnings_of(result), ElementsAre(HasSubstr("1 of 1 steps were cut into smaller ones")));
    }
  }
}

}  // namespace
}  // namespace stickslip
