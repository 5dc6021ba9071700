/// gradcheck on scenes: a right derivative agrees, also next to noise; at a tie each side is checked.
#include <gmock/gmock.h>

#include "studies/run/gradient_report.hpp"
#include "studies/run/simulation.hpp"
#include "tests/studies/cases.hpp"

namespace stickslip::gradcheck {
namespace {

using nlohmann::json;
using Verdict = GradientCheck::Verdict;
namespace fs = std::filesystem;

const fs::path folder = fs::path(STICKSLIP_SOURCE_DIR) / "tests" / "cases";

GradientCheck check_of(json document, const json& method) {
  document["method"] = method;
  const auto input = cases::read(document, folder / "gradcheck.json");
  return check_gradients({input, std::make_shared<const Problem>(input.scene)}, "gradcheck.json");
}

const std::vector<json> gradcheck_methods = {
    {{"penalty", json::object()}}, {{"uzawa_al", json::object()}}, {{"monolithic_al", json::object()}}};

TEST(Gradcheck, OfARightDerivativeAgreesWhereTheSolverIsNoisy) {
  for (const auto& method : gradcheck_methods)
    for (const auto& entry : check_of(cases::load(folder / "gradcheck-noise.json"), method).entries) {
      EXPECT_EQ(entry.verdict, Verdict::agrees) << method << entry.parameter << entry.error << entry.allowed;
      EXPECT_LT(entry.allowed, 5e-7) << method << entry.parameter;  // so that an error of 1e-6 is seen
    }
}

TEST(Gradcheck, OfAStepWithATieChecksTheOthersAndBothSides) {
  // unloaded to where it was: at t = 2 all nodes are at the edge of contact
  for (const auto& method : gradcheck_methods) {
    const auto check = check_of(cases::load(folder / "gradcheck-unloaded.json"), method);
    ASSERT_EQ(check.entries.size(), 1u);
    const auto& entry = check.entries.front();
    EXPECT_EQ(entry.verdict, Verdict::agrees) << method << check_table(check);
    EXPECT_EQ(entry.steps, 6);
    EXPECT_EQ(entry.unchecked, 0);
    EXPECT_TRUE(check.passed());
    EXPECT_GT(check.rejected, 5) << method;  // of a side all runs pass through other states at the last step
  }
}

json unloaded_adjoint() {
  auto document = cases::load(folder / "gradcheck-unloaded.json");
  document["objectives"] = {{"J", {{"of", "press"}, {"sum", true}}}};
  document["sensitivity"] = {{"mode", "adjoint"}};
  return document;
}

TEST(Gradcheck, OfAnAdjointChecksBothSidesOfAnObjective) {
  const auto check = check_of(unloaded_adjoint(), gradcheck_methods.back());
  ASSERT_EQ(check.entries.size(), 1u);
  EXPECT_EQ(check.entries.front().verdict, Verdict::agrees) << check_table(check);
  EXPECT_EQ(check.entries.front().unchecked, 0);
}

TEST(Gradcheck, SaysHowManyStepsWereNotChecked) {
  // an adjoint of more parameters has no one-sided derivatives, so the step with the tie is left, and its objective
  auto document = unloaded_adjoint();
  const json first = document["parameters"].begin().value();
  for (int k = 0; k < most_sided_parameters; ++k) document["parameters"]["z" + std::to_string(k)] = first;
  const auto check = check_of(document, gradcheck_methods.back());
  EXPECT_EQ(check.entries.front().verdict, Verdict::not_checked);
  EXPECT_EQ(check.entries.front().unchecked, 1);
  EXPECT_FALSE(check.passed());
}

}  // namespace
}  // namespace stickslip::gradcheck
