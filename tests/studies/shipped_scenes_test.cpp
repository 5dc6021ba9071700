/// Every shipped scene by every method: converged, without error where the method has none, its derivatives those of
/// differences and of the complex step, and what its comments claim.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sensitivity/gradcheck.hpp"
#include "studies/study_reader.hpp"
#include "tests/support/cases.hpp"
#include "tests/support/oracle.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

const fs::path folder = fs::path(STICKSLIP_SOURCE_DIR) / "studies" / "scenes";

/// Too large for the complex step in a minute.
bool is_large(const std::string& name) { return name == "cattaneo_mindlin"; }

std::vector<std::string> names(bool studies, bool large) {
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string stem = entry.path().stem().string();
    const bool study = stem.ends_with(".study");
    if (study == studies && (studies || is_large(stem) == large)) found.push_back(stem);
  }
  std::sort(found.begin(), found.end());
  return found;
}

CaseResult run(const std::string& name, const json& method) {
  const fs::path file = folder / (name + ".json");
  return cases::run(cases::load(file), method, file);
}

/// The three methods from `auto`, Uzawa with each of its exact schemes.
std::vector<json> methods() {
  return {{{"penalty", json::object()}},
          {{"uzawa_al", {{"tolerance", 1e-12}, {"max_augmentations", 2000}}}},
          {{"uzawa_al", {{"sensitivity", "truncated"}}}},
          {{"monolithic_al", json::object()}}};
}

bool is_exact(const json& method) {
  return method.contains("monolithic_al") || method.value(json::json_pointer("/uzawa_al/tolerance"), 1.0) < 1e-11;
}

/// Holds the derivatives of a result against the complex step of the whole program, for parameters [first, last).
void expect_oracle(const CaseResult& result, const std::string& what, int first, int last) {
  const Model& model = result.problem->model;
  const auto& increments = result.trajectory.increments;
  Matrix<double> responses(model.scene.responses.size(), increments.size());
  for (std::size_t n = 0; n < increments.size(); ++n)
    responses.col(n) = evaluate_responses(model, result.problem->slots, increments[n].state, increments[n].time);
  const double overall = responses.cwiseAbs().maxCoeff();
  // oracle and scheme round differently, by 50 u cond
  const double rounding = std::max(1e-10, 50 * 1.1e-16 * result.condition_estimate);
  for (int j = first; j < last; ++j) {
    const auto& parameter = model.scene.parameters[j];
    const Matrix<double> exact = oracle::complex_step(model, result.method, result.trajectory.step_table(), j);
    ASSERT_EQ(exact.cols(), static_cast<Eigen::Index>(result.gradients.of.size())) << what;
    for (Eigen::Index i = 0; i < exact.rows(); ++i) {
      double scale = exact.row(i).cwiseAbs().maxCoeff();
      const double size = responses.row(i).cwiseAbs().maxCoeff();
      if (parameter.value != 0) scale = std::max(scale, (size > 0 ? size : overall) / std::abs(parameter.value));
      for (Eigen::Index n = 0; n < exact.cols(); ++n)
        EXPECT_NEAR(result.gradients.of[n](i, j), exact(i, n), rounding * scale)
            << what << " " << model.scene.responses[i].name << "/" << parameter.name << " increment " << n;
    }
  }
}

void expect_sound(const CaseResult& result, const json& method, const std::string& what) {
  ASSERT_TRUE(is_converged(result.status())) << what << ": " << result.message();
  if (!is_exact(method)) return;
  for (const auto& step : result.steps) EXPECT_LE(step.kkt.largest(), 1e-8) << what << " t = " << step.increment->time;
}

void expect_differences(const CaseResult& result, const std::string& what) {
  const auto check = check_gradients(result.problem->model, result.method, {});
  EXPECT_TRUE(check.passed()) << what;
  EXPECT_FALSE(check.entries.empty()) << what;
  for (const auto& entry : check.entries)
    EXPECT_EQ(entry.verdict, GradientCheck::Verdict::agrees)
        << what << " " << entry.response << "/" << entry.parameter << " t = " << entry.time << ": " << entry.computed
        << " against " << entry.difference << ", error " << entry.error << ", allowed " << entry.allowed;
}

class Shipped : public testing::TestWithParam<std::string> {};

TEST_P(Shipped, ConvergesWithDerivativesThatDifferencesAndComplexStepConfirm) {
  for (const auto& method : methods()) {
    const std::string what = GetParam() + " " + method.dump();
    const auto result = run(GetParam(), method);
    expect_sound(result, method, what);
    expect_oracle(result, what, 0, static_cast<int>(result.problem->model.scene.parameters.size()));
    expect_differences(result, what);
  }
}

std::string identifier(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, Shipped, testing::ValuesIn(names(false, false)), identifier);

class SlowShipped : public testing::TestWithParam<std::string> {};

TEST_P(SlowShipped, ConvergesWithDerivativesThatDifferencesAndComplexStepConfirm) {
  for (const auto& method : methods()) {
    const std::string what = GetParam() + " " + method.dump();
    const auto result = run(GetParam(), method);
    expect_sound(result, method, what);
    // one parameter by each method, all by one: the complex run takes minutes
    const int parameters = static_cast<int>(result.problem->model.scene.parameters.size());
    expect_oracle(result, what, 0, method.contains("monolithic_al") ? parameters : 1);
    expect_differences(result, what);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SlowShipped, testing::ValuesIn(names(false, true)), identifier);

class ShippedStudy : public testing::TestWithParam<std::string> {};

TEST_P(ShippedStudy, IsReadWithoutFault) {
  Diagnostics diagnostics;
  const auto study = read_study((folder / (GetParam() + ".json")).string(), diagnostics);
  EXPECT_TRUE(study.has_value()) << diagnostics.text();
}

INSTANTIATE_TEST_SUITE_P(All, ShippedStudy, testing::ValuesIn(names(true, false)), identifier);

/// A response, and its derivative, of a scene at its last step by the monolithic method.
struct Last {
  CaseResult result;
  explicit Last(const std::string& name) : result(run(name, {{"monolithic_al", json::object()}})) {}
  int row(const std::string& response) const {
    const auto& all = result.problem->model.scene.responses;
    return static_cast<int>(std::find_if(all.begin(), all.end(), [&](auto& r) { return r.name == response; }) -
                            all.begin());
  }
  double value(const std::string& response) const { return result.steps.back().responses[row(response)]; }
  double derivative(const std::string& response, const std::string& parameter) const {
    const auto& all = result.problem->model.scene.parameters;
    const auto j = std::find_if(all.begin(), all.end(), [&](auto& p) { return p.name == parameter; }) - all.begin();
    return result.steps.back().sensitivities(row(response), j);
  }
};

// Closed forms of the scenes' comments; 1e-10 is rounding with the condition of these few unknowns.

TEST(ShippedClosedForms, StopHoldsTheMassAndPassesTheRestToTheWall) {
  for (const char* name : {"stop", "stop_bars"}) {
    const Last s(name);
    EXPECT_NEAR(s.value("u"), 0.01, 1e-12);
    EXPECT_NEAR(s.value("press"), 5, 5e-10);
    EXPECT_NEAR(s.derivative("press", "F"), 1, 1e-10);
    EXPECT_NEAR(s.derivative("press", "g0"), -1000, 1e-7);
    EXPECT_NEAR(s.derivative("u", "g0"), 1, 1e-10);
    EXPECT_NEAR(s.derivative("u", "F"), 0, 1e-13);
  }
}

TEST(ShippedClosedForms, SliderComesBackWithTheHeatOfItsPath) {
  const Last s("slider");
  EXPECT_NEAR(s.value("u"), 0.07, 0.07 * 1e-10);
  EXPECT_NEAR(s.value("heat"), 0.21 + 0.84, 1e-10);
  EXPECT_NEAR(s.derivative("u", "mu"), -0.1, 0.1 * 1e-10);
  EXPECT_NEAR(s.derivative("u", "U0"), 1, 1e-10);
}

TEST(ShippedClosedForms, BeltPullsByTheFactorOfItsPolygon) {
  const Last s("belt");
  const double n = 8, mu = 0.3, t = std::tan(std::acos(-1.0) / (2 * n));
  const double ratio = std::pow((1 + mu * t) / (1 - mu * t), n), slope = ratio * 2 * n * t / (1 - mu * mu * t * t);
  EXPECT_NEAR(s.value("tight"), -ratio, 1e-8 * ratio);
  EXPECT_NEAR(s.derivative("tight", "mu"), -slope, 1e-8 * slope);
  EXPECT_NEAR(s.derivative("tight", "T1"), -ratio, 1e-8 * ratio);
}

TEST(ShippedClosedForms, TractrixEndsAsFarFromTheCurveAsItsStepsLeaveIt) {
  const Last s("tractrix");
  const double dx = s.value("x") - 2.0027245810, dy = s.value("y") + 0.6 - 0.0737681415;
  EXPECT_NEAR(std::hypot(dx, dy), 7.5e-4, 0.05e-4);  // first order in the step, to the digits of the comment
}

}  // namespace
}  // namespace stickslip
