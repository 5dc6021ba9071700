#include "studies/sweep/study_cell.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/studies/cases.hpp"
#include "tests/studies/temporary_folder.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

class StudyCell : public InOwnFolder {
 protected:
  /// The study and its cells; a fault of either fails the test.
  std::pair<Study, std::vector<CellInput>> read(const json& scene, json study) {
    std::ofstream(folder_ / "scene.json") << scene.dump();
    study["scene"] = "scene.json";
    std::ofstream(folder_ / "a.study.json") << study.dump();
    Diagnostics diagnostics;
    auto valid = read_study((folder_ / "a.study.json").string(), diagnostics);
    auto cells = valid ? expand(*valid, "1.0", diagnostics, meshes_) : std::vector<CellInput>();
    EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.text();
    return {valid.value_or(Study{}), cells};
  }

  MeshFiles meshes_;
};

TEST_F(StudyCell, ALevelHalvesTheCellsOfEveryGenerator) {
  const json material = {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}};
  const std::vector<std::pair<json, int>> generators = {
      // and how many elements become of one
      {{{"box", {{"min", {0, 0}}, {"max", {4, 2}}, {"cells", {4, 2}}}}}, 4},
      {{{"quad", {{"corners", {{0, 0}, {2, 0}, {3, 1}, {0, 1}}}, {"cells", {2, 3}}}}}, 4},
      {{{"ring", {{"center", {0, 0}}, {"inner", 1}, {"outer", 2}, {"to_angle", 90}, {"cells", {2, 5}}}}}, 4},
      {{{"disk", {{"center", {0, 0}}, {"radius", 1}, {"cells", {2, 4}}}}}, 4},
      {{{"half_disk", {{"center", {0, 0}}, {"radius", 1}, {"cells", {4, 4}}}}}, 4},
      {{{"line", {{"from", {0, 0}}, {"to", {1, 0}}, {"cells", 3}}}}, 2},
      {{{"arc", {{"center", {0, 0}}, {"radius", 1}, {"from_angle", 0}, {"to_angle", 90}, {"cells", 3}}}}, 2},
      {{{"point", {{"at", {0, 0}}}}}, 1}};
  for (const auto& [mesh, factor] : generators) {
    json body = {{"mesh", mesh}, {"material", material}};
    if (mesh.contains("point")) body["material"] = {{"grounded_spring", {{"stiffness", {{1, 0}, {0, 1}}}}}};
    const auto [study, cells] = read({{"bodies", {{"body", body}}}, {"time", {{"end", 1}, {"steps", 1}}}},
                                     {{"methods", {{{"monolithic_al", json::object()}}}}, {"refine", {0, 1}}});
    if (factor == 1) {
      EXPECT_EQ(cells.size(), 1u) << "a point has no levels, and cells that are the same come once";
      continue;
    }
    ASSERT_EQ(cells.size(), 2u) << mesh;
    int elements[2];
    for (int level = 0; level < 2; ++level)
      elements[level] = problem_of(input_of(cells[level], meshes_))->model.bodies[0].mesh.element_count();
    EXPECT_EQ(elements[1], factor * elements[0]) << mesh;
  }
}

/// A block that is pressed on a floor and pulled along it.
json block_scene() {
  return {{"bodies",
           {{"block",
             {{"mesh", {{"box", {{"min", {0, 0}}, {"max", {4, 2}}, {"cells", {4, 2}}}}}},
              {"material", {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}}}}}}},
          {"obstacles", {{"floor", {{"plane", {{"point", {0, 0}}, {"normal", {0, 1}}}}}}}},
          {"contacts", {{"sole", {{"slave", "block.bottom"}, {"master", "floor"}, {"friction", 0.3}}}}},
          {"loads", {{{"on", "block.top"}, {"traction", {1, -5}}, {"history", {{0, 0}, {1, 1}}}}}},
          {"time", {{"end", 1}, {"steps", 2}}},
          {"responses", {{"shift", {{"displacement", {{"on", "block.top"}, {"component", "x"}}}}}}},
          {"parameters", {{"E", "/bodies/block/material/linear_elastic/E"}}}};
}

TEST_F(StudyCell, ErrorsAgainstAFinerMeshFallWithTheMesh) {
  const auto [study, cells] = read(block_scene(), {{"methods", {{{"monolithic_al", json::object()}}}},
                                                   {"refine", {0, 1, 2}},
                                                   {"reference", {{{"overkill", {{"refine", 2}}}}}}});
  ASSERT_EQ(cells.size(), 3u);
  CellRunner runner(study, cells, meshes_);
  double last = 1;
  for (std::size_t level = 0; level < cells.size(); ++level) {
    const json errors = runner.row(level)["errors"];
    for (const char* name : {"response:shift", "sensitivity:shift/E"}) {
      EXPECT_GT(errors["discretization"].value(name, 0.0), 0) << name;
      EXPECT_LT(errors["discretization"].value(name, 1.0), 0.1) << name;  // a coarse mesh of a stout block
    }
    EXPECT_LT(errors["discretization"].value("response:shift", 1.0), last);
    EXPECT_TRUE(errors["enforcement"].empty());
    last = errors["discretization"]["response:shift"];
  }
}

/// The errors are differences of the responses of each mesh to those of one run.
TEST_F(StudyCell, MeshesCanHaveOneReferenceThatIsRunOnce) {
  const char* const mesh = "/bodies/block/mesh/box/cells";
  const auto [study, cells] =
      read(block_scene(), {{"methods", {{{"monolithic_al", json::object()}}}},
                           {"vary", {{mesh, {{4, 2}, {6, 3}, {16, 8}}}}},
                           {"reference", {{{"overkill", {{"vary", {{mesh, {8, 4}}}}, {"refine", 1}}}}}}});
  ASSERT_EQ(cells.size(), 3u);
  CellRunner runner(study, cells, meshes_);
  std::vector<json> rows;
  for (std::size_t i = 0; i < cells.size(); ++i) rows.push_back(runner.row(i));
  EXPECT_EQ(runner.runs(), 4);
  const double exact = rows[2]["responses"]["shift"], exact_derivative = rows[2]["sensitivities"]["shift"]["E"];
  for (const json& row : rows) {
    const json& errors = row["errors"]["discretization"];
    EXPECT_NEAR(errors["response:shift"], std::abs(row["responses"]["shift"].get<double>() / exact - 1), 1e-12);
    EXPECT_NEAR(errors["sensitivity:shift/E"],
                std::abs(row["sensitivities"]["shift"]["E"].get<double>() / exact_derivative - 1), 1e-12);
  }
  EXPECT_GT(rows[0]["errors"]["discretization"]["response:shift"], 1e-4);  // a coarse mesh of a stout block
}

TEST_F(StudyCell, RowsHoldTheWarningsOfTheirRun) {
  json scene = block_scene();
  scene["contacts"]["sole"]["friction"] = 50;
  const auto [study, cells] = read(scene, {{"methods", {{{"penalty", {{"stiffness", 100}}}}}}});
  ASSERT_EQ(cells.size(), 1u);
  const json row = CellRunner(study, cells, meshes_).row(0);
  ASSERT_EQ(row["warnings"].size(), 1u);
  EXPECT_EQ(row["warnings"][0]["code"], "idle_friction");
  EXPECT_EQ(row["warnings"][0]["value"], 50);
}

TEST_F(StudyCell, HoldsObjectivesAndTheirGradientsAgainstAReferenceInEitherMode) {
  for (const char* mode : {"direct", "adjoint"}) {
    json scene = block_scene();
    scene["objectives"] = {{"J", {{"of", "shift"}, {"sum", true}}}};
    scene["sensitivity"] = {{"mode", mode}};
    const auto [study, cells] =
        read(scene, {{"methods", {{{"penalty", {{"stiffness", 100}}}}, {{"monolithic_al", json::object()}}}},
                     {"reference", {{{"method", {{"monolithic_al", json::object()}}}}, {{"values", {{"J/E", -1e-6}}}}}},
                     {"errors", {"response:J", "sensitivity:J/E"}}});
    ASSERT_EQ(cells.size(), 2u);
    CellRunner runner(study, cells, meshes_);
    const json penalty = runner.row(0), exact = runner.row(1);
    const double J = exact["objectives"]["J"]["value"], dJ = exact["objectives"]["J"]["gradient"]["E"];
    const double off = penalty["objectives"]["J"]["value"], d_off = penalty["objectives"]["J"]["gradient"]["E"];
    const auto& errors = penalty["errors"]["enforcement"];
    EXPECT_GT(std::abs(off - J), 1e-6 * std::abs(J)) << mode;
    EXPECT_DOUBLE_EQ(errors["response:J"], std::abs(off - J) / std::abs(J)) << mode;
    // J is proportional to 1/E: dJ/dE is of the size of J over E, by which a derivative that vanishes is measured
    EXPECT_NEAR(errors["sensitivity:J/E"], std::abs(d_off - dJ) / std::abs(dJ), 1e-9) << mode;
    EXPECT_EQ(exact["errors"]["enforcement"]["response:J"], 0) << mode;
    EXPECT_NEAR(exact["errors"]["discretization"]["sensitivity:J/E"], std::abs(dJ + 1e-6) / std::abs(J / 1000), 1e-9);
  }
}

TEST_F(StudyCell, KeepsTheErrorsOfEveryReferenceAndTheFirstOfEachName) {
  const auto [study, cells] = read(block_scene(), {{"methods", {{{"penalty", {{"stiffness", 100}}}}}},
                                                   {"reference",
                                                    {{{"values", {{"shift", 1}}}},
                                                     {{"overkill", {{"refine", 1}}}},
                                                     {{"method", {{"monolithic_al", json::object()}}}}}}});
  ASSERT_EQ(cells.size(), 1u);
  CellRunner runner(study, cells, meshes_);
  const json errors = runner.row(0)["errors"];
  ASSERT_EQ(errors["by_reference"].size(), 3u);
  EXPECT_EQ(errors["discretization"]["response:shift"], errors["by_reference"][0]["errors"]["response:shift"]);
  EXPECT_NE(errors["discretization"]["response:shift"], errors["by_reference"][1]["errors"]["response:shift"]);
  EXPECT_EQ(errors["enforcement"]["response:shift"], errors["by_reference"][2]["errors"]["response:shift"]);
}

/// What a history is drawn from.
TEST_F(StudyCell, RowsHoldTheResponsesOfEveryStep) {
  const auto [study, cells] = read(block_scene(), {{"methods", {{{"monolithic_al", json::object()}}}}});
  const json row = CellRunner(study, cells, meshes_).row(0);
  ASSERT_GE(row["steps"].size(), 1u);
  for (const auto& step : row["steps"]) EXPECT_TRUE(step["responses"]["shift"].is_number());
  EXPECT_EQ(row["steps"].back()["responses"], row["responses"]);
}

/// The shipped study of the belt: its tensions and, node by node, its tractions are those of the polygon.
TEST_F(StudyCell, TheBeltIsHeldAgainstItsClosedForm) {
  json scene = cases::load(cases::shipped / "belt.json"), shipped = cases::load(cases::shipped / "belt.study.json");
  shipped["methods"] = {{{"monolithic_al", json::object()}}};
  shipped.erase("timing");
  const auto [study, cells] = read(scene, shipped);
  ASSERT_EQ(cells.size(), 2u);  // two coefficients of friction
  CellRunner runner(study, cells, meshes_);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const json errors = runner.row(i)["errors"]["discretization"];
    // the bars are a hundred times as stiff as the pull that stretches them: condition 1e5 or so
    for (const char* name : {"response:tight", "sensitivity:tight/mu", "sensitivity:tight/T1", "field:normal_traction",
                             "field:tangential_traction"})
      EXPECT_LT(errors.value(name, 1.0), 1e-8) << name;
  }
}

/// A radius that is a parameter is known when the cell is run.
TEST_F(StudyCell, AClosedFormWithoutAnAnswerGivesNoErrors) {
  json scene = block_scene();
  scene["responses"]["press"] = {{"contact_force", {{"contact", "sole"}, {"component", "normal"}}}};
  scene["contacts"]["sole"]["offset"] = 0;
  scene["parameters"]["R"] = "/contacts/sole/offset";
  const auto [study, cells] = read(
      scene,
      {{"methods", {{{"monolithic_al", json::object()}}}},
       {"reference", {{{"analytic", "hertz_line"}, {"map", {{"press", "force"}}}, {"inputs", {{"radius", "R"}}}}}}});
  ASSERT_EQ(cells.size(), 1u);
  const json errors = CellRunner(study, cells, meshes_).row(0)["errors"];
  EXPECT_EQ(errors["discretization"], json::object());
}

/// A block that its weight presses on a floor of friction 1000 and its drive lifts at one end, on the sparse engine:
/// the last factorisation of a run that ends without an answer fails.
TEST_F(StudyCell, ARunThatEndsWithoutFactorsIsARow) {
  json scene = block_scene();
  scene["contacts"]["sole"]["friction"] = 1000;
  scene["loads"] = {{{"on", "block"}, {"body_force", {3, -1}}, {"history", {{0, 0}, {1, 1}}}}};
  scene["linear_solver"] = {{"engine", "sparse"}};
  const auto [study, cells] =
      read(scene, {{"methods", {{{"uzawa_al", json::object()}}, {{"penalty", json::object()}}}}});
  ASSERT_EQ(cells.size(), 2u);
  CellRunner runner(study, cells, meshes_);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const json row = runner.row(i);
    EXPECT_NE(row["status"], "failed") << row["message"];
    EXPECT_TRUE(row["cost"].contains("condition_estimate"));
  }
}

/// Whatever a cell throws is a row, and the cells after it run.
TEST_F(StudyCell, ACellThatThrowsIsARow) {
  auto [study, cells] = read(block_scene(), {{"methods", {{{"penalty", {{"stiffness", {10, 1000}}}}}}},
                                             {"vary", {{"/contacts/sole/friction", {0.3, 0.4}}}}});
  ASSERT_EQ(cells.size(), 4u);
  cells[2].document.set("/bodies", 7, {"nowhere"});  // as of a fault in the program: no valid cell is like that
  CellRunner runner(study, cells, meshes_);
  EXPECT_EQ(runner.row(1)["status"], "converged");
  const json row = runner.row(2);
  EXPECT_EQ(row["status"], "failed");
  EXPECT_EQ(row["id"], cells[2].id);
  EXPECT_EQ(row["label"], cells[2].label);
  EXPECT_NE(row["message"].get<std::string>().find("not a valid scene"), std::string::npos) << row["message"];
  EXPECT_EQ(runner.row(3)["status"], "converged");
}

/// A reference that throws leaves the cells their own results.
TEST_F(StudyCell, AReferenceThatThrowsGivesNoErrors) {
  auto [study, cells] = read(
      block_scene(), {{"methods", {{{"penalty", json::object()}}}}, {"reference", {{{"overkill", {{"refine", 1}}}}}}});
  study.references.front().method.options.push_back({"/no_such_option", {{1, {"nowhere"}}}});
  CellRunner runner(study, cells, meshes_);
  const json row = runner.row(0);
  EXPECT_EQ(row["status"], "converged");
  EXPECT_EQ(row["errors"]["discretization"], json::object());
  EXPECT_NE(row["message"].get<std::string>().find("no_such_option"), std::string::npos) << row["message"];
}

/// What a worker of another process gives is what this one gives, so it must not depend on the cells before.
TEST_F(StudyCell, ARowDoesNotDependOnWhatRanBefore) {
  const auto [study, cells] =
      read(block_scene(), {{"methods", {{{"penalty", {{"stiffness", {10, 1000}}}}}, {{"uzawa_al", json::object()}}}},
                           {"vary", {{"/contacts/sole/friction", {0.1, 0.3}}}},
                           {"reference", {{{"method", {{"monolithic_al", json::object()}}}}}}});
  const auto row = [](CellRunner& runner, std::size_t cell) {
    json out = runner.row(cell);
    out.erase("provenance");
    out["cost"].erase("seconds");
    out["cost"].erase("peak_memory_mb");
    return out;
  };
  CellRunner forwards(study, cells, meshes_);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const json after_others = row(forwards, i);
    CellRunner fresh(study, cells, meshes_);
    EXPECT_EQ(after_others, row(fresh, i)) << i;
  }
}

}  // namespace
}  // namespace stickslip
