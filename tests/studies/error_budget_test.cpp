/// Error budgets: their arithmetic, their parts against what the test computes itself, their sum against the error of
/// closed forms, and that they cost nothing where they are not asked for.
#include "studies/sweep/error_budget.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "studies/sweep/budget_runs.hpp"
#include "studies/sweep/study_cell.hpp"
#include "tests/studies/cases.hpp"
#include "tests/studies/temporary_folder.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

// --- arithmetic

TEST(BudgetPart, IsTheMeanWithItsStandardError) {
  const auto part = mean_of({1, 2, 3, 6});
  EXPECT_DOUBLE_EQ(*part.value, 3);
  EXPECT_DOUBLE_EQ(part.noise, std::sqrt((4 + 1 + 0 + 9) / 3.0 / 4));
}

/// limit + c h^p at h = 1, 1/2, 1/4.
BudgetPart of_order(double p, double c, double noise = 0) {
  const auto f = [&](double h) { return 7 + c * std::pow(h, p); };
  return beyond_limit(f(1), f(0.5), f(0.25), noise);
}

TEST(BudgetPart, OfALimitIsExactForPowers) {
  for (const double p : {0.6, 1.0, 2.0, 4.0})
    for (const double c : {3.0, -0.01}) {
      const auto part = of_order(p, c);
      ASSERT_TRUE(part.value) << p;
      EXPECT_NEAR(*part.value, c, 1e-9) << p;
      EXPECT_NEAR(*part.order, p, 1e-9);
    }
}

TEST(BudgetPart, OfALimitIsRefusedWhereThereIsNone) {
  for (const auto& [half, quarter] : {std::pair{2.0, 1.0}, {2.0, 4.0}, {0.9, 1.0}, {0.99, 0.9}}) {  // and 1 at h
    const auto part = beyond_limit(1, half, quarter, 1e-9);
    EXPECT_FALSE(part.value) << half << " " << quarter;
    EXPECT_NE(part.reason.find("asymptotic"), std::string::npos) << part.reason;
  }
}

TEST(BudgetPart, OfALimitThatDoesNotMoveIsNoise) {
  const auto part = beyond_limit(1, 1 + 1e-12, 1 - 1e-12, 1e-11);
  ASSERT_TRUE(part.value);
  EXPECT_LT(std::abs(*part.value), part.noise);
  EXPECT_FALSE(part.order);
}

TEST(Budget, LeavesTheRestAsInteractionAndSaysWhatItLacks) {
  Budget budget;
  budget.parts = {{"mesh", {4.0, 0.3, 2.0, ""}}, {"step", BudgetPart::unknown("no path")}, {"rounding", {-1.0, 0.4}}};
  budget.scale = 2;
  budget.error = 3.5;
  const json out = to_json(budget);
  EXPECT_DOUBLE_EQ(out["sum"], 1.5);
  EXPECT_DOUBLE_EQ(out["noise"], 0.25);
  EXPECT_DOUBLE_EQ(out["error"], 1.75);
  EXPECT_DOUBLE_EQ(out["interaction"], 0.25);
  EXPECT_EQ(out["without"], json::array({"step"}));
  EXPECT_TRUE(out["parts"]["step"]["value"].is_null());
  EXPECT_EQ(out["parts"]["step"]["reason"], "no path");
  EXPECT_DOUBLE_EQ(out["parts"]["mesh"]["value"], 2);
  budget.parts[0].second.shared = true;  // a finer mesh has the steps of the run
  EXPECT_DOUBLE_EQ(to_json(budget)["sum"], -0.5);
  EXPECT_DOUBLE_EQ(to_json(budget)["interaction"], 2.25);
  budget.error.reset();
  EXPECT_TRUE(to_json(budget)["interaction"].is_null());
}

// --- runs

TEST(BudgetRuns, MoveEveryNumberByOneRounding) {
  Scene scene;
  scene.numbers = {1, -0.3, 0, 1e9};
  scene.pointers = {"/a", "/b", "/c", "/d"};
  int ups = 0;
  for (int copy = 1; copy <= 32; ++copy) {
    Scene moved = scene, again = scene;
    round_otherwise(moved, copy);
    round_otherwise(again, copy);
    EXPECT_EQ(moved.numbers, again.numbers);
    for (std::size_t i = 0; i < scene.numbers.size(); ++i) {
      const double from = scene.numbers[i], to = moved.numbers[i];
      EXPECT_TRUE(from == 0 ? to == 0 : to != from && std::nextafter(from, to) == to) << i;
      ups += to > from;
    }
  }
  EXPECT_GT(ups, 96 / 3);
  EXPECT_LT(ups, 96 * 2 / 3);
}

TEST(BudgetRuns, CutTheStepsOfEveryLeg) {
  for (const auto& [time, finer] : {std::pair{json{{"end", 1}, {"steps", 3}}, json{{"end", 1}, {"steps", 12}}},
                                    {json{{"legs", {{1, 2}, {3, 5}}}}, json{{"legs", {{1, 8}, {3, 20}}}}}}) {
    auto scene = JsonDocument::of({{"time", time}}, "test");
    refine_steps(scene, 2, {"test"});
    EXPECT_EQ(scene.root()["time"], finer);
  }
}

class ErrorBudget : public InOwnFolder {
 protected:
  /// The rows of a study; a fault fails the test. `scene` is one of the shipped ones, in which `change` may be made.
  std::vector<json> rows(const std::string& scene, json study, const json& change = json::object()) {
    json document = cases::load(cases::shipped / scene);
    document.merge_patch(change);
    std::ofstream(folder_ / "scene.json") << document.dump();
    study["scene"] = "scene.json";
    std::ofstream(folder_ / "a.study.json") << study.dump();
    Diagnostics diagnostics;
    MeshFiles meshes;
    const auto valid = read_study((folder_ / "a.study.json").string(), diagnostics);
    const auto cells = valid ? expand(*valid, "1.0", diagnostics, meshes) : std::vector<CellInput>();
    EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.text();
    if (cells.empty()) return {};
    CellRunner runner(*valid, cells, meshes);
    std::vector<json> out;
    for (std::size_t i = 0; i < cells.size(); ++i) out.push_back(runner.row(i));
    runs_ = runner.runs();
    return out;
  }

  long runs_ = 0;  ///< of the last study
};

/// As the study asks for: within .8 to 1.25.
void expect_parts_to_add_up(const json& row, const std::string& quantity) {
  const json& budget = row["error_budget"]["quantities"][quantity];
  const double error = budget["error"], sum = budget["sum"];
  EXPECT_TRUE(budget["without"].empty()) << row["label"] << " " << quantity << budget;
  EXPECT_GT(sum / error, 0.8) << row["label"] << " " << quantity << budget;
  EXPECT_LT(sum / error, 1.25) << row["label"] << " " << quantity << budget;
}

json part(const json& row, const std::string& quantity, const std::string& name) {
  return row["error_budget"]["quantities"][quantity]["parts"][name];
}

json pull_out_study() {
  return {{"methods",
           {{{"penalty", {{"stiffness", {1, 1e2, 1e4, 1e8}}}}},
            {{"uzawa_al", {{"scale", 10}, {"tolerance", {1e-1, 1e-3, 1e-8}}}}},
            {{"monolithic_al", {{"scale", {1e-2, 1}}}}}}},
          {"reference",
           {{{"analytic", "pull_out"},
             {"inputs", {{"force", "P"}, {"stiffness", "EA"}, {"friction_per_length", "f"}}},
             {"map", {{"u", "end_displacement"}, {"heat", "dissipation"}}}}}},
          {"error_budget", true}};
}

TEST_F(ErrorBudget, AddsUpToTheErrorOfTheBarOnARoughFloorForAllMethods) {
  for (const json& row : rows("pull_out.json", pull_out_study())) {
    ASSERT_EQ(row["status"], "converged") << row["message"];
    EXPECT_EQ(row["error_budget"]["failed"], json::array()) << row["label"];
    for (const char* quantity : {"response:u", "response:heat", "sensitivity:u/EA", "sensitivity:heat/EA"})
      expect_parts_to_add_up(row, quantity);
    // The front stands a third of a cell beyond a node and short of one in turn, and so errs its motion.
    for (const char* quantity : {"sensitivity:u/P", "sensitivity:u/f"}) {
      EXPECT_TRUE(part(row, quantity, "mesh")["value"].is_null()) << row["label"] << quantity;
      EXPECT_NE(part(row, quantity, "mesh")["reason"].get<std::string>().find("asymptotic"), std::string::npos);
    }
    // f h^2 / (18 EA) of P^2 / (2 EA f), with f h / P = 3 / 20
    const json mesh = part(row, "response:u", "mesh");
    EXPECT_NEAR(mesh["value"], -0.15 * 0.15 / 9, 1e-8) << row["label"];
    EXPECT_NEAR(mesh["order"], 2, 1e-6) << row["label"];
  }
}

/// Two runs of the test's own.
TEST_F(ErrorBudget, EnforcementIsWhatTwoSeparateRunsDifferBy) {
  json study = pull_out_study();
  study["methods"] = {{{"penalty", {{"stiffness", {1e2, 1e4}}}}}};
  const auto budgets = rows("pull_out.json", study);
  study.erase("error_budget");
  study["methods"].push_back({{"monolithic_al", {{"newton", {{"tolerance", 1e-14}}}}}});
  const auto plain = rows("pull_out.json", study);
  ASSERT_EQ(plain.size(), 3u);
  for (std::size_t i = 0; i < 2; ++i)
    for (const char* name : {"u", "heat"}) {
      const double scale = budgets[i]["error_budget"]["quantities"][std::string("response:") + name]["scale"];
      const double penalty = plain[i]["responses"][name], exact = plain[2]["responses"][name];
      const json enforcement = part(budgets[i], std::string("response:") + name, "enforcement");
      // the two runs' own rounding, some 1e-14, is all that they know less of
      EXPECT_NEAR(enforcement["value"], (penalty - exact) / scale, 1e-12) << i << name;
      EXPECT_GT(std::abs(penalty - exact) / scale, 1e-8);
    }
}

TEST_F(ErrorBudget, IterationIsWhatALooseToleranceLeaves) {
  json study = pull_out_study();
  study["methods"] = {{{"uzawa_al", {{"scale", 10}, {"tolerance", {1e-2, 1e-4, 1e-14}}}}}};
  const auto all = rows("pull_out.json", study);
  for (std::size_t i = 0; i < 2; ++i) {
    const double scale = all[i]["error_budget"]["quantities"]["response:u"]["scale"];
    const double left = all[i]["responses"]["u"].get<double>() - all[2]["responses"]["u"].get<double>();
    EXPECT_GT(std::abs(left) / scale, 1e-7);
    EXPECT_NEAR(part(all[i], "response:u", "iteration")["value"], left / scale, 1e-12);
    EXPECT_NEAR(part(all[i], "response:u", "enforcement")["value"], 0, 1e-12);
  }
}

/// A turning direction of slip: first order in the steps, and there is no mesh.
TEST_F(ErrorBudget, AddsUpToTheErrorOfTheTractrixWhoseStepsErr) {
  const auto all = rows("tractrix.json",
                        {{"methods",
                          {{{"penalty", {{"stiffness", {1e2, 1e6}}}}},
                           {{"uzawa_al", {{"tolerance", {1e-2, 1e-6}}}}},
                           {{"monolithic_al", json::object()}}}},
                         {"reference", {{{"values", {{"x", 2.0027245810}, {"heat", 209.60027036}}}}}},
                         {"errors", {"response:x", "response:heat"}},
                         {"error_budget", true}},
                        {{"time", {{"steps", 40}}}});
  ASSERT_EQ(all.size(), 5u);
  for (const json& row : all)
    for (const char* quantity : {"response:x", "response:heat"}) {
      expect_parts_to_add_up(row, quantity);
      EXPECT_NEAR(part(row, quantity, "step")["order"], 1, 0.15);
      EXPECT_EQ(part(row, quantity, "mesh")["value"], 0);
      EXPECT_EQ(part(row, quantity, "mesh")["reason"], "there is no mesh");
    }
}

/// A spring against a stop: u = (F + rho g) / (k + rho), press = rho (u - g), in the arithmetic of the test without
/// cancellation. What a run is off by is its rounding.
TEST_F(ErrorBudget, RoundingIsWhatAStiffPenaltyIsOffByFromItsOwnSolution) {
  const auto all = rows("stop.json", {{"methods", {{{"penalty", {{"stiffness", {1e7, 1e9}}}}}}},
                                      {"reference", {{{"values", {{"press", 5}}}}}},
                                      {"errors", {"response:press"}},
                                      {"error_budget", {{"copies", 16}}}});
  for (const json& row : all) {
    const double F = 15, k = 1000, g = 0.01, rho = k * row["knobs"]["stiffness"].get<double>();
    const double solution = rho / (k + rho) * (F - k * g);
    const double rounding = (row["responses"]["press"].get<double>() - solution) / 5;
    const double measured = part(row, "response:press", "rounding")["value"];
    // Copies may share some of their roundings: sign and size are right, digits are not.
    constexpr double alike = 8;
    EXPECT_GT(measured / rounding, 1 / alike) << row["label"];
    EXPECT_LT(measured / rounding, alike) << row["label"];
    expect_parts_to_add_up(row, "response:press");
  }
}

TEST_F(ErrorBudget, MeasuresTheMeshOfAFileByItsSplits) {
  const auto folder = std::filesystem::path(STICKSLIP_SOURCE_DIR) / "studies" / "meshes";
  const auto all = rows("cattaneo_mindlin.json",
                        {{"methods", {{{"penalty", {{"stiffness", 100}}}}}},
                         {"errors", {"response:pull"}},
                         {"error_budget", {{"copies", 2}}}},
                        {{"bodies",
                          {{"upper", {{"mesh", {{"gmsh", folder / "two_half_disks.msh"}}}}},
                           {"lower", {{"mesh", {{"gmsh", folder / "two_half_disks.msh"}}}}}}},
                         {"parameters", nullptr},
                         {"time", {{"legs", {{1, 2}, {2, 2}}}}}});
  ASSERT_EQ(all.size(), 1u);
  const json mesh = part(all[0], "response:pull", "mesh");
  ASSERT_TRUE(mesh["value"].is_number()) << mesh;
  EXPECT_GT(std::abs(mesh["value"].get<double>()), 1e-4) << mesh;  // of T3: a share that one sees
  EXPECT_LT(std::abs(mesh["value"].get<double>()), 0.1) << mesh;
  const json& budget = all[0]["error_budget"];
  EXPECT_TRUE(budget["failed"].empty()) << budget;
  EXPECT_TRUE(budget["quantities"]["response:pull"]["error"].is_null());  // no reference
}

/// A tip lies between the two nodes of a side that supports hold: halved, the side has a node inside of it.
TEST_F(ErrorBudget, IsNullWithItsReasonWhereAPartCannotBeMeasured) {
  const json box = {{"min", {0, 0}}, {"max", {1, 1}}, {"cells", {1, 1}}}, rubber = {{"E", 1000}, {"nu", 0.3}};
  const auto all =
      rows("stop.json",
           {{"methods", {{{"penalty", {{"stiffness", 100}}}}}},
            {"errors", {"response:u"}},
            {"error_budget", {{"copies", 2}}}},
           {{"bodies",
             {{"mass",
               {{"mesh", {{"point", nullptr}, {"box", box}}},
                {"material", {{"grounded_spring", nullptr}, {"linear_elastic", rubber}}}}}}},
            {"obstacles", {{"wall", {{"plane", nullptr}, {"circle", {{"center", {0.5, -0.03}}, {"radius", 0.05}}}}}}},
            {"contacts", {{"stop", {{"slave", "mass.bottom"}}}}},
            {"supports", {{{"on", "mass.bottom"}, {"move", {{"x", 0}, {"y", 0}}}}}},
            {"loads", {{{"on", "mass.top"}, {"pressure", 1}}}},
            {"responses", {{"press", nullptr}, {"u", {{"displacement", {{"on", "mass.top"}, {"component", "y"}}}}}}},
            {"parameters", nullptr}});
  ASSERT_EQ(all.size(), 1u);
  const json mesh = part(all[0], "response:u", "mesh");
  EXPECT_TRUE(mesh["value"].is_null());
  EXPECT_NE(mesh["reason"].get<std::string>().find("mesh halved once: infeasible"), std::string::npos) << mesh;
  const json& budget = all[0]["error_budget"];
  ASSERT_EQ(budget["failed"].size(), 2u) << budget;
  EXPECT_EQ(budget["failed"][0]["status"], "infeasible");
  EXPECT_NE(budget["failed"][0]["message"].get<std::string>().find("penetrates by 0.02"), std::string::npos) << budget;
  EXPECT_EQ(budget["quantities"]["response:u"]["without"][0], "mesh");
}

TEST_F(ErrorBudget, OfARunThatFailedSaysSo) {
  const auto all =
      rows("pull_out.json", {{"methods", {{{"uzawa_al", {{"max_augmentations", 1}}}}}}, {"error_budget", true}});
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0]["status"], "cap");
  EXPECT_EQ(all[0]["error_budget"]["reason"], "the run did not converge");
  EXPECT_FALSE(all[0]["error_budget"].contains("quantities"));
}

TEST_F(ErrorBudget, CostsNothingWhereItIsNotAskedFor) {
  json study = pull_out_study();
  study["methods"] = {{{"penalty", {{"stiffness", {1, 1e2}}}}}, {{"monolithic_al", json::object()}}};
  study["error_budget"] = {{"copies", 2}};
  const auto with = rows("pull_out.json", study);
  // the three cells; 2 copies of each as given and tight; of the exact run 1, its 2 copies, 2 finer meshes and 2 steps
  EXPECT_EQ(runs_, 3 + 3 * 2 * 2 + 7);
  EXPECT_EQ(with[0]["error_budget"]["runs"], 2 * 2 + 7);
  for (const json& off : {json(false), json()}) {
    study["error_budget"] = off;
    if (off.is_null()) study.erase("error_budget");
    const auto without = rows("pull_out.json", study);
    EXPECT_EQ(runs_, 3);
    ASSERT_EQ(without.size(), with.size());
    for (std::size_t i = 0; i < with.size(); ++i) {
      json a = with[i], b = without[i];
      EXPECT_FALSE(b.contains("error_budget"));
      a.erase("error_budget");
      for (json* row : {&a, &b}) {
        row->erase("provenance");
        (*row)["cost"].erase("seconds");
        (*row)["cost"].erase("peak_memory_mb");
      }
      EXPECT_EQ(a, b);
    }
  }
}

}  // namespace
}  // namespace stickslip
