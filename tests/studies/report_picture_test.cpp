/// The picture of the deformed bodies.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "studies/report/picture.hpp"
#include "tests/studies/recorded_study.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using recorded::picture;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(ReportPicture, DrawsBodiesObstaclesAndContactStates) {
  const std::string svg = report::draw_picture(picture())->drawing.inline_svg();
  EXPECT_THAT(svg, AllOf(HasSubstr("role=\"img\""), HasSubstr("<title>Deformed bodies"), HasSubstr("<desc>"),
                         HasSubstr("<clipPath id="), HasSubstr("sole: stick"), HasSubstr("sole: slip"),
                         HasSubstr("true scale"), Not(HasSubstr("nan")), Not(HasSubstr("inf "))));
}

TEST(ReportPicture, StatesByHowMuchSmallDisplacementsAreEnlarged) {
  json small = picture();
  for (auto& u : small["displacement"]) u[1] = u[1].get<double>() * 1e-3;
  // 1e-4 of a width of 2: 3 % of the width is 600 times that, 500 the round number below.
  EXPECT_THAT(report::draw_picture(small)->text, HasSubstr("displacements 500 times enlarged"));
}

/// Enlarged, bodies that touch would part.
TEST(ReportPicture, DrawsBodiesThatTouchOneAnotherAtTrueScale) {
  json small = picture();
  for (auto& u : small["displacement"]) u = {0, u[1].get<double>() / 1000};
  EXPECT_THAT(report::draw_overview(small)->text, HasSubstr("times enlarged"));
  small["obstacles"] = json::array();
  EXPECT_THAT(report::draw_overview(small)->text, HasSubstr("true scale"));
}

TEST(ReportPicture, DrawsContactPointsAtTheirEnlargedPlaces) {
  json small = picture();
  for (auto& u : small["displacement"]) u = {0, 1e-4};
  small["contact"][0]["node"] = 3;
  small["contact"][0]["x"] = 0;
  small["contact"][0]["y"] = 1 + 1e-4;
  const auto plate = report::draw_picture(small);
  EXPECT_THAT(plate->drawing.inline_svg(), AllOf(HasSubstr("sole: stick"), HasSubstr("sole: slip")));
  for (const auto& row : plate->rows)
    if (row["what"] == "contact point" && row["state"] == "stick") {
      EXPECT_NEAR(row["y"].get<double>(), 1 + 500 * 1e-4, 1e-12);  // enlarged 500 times; few roundings
    }
}

TEST(ReportPicture, DrawsObstaclesWhereTheyHaveMovedTo) {
  const auto svg = [](double y, const json& moved) {
    json drawn = picture();
    json& plane = drawn["obstacles"][0]["plane"];
    plane["point"][1] = y;
    if (!moved.is_null()) plane["moved"] = moved;
    return report::draw_picture(drawn)->drawing.inline_svg();
  };
  ASSERT_NE(svg(0, nullptr), svg(-0.25, nullptr));
  EXPECT_EQ(svg(0, {{"by", {0, -0.25}}}), svg(-0.25, nullptr));  // displacements are at true scale here
  EXPECT_EQ(svg(0, {{"by", {0, 0}}, {"degrees", 0}, {"center", {1, 0}}}), svg(0, nullptr));
  EXPECT_NE(svg(0, {{"by", {0, 0}}, {"degrees", 5}, {"center", {1, 0}}}), svg(0, nullptr));
}

TEST(ReportPicture, EnlargesTheMotionOfObstaclesAsThatOfBodies) {
  json small = picture(), larger = picture();
  for (json* drawn : {&small, &larger})
    for (auto& u : (*drawn)["displacement"]) u = {0, 1e-4};  // 500 times enlarged
  small["obstacles"][0]["plane"]["moved"] = {{"by", {0, -1e-4}}};
  larger["obstacles"][0]["plane"]["point"][1] = -0.05;
  EXPECT_EQ(report::draw_overview(small)->drawing.inline_svg(), report::draw_overview(larger)->drawing.inline_svg());
}

TEST(ReportPicture, ShowsAPointWithItsSpringInThePlaneAndInSpace) {
  json point = {{"points", {{0, 0}, {0, 0}}},  // a slider: the point has lagged behind its anchor
                {"displacement", {{0.07, 0}, {0.1, 0}}},
                {"elements", {{0, 1}}},
                {"contact", {{{"name", "sole"}, {"x", 0.07}, {"y", 0}, {"node", 0}, {"state", "slip"}}}},
                {"obstacles", {{{"plane", {{"point", {0, 0}}, {"normal", {0, 1}}}}}}}};
  const auto plane = report::draw_overview(point);
  ASSERT_TRUE(plane);
  EXPECT_EQ(plane->text,
            "At the last step: 1 spring, 1 contact point; displacements at true scale; a cross is a spring's anchor.");
  EXPECT_THAT(plane->drawing.inline_svg(), HasSubstr(">slips<"));
  for (auto* places : {&point["points"], &point["displacement"]})
    for (auto& place : *places) place.push_back(5);  // along z, where nothing is seen of it
  point["obstacles"] = json::array();
  const auto space = report::draw_overview(point);
  ASSERT_TRUE(space);
  EXPECT_THAT(space->text, HasSubstr("seen along z"));
  point["displacement"] = {{0, 0, 1}, {0, 0, 2}};
  EXPECT_FALSE(report::draw_overview(point));  // all in one place
}

TEST(ReportPicture, AFrictionlessContactTouchesAndDoesNotSlip) {
  json smooth = picture();
  for (auto& c : smooth["contact"]) c["state"] = "closed";
  EXPECT_THAT(report::draw_picture(smooth)->drawing.inline_svg(),
              AllOf(HasSubstr(">touches<"), Not(HasSubstr(">slips<")), Not(HasSubstr(">open<"))));
}

TEST(ReportPicture, HasNoWordsForStatesWhereNothingCanTouch) {
  json alone = picture();
  alone["contact"] = json::array();
  EXPECT_THAT(report::draw_picture(alone)->drawing.inline_svg(), Not(HasSubstr(">sticks<")));
}

TEST(ReportPicture, DrawsNothingWhereThereIsNothingToSee) {
  EXPECT_FALSE(report::draw_picture(nullptr));
  EXPECT_FALSE(report::draw_picture({{"points", {{0, 0}}}, {"elements", json::array()}}));
  EXPECT_FALSE(report::draw_picture({{"points", {{0, 0, 0}, {0, 0, 1}}}, {"elements", {{0, 1}}}}));
}

TEST(ReportPicture, LeavesOutElementsThatNameNoNode) {
  json broken = picture();
  broken["elements"].push_back({0, 1, 99});
  EXPECT_THAT(report::draw_picture(broken)->text, HasSubstr("2 elements"));
}

}  // namespace
}  // namespace stickslip
