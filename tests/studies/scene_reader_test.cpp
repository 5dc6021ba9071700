#include "studies/input/scene_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/mesh/generators.hpp"
#include "core/mesh/sides.hpp"
#include "studies/input/method_options.hpp"
#include "tests/studies/scene_texts.hpp"

namespace stickslip {
namespace {

using namespace scene_texts;
using testing::ElementsAre;
using testing::HasSubstr;

Input valid(const std::string& text, const std::optional<std::string>& method = std::nullopt) {
  Diagnostics diagnostics;
  auto input = read_text(text, diagnostics, method);
  EXPECT_EQ(diagnostics.text(), "");
  return input.value();
}

/// Value of the slot that the pointer names.
double slot_value(const Scene& scene, const std::string& pointer) {
  const auto found = std::find(scene.pointers.begin(), scene.pointers.end(), pointer);
  EXPECT_NE(found, scene.pointers.end()) << pointer;
  return scene.numbers.at(found - scene.pointers.begin());
}

TEST(SceneReader, NotesAnObstacleThatNoContactNames) {
  Diagnostics diagnostics;
  EXPECT_TRUE(read_text(edited(block_scene, R"("obstacles": {)",
                               R"("obstacles": {"wall": {"plane": {"point": [9, 0], "normal": [-1, 0]}}, )"),
                        diagnostics));
  ASSERT_EQ(diagnostics.notes().size(), 1u);
  EXPECT_EQ(diagnostics.notes()[0].pointer, "/obstacles/wall");
}

TEST(SceneReader, ReadsWhatDrivesAScene) {
  std::string text = edited(block_scene, R"("supports": [{)", R"("supports": [
    {"on": "block.right", "along": [3, 4], "value": {"table": [[0, 0], [1, 5], [2, 0]], "repeat": 7}},
    {"on": "block.right & block.top", "rotate": {"center": [1, 2], "angle": 30}, "move": {"y": 6}}, {)");
  text = edited(text, R"("loads": [)", R"("loads": [{"on": "block.top", "pressure": 8},
    {"on": "block", "body_force": [0, -9]}, )");
  text = edited(text, R"("obstacles": {)", R"("obstacles": {"ring":
    {"polyline": {"points": [[0, 0], [0, 1], [1, 0], [0, 0]]}, "rotate": {"center": [0, 0], "angle": [[0, 0], [1, 2]]}},
    "step": {"polyline": {"points": [[0, 0], [1, 0], [1, 1]]}}, )");
  text = edited(text, R"("pull": {)", R"("torque": {"contact_force": {"contact": "sole", "component": "moment",
    "about": [4, 5]}}, "pull": {)");
  const Scene scene = valid(text).scene;
  const auto& inclined = scene.supports.at(0).inclined.value();
  EXPECT_EQ(inclined.along[1].value, 4);
  EXPECT_EQ(inclined.value.repeat, 7);
  EXPECT_EQ(inclined.value.points.at(1).second.value, 5);
  EXPECT_EQ(scene.supports[1].rotate.value().angle.points.at(0).second.value, 30);
  EXPECT_EQ(scene.supports[1].move.at('y').points.at(0).second.value, 6);
  EXPECT_EQ(scene.loads.at(0).kind, Load::Kind::pressure);
  EXPECT_EQ(scene.loads[1].kind, Load::Kind::body_force);
  for (const auto& obstacle : scene.obstacles)
    if (const auto* line = std::get_if<Polyline>(&obstacle.shape)) {
      EXPECT_EQ(line->points.size(), 3u);
      EXPECT_EQ(line->closed, obstacle.name == "ring");
      EXPECT_EQ(obstacle.rotate.has_value(), obstacle.name == "ring");
    }
  for (const char* pointer :
       {"/supports/0/along/0", "/supports/0/value/table/1/1", "/supports/1/rotate/center/0", "/supports/1/rotate/angle",
        "/loads/0/pressure", "/loads/1/body_force/1", "/obstacles/ring/polyline/points/1/1"})
    EXPECT_NE(std::find(scene.pointers.begin(), scene.pointers.end(), pointer), scene.pointers.end()) << pointer;
  Diagnostics diagnostics;
  EXPECT_FALSE(
      read_text(edited(text, R"("mu": "/contacts/sole/friction")", R"("x": "/obstacles/ring/polyline/points/3/0")"),
                diagnostics));
  EXPECT_THAT(diagnostics.text(), HasSubstr("its first point is the parameter"));
}

TEST(SceneReader, ReadsABlockOnAFloor) {
  const Input input = valid(block_scene);
  const Scene& scene = input.scene;
  EXPECT_EQ(scene.title, "block pushed over a floor");
  EXPECT_EQ(scene.space, Space::plane_strain);
  ASSERT_EQ(scene.bodies.size(), 1u);
  const auto& box = std::get<BoxMesh>(scene.bodies[0].mesh);
  EXPECT_EQ(box.max[0].value, 4);
  EXPECT_EQ(box.max[1].value, 2);
  EXPECT_EQ(box.cells, (std::vector{4, 2}));
  EXPECT_EQ(scene.bodies[0].element, "Q4");
  EXPECT_EQ(std::get<LinearElastic>(scene.bodies[0].material).nu.value, 0.25);
  const auto& plane = std::get<Plane>(scene.obstacles.at(0).shape);
  EXPECT_EQ(plane.point[1].value, -1);
  EXPECT_EQ(plane.normal[1].value, 2);
  EXPECT_EQ(scene.contacts.at(0).slave, "block.bottom");
  EXPECT_EQ(scene.contacts[0].master, "floor");
  EXPECT_EQ(scene.contacts[0].friction->first_number().value, 0.3);
  EXPECT_EQ(scene.contacts[0].offset.value, 0);
  EXPECT_EQ(scene.supports.at(0).on, "block.left");
  const Table& move = scene.supports[0].move.at('x');
  ASSERT_EQ(move.points.size(), 2u);
  EXPECT_EQ(move.points[1].first, 1);
  EXPECT_EQ(move.points[1].second.value, 0.2);
  EXPECT_EQ(scene.loads.at(0).kind, Load::Kind::traction);
  EXPECT_EQ(scene.loads[0].vector.at(1).value, -5);
  EXPECT_EQ(scene.loads[0].history->points.size(), 2u);
  ASSERT_EQ(scene.legs.size(), 1u);
  EXPECT_EQ(scene.legs[0].end, 2);
  EXPECT_EQ(scene.legs[0].steps, 10);
  ASSERT_EQ(scene.responses.size(), 3u);  // by name: press, pull, tip
  EXPECT_EQ(scene.responses[0].kind, Response::Kind::contact_force);
  EXPECT_EQ(scene.responses[0].on, "sole");
  EXPECT_EQ(scene.responses[0].component, Response::Component::normal);
  EXPECT_EQ(scene.responses[1].kind, Response::Kind::reaction);
  EXPECT_EQ(scene.responses[2].take, Response::Take::max);
  EXPECT_EQ(scene.responses[2].component, Response::Component::y);
  const auto& method = std::get<MonolithicAL>(input.method);
  EXPECT_EQ(method.scale.kind, Regularisation::Kind::relative);
  EXPECT_EQ(method.scale.value.value, 2);
  EXPECT_EQ(input.fields_every, 0);
}

TEST(SceneReader, MakesAContactOfEachPairOfBodies) {
  const char* text = R"({
    "strain": "finite",
    "bodies": {
      "a": {"mesh": {"box": {"min": [0, 0], "max": [1, 1], "cells": [2, 2]}}, "material": {"neo_hookean": {"E": 1, "nu": 0}}},
      "b": {"mesh": {"box": {"min": [2, 0], "max": [3, 1], "cells": [4, 4]}}, "material": {"neo_hookean": {"E": 1, "nu": 0}}},
      "c": {"mesh": {"box": {"min": [4, 0], "max": [5, 1], "cells": [2, 2]}}, "material": {"neo_hookean": {"E": 1, "nu": 0}}}},
    "contacts": {"pile": {"between": "all", "friction": 0.2, "surface": {"smooth": "b_spline", "corner": 40}}},
    "supports": [{"on": "a.boundary", "move": {"x": 0, "y": 0}}],
    "time": {"end": 1, "steps": 1},
    "responses": {"heat": {"dissipation": {"contact": "pile"}}, "slid": {"slip": {"contact": "pile/b~a"}}},
    "parameters": {"mu": "/contacts/pile/friction"},
    "method": {"monolithic_al": {}}
  })";
  const Scene scene = valid(text).scene;
  ASSERT_EQ(scene.contacts.size(), 3u);
  std::vector<std::string> names;
  for (const Contact& contact : scene.contacts) {
    names.push_back(contact.name);
    EXPECT_EQ(contact.group, "pile");
    EXPECT_EQ(contact.smoothing, Smoothing::b_spline);
    EXPECT_EQ(contact.corner, 40);
    EXPECT_EQ(contact.friction->first_number().slot, scene.contacts[0].friction->first_number().slot);
  }
  // the finer body is the slave; of two alike the one that is named first
  EXPECT_THAT(names, ElementsAre("pile/b~a", "pile/a~c", "pile/b~c"));
  EXPECT_EQ(scene.contacts[0].slave, "b.boundary");
  EXPECT_EQ(scene.contacts[0].master, "a.boundary");
  const auto mesh = make_mesh(scene.bodies[1].mesh, "", 2);
  EXPECT_EQ(evaluate_side(mesh, "boundary").facets.size(), 16u);
  EXPECT_EQ(evaluate_side(mesh, "boundary - left").nodes.size(), 11u);
}

TEST(SceneReader, ReadsLumpedBodies) {
  const Input input = valid(lumped_scene);
  const Scene& scene = input.scene;
  ASSERT_EQ(scene.bodies.size(), 3u);  // by name: belt, mass, rod
  const auto& arc = std::get<ArcMesh>(scene.bodies[0].mesh);
  EXPECT_EQ(arc.to_angle.value, 90);
  EXPECT_EQ(arc.cells, 4);
  EXPECT_EQ(scene.bodies[0].area.value, 0.5);
  EXPECT_EQ(std::get<GroundedSpring>(scene.bodies[1].material).stiffness[0][1].value, 1);
  EXPECT_EQ(std::get<LineMesh>(scene.bodies[2].mesh).to[0].value, 3);
  EXPECT_EQ(std::get<Circle>(scene.obstacles.at(0).shape).radius.value, 0.5);
  EXPECT_EQ(scene.obstacles[0].move.at('y').points[0].second.value, -0.1);
  EXPECT_FALSE(scene.contacts.at(0).friction.has_value());
  EXPECT_EQ(scene.loads.at(0).kind, Load::Kind::force);
  EXPECT_FALSE(scene.loads[0].history.has_value());
  ASSERT_EQ(scene.legs.size(), 2u);
  EXPECT_EQ(scene.legs[1].end, 3);
  EXPECT_EQ(scene.legs[1].steps, 5);
  EXPECT_EQ(std::get<Penalty>(input.method).stiffness.kind, Regularisation::Kind::absolute);
  EXPECT_EQ(std::get<Penalty>(input.method).stiffness.value.value, 50);
  EXPECT_EQ(input.fields_every, 1);
}

TEST(SceneReader, GivesEveryPhysicalNumberASlotNamedByItsPointer) {
  const Scene block = valid(block_scene).scene, lumped = valid(lumped_scene).scene;
  ASSERT_EQ(block.numbers.size(), block.pointers.size());
  for (const auto& [pointer, value] :
       std::vector<std::pair<std::string, double>>{{"/bodies/block/mesh/box/max/0", 4},
                                                   {"/bodies/block/material/linear_elastic/E", 1000},
                                                   {"/obstacles/floor/plane/point/1", -1},
                                                   {"/contacts/sole/friction", 0.3},
                                                   {"/contacts/sole/offset", 0},
                                                   {"/supports/0/move/x/1/1", 0.2},
                                                   {"/loads/0/traction/1", -5},
                                                   {"/loads/0/history/1/1", 1},
                                                   {"/method/monolithic_al/scale", 2}})
    EXPECT_EQ(slot_value(block, pointer), value) << pointer;
  for (const auto& [pointer, value] :
       std::vector<std::pair<std::string, double>>{{"/bodies/mass/material/grounded_spring/stiffness/1/1", 2},
                                                   {"/bodies/belt/mesh/arc/to_angle", 90},
                                                   {"/bodies/belt/area", 0.5},
                                                   {"/bodies/rod/area", 1},
                                                   {"/obstacles/drum/move/y", -0.1},
                                                   {"/supports/0/move/y/1/1", 3},
                                                   {"/method/penalty/stiffness/absolute", 50},
                                                   {"/method/penalty/tangential_ratio", 1}})
    EXPECT_EQ(slot_value(lumped, pointer), value) << pointer;
  const auto& nu = std::get<LinearElastic>(block.bodies[0].material).nu;
  EXPECT_EQ(block.pointers.at(nu.slot), "/bodies/block/material/linear_elastic/nu");
}

TEST(SceneReader, TurnsPointersIntoWeightedSlots) {
  const Scene scene = valid(edited(block_scene, R"("mu": "/contacts/sole/friction")",
                                   R"("mu": "/contacts/sole/friction", "gap": "/contacts/sole/offset",
                      "push": {"/supports/0/move/x/1/1": 2, "/loads/0/traction/1": -1},
                      "scale": "/method/monolithic_al/scale")"))
                          .scene;
  ASSERT_EQ(scene.parameters.size(), 4u);  // by name: gap, mu, push, scale
  EXPECT_EQ(scene.pointers[scene.parameters[0].slots.at(0).first], "/contacts/sole/offset");
  EXPECT_EQ(scene.parameters[1].value, 0.3);
  EXPECT_EQ(scene.parameters[1].pointer, "/contacts/sole/friction");
  const Parameter& push = scene.parameters[2];
  ASSERT_EQ(push.slots.size(), 2u);
  EXPECT_EQ(scene.pointers[push.slots[0].first], "/loads/0/traction/1");
  EXPECT_EQ(push.slots[0].second, -1);
  EXPECT_EQ(push.slots[1].second, 2);
  EXPECT_EQ(push.value, -5);
}

TEST(SceneReader, ReadsEveryOptionOfEveryMethod) {
  auto method = [&](const std::string& text) {
    return valid(edited(block_scene, R"({"monolithic_al": {"scale": 2}})", text)).method;
  };
  const auto penalty = std::get<Penalty>(method(R"({"penalty": {"stiffness": 1e4, "tangential_ratio": 0.5,
      "newton": {"tolerance": 1e-9, "max_iterations": 7, "line_search": false}}})"));
  EXPECT_EQ(penalty.stiffness.kind, Regularisation::Kind::relative);
  EXPECT_EQ(penalty.stiffness.value.value, 1e4);
  EXPECT_EQ(penalty.tangential_ratio.value, 0.5);
  EXPECT_EQ(penalty.newton.tolerance, 1e-9);
  EXPECT_EQ(penalty.newton.max_iterations, 7);
  EXPECT_FALSE(penalty.newton.line_search);
  const auto uzawa = std::get<UzawaAL>(method(R"({"uzawa_al": {"scale": "auto", "tolerance": 1e-4,
      "max_augmentations": 9, "adapt": false, "acceleration": "none", "cone": "augmented",
      "sensitivity": "oversized", "oversize": 50}})"));
  EXPECT_EQ(uzawa.scale.kind, Regularisation::Kind::automatic);
  EXPECT_EQ(uzawa.tolerance, 1e-4);
  EXPECT_EQ(uzawa.max_augmentations, 9);
  EXPECT_FALSE(uzawa.adapt);
  EXPECT_EQ(uzawa.sensitivity, UzawaAL::Sensitivity::oversized);
  EXPECT_EQ(uzawa.oversize, 50);
  const auto monolithic =
      std::get<MonolithicAL>(method(R"({"monolithic_al": {"scale": {"absolute": 3}, "cone": "multiplier"}})"));
  EXPECT_EQ(monolithic.scale.kind, Regularisation::Kind::absolute);
  EXPECT_EQ(monolithic.scale.value.value, 3);
  EXPECT_EQ(monolithic.cone, MonolithicAL::Cone::multiplier);
}

TEST(SceneReader, WritesTheOptionsOfAMethodSoThatTheyReadTheSame) {
  for (const std::string text :
       {R"({"penalty": {"stiffness": {"absolute": 2400.5}, "tangential_ratio": 0.3, "newton": {"max_iterations": 3}}})",
        R"({"uzawa_al": {"scale": 0.1, "sensitivity": "truncated", "adapt": false, "tolerance": 1e-05}})",
        R"({"uzawa_al": {"acceleration": "anderson", "sensitivity": "preconditioned", "oversize": 30.5}})",
        R"({"uzawa_al": {"acceleration": "aitken", "sensitivity": "iterated", "oversize": "auto"}})",
        R"({"uzawa_al": {"cone": "frozen", "sensitivity": "truncated"}})",
        R"({"monolithic_al": {"cone": "multiplier", "newton": {"line_search": false}}})"}) {
    const auto written = to_json(valid(edited(block_scene, R"({"monolithic_al": {"scale": 2}})", text)).method);
    const auto flat = written.flatten(), given = nlohmann::json::parse(text).flatten();
    for (const auto& [pointer, value] : given.items())
      EXPECT_EQ(flat.value(pointer, nlohmann::json()), value) << pointer;
    const auto again = to_json(valid(edited(block_scene, R"({"monolithic_al": {"scale": 2}})", written.dump())).method);
    EXPECT_EQ(again, written);
  }
}

TEST(SceneReader, ReadsAnImportedMeshBesideTheSceneFile) {
  const Input input =
      valid(R"({"bodies": {"disk": {"mesh": {"gmsh": "../studies/../../studies/meshes/half_disk_coarse.msh",
      "body": "disk"}, "material": {"linear_elastic": {"E": 1, "nu": 0}}}},
      "supports": [{"on": "disk.flat", "move": {"x": 0, "y": 0}}], "time": {"end": 1, "steps": 1},
      "method": {"penalty": {}}})");
  const auto& mesh = std::get<ImportedMesh>(input.scene.bodies.at(0).mesh);
  EXPECT_EQ(mesh.mesh.sides.count("arc"), 1u);
  EXPECT_EQ(mesh.points.cols(), mesh.mesh.node_count);
  EXPECT_EQ(input.mesh_fingerprints.at("../studies/../../studies/meshes/half_disk_coarse.msh").size(), 16u);
}

TEST(SceneReader, ReadsAnImportedMeshInSpaceAndSplitsIt) {
  const std::string scene = R"({"space": "solid", "bodies": {
      "ball": {"mesh": {"gmsh": "../support/meshes/solids_22.msh", "body": "ball", "split": 1},
               "material": {"linear_elastic": {"E": 1, "nu": 0}}, "element": "T4"},
      "block": {"mesh": {"gmsh": "../support/meshes/solids_41.msh", "body": "block"},
                "material": {"linear_elastic": {"E": 1, "nu": 0}}, "element": "H8_mean_dilatation"}},
      "supports": [{"on": "ball.sphere", "move": {"x": 0, "y": 0, "z": 0}},
                   {"on": "block.edge", "move": {"x": 0, "y": 0, "z": 0}}],
      "time": {"end": 1, "steps": 1}, "method": {"penalty": {}}})";
  const Input input = valid(scene);
  const auto& ball = std::get<ImportedMesh>(input.scene.bodies.at(0).mesh);
  EXPECT_EQ(ball.mesh.element_count(), 8 * 78);
  EXPECT_EQ(ball.mesh.sides.at("sphere").facets.size(), 4u * 78);
  Diagnostics diagnostics;
  EXPECT_FALSE(read_text(edited(scene, R"("split": 1)", R"("split": 5)"), diagnostics));
  EXPECT_THAT(diagnostics.text(), HasSubstr("is 5; must be a whole number from 0 to 4"));
}

TEST(SceneReader, ReadsTheScenesThatAreShipped) {
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(STICKSLIP_SOURCE_DIR "/studies/scenes")) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() != ".json" || name.find(".study.") != std::string::npos) continue;
    Diagnostics diagnostics;
    EXPECT_TRUE(read_scene(entry.path().string(), {}, std::nullopt, diagnostics).has_value());
    EXPECT_EQ(diagnostics.text(), "");
    ++read;
  }
  EXPECT_GT(read, 0);
}

TEST(SceneReader, ReplacesTheMethodAndDropsWhatBelongsToTheOther) {
  const auto text = edited(block_scene, R"("mu": "/contacts/sole/friction")",
                           R"("mu": "/contacts/sole/friction", "s": "/method/monolithic_al/scale",
                              "both": {"/contacts/sole/friction": 1, "/method/monolithic_al/scale": 2})");
  Diagnostics diagnostics;
  const Input input = read_text(text, diagnostics, "penalty").value();
  EXPECT_FALSE(diagnostics.has_errors());
  ASSERT_EQ(diagnostics.notes().size(), 2u);
  EXPECT_EQ(diagnostics.notes()[1].pointer, "/parameters/s");
  EXPECT_THAT(diagnostics.notes()[1].message, HasSubstr("is an option of monolithic_al, and penalty runs"));
  EXPECT_EQ(std::get<Penalty>(input.method).stiffness.kind, Regularisation::Kind::automatic);
  ASSERT_EQ(input.scene.parameters.size(), 2u);
  EXPECT_EQ(input.scene.parameters[0].name, "both");
  EXPECT_EQ(input.scene.parameters[0].slots.size(), 1u);
  EXPECT_EQ(input.document["method"], nlohmann::json::parse(R"({"penalty": {}})"));
  // what is left reads the same again, without a word on methods
  EXPECT_EQ(canonical_text(valid(input.document.dump())), canonical_text(input));
}

TEST(SceneReader, KeepsTheOptionsOfTheMethodThatIsAskedFor) {
  EXPECT_EQ(std::get<MonolithicAL>(valid(block_scene, "monolithic_al").method).scale.value.value, 2);
}

TEST(SceneReader, RefusesAMethodThatDoesNotExist) {
  Diagnostics diagnostics;
  EXPECT_FALSE(read_text(block_scene, diagnostics, "penaty").has_value());
  EXPECT_EQ(diagnostics.text(),
            "-m penaty: there is no method \"penaty\"; did you mean \"penalty\"? allowed: penalty, uzawa_al, "
            "monolithic_al\n");
}

TEST(SceneReader, ReadsEveryLawOfFriction) {
  const auto law = [](const std::string& text) {
    std::string scene = block_scene;
    const std::string number = "\"friction\": 0.3";
    scene.replace(scene.find(number), number.size(), "\"friction\": " + text);
    const std::string mu = "\"/contacts/sole/friction\"";
    if (const auto at = scene.find(mu); at != std::string::npos)
      scene.replace(at, mu.size(), "\"/bodies/block/material/linear_elastic/E\"");
    const auto path = std::filesystem::path(testing::TempDir()) / "law_of_friction.json";
    std::ofstream(path) << scene;
    Diagnostics diagnostics;
    const auto input = read_scene(path.string(), {}, {}, diagnostics);
    EXPECT_TRUE(input.has_value()) << diagnostics.text();
    return input ? *input->scene.contacts[0].friction : FrictionLaw<Number>();
  };
  const auto limited = law(R"({"coulomb": 0.4, "limit": 5})"), tresca = law(R"({"tresca": 6})");
  const auto& coulomb = std::get<Coulomb<Number>>(limited.law);
  EXPECT_EQ(coulomb.coefficient.value, 0.4);
  EXPECT_EQ(coulomb.limit->value, 5);
  EXPECT_GE(coulomb.limit->slot, 0) << "it can be a parameter";
  EXPECT_EQ(std::get<Tresca<Number>>(tresca.law).limit.value, 6);
}

TEST(SceneReader, CarriesOutOverridesAndNamesThemInFaults) {
  const auto path = std::filesystem::path(testing::TempDir()) / "overridden_scene.json";
  std::ofstream(path) << block_scene;
  Diagnostics diagnostics;
  const auto input = read_scene(path.string(), {"/contacts/sole/friction=0.4", "/time/steps=3"}, {}, diagnostics);
  ASSERT_TRUE(input.has_value()) << diagnostics.text();
  EXPECT_EQ(input->scene.contacts[0].friction->first_number().value, 0.4);
  EXPECT_EQ(input->scene.legs[0].steps, 3);
  EXPECT_FALSE(read_scene(path.string(), {"/contacts/sole/friction=-0.4", "/time/stops=3"}, {}, diagnostics));
  EXPECT_EQ(diagnostics.text(),
            "--set /contacts/sole/friction=-0.4: /contacts/sole/friction: is -0.4; must be a number >= 0\n"
            "--set /time/stops=3: /time/stops: unknown key \"stops\"; did you mean \"steps\"? allowed: end, steps, "
            "legs, control\n");
  std::filesystem::remove(path);
}

TEST(SceneReader, OverridesOfAnotherMethodAskForIt) {
  const auto path = std::filesystem::path(testing::TempDir()) / "other_method.json";
  std::ofstream(path) << block_scene;
  for (const auto& [method, pointer, fault] :
       {std::tuple{"monolithic_al", "/method/penalty/stiffness", "the scene runs monolithic_al; add -m penalty"},
        {"penalty", "/method/stiffness", R"(names no method; did you mean "/method/penalty/stiffness"?)"}}) {
    Diagnostics diagnostics;
    EXPECT_FALSE(read_scene(path.string(), {std::string(pointer) + "=10"}, method, diagnostics));
    EXPECT_EQ(diagnostics.text(), std::string("--set ") + pointer + "=10: " + fault + "\n");
  }
  std::filesystem::remove(path);
}

TEST(SceneReader, OverridesMayNameOptionsThatTheFileLeavesOut) {
  const auto path = std::filesystem::path(testing::TempDir()) / "optional_override.json";
  std::ofstream(path) << block_scene;
  Diagnostics diagnostics;
  const auto input =
      read_scene(path.string(), {"/method/penalty/stiffness=250", "/contacts/sole/offset=0.1"}, "penalty", diagnostics);
  ASSERT_TRUE(input.has_value()) << diagnostics.text();
  EXPECT_EQ(std::get<Penalty>(input->method).stiffness.value.value, 250);
  EXPECT_EQ(input->scene.contacts[0].offset.value, 0.1);
  std::filesystem::remove(path);
}

TEST(SceneReader, HashesWhatIsSimulatedAndNothingElse) {
  auto hash = [](const std::string& text) { return fingerprint(canonical_text(valid(text))); };
  const std::string original = hash(block_scene);
  EXPECT_EQ(hash(edited(block_scene, "block pushed over a floor", "another title")), original);
  EXPECT_EQ(hash(edited(block_scene, R"("scale": 2)", R"("scale": 2, "cone": "augmented")")), original);
  EXPECT_NE(hash(edited(block_scene, R"("scale": 2)", R"("scale": 2.5)")), original);
  EXPECT_NE(hash(edited(block_scene, R"("nu": 0.25)", R"("nu": 0.26)")), original);
}

TEST(SceneReader, ReportsAllFaultsOfAFileInItsOrder) {
  auto text = edited(block_scene, R"("E": 1000, "nu": 0.25)", R"("E": -1, "nu": 0.5)");
  text = edited(text, R"("steps": 10)", R"("steps": 0)");
  text = edited(text, R"("friction": 0.3)", R"("frction": 0.3)");
  Diagnostics diagnostics;
  EXPECT_FALSE(read_text(text, diagnostics).has_value());
  std::vector<std::string> pointers;
  for (const auto& error : diagnostics.errors()) pointers.push_back(error.pointer);
  EXPECT_THAT(pointers,
              ElementsAre("/bodies/block/material/linear_elastic/E", "/bodies/block/material/linear_elastic/nu",
                          "/contacts/sole/frction", "/time/steps"));  // not what the parameter misses for it
}

TEST(SceneReader, MissesTheKeysThatEverySceneHas) {
  Diagnostics diagnostics;
  EXPECT_FALSE(read_text("// nothing\n{}", diagnostics).has_value());
  ASSERT_EQ(diagnostics.error_count(), 3u) << diagnostics.text();
  EXPECT_THAT(diagnostics.text(), HasSubstr("scene.json:2:1: the key \"bodies\" is missing; required: bodies, time"));
  EXPECT_THAT(diagnostics.text(), HasSubstr("scene.json:2:1: the key \"time\" is missing"));
  EXPECT_THAT(diagnostics.text(), HasSubstr("scene.json:2:1: the key \"method\" is missing; allowed: penalty"));
}

TEST(SceneReader, ReadsRingsDisksQuadsThicknessAndElements) {
  const auto input = valid(R"({
    "space": "plane_stress",
    "bodies": {
      "ring": {"mesh": {"ring": {"center": [1, 2], "inner": 3, "outer": 4, "cells": [2, 9], "grade": {"outer": 5}}},
               "material": {"linear_elastic": {"E": 1, "nu": 0}}, "element": "Q8", "thickness": 0.5},
      "sector": {"mesh": {"ring": {"center": [0, 0], "inner": 3, "outer": 4, "cells": [2, 9], "from_angle": -20,
                                   "to_angle": 70}}, "material": {"linear_elastic": {"E": 1, "nu": 0}}},
      "disk": {"mesh": {"disk": {"center": [1, 2], "radius": 3, "cells": [2, 4], "grade": 2}},
               "material": {"linear_elastic": {"E": 1, "nu": 0}}, "element": "T6"},
      "quad": {"mesh": {"quad": {"corners": [[0, 0], [2, 0], [3, 4], [0, 1]], "cells": [2, 4], "grade": {"top": 2}}},
               "material": {"linear_elastic": {"E": 1, "nu": 0}}}
    },
    "time": {"end": 1, "steps": 1},
    "parameters": {"a": "/bodies/ring/thickness", "b": "/bodies/sector/mesh/ring/to_angle",
                   "c": "/bodies/disk/thickness", "d": "/bodies/quad/mesh/quad/corners/2/1",
                   "e": "/bodies/ring/mesh/ring/from_angle"},
    "method": {"monolithic_al": {}}
  })");
  const auto& bodies = input.scene.bodies;  // by name: disk, quad, ring, sector
  const auto &ring = std::get<RingMesh>(bodies[2].mesh), &sector = std::get<RingMesh>(bodies[3].mesh);
  EXPECT_EQ(ring.center[1].value, 2);
  EXPECT_EQ(ring.inner.value, 3);
  EXPECT_EQ(ring.outer.value, 4);
  EXPECT_EQ(ring.cells, (std::array{2, 9}));
  EXPECT_EQ(ring.grade.at(0).towards, "outer");
  EXPECT_EQ(ring.grade.at(0).ratio.value, 5);
  EXPECT_EQ(ring.to_angle.value, 360);
  EXPECT_EQ(bodies[2].element, "Q8");
  EXPECT_EQ(bodies[2].thickness.value, 0.5);
  EXPECT_EQ(sector.from_angle.value, -20);
  EXPECT_EQ(sector.to_angle.value, 70);
  const auto& disk = std::get<DiskMesh>(bodies[0].mesh);
  EXPECT_EQ(disk.radius.value, 3);
  EXPECT_EQ(disk.grade.value, 2);
  EXPECT_EQ(bodies[0].thickness.value, 1);
  const auto& quad = std::get<QuadMesh>(bodies[1].mesh);
  EXPECT_EQ(quad.corners[2][1].value, 4);
  EXPECT_EQ(quad.grade.at(0).towards, "top");
  std::vector<double> values;
  for (const auto& parameter : input.scene.parameters) values.push_back(parameter.value);
  EXPECT_THAT(values, ElementsAre(0.5, 70, 1, 4, 0));
}

}  // namespace
}  // namespace stickslip
