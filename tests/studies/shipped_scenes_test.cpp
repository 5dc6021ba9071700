/// Every shipped scene by every method: converged, without error where the method has none, its derivatives those of
/// differences and of the complex step, and what its comments claim.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/model/response.hpp"
#include "sensitivity/gradcheck.hpp"
#include "studies/sweep/study.hpp"
#include "studies/sweep/study_reader.hpp"
#include "tests/studies/cases.hpp"
#include "tests/support/largest.hpp"
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
    if (entry.path().extension() != ".json") continue;
    const std::string stem = entry.path().stem().string();
    const bool study = stem.ends_with(".study");
    if (study == studies && (studies || is_large(stem) == large)) found.push_back(stem);
  }
  std::sort(found.begin(), found.end());
  return found;
}

json scene(const std::string& name) { return cases::load(folder / (name + ".json")); }

/// Condensed here, sparse in the oracle: the two engines hold each other.
CaseResult run(json document, const json& method, const std::string& name) {
  document["linear_solver"]["engine"] = "condensed";
  auto result = cases::run(std::move(document), method, folder / (name + ".json"));
  EXPECT_EQ(result.trajectory.engine.rfind("condensed", 0), 0u) << name << ": " << result.trajectory.engine;
  return result;
}
CaseResult run(const std::string& name, const json& method) { return run(scene(name), method, name); }

const json monolithic = {{"monolithic_al", json::object()}};

/// The three methods from `auto`, Uzawa with each of its exact schemes.
std::vector<json> methods() {
  return {{{"penalty", json::object()}},
          {{"uzawa_al", {{"tolerance", 1e-12}, {"max_augmentations", 2000}}}},
          {{"uzawa_al", {{"sensitivity", "truncated"}, {"tolerance", 1e-12}, {"max_augmentations", 2000}}}},
          monolithic};
}

/// A penalty leaves an error of its own.
bool is_exact(const json& method) { return !method.contains("penalty"); }

/// Holds the derivatives of a result against the complex step of the whole program, for parameters [first, last).
void expect_oracle(const CaseResult& result, const std::string& what, int first, int last) {
  const Model& model = result.problem->model;
  const auto& increments = result.trajectory.increments;
  Matrix<double> responses(model.scene.responses.size(), increments.size());
  for (std::size_t n = 0; n < increments.size(); ++n)
    responses.col(n) = evaluate_responses(model, result.problem->slots, increments[n].state, increments[n].time);
  const double overall = largest_entry(responses);
  // oracle and scheme round differently, by 50 u cond
  const double rounding = std::max(1e-10, 50 * 1.1e-16 * result.condition_estimate);
  for (int j = first; j < last; ++j) {
    const auto& parameter = model.scene.parameters[j];
    const Matrix<double> exact = oracle::complex_step(model, result.method, result.trajectory.step_table(), j);
    ASSERT_EQ(exact.cols(), static_cast<Eigen::Index>(result.gradients.of.size())) << what;
    for (Eigen::Index i = 0; i < exact.rows(); ++i) {
      double scale = largest_entry(exact.row(i));
      const double size = largest_entry(responses.row(i));
      if (parameter.value != 0) scale = larger(scale, (size > 0 ? size : overall) / std::abs(parameter.value));
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

TEST(Headline, MonolithicTakesAsManyIterationsAtEveryScale) {  // README
  json document = scene("cattaneo_mindlin");
  document.erase("parameters");
  int iterations = 0;
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const auto result = run(document, {{"monolithic_al", {{"scale", scale}}}}, "cattaneo_mindlin");
    ASSERT_TRUE(is_converged(result.status())) << scale << ": " << result.message();
    EXPECT_EQ(result.trajectory.counters.cutbacks, 0) << scale;
    if (iterations == 0) iterations = result.trajectory.counters.newton;
    // where rounding, which grows with the scale, is above the tolerance, each of the 10 steps takes two more to see it
    EXPECT_NEAR(result.trajectory.counters.newton, iterations, 20) << scale;
  }
}

/// The headline's kind of scene at a size for the complex step in every run: two half disks, pressed and then sheared.
json half_disks(double friction) {
  json document = json::parse(R"({
    "bodies": {
      "upper": {"mesh": {"half_disk": {"center": [0, 1], "radius": 1, "cells": [9, 9], "grade": 8}},
                "material": {"linear_elastic": {"E": 200, "nu": 0.3}}},
      "lower": {"mesh": {"half_disk": {"center": [0, -1.3], "radius": 1.3, "cells": [10, 9], "grade": 8,
                                       "facing": "up"}},
                "material": {"linear_elastic": {"E": 300, "nu": 0.25}}}
    },
    "contacts": {"touch": {"slave": "upper.arc", "master": "lower.arc"}},
    "supports": [
      {"on": "lower.flat", "move": {"x": 0, "y": 0}},
      {"on": "upper.flat", "move": {"x": [[0, 0], [1, 0], [2, 0.02]], "y": [[0, 0], [1, -0.09]]}}
    ],
    "time": {"legs": [[1, 3], [2, 4]]},
    "responses": {
      "press": {"contact_force": {"contact": "touch", "component": "normal"}},
      "pull": {"reaction": {"on": "upper.flat", "component": "x"}},
      "width": {"contact_half_width": {"contact": "touch"}},
      "heat": {"dissipation": {"contact": "touch"}}
    },
    "parameters": {
      "mu": "/contacts/touch/friction",
      "E": "/bodies/upper/material/linear_elastic/E",
      "radius": "/bodies/lower/mesh/half_disk/radius",
      "down": {"/supports/1/move/y/1/1": -1},
      "sideways": "/supports/1/move/x/2/1"
    }
  })");
  document["contacts"]["touch"]["friction"] = friction;
  return document;
}

TEST(ShippedHalfDisks, ConvergeWithDerivativesThatDifferencesAndComplexStepConfirm) {
  for (double friction : {0.15, 0.35})
    for (const auto& method : methods()) {
      const std::string what = "friction " + std::to_string(friction) + " " + method.dump();
      const auto result = run(half_disks(friction), method, "half_disks");
      expect_sound(result, method, what);
      const auto& states = result.steps.back().increment->state.contact.state;
      for (ContactState state : {ContactState::open, ContactState::stick, ContactState::slip})
        EXPECT_GE(std::count(states.begin(), states.end(), state), 2) << what;  // partial slip, or it shows little
      expect_oracle(result, what, 0, static_cast<int>(result.problem->model.scene.parameters.size()));
      expect_differences(result, what);
    }
}

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

TEST_P(ShippedStudy, IsReadWithoutFaultAndNamesWhatIsThere) {
  Diagnostics diagnostics;
  const auto study = read_study((folder / (GetParam() + ".json")).string(), diagnostics);
  ASSERT_TRUE(study.has_value()) << diagnostics.text();
  MeshFiles meshes;
  EXPECT_FALSE(expand(*study, "1.0", diagnostics, meshes).empty()) << diagnostics.text();
  // the reader checks the names in references; a pattern of an error that nothing has would just be left out
  std::vector<std::string> errors = {"kkt"};
  const json& root = study->scene.root();
  const json parameters = root.value("parameters", json::object());
  for (const auto& [response, unused] : root.at("responses").items()) {
    errors.push_back("response:" + response);
    for (const auto& [parameter, unused_too] : parameters.items())
      errors.push_back("sensitivity:" + response + "/" + parameter);
  }
  for (const auto& pattern : study->errors)
    EXPECT_TRUE(pattern.starts_with("field:") ||
                std::any_of(errors.begin(), errors.end(), [&](auto& error) { return asked_for(error, {pattern}); }))
        << pattern;
}

INSTANTIATE_TEST_SUITE_P(All, ShippedStudy, testing::ValuesIn(names(true, false)), identifier);

/// Responses and derivatives of a run by name, at a time or at the end.
struct Values {
  CaseResult result;
  explicit Values(CaseResult r) : result(std::move(r)) {}
  explicit Values(const std::string& name) : Values(run(name, monolithic)) {}
  const StepResult& step(double time) const {
    const auto& all = result.steps;
    const auto at = [&](const StepResult& s) { return std::abs(s.increment->time - time) <= 1e-9 * time; };
    return time < 0 ? all.back() : *std::find_if(all.begin(), all.end(), at);
  }
  template <class Named>
  static int index(const std::vector<Named>& all, const std::string& name) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const Named& named) { return named.name == name; });
    return static_cast<int>(found - all.begin());
  }
  double value(const std::string& response, double time = -1) const {
    return step(time).responses[index(result.problem->model.scene.responses, response)];
  }
  double derivative(const std::string& response, const std::string& parameter, double time = -1) const {
    const Scene& scene = result.problem->model.scene;
    return step(time).sensitivities(index(scene.responses, response), index(scene.parameters, parameter));
  }
};

// What the comments of the scenes state. 1e-10 of the size of a quantity is rounding with the condition of these few
// unknowns; for derivatives the size is at least response / parameter.

TEST(ShippedComments, StopHoldsTheMassAndPassesTheRestToTheWall) {
  for (const std::string name : {"stop", "stop_bars"}) {
    const Values s(name);
    const std::string k = name == "stop" ? "k" : "E";
    EXPECT_NEAR(s.value("u"), 0.01, 0.01 * 1e-10);
    EXPECT_NEAR(s.value("press"), 5, 5 * 1e-10);
    EXPECT_NEAR(s.derivative("press", "F"), 1, 1e-10);
    EXPECT_NEAR(s.derivative("press", "g0"), -1000, 1000 * 1e-10);
    EXPECT_NEAR(s.derivative("press", k), -0.01, 0.01 * 1e-10);
    EXPECT_NEAR(s.derivative("u", "g0"), 1, 1e-10);
    EXPECT_NEAR(s.derivative("u", "F"), 0, 0.01 / 15 * 1e-10);
    EXPECT_NEAR(s.derivative("u", k), 0, 0.01 / 1000 * 1e-10);
  }
}

TEST(ShippedComments, StopGivesWayUnderAPenalty) {
  const double F = 15, k = 1000, g0 = 0.01, eps = 24000;
  const Values s(run("stop", {{"penalty", {{"stiffness", {{"absolute", eps}}}}}}));
  const double u = (F + eps * g0) / (k + eps);
  EXPECT_NEAR(s.value("u"), u, u * 1e-10);
  EXPECT_NEAR(s.value("u") - g0, 5 / (k + eps), u * 1e-10);
  EXPECT_NEAR(s.derivative("u", "F"), 1 / (k + eps), u / F * 1e-10);
  EXPECT_NEAR(s.derivative("u", "k"), -u / (k + eps), u / k * 1e-10);
  EXPECT_NEAR(s.derivative("u", "g0"), eps / (k + eps), 1e-10);
}

TEST(ShippedComments, StopIsReachedGeometricallyByUzawa) {
  const double k = 1000, g0 = 0.01, rho = 2500, theta = k / (k + rho);
  for (int i = 1; i <= 6; ++i) {
    const Values s(run("stop", {{"uzawa_al",
                                 {{"scale", {{"absolute", rho}}},
                                  {"adapt", false},
                                  {"tolerance", 1e-14},
                                  {"max_augmentations", i},
                                  {"sensitivity", "truncated"}}}}));
    const double left = std::pow(theta, i), left_by_k = i * left * (1 / k - 1 / (k + rho));
    EXPECT_NEAR(s.value("press"), 5 * (1 - left), 5 * 1e-10) << i;
    EXPECT_NEAR(s.derivative("press", "F"), 1 - left, 1e-10) << i;
    EXPECT_NEAR(s.derivative("press", "k"), -g0 * (1 - left) - 5 * left_by_k, 0.01 * 1e-10) << i;
  }
}

TEST(ShippedComments, SliderRemembersItsPathAtEachTurningPoint) {
  const Values s("slider");
  const double mu = 0.3, N = 10, k = 100, U0 = 0.1, lag = mu * N / k;
  for (int leg = 1; leg <= 3; ++leg) {
    const double sign = leg % 2 ? 1 : -1, ways = 2 * leg - 1;  // the first leg is half a way
    EXPECT_NEAR(s.value("u", leg), sign * 0.07, 0.07 * 1e-10);
    EXPECT_NEAR(s.value("press", leg), 10, 10 * 1e-10);
    EXPECT_NEAR(s.value("heat", leg), 0.21 + 0.42 * (leg - 1), 1e-10);
    EXPECT_NEAR(s.derivative("u", "mu", leg), -sign * N / k, N / k * 1e-10);
    EXPECT_NEAR(s.derivative("u", "N", leg), -sign * mu / k, 0.07 / N * 1e-10);
    EXPECT_NEAR(s.derivative("u", "k", leg), sign * lag / k, 0.07 / k * 1e-10);
    EXPECT_NEAR(s.derivative("u", "U0", leg), sign, 1e-10);
    EXPECT_NEAR(s.derivative("heat", "mu", leg), ways * N * (U0 - 2 * lag), ways * 1e-10);
    EXPECT_NEAR(s.derivative("heat", "N", leg), ways * mu * (U0 - 2 * lag), ways * 0.021 * 1e-10);
    EXPECT_NEAR(s.derivative("heat", "k", leg), ways * lag * lag, ways * 0.0021 * 1e-10);
    EXPECT_NEAR(s.derivative("heat", "U0", leg), ways * mu * N, ways * 3 * 1e-10);
  }
}

TEST(ShippedComments, SliderSinksUnderAPenalty) {
  const double k = 100, eps = 7000;
  const Values s(run("slider", {{"penalty", {{"stiffness", {{"absolute", eps}}}}}}));
  EXPECT_NEAR(s.value("press"), 10 * eps / (k + eps), 10 * 1e-10);
}

TEST(ShippedComments, BeltPullsByTheFactorOfItsPolygon) {
  const double pi = std::acos(-1.0), mu = 0.3;
  const std::pair<int, double> printed[] = {{8, 2.601050}, {16, 2.574854}, {32, 2.568453}};
  double before = 0;
  for (const auto& [n, digits] : printed) {
    json document = scene("belt");
    auto& arc = document["bodies"]["belt"]["mesh"]["arc"];
    arc["cells"] = n + 1;
    arc["from_angle"] = -90.0 / n;
    arc["to_angle"] = 180 + 90.0 / n;
    const Values s(run(document, monolithic, "belt"));
    const double t = std::tan(pi / (2 * n)), ratio = std::pow((1 + mu * t) / (1 - mu * t), n);
    const double slope = ratio * 2 * n * t / (1 - mu * mu * t * t);
    EXPECT_NEAR(ratio, digits, 0.5e-6);  // as printed
    // the bars are a hundred times as stiff as the pull that stretches them: condition 1e5 or so
    EXPECT_NEAR(s.value("tight"), -ratio, 1e-8 * ratio);
    EXPECT_NEAR(s.derivative("tight", "mu"), -slope, 1e-8 * slope);
    EXPECT_NEAR(s.derivative("tight", "T1"), -ratio, 1e-8 * ratio);
    EXPECT_NEAR(s.derivative("tight", "E"), 0, 1e-8 * ratio / 1e4);
    const double off = ratio - std::exp(mu * pi);
    if (before > 0) {
      EXPECT_NEAR(before / off, 4, 0.1);  // tan x - x: second order in 1/n
    }
    before = off;
  }
  EXPECT_NEAR(std::exp(mu * pi), 2.566332, 0.5e-6);
}

TEST(ShippedComments, TractrixIsFollowedToFirstOrderOfItsSteps) {
  // the leash at the angle phi to x: d phi / ds = -sin phi, from sin phi = 0.6 at s = 0.8
  const double phi = 2 * std::atan(std::exp(-2.2) / 3), x = 3 - std::cos(phi), y = std::sin(phi);
  EXPECT_NEAR(x, 2.0027, 0.5e-4);
  EXPECT_NEAR(y, 0.0738, 0.5e-4);
  EXPECT_NEAR(std::log(0.6 / y), 2.0960, 0.5e-4);
  double before = 0;
  for (int steps : {310, 620}) {
    json document = scene("tractrix");
    document["time"]["steps"] = steps;
    const Values s(run(document, monolithic, "tractrix"));
    const double off = std::hypot(s.value("x") - x, s.value("y") + 0.6 - y);
    if (before > 0) {
      EXPECT_NEAR(before / off, 2, 0.05);  // the second order is 1/310 times a few
    } else {
      EXPECT_NEAR(off, 7.5e-4, 0.05e-4);                  // to the digits of the comment
      EXPECT_NEAR(s.value("heat") / 100, 2.0960, 10e-4);  // slip, first order too
    }
    before = off;
    for (const auto& step : s.result.steps) {
      const double time = step.increment->time, moved = std::abs(s.value("x", time));
      if (time < 0.8) {
        EXPECT_LE(moved, 1e-12) << time;  // sticks: rounding of lengths of 1
      } else if (time > 0.8 + 3.0 / steps) {
        EXPECT_GT(moved, 0) << time;
      }
    }
  }
}

TEST(ShippedComments, PlateMovesAsPublished) {
  const Values s("greco_plate");
  const double published[] = {2.86, 2.72, 2.28, 1.98, 1.54};
  for (int i = 0; i < 5; ++i)  // one unit of the last digit: the published mesh is another one
    EXPECT_NEAR(s.value("u" + std::to_string(i + 1)) * 100, published[i], 0.01) << i;
}

TEST(ShippedComments, CylindersTouchAsHertzAndSlipAsCattaneoAndMindlinSay) {
  const Values s("cattaneo_mindlin");
  const double pi = std::acos(-1.0), P = s.value("press"), Q = std::abs(s.value("pull"));
  // the comment's round numbers are those of half planes; on disks of 12 b the same motion gives 0.2 % and 1.7 % more
  EXPECT_NEAR(P, 10, 0.003 * 10);
  EXPECT_NEAR(Q, 0.94, 0.02 * 0.94);
  const auto b_of = [&](double p) { return std::sqrt(4 * p * 4 / (pi * 200 / (2 * (1 - 0.3 * 0.3)))); };
  EXPECT_NEAR(b_of(10), 0.681, 0.5e-3);
  EXPECT_NEAR(2 * 10 / (pi * b_of(10)), 9.35, 0.5e-2);
  EXPECT_NEAR(b_of(10) * std::sqrt(1 - 0.94 / (0.2 * 10)), 0.5, 0.5e-1);
  const double b = b_of(P), p0 = 2 * P / (pi * b), c = b * std::sqrt(1 - Q / (0.2 * P));
  EXPECT_NEAR(s.value("width"), b, 0.003 * b);   // 21 elements a half width: 0.2 %
  EXPECT_NEAR(s.value("peak"), p0, 0.005 * p0);  // the same: 0.3 %
  const Problem& problem = *s.result.problem;
  const auto& states = s.result.steps.back().increment->state.contact.state;
  double stick = 0, closed = 0;
  for (std::size_t p = 0; p < states.size(); ++p) {
    const double at = std::abs(problem.slots.points(0, problem.model.points[p].nodes[0]));
    if (states[p] != ContactState::open) closed = larger(closed, at);
    if (states[p] == ContactState::stick) stick = larger(stick, at);
  }
  EXPECT_NEAR(closed, b, b / 21);  // an element
  EXPECT_NEAR(stick, c, b / 21);
}

}  // namespace
}  // namespace stickslip
