/// The picture of the deformed bodies.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
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

/// Of a point that goes straight, or to and fro, a line would say nothing.
TEST(ReportPicture, DrawsThePathOfAPointThatTurns) {
  json drawn = {{"points", {{0, 0}, {0, 0}}},
                {"displacement", {{2, 1}, {3, 1}}},
                {"elements", {{0, 1}}},
                {"bodies", {0}},
                {"von_mises", {0}},
                {"contact", json::array()},
                {"obstacles", json::array()},
                {"paths",
                 {{{"node", 0}, {"displacement", {{0, 0}, {2, 0}, {2, 1}}}},
                  {{"node", 1}, {"displacement", {{1, 1}, {2, 1}, {3, 1}}}}}}};
  const auto turning = report::draw_overview(drawn);
  EXPECT_THAT(turning->text, HasSubstr("the line the path of the point, the dotted one of the anchor"));
  std::string places;
  for (const auto& row : turning->rows)
    if (row["what"] == "path of the point") places += row["x"].dump() + "," + row["y"].dump() + " ";
  EXPECT_EQ(places, "0.0,0.0 2.0,0.0 2.0,1.0 ");
  drawn["paths"][0]["displacement"] = {{0, 0}, {2, 1}, {1, 0.5}};
  EXPECT_THAT(report::draw_overview(drawn)->text, Not(HasSubstr("the path of the point")));
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

TEST(ReportPicture, DrawsLinesOnObstaclesInSpaceOverTheBodies) {
  const auto svg = [](const json& obstacles) {
    json drawn = picture();
    drawn["aslant"] = true;
    drawn["obstacles"] = obstacles;
    return report::draw_picture(drawn)->drawing.inline_svg();
  };
  const json wire = {{"points", {{0, 0}, {0.5, 0.25}}}},
             moved = {{"points", {{0, 0}, {0.5, 0.25}}}, {"moved", {{"by", {0, 0.1}}}}};
  const std::string without = svg(json::array()), with = svg({{{"wire", wire}}});
  ASSERT_GT(with.size(), without.size());
  EXPECT_NE(svg({{{"wire", moved}}}), with);
  EXPECT_EQ(svg({{{"wire", wire}}, {{"wire", {{"points", "none"}}}}}), with);  // what is no line is left out
  const auto line = with.find("stroke:var(--soft);stroke-width:0.8");
  ASSERT_NE(line, std::string::npos) << with;
  EXPECT_GT(line, with.rfind("stroke-width:0.3"));  // of the last face
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

/// A block with `points` contact points in the middle of its lower side, over a tenth of its width.
json narrow_contact(int points) {
  json drawn = picture();
  drawn["points"] = {{0, 0}, {1, 0}, {2, 0}, {0, 2}, {1, 2}, {2, 2}};
  drawn["contact"] = json::array();
  for (int i = 0; i < points; ++i)
    drawn["contact"].push_back({{"name", "sole"}, {"x", 0.9 + 0.2 * i / (points - 1)}, {"y", 0}, {"state", "stick"}});
  return drawn;
}

TEST(ReportPicture, ShowsASmallContactLargerBesideTheWhole) {
  const auto overview = report::draw_overview(narrow_contact(9));
  ASSERT_TRUE(overview);
  EXPECT_THAT(overview->text, HasSubstr("Frame: the contact enlarged; displacements not exaggerated."));
  const std::string svg = overview->drawing.inline_svg();
  EXPECT_NE(svg.find("the-scene-clip-2"), std::string::npos);  // a window of its own
  EXPECT_FALSE(report::needs_close_up(narrow_contact(9)));
  EXPECT_THAT(report::draw_overview(picture())->text, Not(HasSubstr("Right:")));  // the contact is the whole side
}

/// Widths of the symbols in a drawing, which are the only shapes in their colour.
std::vector<double> symbols_of(const std::string& svg) {
  std::vector<double> widths;
  for (std::size_t at = svg.find("<path"); at != std::string::npos; at = svg.find("<path", at + 1)) {
    const std::string path = svg.substr(at, svg.find('>', at) - at);
    double x0 = 0, y0 = 0, x1 = 0;
    if (path.find("fill:#0072B2") != std::string::npos &&
        std::sscanf(path.c_str(), "<path d=\"M%lf %lfL%lf", &x0, &y0, &x1) == 3)
      widths.push_back(std::abs(x1 - x0));
  }
  return widths;
}

TEST(ReportPicture, SymbolsOfManyPointsDoNotCoverOneAnother) {
  const auto few = symbols_of(report::draw_overview(narrow_contact(9))->drawing.inline_svg());
  const auto many = symbols_of(report::draw_overview(narrow_contact(60))->drawing.inline_svg());
  ASSERT_EQ(few.size(), 10u);  // the last is that of the legend
  ASSERT_EQ(many.size(), 61u);
  EXPECT_EQ(few.front(), few.back());
  EXPECT_EQ(many.back(), few.back());
  // The window is 1.4 times as wide as the contact and has 300 pixels.
  EXPECT_LT(many.front(), 300 / 1.4 / 59);
  EXPECT_GT(many.front(), 2);  // pixels: the colour is seen
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
