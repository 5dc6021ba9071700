/// What a run leaves in result.json of Uzawa's iterations.
#include "studies/case.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/scenes.hpp"

namespace stickslip {
namespace {

nlohmann::json last_step(const Method& method) {
  const auto problem = std::make_shared<const Problem>(scenes::greco_plate(8));
  std::shared_ptr<Condensation<double>> condensation;
  return steps_json(run_case(problem, method, {}, condensation)).back();
}

TEST(Case, RecordsTheContractionAndWhatTheDerivativesTook) {
  UzawaAL method;
  method.scale = scenes::relative(0.3);
  method.adapt = false;
  method.max_augmentations = 1000;
  auto step = last_step(method);
  EXPECT_NEAR(step["contraction"], 0.8, 0.05);
  EXPECT_GT(step["sensitivity_scheme"]["passes"], 50);  // ln(1e-13) / ln(0.8) = 134
  EXPECT_EQ(step["sensitivity_scheme"]["oversize"], 1);
  EXPECT_NEAR(step["sensitivity_scheme"]["contraction"], 0.8, 0.05);

  method.sensitivity = UzawaAL::Sensitivity::preconditioned;
  step = last_step(method);
  EXPECT_LE(step["sensitivity_scheme"]["passes"], 6);
  EXPECT_GT(step["sensitivity_scheme"]["oversize"], 1e3);

  method.sensitivity = UzawaAL::Sensitivity::oversized;
  step = last_step(method);
  EXPECT_EQ(step["sensitivity_scheme"]["passes"], 1);
  EXPECT_EQ(step["sensitivity_scheme"]["oversize"], UzawaAL::automatic_oversize);
}

TEST(Case, OfAMethodWithoutIteratedDerivativesRecordsNothingOfThem) {
  for (const Method& method : {Method(Penalty{}), Method(MonolithicAL{})}) {
    const auto step = last_step(method);
    EXPECT_FALSE(step.contains("sensitivity_scheme")) << name_of(method);
    EXPECT_FALSE(step.contains("contraction")) << name_of(method);
  }
}

}  // namespace
}  // namespace stickslip
