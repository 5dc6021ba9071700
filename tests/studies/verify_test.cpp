/// `verify`: it holds for what the solver finds, and finds what is planted. Each planted fault changes a solution, its
/// result or its scene in one way, and the law that it breaks must be among those that are named.
#include "studies/verify/verify.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <functional>

#include "studies/io/input_fault.hpp"
#include "studies/run/certificate.hpp"
#include "studies/run/run_files.hpp"
#include "studies/run/simulation.hpp"
#include "studies/run/solution_file.hpp"
#include "tests/studies/cases.hpp"
#include "tests/studies/temporary_folder.hpp"

namespace stickslip::verify_tests {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// A solution and result.json, as files hold them.
struct Solved {
  json solution, result;
};

Solved solve(json document, const std::string& method = "") {
  if (!method.empty()) document["method"] = {{method, json::object()}};
  const Simulation simulation{cases::read(document, cases::shipped / "scene.json"), nullptr};
  const auto problem = std::make_shared<const Problem>(simulation.input.scene);
  const CaseResult result = simulate({simulation.input, problem});
  return {json::parse(solution_file(result, simulation.input.document).text),
          json::parse(result_json(result, "").dump())};
}

verify::Certificate certificate(const Solved& solved) {
  return verify::certify(solved.solution.at("scene"), solved.solution.at("mesh"), solved.solution, solved.result);
}

/// The laws that are broken, with what is printed of the first of each.
std::map<std::string, std::string> broken(const verify::Certificate& certificate) {
  std::map<std::string, std::string> laws;
  for (const auto& step : certificate.steps)
    for (const auto& [law, where, value, allowed, why] : step.findings)
      if (!(value <= allowed))
        laws.emplace(law, where + ": " + std::to_string(value / allowed) + " of what is allowed");
  return laws;
}

// --- scenes that the shipped ones leave out --------------------------------------------------------------------------

json linear() { return json::parse(R"({"linear_elastic": {"E": 1000, "nu": 0.3}})"); }
json rubber() { return json::parse(R"({"neo_hookean": {"E": 1000, "nu": 0.4, "volumetric": "log"}})"); }
json metal() {
  return json::parse(R"({"j2_plastic": {"E": 1000, "nu": 0.3, "hardening": [[0, 4], [0.01, 6], [0.05, 7]]}})");
}

/// A block that is pressed, squeezed and dragged, on a floor that moves.
json block(const std::string& space, const std::string& strain, const std::string& element, const json& material) {
  json scene = json::parse(R"({
    "bodies": {"block": {"mesh": {"box": {"min": [0, 0], "max": [1, 1], "cells": [3, 3]}}}},
    "obstacles": {"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}, "move": {"y": [[0, 0], [1, 0], [2, 0.02]]}}},
    "contacts": {"sole": {"slave": "block.bottom", "master": "floor", "friction": {"coulomb": 0.3, "limit": 2}}},
    "supports": [{"on": "block.top", "move": {"x": 0, "y": [[0, 0], [1, -0.03], [2, -0.01]]}}],
    "loads": [{"on": "block.right", "pressure": 3, "history": [[0, 0], [1, 1]]},
              {"on": "block", "body_force": [0, -1]}],
    "time": {"end": 2, "steps": 6},
    "responses": {"N": {"contact_force": {"contact": "sole", "component": "normal"}},
                  "R": {"reaction": {"on": "block.top", "component": "y"}},
                  "u": {"displacement": {"at": [0.37, 0.41], "component": "x"}},
                  "W": {"strain_energy": {}}, "D": {"dissipation": {"contact": "sole"}},
                  "s": {"slip": {"contact": "sole", "take": "max"}},
                  "w": {"contact_half_width": {"contact": "sole"}},
                  "g": {"gap": {"contact": "sole", "take": "min"}}},
    "method": {"monolithic_al": {}}})");
  scene["space"] = space;
  scene["strain"] = strain;
  scene["bodies"]["block"]["element"] = element;
  scene["bodies"]["block"]["material"] = material;
  if (space == "plane_stress") scene["bodies"]["block"]["thickness"] = 0.7;
  return scene;
}

/// A block of space, or a tube, that is pressed, dragged along two directions and twisted on a floor, a ball or a drum.
json solid(const std::string& strain, const std::string& element, const json& material, const std::string& obstacle,
           bool is_tube) {
  json scene = json::parse(R"({
    "space": "solid",
    "bodies": {"body": {"mesh": {"box": {"min": [-1, -1, 0], "max": [1, 1, 1], "cells": [3, 3, 2]}}}},
    "contacts": {"sole": {"slave": "body.bottom", "master": "o"}},
    "supports": [{"on": "body.top", "move": {"x": [[1, 0], [2, 0.03]], "y": [[1, 0], [2, -0.01]],
                                             "z": [[0, 0], [1, -0.05]]},
                  "rotate": {"center": [0.1, 0, 1], "axis": [0.1, 0, 1], "angle": [[1, 0], [2, 2]]}}],
    "loads": [{"on": "body.right", "pressure": 3, "history": [[0, 0], [1, 1]]}, {"on": "body", "body_force": [0, 0.2, -1]}],
    "time": {"end": 2, "steps": 6},
    "responses": {"N": {"contact_force": {"contact": "sole", "component": "normal"}},
                  "T": {"contact_force": {"contact": "sole", "component": "y"}},
                  "R": {"reaction": {"on": "body.top", "component": "z"}},
                  "u": {"displacement": {"at": [0.31, -0.57, 0.41], "component": "x"}},
                  "W": {"strain_energy": {}}, "D": {"dissipation": {"contact": "sole"}}},
    "method": {"monolithic_al": {}}})");
  scene["obstacles"]["o"] = json::parse(obstacle);
  scene["strain"] = strain;
  scene["bodies"]["body"]["element"] = element;
  scene["bodies"]["body"]["material"] = material;
  if (strain == "small" || obstacle.find("plane") != std::string::npos) scene["contacts"]["sole"]["friction"] = 0.3;
  if (!is_tube) return scene;
  scene["bodies"]["body"]["mesh"] = json::parse(R"({"extruded": {"mesh": {"ring": {"center": [0, 0], "inner": 0.4,
    "outer": 1, "cells": [2, 12]}}, "from": 0, "to": 1, "cells": 2}})");
  scene["contacts"]["sole"]["slave"] = "body.front";
  scene["supports"][0]["on"] = scene["responses"]["R"]["reaction"]["on"] = "body.back";
  scene["loads"][0]["on"] = "body.outer";
  return scene;
}

/// A block that is pressed on another with some interference, and drawn along it. No node meets a vertex.
json two_blocks(const std::string& strain, const json& surface, const std::string& discretization) {
  json scene = json::parse(R"({
    "bodies": {"low": {"mesh": {"quad": {"corners": [[0, 0], [4, 0], [4, 1.2], [0, 1]], "cells": [9, 3]}}},
               "up": {"mesh": {"quad": {"corners": [[1.1, 1.055], [3.1, 1.155], [3.1, 2], [1.1, 2]], "cells": [5, 2]}}}},
    "contacts": {"c": {"slave": "up.bottom", "master": "low.top", "friction": 0.25, "offset": -0.001}},
    "supports": [{"on": "low.bottom", "move": {"x": 0, "y": 0}},
                 {"on": "up.top", "move": {"x": [[0, 0], [1, 0], [3, 0.3]], "y": [[0, 0], [1, -0.08]]}}],
    "time": {"end": 3, "steps": 9},
    "responses": {"M": {"contact_force": {"contact": "c", "component": "moment", "about": [0, 0]}},
                  "R": {"reaction": {"on": "up.top", "component": "x"}}, "D": {"dissipation": {"contact": "c"}},
                  "p": {"contact_pressure": {"contact": "c", "take": "max"}}},
    "method": {"monolithic_al": {}}})");
  scene["strain"] = strain;
  for (const char* body : {"low", "up"}) scene["bodies"][body]["material"] = strain == "finite" ? rubber() : linear();
  scene["contacts"]["c"]["surface"] = surface;
  scene["contacts"]["c"]["discretization"] = discretization;
  return scene;
}

/// A block that is pressed on a barrel whose faces turn by 20 degrees, and drawn over it askew.
json on_barrel(const char* element, const json& surface) {
  json scene = json::parse(R"({
    "space": "solid", "strain": "finite",
    "bodies": {"barrel": {"mesh": {"extruded": {"mesh": {"ring": {"center": [0, 0], "inner": 0.5, "outer": 1, "cells": [2, 9],
                                     "from_angle": 0, "to_angle": 180}}, "from": 0, "to": 2, "cells": 4}}},
               "block": {"mesh": {"extruded": {"mesh": {"quad": {"corners": [[-0.52, 1.02], [0.57, 1.03], [0.57, 1.6], [-0.52, 1.6]],
                                    "cells": [5, 2]}}, "from": 0.43, "to": 1.54, "cells": 4}}}},
    "contacts": {"c": {"slave": "block.bottom", "master": "barrel.outer", "friction": 0.3}},
    "supports": [{"on": "barrel.inner", "move": {"x": 0, "y": 0, "z": 0}},
                 {"on": "block.top", "move": {"x": [[1, 0], [2, 0.15]], "y": [[0, 0], [1, -0.1]], "z": [[1, 0], [2, 0.1]]}}],
    "time": {"end": 2, "steps": 8},
    "responses": {"N": {"contact_force": {"contact": "c", "component": "normal"}}, "D": {"dissipation": {"contact": "c"}},
                  "g": {"gap": {"contact": "c", "take": "max"}}},
    "method": {"monolithic_al": {}}})");
  for (const char* body : {"barrel", "block"}) scene["bodies"][body]["material"] = rubber();
  scene["bodies"]["barrel"]["element"] = element;
  scene["contacts"]["c"]["surface"] = surface;
  return scene;
}

/// A block on an obstacle that moves and turns.
json on_obstacle(const std::string& strain, const std::string& obstacle, const std::string& discretization) {
  json scene = json::parse(R"({
    "bodies": {"block": {"mesh": {"box": {"min": [0, 0.08], "max": [1, 1], "cells": [4, 3]}}}},
    "contacts": {"sole": {"slave": "block.bottom", "master": "o", "friction": {"tresca": 3}}},
    "supports": [{"on": "block.top", "move": {"x": 0, "y": [[0, 0], [1, -0.12], [2, -0.1]]}},
                 {"on": "block.left & block.top", "along": [1, 0], "value": 0}],
    "time": {"end": 2, "steps": 6},
    "responses": {"N": {"contact_force": {"contact": "sole", "component": "normal"}}, "D": {"dissipation": {"contact": "sole"}}},
    "method": {"monolithic_al": {}}})");
  json& o = scene["obstacles"]["o"] = json::parse(obstacle);
  o["move"] = json::parse(R"({"x": [[0, 0], [1, 0.02], [2, 0.1]], "y": 0.004})");
  o["rotate"] = json::parse(R"({"center": [0.5, 1], "angle": [[0, 0], [1, 0], [2, 2]]})");
  scene["strain"] = strain;
  scene["bodies"]["block"]["material"] = strain == "finite" ? rubber() : linear();
  scene["contacts"]["sole"]["discretization"] = discretization;
  return scene;
}

constexpr const char *floor_in_space = R"({"plane": {"point": [0, 0, 0.01], "normal": [0.02, -0.01, 1]}})",
                     *ball = R"({"sphere": {"center": [0.1, 0, -6], "radius": 6}})",
                     *drum = R"({"cylinder": {"point": [0, 0, -4], "axis": [0.2, 1, 0], "radius": 4}})",
                     *bore = R"({"cylinder": {"point": [0, 0, 9], "axis": [1, 0, 0], "radius": 9.05, "inside": true}})";
constexpr const char *polyline = R"({"polyline": {"points": [[-3, 0], [-1, 0.1], [0.4, 0], [1.2, -0.02], [4, 0.3]]}})",
                     *circle = R"({"circle": {"center": [0.5, -3], "radius": 3}})",
                     *cup = R"({"circle": {"center": [0.5, 4], "radius": 4.05, "inside": true}})";

void expect_holds(const Solved& solved) {
  const auto judged = certificate(solved);
  EXPECT_TRUE(judged.holds()) << testing::PrintToString(broken(judged));
  EXPECT_THAT(judged.remarks, testing::IsEmpty());  // every response is measured again
  EXPECT_EQ(judged.steps.size(), solved.solution["increments"].size());
}

// --- it holds ----------------------------------------------------------------------------------------------------

class ShippedScene : public testing::TestWithParam<const char*> {};

TEST_P(ShippedScene, HoldsByEachMethod) {
  for (const char* method : {"penalty", "uzawa_al", "monolithic_al"}) {
    SCOPED_TRACE(method);
    expect_holds(solve(cases::load(cases::shipped / (std::string(GetParam()) + ".json")), method));
  }
}

INSTANTIATE_TEST_SUITE_P(Verify, ShippedScene,
                         testing::Values("ball_on_plane", "belt", "dented_metal", "dragged_ball", "greco_plate",
                                         "ironing", "plastic_bar", "press_fit", "pressed_block", "pull_out", "slider",
                                         "slope", "snap", "solid_ironing", "stop", "stop_bars", "tractrix", "truss"));

TEST(Verify, HoldsForEachElementMaterialAndSpace) {
  for (const char* element : {"Q4", "Q8", "T3", "T6", "Q4_mean_dilatation"})
    for (const char* space : {"plane_strain", "plane_stress", "axisymmetric"})
      for (const auto& [strain, material] :
           {std::pair{"small", linear()}, {"small", metal()}, {"finite", rubber()}, {"finite", metal()}}) {
        if (element == std::string("Q4_mean_dilatation") && space == std::string("plane_stress")) continue;
        if (space == std::string("plane_stress") && strain == std::string("finite") && material.contains("j2_plastic"))
          continue;  // (no pressure on metal there)
        SCOPED_TRACE(std::string(element) + ", " + space + ", " + strain + ", " + material.dump());
        expect_holds(solve(block(space, strain, element, material)));
      }
}

TEST(Verify, HoldsForEachSurfaceAndDiscretization) {
  for (const char* strain : {"small", "finite"}) {
    SCOPED_TRACE(strain);
    for (const auto& surface : {json("faceted"), json("smooth"), json{{"smooth", "b_spline"}}})
      expect_holds(solve(two_blocks(strain, surface, "node")));
    expect_holds(solve(two_blocks(strain, "faceted", "segment")));
    for (const char* obstacle : {polyline, circle, cup}) {
      SCOPED_TRACE(obstacle);
      expect_holds(solve(on_obstacle(strain, obstacle, "node")));
    }
    json segments = on_obstacle(strain, polyline, "segment");
    // (at small strain the solver turns an obstacle about x - g n, which is off the mean foot by the gap times the
    // angle)
    if (strain == std::string("small")) segments["obstacles"]["o"].erase("rotate");
    segments["contacts"]["sole"]["friction"] = 0.3;
    expect_holds(solve(segments));
  }
}

TEST(Verify, HoldsOfAPointFarPastTheEndOfASmoothMaster) {
  const json scene = json::parse(R"({
    "strain": "finite",
    "bodies": {"pin": {"mesh": {"point": {"at": [-0.3, 0.95]}},
                       "material": {"grounded_spring": {"stiffness": [[1000, 0], [0, 1000]]}}}},
    "obstacles": {"slab": {"polyline": {"points": [[0, 1], [2, 1]]}}},
    "contacts": {"t": {"slave": "pin.node", "master": "slab", "friction": 0.4, "surface": "smooth"}},
    "supports": [{"on": "pin.anchor", "move": {"x": [[0, 0], [1, 6e8]], "y": 0}}],
    "time": {"end": 1, "steps": 1}})");
  for (const auto& method : {"penalty", "uzawa_al", "monolithic_al"}) expect_holds(solve(scene, method));
}

/// Bent sides are integrated over what faces one facet, whatever ends behind that.
TEST(Verify, HoldsWhereAnotherWallIsBehindTheMaster) {
  for (const auto& method : {"penalty", "uzawa_al", "monolithic_al"})
    expect_holds(solve(cases::load(STICKSLIP_SOURCE_DIR "/studies/hard/another-wall-behind-the-floor.json"), method));
}

/// A bar that bends aside: of its nodes some may touch another part of it, none does, and some may touch nothing.
TEST(Verify, HoldsForTheGapOfASideThatDoesNotTouchItself) {
  json bar = json::parse(R"({
    "strain": "finite",
    "bodies": {"b": {"mesh": {"box": {"min": [-10, -0.25], "max": [10, 0.25], "cells": [40, 2]}}}},
    "contacts": {"self": {"between": ["b"], "self": true}},
    "supports": [{"on": "b.left", "move": {"x": [[0, 0], [1, 4]], "y": 0}},
                 {"on": "b.right", "move": {"x": [[0, 0], [1, -4]], "y": 0}}],
    "loads": [{"on": "b.top", "force": [0, 0.05]}],
    "time": {"end": 1, "steps": 8},
    "responses": {"gap": {"gap": {"contact": "self", "take": "min"}}}})");
  bar["bodies"]["b"]["material"] = rubber();
  const auto solved = solve(bar, "monolithic_al");
  EXPECT_GT(solved.result["steps"].back()["responses"]["gap"].get<double>(), 1);  // (round a corner it is half a cell)
  EXPECT_THAT(broken(certificate(solved)), testing::IsEmpty());
}

TEST(Verify, HoldsForSolidBodiesInSpace) {
  for (const char* element : {"H8", "H8_mean_dilatation", "T4", "T10", "H20", "H27"})
    for (const auto& [strain, material] :
         {std::pair{"small", linear()}, {"small", metal()}, {"finite", rubber()}, {"finite", metal()}}) {
      SCOPED_TRACE(std::string(element) + ", " + strain + ", " + material.dump());
      expect_holds(solve(solid(strain, element, material, floor_in_space, false)));
    }
  for (const char* strain : {"small", "finite"})
    for (const char* obstacle : {ball, drum, bore}) {
      SCOPED_TRACE(std::string(strain) + obstacle);
      const json material = strain == std::string("finite") ? rubber() : linear();
      expect_holds(solve(solid(strain, "H8", material, obstacle, true)));
      expect_holds(solve(solid(strain, "T4", material, obstacle, true), "penalty"));
    }
  for (const char* element : {"T10", "H20", "H27"}) expect_holds(solve(solid("finite", element, rubber(), ball, true)));
}

/// Integrated over what faces overlap: the curved barrel and the block of all elements, obstacles, and a slave side of
/// which some nodes carry nothing.
TEST(Verify, HoldsForSegmentsInSpace) {
  for (const char* element : {"H8", "H20"}) {
    SCOPED_TRACE(element);
    json scene = on_barrel(element, "faceted");
    scene["strain"] = "small";
    scene["time"]["steps"] = 2;
    scene["contacts"]["c"]["discretization"] = "segment";
    for (const char* body : {"barrel", "block"}) scene["bodies"][body]["material"] = linear();
    EXPECT_THAT(broken(certificate(solve(scene))), testing::IsEmpty());  // (a moment is left, as on any facets)
    scene["contacts"]["c"]["slave"] = "block.bottom - block.front";
    EXPECT_THAT(broken(certificate(solve(scene, "penalty"))), testing::IsEmpty());
    if (element != std::string("H8")) continue;
    scene["contacts"]["c"]["slave"] = "block.boundary";  // the far sides of either are inside of nothing
    scene["contacts"]["c"]["master"] = "barrel.boundary";
    const auto solved = solve(scene);
    EXPECT_THAT(broken(certificate(solved)), testing::IsEmpty());
    EXPECT_GT(solved.result["steps"][0]["responses"]["N"].get<double>(), 0);
  }
  for (const auto& [obstacle, element] :
       {std::pair{floor_in_space, "H27"}, {floor_in_space, "T10"}, {ball, "T4"}, {drum, "T10"}, {bore, "H8"}}) {
    SCOPED_TRACE(std::string(element) + obstacle);
    json scene = solid("small", element, linear(), obstacle, obstacle != floor_in_space);
    scene["contacts"]["sole"]["discretization"] = "segment";
    expect_holds(solve(scene));
  }
}

/// A body whose whole boundary is a slave has the normal of its sole at the corners of the sole. A master ends where
/// its sole does: what is beside it faces nothing.
TEST(Verify, HoldsAtTheCornersOfASlaveSide) {
  json plane = json::parse(R"({
    "bodies": {"upper": {"mesh": {"box": {"min": [1, 1], "max": [3, 2], "cells": [4, 2]}}},
               "lower": {"mesh": {"box": {"min": [0, 0], "max": [4.2, 1], "cells": [5, 2]}}}},
    "contacts": {"c": {"slave": "upper.boundary", "master": "lower.top", "friction": 0.3}},
    "supports": [{"on": "lower.bottom", "move": {"x": 0, "y": 0}}, {"on": "upper.top", "move": {"x": 0.01, "y": -0.02}}],
    "responses": {"N": {"contact_force": {"contact": "c", "component": "normal"}}},
    "time": {"end": 1, "steps": 2}})");
  json space = json::parse(R"({
    "space": "solid",
    "bodies": {"upper": {"mesh": {"box": {"min": [1, 1, 1], "max": [3, 2, 2], "cells": [3, 2, 2]}}},
               "lower": {"mesh": {"box": {"min": [0, 0, 0], "max": [4.2, 3, 1], "cells": [5, 4, 2]}}},
               "beside": {"mesh": {"box": {"min": [3, 1, 1], "max": [4, 2, 1.5], "cells": [1, 1, 1]}}}},
    "contacts": {"c": {"between": "all", "friction": 0.3}},
    "supports": [{"on": "lower.bottom", "move": {"x": 0, "y": 0, "z": 0}}, {"on": "beside.top", "move": {"x": 0, "y": 0, "z": -0.01}},
                 {"on": "upper.top", "move": {"x": [[0, 0], [1, 0.01], [2, 0.02]], "y": 0, "z": -0.02}}],
    "responses": {"N": {"contact_force": {"contact": "c/upper~lower", "component": "normal"}}},
    "time": {"end": 2, "steps": 4}})");
  for (json* scene : {&plane, &space})
    for (auto& [name, body] : (*scene)["bodies"].items()) body["material"] = linear();
  for (const char* method : {"penalty", "uzawa_al", "monolithic_al"}) {
    SCOPED_TRACE(method);
    expect_holds(solve(plane, method));
    plane["contacts"]["c"]["surface"] = "smooth";
    expect_holds(solve(plane, method));
    plane["contacts"]["c"].erase("surface");
    expect_holds(solve(space, method));
  }
  json finite = space;
  finite["strain"] = "finite";
  for (auto& [name, body] : finite["bodies"].items()) body["material"] = rubber();
  expect_holds(solve(finite, "monolithic_al"));
  // the far side of the upper block is two blocks away from what it could face through the whole body beside it
  finite["contacts"] = {{"far", {{"slave", "upper.left"}, {"master", "beside.boundary"}}},
                        {"c", {{"slave", "upper.bottom"}, {"master", "lower.top"}, {"friction", 0.3}}},
                        {"d", {{"slave", "beside.bottom"}, {"master", "lower.top"}, {"friction", 0.3}}}};
  finite["responses"] = {{"N", {{"contact_force", {{"contact", "far"}, {"component", "normal"}}}}}};
  const auto apart = solve(finite, "monolithic_al");
  expect_holds(apart);
  ASSERT_FALSE(apart.solution["increments"].empty());
  EXPECT_EQ(apart.result["steps"].back()["responses"]["N"], 0);
}

/// What is at a right angle to a slave side does not face it, however the bodies are turned: rounding does not decide.
TEST(Verify, HoldsForSmoothSolesThatAreTurned) {
  for (const bool solid : {false, true})
    for (const double angle : {0.5, 1.0, 3.5}) {
      const auto at = [c = std::cos(angle), s = std::sin(angle)](double x, double y) {
        return json{c * x - s * y, s * x + c * y};
      };
      const auto block = [&](double left, double low, double right, double high, const json& cells) {
        json mesh = {
            {"quad",
             {{"corners", {at(left, low), at(right, low), at(right, high), at(left, high)}}, {"cells", cells}}}};
        if (solid) mesh = {{"extruded", {{"mesh", mesh}, {"from", low}, {"to", low + 2}, {"cells", 2}}}};
        return json{{"mesh", mesh}, {"material", linear()}};
      };
      json down = {{"x", at(0, -0.02)[0]}, {"y", at(0, -0.02)[1]}}, held = {{"x", 0}, {"y", 0}};
      if (solid) down["z"] = held["z"] = 0;
      json scene = {
          {"bodies", {{"upper", block(1, 1, 3, 2, {3, 2})}, {"lower", block(0, 0, 5, 1, {10, 2})}}},
          {"contacts", {{"c", {{"slave", "lower.top"}, {"master", "upper.boundary"}, {"surface", "smooth"}}}}},
          {"supports", {{{"on", "lower.bottom"}, {"move", held}}, {{"on", "upper.top"}, {"move", down}}}},
          {"responses", {{"N", {{"contact_force", {{"contact", "c"}, {"component", "normal"}}}}}}},
          {"time", {{"end", 1}, {"steps", 1}}}};
      if (solid) scene["space"] = "solid";
      SCOPED_TRACE(angle);
      expect_holds(solve(scene, "monolithic_al"));
    }
}

/// A block slides along a larger one that is the slave: nodes leave its sole and others come onto it. A node that faced
/// nothing, and that Newton's method takes for one in contact, touches no node of the sole.
TEST(Verify, HoldsWhereNodesComeOntoASole) {
  const auto block = [](const char* corners, const char* cells, double from, double to, int layers) {
    const json plane = {{"quad", {{"corners", json::parse(corners)}, {"cells", json::parse(cells)}}}};
    return json{{"mesh", {{"extruded", {{"mesh", plane}, {"from", from}, {"to", to}, {"cells", layers}}}}},
                {"element", "T4"},
                {"material", {{"neo_hookean", {{"E", 100}, {"nu", 0.3}}}}}};
  };
  json scene = {{"space", "solid"},
                {"strain", "finite"},
                {"bodies",
                 {{"upper", block("[[1, 1], [3, 1], [3, 2], [1, 2]]", "[3, 2]", 1, 3, 3)},
                  {"lower", block("[[0, 0], [4, 0], [4, 1], [0, 1]]", "[8, 2]", 0, 4, 8)}}},
                {"contacts", {{"c", {{"slave", "lower.top"}, {"master", "upper.boundary"}, {"friction", 0.3}}}}},
                {"supports",
                 {{{"on", "lower.bottom"}, {"move", {{"x", 0}, {"y", 0}, {"z", 0}}}},
                  {{"on", "upper.top"}, {"move", {{"x", 0.3}, {"y", -0.02}, {"z", 0}}}}}},
                {"responses", {{"N", {{"contact_force", {{"contact", "c"}, {"component", "normal"}}}}}}},
                {"time", {{"end", 1}, {"steps", 2}}}};
  for (const char* method : {"penalty", "monolithic_al"}) {
    SCOPED_TRACE(method);
    expect_holds(solve(scene, method));
  }
  // a smaller one: where nodes far away would have their foot past a corner of its sole
  scene["bodies"]["upper"] = block("[[0.5, 1], [1.77, 1], [1.77, 2], [0.5, 2]]", "[3, 2]", 0.5, 1.77, 3);
  scene["supports"][1]["move"]["x"] = {{0, 0}, {1, 0.3}};
  expect_holds(solve(scene, "monolithic_al"));
}

/// A block stands on a table of the plane, and its walls lean outwards: they look at the table, but only its sole faces
/// it. So the whole boundary of the block is as good a master as its sole, also for nodes exactly below its corners.
TEST(Verify, HoldsWhereTheWallsOfABlockLean) {
  const auto block = [](const char* corners, const char* cells) {
    return json{{"mesh", {{"quad", {{"corners", json::parse(corners)}, {"cells", json::parse(cells)}}}}}};
  };
  json scene = {{"bodies",
                 {{"upper", block("[[1, 1], [3, 1], [3.13, 2], [0.87, 2]]", "[3, 2]")},
                  {"lower", block("[[0, 0], [5, 0], [5, 1], [0, 1]]", "[20, 4]")}}},
                {"contacts", {{"c", {{"slave", "lower.top"}, {"friction", 0.3}}}}},
                {"supports",
                 {{{"on", "lower.bottom"}, {"move", {{"x", 0}, {"y", 0}}}},
                  {{"on", "upper.top"}, {"move", {{"x", 0}, {"y", -0.02}}}}}},
                {"responses", {{"N", {{"contact_force", {{"contact", "c"}, {"component", "normal"}}}}}}},
                {"time", {{"end", 1}, {"steps", 2}}}};
  for (const char* strain : {"small", "finite"})
    for (const char* surface : {"segments", "faceted", "smooth"})
      for (const char* method : {"penalty", "uzawa_al", "monolithic_al"}) {
        SCOPED_TRACE(std::string(strain) + " " + surface + " " + method);
        scene["strain"] = strain;
        for (auto& [name, body] : scene["bodies"].items())
          body["material"] = strain == std::string("small") ? linear() : rubber();
        json& contact = scene["contacts"]["c"];
        contact["discretization"] = surface == std::string("segments") ? "segment" : "node";
        contact.erase("surface");
        if (surface != std::string("segments")) contact["surface"] = surface;
        std::vector<double> forces;
        for (const char* master : {"upper.bottom", "upper.boundary"}) {
          contact["master"] = master;
          const auto solved = solve(scene, method);
          expect_holds(solved);
          ASSERT_FALSE(solved.solution["increments"].empty());
          forces.push_back(solved.result["steps"].back()["responses"]["N"].get<double>());
        }
        EXPECT_GT(forces[0], 1);
        // (the springs of a penalty are as stiff as the two sides, of which the walls are a part)
        EXPECT_NEAR(forces[1], forces[0], (method == std::string("penalty") ? 1e-3 : 1e-9) * forces[0]);
      }
}

/// A block that is pressed onto a table: the walls of the block, which its press tilts, take no node from the sole. So
/// the methods find the same contact, also where nodes of the table are below the edges of the sole.
TEST(Verify, HoldsWhereABlockStandsOnATable) {
  const auto block = [](const char* low, const char* high, const char* cells) {
    return json{
        {"mesh", {{"box", {{"min", json::parse(low)}, {"max", json::parse(high)}, {"cells", json::parse(cells)}}}}},
        {"material", rubber()}};
  };
  json scene = {{"space", "solid"},
                {"strain", "finite"},
                {"bodies",
                 {{"upper", block("[1, 1, 1]", "[3, 3, 2]", "[3, 3, 2]")},
                  {"lower", block("[0, 0, 0]", "[4, 4, 1]", "[8, 8, 2]")}}},
                {"contacts", {{"c", {{"slave", "lower.top"}, {"master", "upper.boundary"}, {"friction", 0.3}}}}},
                {"supports",
                 {{{"on", "lower.bottom"}, {"move", {{"x", 0}, {"y", 0}, {"z", 0}}}},
                  {{"on", "upper.top"}, {"move", {{"x", 0}, {"y", 0}, {"z", -0.02}}}}}},
                {"responses", {{"N", {{"contact_force", {{"contact", "c"}, {"component", "normal"}}}}}}},
                {"time", {{"end", 1}, {"steps", 2}}}};
  for (const auto& [element, edge] : {std::pair("T4", 0.93), {"H8", 0.93}, {"T4", 1.0}, {"H8", 1.0}}) {
    for (const char* body : {"upper", "lower"}) scene["bodies"][body]["element"] = element;
    json& box = scene["bodies"]["upper"]["mesh"]["box"];
    for (const int i : {0, 1}) {
      box["min"][i] = edge;
      box["max"][i] = 4 - edge;
    }
    std::vector<double> forces;
    for (const char* method : {"penalty", "uzawa_al", "monolithic_al"}) {
      SCOPED_TRACE(element + std::to_string(edge) + method);
      const auto solved = solve(scene, method);
      expect_holds(solved);
      ASSERT_FALSE(solved.solution["increments"].empty());
      forces.push_back(solved.result["steps"].back()["responses"]["N"].get<double>());
    }
    for (const double force : forces) EXPECT_NEAR(force, forces.back(), 1e-3 * forces.back());  // compliance of springs
  }
}

TEST(Verify, HoldsForSolidBodiesThatSlideOnOneAnother) {
  for (const char* element : {"H8", "T4"})
    for (const auto& surface :
         {json("smooth"), json{{"smooth", "b_spline"}}, json{{"smooth", "catmull_rom"}, {"corner", 15}}})
      for (const char* method : {"penalty", "monolithic_al"}) {
        SCOPED_TRACE(element + surface.dump() + method);
        expect_holds(solve(on_barrel(element, surface), method));
      }
  expect_holds(solve(on_barrel("H8", "faceted"), "penalty"));
  for (const char* element : {"T10", "H20", "H27"}) {
    json scene = on_barrel(element, "smooth");
    scene["bodies"]["block"]["element"] = element;
    scene["bodies"]["block"]["mesh"]["extruded"]["mesh"]["quad"]["cells"] = json::parse("[3, 1]");
    scene["bodies"]["block"]["mesh"]["extruded"]["cells"] = 2;
    SCOPED_TRACE(element);
    expect_holds(solve(scene));
  }
}

/// Forces of segments act where each side is; between curved sides these are two places.
TEST(Verify, TellsTheMomentThatAContactLeaves) {
  const fs::path hard = fs::path(STICKSLIP_SOURCE_DIR) / "studies" / "hard";
  const auto judged = certificate(solve(cases::load(hard / "moment-of-segments.json")));
  EXPECT_TRUE(judged.holds());
  EXPECT_THAT(judged.remarks, testing::ElementsAre(testing::HasSubstr("moments of the forces of t on its two sides "
                                                                      "differ by up to 0.073")));
}

/// Of a path by arc length no times are asked for; a solution without a state is none all the same.
TEST(Verify, DoesNotHoldOfASolutionWithoutAState) {
  for (const char* name : {"snap", "stop"}) {
    const Solved solved = solve(cases::load(cases::shipped / (std::string(name) + ".json")));
    json empty = solved.solution;
    empty["increments"] = json::array();
    const auto judged = verify::certify(empty.at("scene"), empty.at("mesh"), empty, json::object());
    EXPECT_FALSE(judged.holds()) << name;
    EXPECT_EQ(judged.steps.back().worst().law, "steps") << name;
  }
}

TEST(Verify, FindsForcesWhereAProgramGivesNone) {
  Solved solved = solve(cases::load(cases::shipped / "greco_plate.json"), "monolithic_al");
  for (auto& increment : solved.solution["increments"]) increment.erase("contacts");
  expect_holds(solved);
}

/// A column of bars along y: the size that tells places apart is that of all coordinates, and its nodes may come in any
/// order, with the digits of a file.
TEST(Verify, MatchesNodesOfAnotherProgramByTheirPlaces) {
  const json scene = {{"bodies",
                       {{"b",
                         {{"mesh", {{"line", {{"from", {0, 0}}, {"to", {0, 3}}, {"cells", 3}}}}},
                          {"element", "bar"},
                          {"area", 1},
                          {"material", {{"linear_elastic", {{"E", 10}, {"nu", 0}}}}}}}}},
                      {"supports",
                       {{{"on", "b.nodes"}, {"move", {{"x", 0}}}},
                        {{"on", "b.start"}, {"move", {{"y", 0}}}},
                        {{"on", "b.end"}, {"move", {{"y", -0.3}}}}}},
                      {"time", {{"end", 1}, {"steps", 1}}},
                      {"method", {{"monolithic_al", json::object()}}}};
  const TemporaryFolder own_folder;
  const fs::path& directory = own_folder.path;
  const Simulation simulation{cases::read(scene, cases::shipped / "scene.json"), nullptr};
  const Simulation made{simulation.input, std::make_shared<const Problem>(simulation.input.scene)};
  write_result(directory, made, simulate(made));
  std::ifstream in(directory / "solution.json");
  json peer = json::parse(in);
  peer["nodes"] = json::array();
  json& u = peer["increments"][0]["displacement"];
  const json own = u;
  for (int n = 3; n >= 0; --n) {  // from the other end
    peer["nodes"].push_back({0, n + 1e-7});
    for (int i = 0; i < 2; ++i) u[2 * (3 - n) + i] = own[2 * n + i];
  }
  const std::string file = (directory / "peer.json").string();
  std::ofstream(file) << peer.dump();
  EXPECT_TRUE(certificate_of(directory, file).holds());
  peer["nodes"][0][1] = 2.9;
  std::ofstream(file) << peer.dump();
  EXPECT_THROW(certificate_of(directory, file), InputFault);
}

TEST(Verify, RefusesWhatDoesNotFit) {
  Solved solved = solve(cases::load(cases::shipped / "slider.json"));
  Solved shorter = solved;
  shorter.solution["increments"][0]["displacement"].erase(0);
  EXPECT_THROW(certificate(shorter), verify::BadFile);
  Solved backwards = solved;
  backwards.solution["increments"][1]["time"] = -1;
  EXPECT_THROW(certificate(backwards), verify::BadFile);
  (*solved.solution["mesh"]["bodies"].begin())["elements"][0][0] = 99;
  EXPECT_THROW(certificate(solved), verify::BadFile);
  Solved unknown = solve(block("plane_strain", "finite", "Q4", rubber()));
  unknown.solution["scene"]["bodies"]["block"]["material"] = {{"cork", {{"E", 1000}, {"nu", 0.4}}}};
  EXPECT_THROW(certificate(unknown), verify::BadFile);
}

// --- it finds what is planted --------------------------------------------------------------------------------------

struct Fault {
  std::string name;
  std::string base;  ///< scene that is solved first
  std::string law;   ///< that must be named
  std::function<void(Solved&)> plant;
  friend void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }
};

json scene_of(const std::string& base) {
  if (base == "block") return block("plane_strain", "small", "Q4", linear());
  if (base == "rubber block") return block("plane_strain", "finite", "Q4", rubber());
  if (base == "metal block") return block("plane_strain", "finite", "Q4", metal());
  if (base == "solid") return solid("finite", "H8", rubber(), floor_in_space, false);
  if (base == "two blocks") return two_blocks("finite", "smooth", "node");
  if (base == "segments") return two_blocks("finite", "faceted", "segment");
  if (base == "barrel") return on_barrel("H8", "smooth");
  if (base == "polyline") return on_obstacle("finite", polyline, "node");
  return cases::load(cases::shipped / (base + ".json"));
}

json& last(Solved& solved) { return solved.solution["increments"].back(); }
json& contact(Solved& solved) { return *last(solved)["contacts"].begin(); }

void scale(json& numbers, double factor) {
  for (auto& number : numbers) number = number.get<double>() * factor;
}
void add(json& number, double by) { number = number.get<double>() + by; }

/// Index of a point of the contact with the largest pressure, in the plane, and without any.
std::size_t pressed(Solved& solved) {
  const json& t = contact(solved)["traction"];
  std::size_t most = 0;
  for (std::size_t k = 0; 2 * k < t.size(); ++k)
    if (std::abs(t[2 * k + 1].get<double>()) > std::abs(t[2 * most + 1].get<double>())) most = k;
  return most;
}
std::size_t open(Solved& solved) {
  const json& t = contact(solved)["traction"];
  for (std::size_t k = 0; 2 * k < t.size(); ++k)
    if (t[2 * k] == 0 && t[2 * k + 1] == 0) return k;
  throw std::out_of_range("no point is open");
}
json& displacement(Solved& solved, std::size_t point, int axis) {
  return last(solved)["displacement"][2 * contact(solved)["nodes"][point].get<std::size_t>() + axis];
}

/// Sets an entry of the scene by its pointer.
std::function<void(Solved&)> in_scene(const std::string& pointer, const json& value) {
  return [=](Solved& solved) { solved.solution["scene"][json::json_pointer(pointer)] = value; };
}
std::function<void(Solved&)> in_response(const std::string& name, double factor) {
  return [=](Solved& solved) {
    json& value = solved.result["steps"].back()["responses"].at(name);
    value = value.get<double>() * factor;
  };
}

json& pressure(Solved& solved) { return contact(solved)["traction"][2 * pressed(solved) + 1]; }

/// Faults of the numbers of a solution.
std::vector<Fault> in_numbers() {
  return {
      {"all tractions larger by 1e-6", "greco_plate", "equilibrium",
       [](Solved& s) { scale(contact(s)["traction"], 1 + 1e-6); }},
      {"one pressure larger by 1e-6", "block", "equilibrium",
       [](Solved& s) { add(pressure(s), 1e-6 * pressure(s).get<double>()); }},
      {"forces that do not balance", "block", "balance of forces",
       [](Solved& s) { scale(contact(s)["traction"], 1.001); }},
      {"a moment too many", "block", "balance of moments",
       [](Solved& s) {
         add(contact(s)["traction"][1], 0.1);
         add(contact(s)["traction"][contact(s)["traction"].size() - 1], -0.1);
       }},
      {"a pressure per wrong area", "greco_plate", "equilibrium", [](Solved& s) { scale(contact(s)["traction"], 2); }},
      {"forces in place of tractions", "two blocks", "equilibrium",
       [](Solved& s) { scale(contact(s)["traction"], 0.4); }},
      {"a free node displaced by 1e-6", "block", "equilibrium",
       [](Solved& s) { add(last(s)["displacement"][2 * 5], 1e-6 * 0.03); }},
      {"two nodes swapped", "block", "equilibrium",
       [](Solved& s) {
         for (int i = 0; i < 2; ++i) std::swap(last(s)["displacement"][2 * 5 + i], last(s)["displacement"][2 * 6 + i]);
       }},
      {"two nodes swapped in space", "tractrix", "equilibrium",
       [](Solved& s) { std::swap(last(s)["displacement"][0], last(s)["displacement"][1]); }},
      {"a free node of a solid displaced by 1e-6", "solid", "equilibrium",
       [](Solved& s) { add(last(s)["displacement"][3 * 20], 1e-6 * 0.05); }},
      {"all tractions of a solid larger by 1e-6", "solid", "equilibrium",
       [](Solved& s) { scale(contact(s)["traction"], 1 + 1e-6); }},
      {"a point of a solid inside of its obstacle", "solid", "gap",
       [](Solved& s) {
         for (std::size_t n = 0; n < 16; ++n) add(last(s)["displacement"][3 * n + 2], -1e-5);
       }},
      {"friction of a solid turned by a right angle", "solid", "slip direction",
       [](Solved& s) {
         json& t = contact(s)["traction"];
         for (std::size_t k = 0; 3 * k < t.size(); ++k) {
           const double x = t[3 * k];
           t[3 * k] = -t[3 * k + 1].get<double>();
           t[3 * k + 1] = x;
         }
       }},
      {"a point of a solid inside of another", "barrel", "gap",
       [](Solved& s) {
         for (const auto& node : contact(s)["nodes"])
           add(last(s)["displacement"][3 * node.get<std::size_t>() + 1], -1e-5);
       }},
      {"friction on another solid turned by a right angle", "barrel", "slip direction",
       [](Solved& s) {
         json& t = contact(s)["traction"];
         for (std::size_t k = 0; 3 * k < t.size(); ++k) std::swap(t[3 * k], t[3 * k + 2]);
       }},
      {"a displacement that is no number", "block", "equilibrium",
       [](Solved& s) { last(s)["displacement"][2 * 5] = nullptr; }},
      {"an element inside out", "rubber block", "elements",
       [](Solved& s) { add(last(s)["displacement"][2 * 5 + 1], 5); }},
      {"a support that is not followed", "block", "supports",
       [](Solved& s) { add(last(s)["displacement"][2 * 15 + 1], 1e-6); }},
      {"a point inside of its obstacle", "block", "gap", [](Solved& s) { add(displacement(s, pressed(s), 1), -1e-5); }},
      {"a point inside of a body", "two blocks", "gap", [](Solved& s) { add(displacement(s, pressed(s), 1), -1e-5); }},
      {"a point inside of a polyline", "polyline", "gap",
       [](Solved& s) { add(displacement(s, pressed(s), 1), -1e-5); }},
      {"a pressed point that is apart", "block", "complementarity",
       [](Solved& s) { add(displacement(s, pressed(s), 1), 1e-5); }},
      {"an open point that bears", "greco_plate", "complementarity",
       [](Solved& s) { contact(s)["traction"][2 * open(s) + 1] = 1.0; }},
      {"tension", "block", "tension", [](Solved& s) { pressure(s) = -pressure(s).get<double>(); }},
      {"a traction where no contact is", "block", "place of contact",
       [](Solved& s) { contact(s)["nodes"][pressed(s)] = 15; }},
      {"friction beyond its bound", "greco_plate", "cone",
       [](Solved& s) {
         const std::size_t k = pressed(s);
         contact(s)["traction"][2 * k] = 2 * contact(s)["traction"][2 * k + 1].get<double>();
       }},
      {"friction without a coefficient", "press_fit", "cone",
       [](Solved& s) {
         json& t = contact(s)["traction"];
         std::swap(t[2 * 3], t[2 * 3 + 1]);
       }},
      {"a slip against its traction", "slider", "slip direction",
       [](Solved& s) { contact(s)["traction"][0] = -contact(s)["traction"][0].get<double>(); }},
      {"friction that gives energy", "slider", "dissipation",
       [](Solved& s) { contact(s)["traction"][0] = -contact(s)["traction"][0].get<double>(); }},
      {"a stick that slid", "greco_plate", "stick",
       [](Solved& s) {
         const json& t = contact(s)["traction"];
         std::size_t k = 0;  // a point well inside of its cone
         while (!(std::abs(t[2 * k].get<double>()) < 0.5 * std::abs(t[2 * k + 1].get<double>()))) ++k;
         add(displacement(s, k, 0), 1e-3);
       }},
      {"a plastic strain forgotten", "plastic_bar", "plastic strain",
       [](Solved& s) { scale(*last(s)["plastic_strain"].begin(), 0); }},
      {"a plastic strain larger by 1e-4", "metal block", "plastic strain",
       [](Solved& s) { scale(*last(s)["plastic_strain"].begin(), 1 + 1e-4); }},
  };
}

/// Faults of steps and of what was reported.
std::vector<Fault> in_reports() {
  return {
      {"a step left out", "slider", "steps", [](Solved& s) { s.solution["increments"].erase(7); }},
      {"the last step left out", "slider", "steps",
       [](Solved& s) { s.solution["increments"].erase(s.solution["increments"].size() - 1); }},
      {"no step at all", "slider", "steps", [](Solved& s) { s.solution["increments"] = json::array(); }},
      {"a run that ended early", "slider", "steps", [](Solved& s) { s.result["status"] = "cycle"; }},
      {"states of two times swapped", "slider", "supports",
       [](Solved& s) {
         std::swap(s.solution["increments"][3]["displacement"], s.solution["increments"][9]["displacement"]);
       }},
      {"a step at another time", "block", "supports", [](Solved& s) { s.solution["increments"][1]["time"] = 0.6; }},
      {"a contact force falsified", "block", "responses", in_response("N", 1 + 1e-6)},
      {"a reaction falsified", "block", "responses", in_response("R", 1 + 1e-6)},
      {"a displacement falsified", "block", "responses", in_response("u", 1 + 1e-4)},
      {"an energy falsified", "block", "responses", in_response("W", 1 + 1e-6)},
      {"a dissipation falsified", "block", "responses", in_response("D", 1 + 1e-6)},
      {"a slip falsified", "block", "responses", in_response("s", -1)},
      {"a half width falsified", "block", "responses", in_response("w", 1.001)},
      {"a moment falsified", "two blocks", "responses", in_response("M", 1 + 1e-6)},
      {"a response that is no number", "block", "responses",
       [](Solved& s) { s.result["steps"].back()["responses"]["N"] = nullptr; }},
      {"springs so stiff that rounding might excuse all", "belt", "equilibrium",
       [](Solved& s) {
         contact(s)["compliance"] = std::vector<double>(2 * contact(s)["nodes"].size(), 1e-300);
         pressure(s) = (1 + 1e-6) * pressure(s).get<double>();
       }},
      {"springs softer than they are", "belt", "complementarity",
       [](Solved& s) { contact(s)["compliance"] = std::vector<double>(2 * contact(s)["nodes"].size(), 1e-3); }},
  };
}

/// Faults of the scene: the solution is that of another one.
std::vector<Fault> in_scenes() {
  const std::string material = "/bodies/block/material/";
  return {
      {"another modulus", "block", "equilibrium", in_scene(material + "linear_elastic/E", 1000.1)},
      {"another Poisson's ratio", "rubber block", "equilibrium", in_scene(material + "neo_hookean/nu", 0.4001)},
      {"another volumetric law", "rubber block", "equilibrium",
       in_scene(material + "neo_hookean/volumetric", "quadratic")},
      {"another yield stress", "metal block", "equilibrium", in_scene(material + "j2_plastic/hardening/0/1", 4.001)},
      {"a smaller coefficient of friction", "slider", "cone", in_scene("/contacts/sole/friction", 0.29)},
      {"a larger coefficient of friction", "slider", "stick", in_scene("/contacts/sole/friction", 0.31)},
      {"a smaller limit of friction", "block", "cone", in_scene("/contacts/sole/friction/limit", 1.9)},
      {"a contact without friction", "greco_plate", "cone",
       [](Solved& s) { s.solution["scene"]["contacts"].begin()->erase("friction"); }},
      {"a load left out", "block", "equilibrium", [](Solved& s) { s.solution["scene"]["loads"].erase(1); }},
      {"a load too large by 1e-5", "block", "equilibrium", in_scene("/loads/0/pressure", 3 * (1 + 1e-5))},
      // (forces and areas all scale with it, so that what it was measured by is wrong alone)
      {"another thickness", "block", "responses", in_scene("/bodies/block/thickness", 1.001)},
      {"another element", "block", "equilibrium",
       [](Solved& s) { s.solution["mesh"]["bodies"]["block"]["element"] = "Q4_mean_dilatation"; }},
      {"small strain", "rubber block", "equilibrium", in_scene("/strain", "small")},
      {"another space", "block", "equilibrium", in_scene("/space", "plane_stress")},
      {"another interference", "two blocks", "gap", in_scene("/contacts/c/offset", -0.00101)},
      {"a smooth master for facets", "segments", "equilibrium", in_scene("/contacts/c/discretization", "node")},
      {"a faceted master", "two blocks", "equilibrium", in_scene("/contacts/c/surface", "faceted")},
      {"another smooth master", "two blocks", "gap", in_scene("/contacts/c/surface", json{{"smooth", "b_spline"}})},
      {"a faceted master in space", "barrel", "gap", in_scene("/contacts/c/surface", "faceted")},
      {"another smooth master in space", "barrel", "complementarity",
       in_scene("/contacts/c/surface", json{{"smooth", "b_spline"}})},
      {"creases in space", "barrel", "complementarity",
       in_scene("/contacts/c/surface", json{{"smooth", "catmull_rom"}, {"corner", 15}})},
      {"a floor elsewhere", "block", "gap", in_scene("/obstacles/floor/plane/point/1", 1e-4)},
      {"a floor that is turned", "block", "cone", in_scene("/obstacles/floor/plane/normal/0", 1e-3)},
      {"an obstacle that does not turn", "polyline", "gap",
       [](Solved& s) { s.solution["scene"]["obstacles"]["o"].erase("rotate"); }},
      {"a support elsewhere", "block", "supports", in_scene("/supports/0/move/x", 1e-6)},
      {"a support left out", "block", "equilibrium", [](Solved& s) { s.solution["scene"]["supports"].erase(0); }},
      {"more steps", "block", "steps", in_scene("/time/steps", 7)},
  };
}

std::vector<Fault> all_faults() {
  auto all = in_numbers();
  for (const auto& more : {in_reports(), in_scenes()}) all.insert(all.end(), more.begin(), more.end());
  return all;
}

class PlantedFault : public testing::TestWithParam<Fault> {};

TEST_P(PlantedFault, IsFound) {
  static std::map<std::string, Solved> solved;
  const auto& [name, base, law, plant] = GetParam();
  if (!solved.contains(base)) {
    solved[base] = solve(scene_of(base), base == "belt" ? "penalty" : "");
    expect_holds(solved[base]);
  }
  Solved wrong = solved[base];
  plant(wrong);
  const auto judged = certificate(wrong);
  EXPECT_FALSE(judged.holds());
  EXPECT_TRUE(broken(judged).contains(law)) << law << " is not among " << testing::PrintToString(broken(judged));
}

std::string name_of(const testing::TestParamInfo<Fault>& info) {
  std::string name;
  for (const char c : info.param.name) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Verify, PlantedFault, testing::ValuesIn(all_faults()), name_of);

}  // namespace
}  // namespace stickslip::verify_tests
