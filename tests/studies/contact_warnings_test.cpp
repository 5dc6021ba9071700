#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "studies/run/explain.hpp"
#include "studies/run/warnings.hpp"
#include "tests/studies/cases.hpp"

namespace stickslip::contact_warnings {
namespace {

using nlohmann::json;
using testing::HasSubstr;

json elastic() { return {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}}; }

json box(const json& min, const json& max, const json& cells, const json& material = elastic()) {
  return {{"mesh", {{"box", {{"min", min}, {"max", max}, {"cells", cells}}}}}, {"material", material}};
}

CaseResult run(const json& scene, const char* method = "monolithic_al") {
  return cases::run(scene, {{method, json::object()}}, "scene.json");
}

/// The warnings of that code.
std::vector<Warning> of_code(const CaseResult& result, WarningCode code) {
  std::vector<Warning> found;
  for (const auto& warning : warnings_of(result))
    if (warning.code == code) found.push_back(warning);
  return found;
}

// --- at nodes ----------------------------------------------------------------------------------------------------

TEST(ContactAtNodes, HasASmoothMasterAtFiniteStrainUnlessFacetsAreAskedFor) {
  const std::string file = std::string(STICKSLIP_SOURCE_DIR) + "/studies/hard/pin-over-a-vertex.json";
  json scene = cases::load(file);
  const auto smoothing = [&] { return cases::read(scene, file).scene.contacts[0].smoothing; };
  EXPECT_EQ(smoothing(), Smoothing::catmull_rom);
  scene["contacts"]["t"]["surface"] = "faceted";
  EXPECT_EQ(smoothing(), Smoothing::none);
  for (const char* method : {"penalty", "uzawa_al", "monolithic_al"}) {
    const auto result = cases::run(scene, {{method, json::object()}}, file);
    EXPECT_FALSE(is_converged(result.status())) << method;
    EXPECT_THAT(result.message(), HasSubstr("or a smooth master")) << method;
  }
}

/// One method lets the node go at the end, the others hold it. Both are equilibria; the one that lets it go says so.
TEST(ContactAtNodes, SayWhereANodeIsHeldOrLetGoAtAnEndOfTheMaster) {
  const std::string file = std::string(STICKSLIP_SOURCE_DIR) + "/studies/hard/node-let-go-at-an-end.json";
  json scene = cases::load(file);
  const auto let_go = of_code(cases::run(scene, {{"uzawa_al", json::object()}}, file), WarningCode::non_unique);
  ASSERT_EQ(let_go.size(), 1u);
  EXPECT_THAT(let_go[0].text, HasSubstr("in 1 of 8 steps a node that presses comes to an end of its master"));
  scene["contacts"]["c"].erase("surface");  // the default, segments, has no such node
  EXPECT_TRUE(of_code(cases::run(scene, {{"uzawa_al", json::object()}}, file), WarningCode::non_unique).empty());
}

// --- the master's nodes ------------------------------------------------------------------------------------------

/// A block of one element over three elements of a slab, whose nodes are the slaves: none is under the block.
json block_between_nodes(bool finite) {
  const json rubber = {{"neo_hookean", {{"E", 1000}, {"nu", 0.3}}}}, material = finite ? rubber : elastic();
  json scene = {
      {"bodies",
       {{"block", box({0.3, 1}, {1.3, 2}, {1, 1}, material)}, {"slab", box({0, 0}, {4, 1}, {3, 1}, material)}}},
      {"contacts",
       {{"t", {{"slave", "slab.top"}, {"master", "block.bottom"}, {"friction", 0.8}, {"discretization", "node"}}}}},
      {"supports",
       {{{"on", "slab.bottom"}, {"move", {{"x", 0}, {"y", 0}}}},
        {{"on", "block.top"}, {"move", {{"x", 0}, {"y", {{0, 0}, {1, -0.1}}}}}}}},
      {"time", {{"end", 1}, {"steps", 2}}},
      {"responses", {{"N", {{"contact_force", {{"contact", "t"}, {"component", "normal"}}}}}}}};
  if (finite) scene["strain"] = "finite";
  return scene;
}

TEST(ContactWarnings, NameANodeOfTheMasterInsideOfTheSlave) {
  for (const bool finite : {false, true})
    for (const char* method : {"penalty", "uzawa_al", "monolithic_al"}) {
      const auto result = run(block_between_nodes(finite), method);
      ASSERT_EQ(result.status() == Status::converged || result.status() == Status::converged_at_roundoff, true);
      EXPECT_EQ(result.steps.back().responses[0], 0);
      const auto found = of_code(result, WarningCode::master_inside);
      ASSERT_EQ(found.size(), 1u) << method << finite;
      EXPECT_EQ(found[0].where, "t");
      EXPECT_NEAR(found[0].value, 0.1, 1e-12);  // the block goes straight down: by rounding
      EXPECT_THAT(found[0].text, HasSubstr("at t = 1 a node of block.bottom, at ("));
      EXPECT_THAT(found[0].remedy, HasSubstr("the other side as the slave"));
    }
}

TEST(ContactWarnings, DoWhatTheRemedySays) {
  json scene = block_between_nodes(true);
  scene["contacts"]["t"]["slave"] = "block.bottom";
  scene["contacts"]["t"]["master"] = "slab.top";
  EXPECT_TRUE(of_code(run(scene), WarningCode::master_inside).empty());
}

TEST(ContactWarnings, FindTheVertexOfAPolyline) {
  // a ridge between two nodes of a block
  json scene = {{"bodies", {{"block", box({0, 0}, {2, 1}, {2, 1})}}},
                {"obstacles", {{"ridge", {{"polyline", {{"points", {{0.3, -1}, {0.5, -0.05}, {0.7, -1}}}}}}}}},
                {"contacts", {{"t", {{"slave", "block.bottom"}, {"master", "ridge"}}}}},
                {"supports", {{{"on", "block.top"}, {"move", {{"x", 0}, {"y", {{0, 0}, {1, -0.1}}}}}}}},
                {"time", {{"end", 1}, {"steps", 1}}}};
  const auto found = of_code(run(scene), WarningCode::master_inside);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].value, 0.05, 1e-12);
  EXPECT_THAT(found[0].text, HasSubstr("a vertex of ridge, at (0.5, -0.05)"));
}

// --- width -------------------------------------------------------------------------------------------------------

json block_on_slab(double width, int cells, int slab_cells) {
  return {{"bodies",
           {{"block", box({1 - width / 2, 1}, {1 + width / 2, 1.2}, {cells, 4})},
            {"slab", box({0, 0}, {2, 1}, {slab_cells, slab_cells})}}},
          {"contacts", {{"t", {{"slave", "block.bottom"}, {"master", "slab.top"}, {"discretization", "node"}}}}},
          {"supports",
           {{{"on", "slab.bottom"}, {"move", {{"x", 0}, {"y", 0}}}},
            {{"on", "block.top"}, {"move", {{"x", 0}, {"y", -0.01}}}}}},
          {"time", {{"end", 1}, {"steps", 1}}}};
}

TEST(ContactWarnings, NameAContactThatIsNarrowerThanAFacetOfItsMaster) {
  const auto found = of_code(run(block_on_slab(0.2, 4, 2)), WarningCode::narrow_contact);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].value, 0.2, 1e-12);
  EXPECT_THAT(found[0].text, HasSubstr("0.2 of a facet of the master slab.top"));
  EXPECT_TRUE(of_code(run(block_on_slab(0.2, 4, 20)), WarningCode::narrow_contact).empty());
}

TEST(ContactWarnings, NameAContactOfOneFacetOfItsSlave) {
  // a drum over the middle of a facet
  json scene = {{"bodies", {{"b", box({-2, -2}, {2, 0}, {5, 3})}}},
                {"obstacles", {{"drum", {{"circle", {{"center", {0, 4}}, {"radius", 4}}}, {"move", {{"y", -0.06}}}}}}},
                {"contacts", {{"t", {{"slave", "b.top"}, {"master", "drum"}}}}},
                {"supports", {{{"on", "b.bottom"}, {"move", {{"x", 0}, {"y", 0}}}}}},
                {"time", {{"end", 1}, {"steps", 1}}}};
  const auto found = of_code(run(scene), WarningCode::narrow_contact);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].text, HasSubstr("two of 6 nodes"));
}

// --- obstacles turned inside out ---------------------------------------------------------------------------------

json block_on_ground(const json& ground, const json& support) {
  return {{"bodies", {{"b", box({-0.5, 0}, {0.5, 1}, {2, 2})}}},
          {"obstacles", {{"ground", ground}}},
          {"contacts", {{"s", {{"slave", "b.bottom"}, {"master", "ground"}, {"friction", 0.3}}}}},
          {"supports", json::array({support})},
          {"time", {{"end", 1}, {"steps", 1}}}};
}

TEST(ContactWarnings, TellToTurnAPolylineOrAPlaneRound) {
  const json down = {{"on", "b.top"}, {"move", {{"x", 0}, {"y", -0.01}}}};
  const json wrong = {{"polyline", {{"points", {{2, 0}, {0, 0}, {-2, 0}}}}}},
             right = {{"polyline", {{"points", {{-2, 0}, {0, 0}, {2, 0}}}}}};
  for (const char* strain : {"small", "finite"}) {
    json scene = block_on_ground(wrong, down);
    scene["strain"] = strain;
    if (scene["strain"] == "finite") scene["bodies"]["b"]["material"] = {{"neo_hookean", {{"E", 1000}, {"nu", 0.3}}}};
    const auto found = of_code(run(scene), WarningCode::turned_surface);
    ASSERT_EQ(found.size(), 1u) << strain;
    EXPECT_EQ(found[0].value, 3);
    EXPECT_THAT(found[0].remedy, HasSubstr("turn the points of the polyline round"));
    scene["obstacles"]["ground"] = right;
    EXPECT_TRUE(of_code(run(scene), WarningCode::turned_surface).empty()) << strain;
  }
  const auto plane = of_code(run(block_on_ground({{"plane", {{"point", {0, 0}}, {"normal", {0, -1}}}}}, down)),
                             WarningCode::turned_surface);
  ASSERT_EQ(plane.size(), 1u);
  EXPECT_THAT(plane[0].remedy, HasSubstr("turn the normal of the plane round"));
}

/// The obstacle is right, and the slave is the side that faces away from it.
TEST(ContactWarnings, TellOfASlaveOnTheFarSideOfItsBody) {
  const json plane = {{"plane", {{"point", {0, 0}}, {"normal", {0, 1}}}}};
  const json side = {{"on", "b.left"}, {"move", {{"x", 0}, {"y", 0}}}};
  json scene = block_on_ground(plane, side);
  scene["contacts"]["s"]["slave"] = "b.top";
  const auto found = of_code(run(scene), WarningCode::turned_surface);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].text, HasSubstr("it is the far side of the body"));
  EXPECT_EQ(found[0].remedy, "take b.bottom as the slave, which faces ground");
}

TEST(ContactWarnings, NameTheSideToTakeInSpaceToo) {
  const json above = {{"plane", {{"point", {0, 0, 0}}, {"normal", {0, 0, 1}}}}},
             turned = {{"plane", {{"point", {0, 0, 0}}, {"normal", {0, 0, -1}}}}};
  const json held = {{"on", "b.left"}, {"move", {{"x", 0}, {"y", 0}, {"z", 0}}}};
  json scene = block_on_ground(above, held);
  scene["space"] = "solid";
  scene["bodies"]["b"]["mesh"] = {{"box", {{"min", {0, 0, 0}}, {"max", {1, 1, 1}}, {"cells", {2, 2, 2}}}}};
  scene["contacts"]["s"]["slave"] = "b.top";
  const auto far_side = of_code(run(scene), WarningCode::turned_surface);
  ASSERT_EQ(far_side.size(), 1u);
  EXPECT_EQ(far_side[0].remedy, "take b.bottom as the slave, which faces ground");
  scene["contacts"]["s"]["slave"] = "b.bottom";
  EXPECT_TRUE(of_code(run(scene), WarningCode::turned_surface).empty());
  scene["obstacles"]["ground"] = turned;
  const auto inside_out = of_code(run(scene), WarningCode::turned_surface);
  ASSERT_EQ(inside_out.size(), 1u);
  EXPECT_THAT(inside_out[0].remedy, HasSubstr("turn the normal of the plane round"));
  json cup = {{"sphere", {{"center", {0.5, 0.5, -5}}, {"radius", 5}}}};
  scene["obstacles"]["ground"] = cup;
  EXPECT_TRUE(of_code(run(scene), WarningCode::turned_surface).empty());
  cup["sphere"]["inside"] = true;
  scene["obstacles"]["ground"] = cup;
  const auto turned_ball = of_code(run(scene), WarningCode::turned_surface);
  ASSERT_EQ(turned_ball.size(), 1u);
  EXPECT_THAT(turned_ball[0].remedy, HasSubstr("look at \"inside\" of the sphere"));
  json table = {{"mesh_side", {{"side", "bottom"}}}};
  table["mesh_side"]["mesh"] = {{"box", {{"min", {-1, -1, -1}}, {"max", {2, 2, 0}}, {"cells", {3, 3, 1}}}}};
  scene["obstacles"]["ground"] = table;
  const auto wrong_side = of_code(run(scene), WarningCode::turned_surface);
  ASSERT_EQ(wrong_side.size(), 1u);
  EXPECT_THAT(wrong_side[0].remedy, HasSubstr("take another side of its mesh"));
  table["mesh_side"]["side"] = "top";
  scene["obstacles"]["ground"] = table;
  EXPECT_TRUE(of_code(run(scene), WarningCode::turned_surface).empty());
}

/// Two blocks, one above the other, whose contact names sides that face away, or across.
TEST(ContactWarnings, NameTheSidesOfTwoBodiesThatFaceEachOther) {
  json scene = {
      {"bodies", {{"low", box({0, 0}, {2, 1}, {3, 2})}, {"up", box({0.5, 1}, {1.5, 2}, {2, 2})}}},
      {"contacts", {{"s", {{"slave", "up.top"}, {"master", "low.top"}}}}},
      {"supports",
       {{{"on", "low.bottom"}, {"move", {{"x", 0}, {"y", 0}}}}, {{"on", "up.left"}, {"move", {{"x", 0}, {"y", 0}}}}}},
      {"time", {{"end", 1}, {"steps", 1}}}};
  const auto found = of_code(run(scene), WarningCode::never_closes);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].remedy, "take up.bottom as the slave and low.top as the master, which face each other");
}

TEST(ContactWarnings, TellOfATurnedPolylineWhereARunFails) {
  json scene = block_on_ground({{"polyline", {{"points", {{2, 0}, {0, 0}, {-2, 0}}}}}},
                               {{"on", "b.left"}, {"move", {{"x", 0}}}});
  scene["loads"] = {{{"on", "b.top"}, {"traction", {0, -1}}}};
  const auto result = run(scene);
  EXPECT_EQ(result.status(), Status::no_equilibrium);
  EXPECT_THAT(result.message(), HasSubstr("turn the points of the polyline round"));
}

TEST(ContactWarnings, FindADiskThatStartsInsideOfItsObstacle) {
  json scene = {
      {"bodies",
       {{"d",
         {{"mesh", {{"disk", {{"center", {0, 1}}, {"radius", 1}, {"cells", {4, 2}}}}}}, {"material", elastic()}}}}},
      {"obstacles", {{"floor", {{"plane", {{"point", {0, 0}}, {"normal", {0, -1}}}}}}}},
      {"contacts", {{"s", {{"slave", "d.arc"}, {"master", "floor"}}}}},
      {"time", {{"end", 1}, {"steps", 1}}},
      {"method", {{"monolithic_al", json::object()}}}};
  const auto input = cases::read(scene, "scene.json");
  const Problem problem(input.scene);
  EXPECT_THAT(explain(input, problem), HasSubstr("warning (turned_surface): s: d.arc starts inside of the solid"));
  scene["obstacles"]["floor"]["plane"]["normal"] = {0, 1};
  const auto sound = cases::read(scene, "scene.json");
  EXPECT_THAT(explain(sound, Problem(sound.scene)), testing::Not(HasSubstr("warning")));
}

// --- moments -----------------------------------------------------------------------------------------------------

TEST(ContactWarnings, TellHowMuchTheMomentsOfSegmentsDiffer) {
  const auto ring = [](double inner, double outer, int cells, double from, double to) {
    return json{{"mesh",
                 {{"ring",
                   {{"center", {0, 0}},
                    {"inner", inner},
                    {"outer", outer},
                    {"cells", {2, cells}},
                    {"from_angle", from},
                    {"to_angle", to}}}}},
                {"material", {{"neo_hookean", {{"E", 1000}, {"nu", 0.3}}}}}};
  };
  const auto moment = [](const char* on) {
    return json{{"reaction", {{"on", on}, {"component", "moment"}, {"about", {0, 0}}}}};
  };
  const auto scene = [&](int finer) {
    return json{
        {"strain", "finite"},
        {"bodies", {{"in", ring(1, 1.5, 3 * finer, 10, 100)}, {"out", ring(1.5, 2, 4 * finer, 0, 120)}}},
        {"contacts",
         {{"t", {{"slave", "in.outer"}, {"master", "out.inner"}, {"discretization", "segment"}, {"friction", 0.3}}}}},
        {"supports",
         {{{"on", "out.outer"}, {"move", {{"x", 0}, {"y", 0}}}},
          {{"on", "in.inner"}, {"move", {{"x", 0.01}, {"y", 0.02}}}}}},
        {"time", {{"end", 1}, {"steps", 2}}},
        {"responses", {{"in", moment("in.inner")}, {"out", moment("out.outer")}}}};
  };
  const auto result = run(scene(1));
  const auto found = of_code(result, WarningCode::unbalanced_moment);
  ASSERT_EQ(found.size(), 1u);
  const auto& last = result.steps.back().responses;
  // the moments of both reactions differ by what the contact's do, to equilibrium
  EXPECT_NEAR(found[0].value, std::abs(last[0] + last[1]) / std::abs(last[0]), 1e-9);
  EXPECT_NEAR(found[0].value, 0.0304, 1e-3);
  EXPECT_TRUE(of_code(run(scene(2)), WarningCode::unbalanced_moment).empty());  // 0.24 %
}

// --- bodies ------------------------------------------------------------------------------------------------------

/// A half ring, clamped at one end and pushed at the other: one element through its wall, or four.
json half_ring(const char* element, int through, int around) {
  return {{"bodies",
           {{"tube",
             {{"mesh",
               {{"ring",
                 {{"center", {0, 0}},
                  {"inner", 0.95},
                  {"outer", 1.05},
                  {"cells", {through, around}},
                  {"from_angle", 0},
                  {"to_angle", 180}}}}},
              {"material", elastic()},
              {"element", element}}}}},
          {"supports",
           {{{"on", "tube.start"}, {"move", {{"x", 0}, {"y", 0}}}}, {{"on", "tube.end"}, {"move", {{"x", 0.01}}}}}},
          {"time", {{"end", 1}, {"steps", 1}}}};
}

TEST(BodyWarnings, NameShearLockingOfOneElementThroughTheWall) {
  const auto found = of_code(run(half_ring("Q4", 1, 31)), WarningCode::shear_locking);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].where, "tube");
  EXPECT_GT(found[0].value, 0.2);
  EXPECT_TRUE(of_code(run(half_ring("Q4", 4, 124)), WarningCode::shear_locking).empty());
  EXPECT_TRUE(of_code(run(half_ring("Q8", 1, 31)), WarningCode::shear_locking).empty());
  // short elements do not lock
  EXPECT_TRUE(of_code(run(half_ring("Q4", 1, 200)), WarningCode::shear_locking).empty());
}

TEST(BodyWarnings, DoNotNameABlockOfOneElementThatIsPressed) {
  json scene = {{"bodies", {{"b", box({0, 0}, {1, 1}, {1, 1})}}},
                {"obstacles", {{"floor", {{"plane", {{"point", {0, 0}}, {"normal", {0, 1}}}}}}}},
                {"contacts", {{"s", {{"slave", "b.bottom"}, {"master", "floor"}, {"friction", 0.3}}}}},
                {"supports", {{{"on", "b.top"}, {"move", {{"x", 0.001}, {"y", -0.01}}}}}},
                {"time", {{"end", 1}, {"steps", 1}}}};
  EXPECT_TRUE(of_code(run(scene), WarningCode::shear_locking).empty());
}

/// A block that a plate presses on a floor and leaves again; `held`: also along y.
json pressed_and_let_go(bool finite) {
  const json rubber = {{"neo_hookean", {{"E", 1000}, {"nu", 0.3}}}};
  json scene = {
      {"bodies", {{"b", box({0, 0}, {1, 1}, {2, 2}, finite ? rubber : elastic())}}},
      {"obstacles",
       {{"floor", {{"plane", {{"point", {0, 0}}, {"normal", {0, 1}}}}}},
        {"plate",
         {{"plane", {{"point", {0, 1}}, {"normal", {0, -1}}}}, {"move", {{"y", {{0, 0}, {1, -0.01}, {2, 0.01}}}}}}}}},
      {"contacts",
       {{"s", {{"slave", "b.bottom"}, {"master", "floor"}}}, {"p", {{"slave", "b.top"}, {"master", "plate"}}}}},
      {"supports", {{{"on", "b.left"}, {"move", {{"x", 0}}}}}},
      {"time", {{"end", 2}, {"steps", 4}}}};
  if (finite) scene["strain"] = "finite";
  return scene;
}

TEST(BodyWarnings, NameABodyThatFloatsOnceItIsLetGo) {
  for (const bool finite : {false, true}) {
    const auto result = run(pressed_and_let_go(finite), "penalty");
    if (!is_converged(result.status())) continue;  // (a method may also refuse it)
    const auto found = of_code(result, WarningCode::floating_body);
    ASSERT_EQ(found.size(), 1u) << finite;
    EXPECT_EQ(found[0].where, "b");
    EXPECT_THAT(found[0].text, HasSubstr("it is free to move along (0, 1)"));
  }
}

// --- the axis of revolution --------------------------------------------------------------------------------------

TEST(OnTheAxis, TheBoundaryOfABodyOfRevolutionMayBeASlave) {
  json scene = {
      {"space", "axisymmetric"},
      {"bodies", {{"disc", box({0, 0}, {1, 1}, {2, 2})}}},
      {"obstacles",
       {{"platen", {{"plane", {{"point", {0, 1}}, {"normal", {0, -1}}}}, {"move", {{"y", {{0, 0}, {1, -0.01}}}}}}}}},
      {"contacts", {{"c", {{"slave", "disc.boundary"}, {"master", "platen"}}}}},
      {"supports", {{{"on", "disc.bottom"}, {"move", {{"y", 0}}}}}},
      {"time", {{"end", 1}, {"steps", 1}}},
      {"responses",
       {{"F", {{"contact_force", {{"contact", "c"}, {"component", "normal"}}}}},
        {"p", {{"contact_pressure", {{"contact", "c"}, {"at", {0, 1}}}}}}}}};
  for (const char* method : {"penalty", "uzawa_al", "monolithic_al"}) {
    const auto whole = run(scene, method);
    ASSERT_TRUE(is_converged(whole.status())) << method << whole.message();
    json top = scene;
    top["contacts"]["c"]["slave"] = "disc.top";
    const auto of_top = run(top, method);
    // side and bottom press on nothing
    EXPECT_NEAR(whole.steps.back().responses[0], of_top.steps.back().responses[0],
                1e-9 * of_top.steps.back().responses[0])
        << method;
    EXPECT_NEAR(whole.steps.back().responses[1], 10, method == std::string("penalty") ? 0.05 : 1e-6);
  }
}

json ball_on_its_pole(const json& at) {
  return {{"space", "axisymmetric"},
          {"bodies",
           {{"b",
             {{"mesh", {{"box", {{"min", {0, 0}}, {"max", {1, 1}}, {"cells", {2, 2}}}}}},
              {"material", elastic()},
              {"element", "Q8"}}}}},
          {"obstacles", {{"f", {{"plane", {{"point", {0, 0}}, {"normal", {0, 1}}}}}}}},
          {"contacts", {{"c", {{"slave", "b.bottom"}, {"master", "f"}}}}},
          {"supports", {{{"on", "b.top"}, {"move", {{"y", -0.01}}}}}},
          {"time", {{"end", 1}, {"steps", 1}}},
          {"responses", {{"p", {{"contact_pressure", {{"contact", "c"}, {"at", at}}}}}}},
          {"method", {{"monolithic_al", json::object()}}}};
}

TEST(OnTheAxis, APoleWithoutAreaIsNamed) {
  const auto result = run(ball_on_its_pole({0.25, 0}));
  const auto found = of_code(result, WarningCode::no_area);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].value, 1);
  EXPECT_THAT(found[0].text, HasSubstr("the node of b.bottom at (0, 0) on the axis of revolution"));
  const auto input = cases::read(ball_on_its_pole({0.25, 0}), "scene.json");
  const std::string text = explain(input, Problem(input.scene));
  EXPECT_THAT(text, HasSubstr("warning (no_area): c: the node of b.bottom at (0, 0)"));
  EXPECT_THAT(text, testing::Not(HasSubstr("face no master")));
}

TEST(OnTheAxis, ThePressureAtAPoleWithoutAreaIsRefusedByName) {
  const auto input = cases::read(ball_on_its_pole({0, 0}), "scene.json");
  try {
    const Problem problem(input.scene);
    FAIL() << "its neighbour's pressure is another";
  } catch (const ModelError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is the node of b.bottom on the axis of revolution, where quadratic elements"));
    EXPECT_EQ(error.pointer, "/responses/p");
  }
}

}  // namespace
}  // namespace stickslip::contact_warnings
