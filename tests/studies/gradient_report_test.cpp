#include "studies/run/gradient_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "studies/io/input_fault.hpp"

namespace stickslip {
namespace {

using testing::HasSubstr;
using Verdict = GradientCheck::Verdict;

GradientCheck check_of(const std::vector<Verdict>& verdicts) {
  GradientCheck check;
  check.runs = 24;
  check.rejected = 3;
  for (const auto verdict : verdicts)
    check.entries.push_back({"press", "mu", 0.5, 0, -2.0, -2.25, 0.125, 1e-9, 1e-8, 2.0, 1e-4, 6, 0, 0, 0, verdict});
  return check;
}

TEST(GradientReport, HoldsEveryNumberOfAnEntryAndItsVerdict) {
  const auto document = check_json(check_of({Verdict::agrees, Verdict::differs, Verdict::not_checked}));
  EXPECT_EQ(document["runs"], 24);
  EXPECT_EQ(document["rejected"], 3);
  EXPECT_EQ(document["passed"], false);
  EXPECT_EQ(
      document["entries"][1],
      nlohmann::json::parse(R"({"response": "press", "parameter": "mu", "time": 0.5, "side": "both", "computed": -2.0,
                                      "difference": -2.25, "error": 0.125, "estimate": 1e-9, "allowed": 1e-8,
                                      "scale": 2.0, "step": 1e-4, "steps": 6, "unchecked": 0,
                                      "unchecked_at": null, "undetermined": 0, "verdict": "differs"})"));
  EXPECT_EQ(document["entries"][0]["verdict"], "agrees");
  EXPECT_EQ(document["entries"][2]["verdict"], "not checked");
}

TEST(GradientReport, PrintsALineAnEntry) {
  const std::string table = check_table(check_of({Verdict::agrees, Verdict::differs}));
  EXPECT_THAT(table, HasSubstr("24 difference runs, 3 of them through other contact states\n"));
  EXPECT_THAT(table, HasSubstr("-2.0000000000e+00  -2.2500000000e+00   1.2e-01   1.0e-08  agrees\n"));
  EXPECT_THAT(table, HasSubstr("  DIFFERS\n"));
}

TEST(GradientReport, SaysWhyACheckDidNotPass) {
  EXPECT_EQ(check_faults(check_of({Verdict::agrees})), "");
  EXPECT_EQ(check_faults(check_of({Verdict::agrees, Verdict::differs})), "1 of 2 derivatives differ\n");
  EXPECT_THAT(check_faults(check_of({Verdict::not_checked, Verdict::differs})),
              HasSubstr("1 of 2 derivatives differ\n1 of 2 derivatives are not checked: "));
  GradientCheck failed;
  failed.status = Status::no_equilibrium;
  failed.message = "nothing holds the block";
  EXPECT_EQ(check_faults(failed), "no_equilibrium: nothing holds the block\n");
}

TEST(GradientReport, RefusesASceneWithoutParameters) {
  Diagnostics diagnostics;
  const auto simulation = prepare(STICKSLIP_SOURCE_DIR "/studies/scenes/stop.json", {}, std::nullopt, diagnostics);
  ASSERT_TRUE(simulation) << diagnostics.text();
  EXPECT_TRUE(check_gradients(*simulation, "stop.json").passed());
  auto scene = simulation->input.scene;
  scene.parameters.clear();
  const Simulation bare{simulation->input, std::make_shared<const Problem>(scene)};
  try {
    check_gradients(bare, "bare.json");
    ADD_FAILURE() << "nothing was thrown";
  } catch (const InputFault& fault) {
    EXPECT_STREQ(fault.what(), "bare.json: gradcheck needs parameters and responses");
  }
}

}  // namespace
}  // namespace stickslip
