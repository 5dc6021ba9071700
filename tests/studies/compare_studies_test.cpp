#include "studies/app/compare_studies.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stickslip {
namespace {

using nlohmann::json;

json row(const std::string& id, const std::string& label, double error, int newton) {
  return {{"id", id},
          {"label", label},
          {"vary", json::object()},
          {"refine", 0},
          {"scene_hash", "abc"},
          {"status", "converged"},
          {"responses", {{"press", 9.9}, {"side", label == "penalty" ? 2e-17 : 5.0}}},
          {"sensitivities", {{"press", {{"E", 0.1}}}}},
          {"errors", {{"enforcement", {{"response:press", error}}}}},
          {"cost", {{"counts", {{"newton", newton}}}, {"seconds", {{"total", 1.0}}}}}};
}

const RowsById before = {{"1", row("1", "penalty", 1e-3, 10)}, {"2", row("2", "uzawa_al", 1e-9, 20)}};

/// `before` by another version of the program, with another value somewhere.
RowsById after(const std::string& label, const std::string& pointer, const json& value) {
  RowsById rows;
  for (const auto& [id, old] : before) {
    rows["new " + id] = old;
    if (old["label"] == label) rows["new " + id][json::json_pointer(pointer)] = value;
  }
  return rows;
}

bool any_worse(const std::vector<CellComparison>& cells) {
  return std::any_of(cells.begin(), cells.end(), [](const auto& cell) { return cell.worse(); });
}

TEST(CompareStudies, FindsNothingInEqualRowsOfAnotherVersion) {
  const auto cells = compare_rows(before, after("", "", 0), {});
  EXPECT_EQ(cells.size(), 2u);
  for (const auto& cell : cells) EXPECT_TRUE(cell.changes.empty());
}

TEST(CompareStudies, KnowsRecordingsOfDifferentStudies) {
  EXPECT_EQ(unrelated(before, after("", "", 0)), "");
  // another scene of the same responses may be an edited one
  auto others = before;
  for (auto& [id, row] : others) row["scene_hash"] = "other";
  EXPECT_EQ(unrelated(before, others), "");
  for (auto& [id, row] : others) {
    row["responses"] = {{"drag", 1.0}};
    row["sensitivities"] = json::object();
  }
  EXPECT_EQ(unrelated(before, others), "their scenes are not the same, and have no response in common");
  for (auto& [id, row] : others) row["label"] = "another " + row["label"].get<std::string>();
  EXPECT_EQ(unrelated(before, others), "they have no cell in common");
}

TEST(CompareStudies, HoldsOneMoreIterationAgainstTheNewRows) {
  const auto cells = compare_rows(before, after("uzawa_al", "/cost/counts/newton", 21), {});
  EXPECT_TRUE(any_worse(cells));
  EXPECT_EQ(cells.front().label, "uzawa_al");
  EXPECT_EQ(cells.front().changes.front().quantity, "count newton");
}

TEST(CompareStudies, TakesFewerIterationsAsABetterChange) {
  const auto cells = compare_rows(before, after("uzawa_al", "/cost/counts/newton", 12), {});
  EXPECT_FALSE(any_worse(cells));
  EXPECT_EQ(cells.front().changes.size(), 1u);
}

TEST(CompareStudies, HoldsThePartsOfErrorBudgetsWithinTheirNoise) {
  const auto with_budget = [](double step, double noise, double rounding) {
    RowsById rows = before;
    json parts;
    for (const char* name : {"iteration", "enforcement", "mesh"}) parts[name] = {{"value", 0.01}, {"noise", 0}};
    parts["step"] = {{"value", step}, {"noise", noise}};
    parts["rounding"] = {{"value", rounding}, {"noise", rounding}};
    rows["1"]["error_budget"] = {{"quantities", {{"response:press", {{"parts", parts}}}}}};
    return rows;
  };
  const auto old_rows = with_budget(-1e-3, 1e-6, 1e-15);
  const auto grown = compare_rows(old_rows, with_budget(-2e-3, 1e-6, 1e-15), {});
  EXPECT_TRUE(any_worse(grown));
  ASSERT_EQ(grown.front().changes.size(), 1u);
  EXPECT_EQ(grown.front().changes.front().quantity, "budget step response:press");
  EXPECT_FALSE(any_worse(compare_rows(old_rows, with_budget(-0.5e-3, 1e-6, 1e-15), {})));
  const RowsById others[] = {with_budget(-1.1e-3, 1e-4, 1e-15), with_budget(-1e-3, 1e-6, 1e-9), before};
  for (const auto& other : others)  // noise; copies measure rounding anew; no budget was asked for
    EXPECT_TRUE(compare_rows(old_rows, other, {}).front().changes.empty());
}

TEST(CompareStudies, PassesOverRoundingAndSmallShares) {
  EXPECT_TRUE(compare_rows(before, after("uzawa_al", "/errors/enforcement/response:press", 9e-12), {})[0]
                  .changes.front()
                  .quantity == "enforcement response:press");  // 1e-9 to 9e-12 is a change, for the better
  for (const double error : {1.04e-3, 0.96e-3})
    EXPECT_TRUE(
        compare_rows(before, after("penalty", "/errors/enforcement/response:press", error), {})[0].changes.empty());
  EXPECT_TRUE(compare_rows(before, after("uzawa_al", "/errors/enforcement/response:press", 1e-9 + 9e-12), {})[0]
                  .changes.empty());
}

TEST(CompareStudies, HoldsLargerErrorsAgainstTheNewRows) {
  EXPECT_TRUE(any_worse(compare_rows(before, after("penalty", "/errors/enforcement/response:press", 1.1e-3), {})));
  EXPECT_TRUE(any_worse(compare_rows(before, after("penalty", "/errors/enforcement/response:press", nullptr), {})));
}

TEST(CompareStudies, FindsOtherResponsesAndSensitivities) {
  for (const auto& [pointer, quantity] :
       {std::pair{"/responses/press", "response press"}, std::pair{"/sensitivities/press/E", "sensitivity press/E"}}) {
    const double old = before.at("1").at(json::json_pointer(pointer));
    const auto cells = compare_rows(before, after("penalty", pointer, old * (1 + 1e-9)), {});
    ASSERT_EQ(cells.front().changes.size(), 1u) << pointer;
    EXPECT_EQ(cells.front().changes.front().quantity, quantity);
    EXPECT_EQ(cells.front().label, "penalty");
    EXPECT_FALSE(any_worse(cells));
    EXPECT_TRUE(cells.back().changes.empty());
    EXPECT_TRUE(compare_rows(before, after("penalty", pointer, old * (1 + 1e-12)), {}).front().changes.empty());
    EXPECT_FALSE(compare_rows(before, after("penalty", pointer, nullptr), {}).front().changes.empty());
  }
}

/// A response that is zero but for rounding in one cell has the size that it has in the others.
TEST(CompareStudies, MeasuresResponsesByTheirLargestSizeInAnyCell) {
  EXPECT_TRUE(compare_rows(before, after("penalty", "/responses/side", -4e-17), {}).front().changes.empty());
  EXPECT_FALSE(compare_rows(before, after("penalty", "/responses/side", 1e-9), {}).front().changes.empty());
}

TEST(CompareStudies, FindsObjectivesAndTheirGradients) {
  auto old_rows = before, new_rows = before;
  for (auto* rows : {&old_rows, &new_rows})
    for (auto& [id, row] : *rows) row["objectives"] = {{"J", {{"value", 2.0}, {"gradient", {{"E", 3.0}}}}}};
  EXPECT_TRUE(compare_rows(old_rows, new_rows, {}).front().changes.empty());
  new_rows["1"]["objectives"] = {{"J", {{"value", 4.0}, {"gradient", {{"E", 6.0}}}}}};
  EXPECT_EQ(compare_rows(old_rows, new_rows, {}).front().changes.size(), 2u);
}

TEST(CompareStudies, SaysThatTheSceneIsAnother) {
  const auto cells = compare_rows(before, after("penalty", "/scene_hash", "def"), {});
  EXPECT_TRUE(cells.front().other_scene());
  EXPECT_FALSE(cells.back().other_scene());
  EXPECT_FALSE(any_worse(cells));
}

TEST(CompareStudies, PutsACellThatNoLongerConvergesFirst) {
  auto rows = after("uzawa_al", "/status", "cap");
  rows["new 1"]["cost"]["counts"]["newton"] = 1000;
  const auto cells = compare_rows(before, rows, {});
  EXPECT_EQ(cells.front().label, "uzawa_al");
  EXPECT_TRUE(cells.front().worse());
  EXPECT_FALSE(any_worse(compare_rows(rows, after("uzawa_al", "/cost/counts/newton", 20), {})));  // and back again
}

TEST(CompareStudies, MissesACellThatIsGone) {
  auto rows = before;
  rows.erase("2");
  EXPECT_TRUE(any_worse(compare_rows(before, rows, {})));
  const auto cells = compare_rows(rows, before, {});
  EXPECT_FALSE(any_worse(cells));
  EXPECT_TRUE(cells.front().only_after);
}

}  // namespace
}  // namespace stickslip
