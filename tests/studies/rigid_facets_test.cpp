/// Obstacles of triangles from STL files: a flat one is a plane, a fine ball is a sphere, and certificates hold.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "studies/io/input_fault.hpp"
#include "studies/run/obstacle_fields.hpp"
#include "studies/run/run_files.hpp"
#include "studies/run/solution_file.hpp"
#include "studies/verify/verify.hpp"
#include "tests/studies/cases.hpp"
#include "tests/studies/temporary_folder.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::rigid_facets_test {
namespace {

using nlohmann::json;
using Point = std::array<double, 3>;
using Triangle = std::array<Point, 3>;

class RigidTriangles : public InOwnFolder {
 protected:
  void write(const std::vector<Triangle>& triangles) const {
    std::ostringstream text;
    text.precision(17);
    text << "solid made\n";
    for (const auto& corners : triangles) {
      text << "facet normal 0 0 0\nouter loop\n";
      for (const auto& x : corners) text << "vertex " << x[0] << " " << x[1] << " " << x[2] << "\n";
      text << "endloop\nendfacet\n";
    }
    text << "endsolid\n";
    std::ofstream(folder_ / "tool.stl") << text.str();
  }
  CaseResult run(const json& scene, const std::string& method) const {
    return cases::run(scene, {{method, json::object()}}, folder_ / "scene.json");
  }
  /// Its steps have certificates, which none has that is of a surface elsewhere.
  void expect_certificates(json scene) const {
    const auto result = run(scene, "monolithic_al");
    ASSERT_EQ(result.status(), Status::converged) << result.message();
    scene["method"] = {{"monolithic_al", json::object()}};
    const json solution = json::parse(solution_file(result, scene).text);
    const auto certificate =
        verify::certify(scene, solution.at("mesh"), solution, json::parse(result_json(result, "").dump()));
    for (const auto& step : certificate.steps)
      EXPECT_TRUE(step.holds()) << step.worst().law << " " << step.worst().where << " " << step.worst().share();
    json lifted = solution;  // a surface that is elsewhere makes other forces
    for (auto& vertex : lifted["mesh"]["obstacles"]["tool"]["vertices"])
      vertex.back() = vertex.back().get<double>() + 1e-4;
    EXPECT_FALSE(verify::certify(scene, lifted.at("mesh"), lifted, json::object()).holds());
  }
  std::string faults(const json& scene) const {
    try {
      Problem(cases::read(scene, folder_ / "scene.json").scene);
    } catch (const std::exception& fault) {
      return fault.what();
    }
    return "none";
  }
};

/// A grid of n x n squares in [-2, 3]^2 at the height f(x, y), each cut in two; the solid is below.
template <class F>
std::vector<Triangle> floor_of(int n, F&& f) {
  const auto at = [&](int i, int j) -> Point {
    const double x = -2 + 5.0 * i / n, y = -2 + 5.0 * j / n;
    return {x, y, f(x, y)};
  };
  std::vector<Triangle> all;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      all.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      all.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return all;
}

/// A block that is pressed and drawn along two directions over an obstacle that moves and turns.
json drawn_block(const char* strain, const json& obstacle) {
  json scene = json::parse(R"({
    "space": "solid",
    "bodies": {"body": {"mesh": {"box": {"min": [0, 0, 0], "max": [1.1, 0.9, 0.6], "cells": [3, 2, 2]}},
                        "material": {"neo_hookean": {"E": 1000, "nu": 0.3}}}},
    "obstacles": {"tool": {"move": {"z": [[0, 0], [1, 0.02]], "y": [[1, 0], [2, 0.1]]}}},
    "contacts": {"sole": {"slave": "body.bottom", "master": "tool", "friction": 0.3}},
    "supports": [{"on": "body.top", "move": {"x": [[1, 0], [2, 0.4]], "y": 0, "z": [[0, 0], [1, -0.06]]}}],
    "time": {"legs": [[1, 2], [2, 4]]},
    "responses": {"N": {"contact_force": {"contact": "sole", "component": "normal"}},
                  "x": {"contact_force": {"contact": "sole", "component": "x"}},
                  "y": {"contact_force": {"contact": "sole", "component": "y"}},
                  "D": {"dissipation": {"contact": "sole"}}},
    "method": {"monolithic_al": {}},
    "parameters": {"mu": "/contacts/sole/friction", "E": "/bodies/body/material/neo_hookean/E",
                   "up": "/obstacles/tool/move/z/1/1", "drawn": "/supports/0/move/x/1/1"}})");
  scene["strain"] = strain;
  if (std::string(strain) == "small")
    scene["bodies"]["body"]["material"] = {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}};
  if (std::string(strain) == "small") scene["parameters"]["E"] = "/bodies/body/material/linear_elastic/E";
  scene["obstacles"]["tool"].update(obstacle);
  return scene;
}

const json skew_turn = json::parse(R"({"center": [0.5, 0.4, -0.2], "axis": [0.2, 0, 1], "angle": [[1, 0], [2, 5]]})");
const json stl = {{"stl", {{"file", "tool.stl"}}}};

TEST_F(RigidTriangles, ThatLieInAPlaneAreThePlane) {
  write(floor_of(7, [](double x, double y) { return 0.05 * x - 0.02 * y - 0.001; }));
  const json plane = {{"plane", {{"point", {0, 0, -0.001}}, {"normal", {-0.05, 0.02, 1}}}}};
  for (const char* strain : {"small", "finite"})
    for (const char* method : {"penalty", "uzawa_al", "monolithic_al"})
      for (const json& surface : {json("faceted"), json("smooth")}) {
        SCOPED_TRACE(std::string(strain) + method + surface.dump());
        json on_facets = drawn_block(strain, stl);
        on_facets["contacts"]["sole"]["surface"] = surface;
        for (const json& turn :
             {json(), json::parse(R"({"center": [0.5, 0.4, -0.2], "axis": [0.2, 0, 1], "angle": [[1, 0], [2, 5]]})")}) {
          json on_plane = drawn_block(strain, plane);
          if (!turn.is_null())
            on_facets["obstacles"]["tool"]["rotate"] = on_plane["obstacles"]["tool"]["rotate"] = turn;
          const auto expected = run(on_plane, method), found = run(on_facets, method);
          ASSERT_EQ(found.status(), Status::converged) << found.message();
          ASSERT_EQ(found.steps.size(), expected.steps.size());
          for (std::size_t n = 0; n < found.steps.size(); ++n) {
            const auto &of = found.steps[n], &wanted = expected.steps[n];
            // responses are 10 to 100; Uzawa's method ends within 1e-8 of its solution, derivatives of it within 1e-6
            EXPECT_LE(largest_entry(of.responses - wanted.responses), 1e-6) << n;
            ASSERT_EQ(of.sensitivities.size(), wanted.sensitivities.size());
            const double size = largest_entry(wanted.sensitivities);
            EXPECT_LE(largest_entry(of.sensitivities - wanted.sensitivities), 1e-6 * size) << n;
          }
        }
      }
}

/// The force of a block on a smooth hill of triangles comes to that on the sphere which the hill is cut from.
TEST_F(RigidTriangles, OfABallComeToTheSphere) {
  constexpr double R = 6;
  const json sphere = {{"sphere", {{"center", {0.5, 0.4, -R}}, {"radius", R}}}};
  const auto hill = [](double x, double y) {
    return std::sqrt(R * R - std::pow(x - 0.5, 2) - std::pow(y - 0.4, 2)) - R;
  };
  const auto expected = run(drawn_block("finite", sphere), "monolithic_al");
  ASSERT_EQ(expected.status(), Status::converged) << expected.message();
  std::vector<double> errors;
  for (const int n : {10, 20, 40}) {
    write(floor_of(n, hill));
    const auto found = run(drawn_block("finite", stl), "monolithic_al");
    ASSERT_EQ(found.status(), Status::converged) << found.message();
    const auto &of = found.steps.back().responses, &wanted = expected.steps.back().responses;
    errors.push_back(largest_entry(of - wanted) / largest_entry(wanted));
  }
  EXPECT_LT(errors[0], 2e-2);  // edges of 0.5 sag by 0.5^2 / (8 R) = 0.005, where the block sinks in by 0.08
  for (std::size_t k = 1; k < errors.size(); ++k) EXPECT_LT(errors[k], errors[k - 1] / 3);  // second order
}

TEST_F(RigidTriangles, HaveCertificates) {
  write(floor_of(9, [](double x, double y) { return -0.02 * (x - 0.6) * (x - 0.6) - 0.03 * (y - 0.3) * (y - 0.3); }));
  for (const char* strain : {"small", "finite"})
    for (const json& surface : {json("faceted"), json("smooth"), json{{"smooth", "b_spline"}}}) {
      SCOPED_TRACE(strain + surface.dump());
      json scene = drawn_block(strain, stl);
      scene["contacts"]["sole"]["surface"] = surface;
      scene["obstacles"]["tool"]["rotate"] = skew_turn;
      expect_certificates(scene);
    }
}

/// A side of a mesh, of the plane or of space.
json side_of(const char* mesh, const char* side) {
  return {{"mesh_side", {{"mesh", json::parse(mesh)}, {"side", side}}}};
}

/// Derivatives by a number of the mesh too: it shifts the surface as a number of the plane does.
TEST_F(RigidTriangles, ThatAreASideOfABoxAreItsPlane) {
  const json plane = json::parse(R"({"plane": {"point": [0, 0, -0.001], "normal": [0, 0, 1]}})");
  const json box = side_of(R"({"box": {"min": [-2, -2, -1], "max": [3, 3, -0.001], "cells": [5, 4, 1]}})", "top");
  for (const char* strain : {"small", "finite"})
    for (const char* method : {"penalty", "uzawa_al", "monolithic_al"}) {
      SCOPED_TRACE(std::string(strain) + method);
      json on_plane = drawn_block(strain, plane), on_side = drawn_block(strain, box);
      on_plane["parameters"]["height"] = "/obstacles/tool/plane/point/2";
      on_side["parameters"]["height"] = "/obstacles/tool/mesh_side/mesh/box/max/2";
      const auto expected = run(on_plane, method), found = run(on_side, method);
      ASSERT_EQ(found.status(), Status::converged) << found.message();
      const auto &of = found.steps.back(), &wanted = expected.steps.back();
      EXPECT_LE(largest_entry(of.responses - wanted.responses), 1e-6);  // as above
      const double size = largest_entry(wanted.sensitivities);
      EXPECT_LE(largest_entry(of.sensitivities - wanted.sensitivities), 1e-6 * size);
    }
}

TEST_F(RigidTriangles, ThatAreSidesOfMeshesHaveCertificates) {
  const json block_in_plane = json::parse(R"({
    "bodies": {"body": {"mesh": {"box": {"min": [0, 0], "max": [1.1, 0.6], "cells": [5, 3]}},
                        "material": {"neo_hookean": {"E": 1000, "nu": 0.3}}}},
    "obstacles": {"tool": {"move": {"x": [[1, 0], [2, 0.1]], "y": [[0, 0], [1, 0.02]]},
                           "rotate": {"center": [0.3, -0.2], "angle": [[1, 0], [2, 2]]}}},
    "contacts": {"sole": {"slave": "body.bottom", "master": "tool", "friction": 0.3}},
    "supports": [{"on": "body.top", "move": {"x": [[1, 0], [2, 0.4]], "y": [[0, 0], [1, -0.06]]}}],
    "strain": "finite", "time": {"legs": [[1, 2], [2, 4]]}, "responses": {}})");
  json in_plane = block_in_plane;
  in_plane["obstacles"]["tool"].update(
      side_of(R"({"disk": {"center": [0.5, -3], "radius": 3, "cells": [12, 2]}})", "arc"));
  json in_space = drawn_block(
      "finite", side_of(R"({"ball": {"center": [0.5, 0.4, -3], "radius": 3, "cells": [12, 1]}})", "surface"));
  in_space["obstacles"]["tool"]["rotate"] = skew_turn;
  for (const json& scene : {in_plane, in_space}) expect_certificates(scene);
}

/// Top and walls of a table, [-0.5, 0.5]^2, its top at z = 0: 3 x 3 squares and 3 a wall, each cut in two.
std::vector<Triangle> table() {
  constexpr int n = 3;
  constexpr double below = -0.3;
  const auto along = [](int i) { return -0.5 + static_cast<double>(i) / n; };
  std::vector<Triangle> all;
  const auto add = [&](const Point& a, const Point& b, const Point& c, const Point& d) {
    all.push_back({a, b, c});
    all.push_back({a, c, d});
  };
  for (int i = 0; i < n; ++i) {
    const double p = along(i), q = along(i + 1);
    for (int j = 0; j < n; ++j) add({p, along(j), 0}, {q, along(j), 0}, {q, along(j + 1), 0}, {p, along(j + 1), 0});
    add({p, -0.5, below}, {q, -0.5, below}, {q, -0.5, 0}, {p, -0.5, 0});
    add({0.5, p, below}, {0.5, q, below}, {0.5, q, 0}, {0.5, p, 0});
    add({q, 0.5, below}, {p, 0.5, below}, {p, 0.5, 0}, {q, 0.5, 0});
    add({-0.5, q, below}, {-0.5, p, below}, {-0.5, p, 0}, {-0.5, q, 0});
  }
  return all;
}

TEST_F(RigidTriangles, LetABodySpreadOverTheirEnds) {
  json scene = json::parse(R"({
    "space": "solid", "strain": "finite",
    "bodies": {"body": {"mesh": {"box": {"min": [-0.5, -0.5, 0], "max": [0.5, 0.5, 0.6], "cells": [4, 4, 3]}},
                        "material": {"neo_hookean": {"E": 1000, "nu": 0.4}}, "element": "H8_mean_dilatation"}},
    "supports": [{"on": "body.top", "move": {"x": 0, "y": 0, "z": [[0, 0], [1, -0.12]]}}],
    "contacts": {"sole": {"slave": "body.bottom", "master": "tool"}},
    "time": {"end": 1, "steps": 6},
    "responses": {"press": {"contact_force": {"contact": "sole", "component": "normal"}}}})");
  write(table());
  const json of_quadrilaterals =
      side_of(R"({"box": {"min": [-0.5, -0.5, -0.3], "max": [0.5, 0.5, 0], "cells": [3, 3, 1]}})", "boundary");
  const json of_triangles = {{"stl", {{"file", "tool.stl"}}}};
  for (const json& tool : {of_quadrilaterals, of_triangles})
    for (const char* surface : {"smooth", "faceted"})
      for (const double friction : {0.0, 0.2}) {
        SCOPED_TRACE(tool.dump() + surface + std::to_string(friction));
        scene["obstacles"]["tool"] = tool;
        scene["contacts"]["sole"]["surface"] = surface;
        scene["contacts"]["sole"].erase("friction");
        if (friction > 0) scene["contacts"]["sole"]["friction"] = friction;
        expect_certificates(scene);
        const auto exact = run(scene, "monolithic_al"), iterated = run(scene, "uzawa_al");
        ASSERT_EQ(exact.status(), Status::converged) << exact.message();
        ASSERT_EQ(iterated.status(), Status::converged) << iterated.message();
        const double press = exact.steps.back().responses[0];
        EXPECT_NEAR(iterated.steps.back().responses[0], press, 1e-6 * press);  // to its tolerance
        for (const auto& step : exact.steps) EXPECT_LE(step.increment->newton, 15);
      }
}

TEST_F(RigidTriangles, OfAMeshAreRefusedWithTheFaultOfTheMesh) {
  const auto fault_of = [&](const char* mesh, const char* side) {
    return faults(drawn_block("finite", side_of(mesh, side)));
  };
  constexpr const char* ball = R"({"ball": {"center": [0, 0, -3], "radius": 3, "cells": [4, 1]}})";
  EXPECT_EQ(fault_of(ball, "surface"), "none");
  EXPECT_THAT(fault_of(ball, "surfase"), testing::HasSubstr("did you mean \"surface\""));
  EXPECT_THAT(fault_of(ball, "tool.surface"), testing::HasSubstr("did you mean \"surface\""));
  EXPECT_THAT(fault_of(R"({"box": {"min": [0, 0, 0], "max": [1, 1, 1], "cells": [780, 780, 780]}})", "top"),
              testing::HasSubstr("need some 380 GB of memory"));  // (800 bytes a node, which has no displacements)
  EXPECT_THAT(fault_of(R"({"ball": {"center": [0, 0, -3], "radius": -3, "cells": [4, 1]}})", "surface"),
              testing::HasSubstr("must be a number > 0"));
  EXPECT_THAT(fault_of(R"({"box": {"min": [0, 0, 0], "max": [1, 1, 1], "cells": [1, 1, 1]}})", "left & bottom & back"),
              testing::HasSubstr("has no facets"));
  EXPECT_THAT(fault_of(R"({"line": {"from": [0, 0, 0], "to": [1, 0, 0], "cells": 3}})", "start"),
              testing::HasSubstr("fills no region"));
  EXPECT_THAT(fault_of(R"({"gmsh": "none.msh", "body": "tool"})", "face"), testing::HasSubstr("none.msh"));
  std::ofstream(folder_ / "loose.msh") << R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
2 7 "punch"
$EndPhysicalNames
$Nodes
4
1 -2 -2 -0.001
2 3 -2 -0.001
3 3 3 -0.001
4 -2 3 -0.001
$EndNodes
$Elements
1
1 3 2 7 1 1 2 3 4
$EndElements
)";
  constexpr const char* loose = R"({"gmsh": "loose.msh"})";  // a surface on no body
  EXPECT_EQ(fault_of(loose, "punch"), "none");
  EXPECT_THAT(fault_of(loose, "punsh"),
              testing::HasSubstr("no physical surface of this name that is on no body; those that are: punch"));
  EXPECT_THAT(fault_of(R"({"gmsh": "loose.msh", "split": 1})", "punch"), testing::HasSubstr("belongs to a body"));
  EXPECT_THAT(fault_of(R"({"gmsh": "loose.msh", "body": "punch"})", "punch"), testing::HasSubstr("there is no body"));
  const auto on_loose = run(drawn_block("finite", side_of(loose, "punch")), "monolithic_al");
  const auto on_box =
      run(drawn_block("finite",
                      side_of(R"({"box": {"min": [-2, -2, -1], "max": [3, 3, -0.001], "cells": [1, 1, 1]}})", "top")),
          "monolithic_al");
  ASSERT_EQ(on_loose.status(), Status::converged) << on_loose.message();
  EXPECT_LE(largest_entry(on_loose.steps.back().responses - on_box.steps.back().responses), 1e-9);  // the same facet
}

TEST_F(RigidTriangles, AreScaledAndDrawnWhereTheyHaveMoved) {
  write(floor_of(1, [](double, double) { return 0.0; }));
  json scene = drawn_block("finite", {{"stl", {{"file", "tool.stl"}, {"scale", 10}}}});
  const Problem problem(cases::read(scene, folder_ / "scene.json").scene);
  ASSERT_TRUE(has_obstacle_fields(problem.model));
  const auto fields = obstacle_fields(problem, 2);
  ASSERT_EQ(fields.points.cols(), 4);
  for (Eigen::Index v = 0; v < 4; ++v)
    for (int i = 0; i < 3; ++i)
      EXPECT_TRUE(i == 2 ? fields.points(i, v) == 0 : fields.points(i, v) == -20 || fields.points(i, v) == 30);
  EXPECT_EQ(fields.cells.size(), 2u);
  for (Eigen::Index v = 0; v < 4; ++v)
    EXPECT_LE((fields.point_fields.at(0).values.col(v) - Eigen::Vector3d(0, 0.1, 0.02)).norm(), 1e-15);
}

TEST_F(RigidTriangles, AreRefusedWithTheFaultOfTheFile) {
  const json scene = drawn_block("finite", stl);
  EXPECT_THAT(faults(scene), testing::HasSubstr("tool.stl"));  // there is none
  std::ofstream(folder_ / "tool.stl") << "solid\nfacet normal 0 0 one\n";
  EXPECT_THAT(faults(scene), testing::HasSubstr("tool.stl:2:18: a number should stand here; found \"one\""));
  auto turned = floor_of(2, [](double, double) { return 0.0; });
  std::swap(turned[3][0], turned[3][1]);
  write(turned);
  EXPECT_THAT(faults(scene), testing::HasSubstr("no surface that bodies can slide on"));
  write(floor_of(2, [](double, double) { return 0.0; }));
  json in_plane = scene;
  in_plane["space"] = "plane_strain";
  EXPECT_THAT(faults(in_plane), testing::HasSubstr("a stl needs the space solid"));
  json scaled = scene;
  scaled["parameters"]["scale"] = "/obstacles/tool/stl/scale";
  scaled["obstacles"]["tool"]["stl"]["scale"] = 2;
  EXPECT_THAT(faults(scaled), testing::HasSubstr("no parameters"));
}

}  // namespace
}  // namespace stickslip::rigid_facets_test
