#include "studies/missing_effects.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/cases.hpp"

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

std::vector<std::string> missing(const json& document) {
  return missing_effects(cases::run(document, {{"monolithic_al", json::object()}}, "blocks.json"));
}

TEST(MissingEffects, AreNoneWhereSmallStrainHolds) { EXPECT_THAT(missing(blocks(0.002, 0.02, 0.1)), IsEmpty()); }

TEST(MissingEffects, NameSlidingBeyondHalfAnElementWithItsLength) {
  // elements of 0.5; the sole lags behind the top by its shear, some 0.1 of it
  EXPECT_THAT(missing(blocks(0.002, 1.0, 0.1)), ElementsAre(HasSubstr("sole: a point slides by 2 elements")));
}

TEST(MissingEffects, NameStrainAndRotation) {
  const auto found = missing(blocks(0.3, 0.02, 0.1));
  EXPECT_THAT(found, testing::Contains(HasSubstr("upper is strained by up to")));
  EXPECT_THAT(missing(blocks(0.002, 0.02, 0.1)), IsEmpty());
  // a bar of 4 x 1 whose end turns by 6 degrees about its corner: without strain, but for what the support takes
  json turned = blocks(0.002, 0.02, 0.1);
  turned["contacts"] = json::object();
  turned["supports"] = {{{"on", "lower.bottom"}, {"move", {{"x", 0}, {"y", 0}}}},
                        {{"on", "upper.top"}, {"rotate", {{"center", {2, 2}}, {"angle", {{0, 0}, {2, 6}}}}}}};
  EXPECT_THAT(missing(turned), testing::Contains(HasSubstr("upper rotates by up to 6")));
}

TEST(MissingEffects, NameFrictionThatNeverSlips) {
  EXPECT_THAT(
      missing(blocks(0.002, 0, 5)),
      ElementsAre("sole: no point slipped in any step, so that the friction coefficient of 5 has no influence"));
}

TEST(MissingEffects, AreNotLookedForInWhatDidNotConverge) {
  json floating = blocks(0.002, 1.0, 0.1);
  floating["supports"].erase(1);
  floating["loads"] = {{{"on", "upper.top"}, {"traction", {0, 1}}}};
  EXPECT_THAT(missing(floating), IsEmpty());
}

}  // namespace
}  // namespace stickslip
