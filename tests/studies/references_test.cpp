/// The program against an independent one: tests/references (Python; Lemke pivoting or sweeps to find the states, one
/// direct solve of those, every inequality verified, derivatives by complex step).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/cases.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

const fs::path folder = fs::path(STICKSLIP_SOURCE_DIR) / "tests" / "references";

/// Relative to the largest value of its kind in the run. Both programs solve to rounding; what is left is the
/// conditioning of the scenes (1e3 to 1e6 times 1e-16), more in a penalised one, and the tolerance 1e-12 of Newton's
/// method.
constexpr double same_solution = 1e-9;
constexpr double same_derivative = 1e-8;

CaseResult run_reference(json scene, const json& method) {
  for (auto& [name, body] : scene["bodies"].items())
    if (body["mesh"].contains("gmsh"))
      body["mesh"]["gmsh"] = fs::path(STICKSLIP_SOURCE_DIR) / "studies" / "meshes" /
                             fs::path(body["mesh"]["gmsh"].get<std::string>()).filename();
  return cases::run(std::move(scene), method, "reference.json");
}

/// Holds responses, derivatives and states of every step against a solution of the reference file.
void compare(const CaseResult& result, const json& solution, const std::string& what) {
  const auto& scene = result.problem->model.scene;
  ASSERT_TRUE(is_converged(result.status())) << what << ": " << result.message();
  const auto& steps = solution["steps"];
  ASSERT_EQ(result.steps.size(), steps.size()) << what;
  double largest = 0;  // stands in for the size of a response that is zero throughout
  for (const auto& step : steps)
    for (const auto& response : step["responses"]) largest = std::max(largest, std::abs(response.get<double>()));
  for (std::size_t i = 0; i < scene.responses.size(); ++i) {
    const auto& name = scene.responses[i].name;
    double size = 0;
    for (const auto& step : steps)
      if (step["responses"].contains(name)) size = std::max(size, std::abs(step["responses"][name].get<double>()));
    if (size == 0) size = largest;
    for (std::size_t n = 0; n < steps.size(); ++n) {
      if (!steps[n]["responses"].contains(name)) continue;
      EXPECT_NEAR(result.steps[n].responses[i], steps[n]["responses"][name].get<double>(), same_solution * size)
          << what << " step " << n << " " << name;
      if (!steps[n].contains("sensitivities") || !steps[n]["sensitivities"].contains(name)) continue;
      for (std::size_t j = 0; j < scene.parameters.size(); ++j) {
        const auto& parameter = scene.parameters[j];
        double scale = parameter.value != 0 ? size / std::abs(parameter.value) : 0;
        for (const auto& step : steps)
          scale = std::max(scale, std::abs(step["sensitivities"][name].value(parameter.name, 0.0)));
        if (!steps[n]["sensitivities"][name].contains(parameter.name)) continue;
        EXPECT_NEAR(result.steps[n].sensitivities(i, j), steps[n]["sensitivities"][name][parameter.name].get<double>(),
                    same_derivative * scale)
            << what << " step " << n << " " << name << "/" << parameter.name;
      }
    }
  }
  for (std::size_t n = 0; n < steps.size(); ++n) {
    if (!steps[n].contains("contacts")) continue;
    for (const auto& [name, expected] : steps[n]["contacts"].items()) {
      const int contact = result.problem->model.contact_index(name);
      std::vector<double> pressure;
      const auto& model = result.problem->model;
      for (std::size_t p = 0; p < model.points.size(); ++p)
        if (model.points[p].contact == contact)
          pressure.push_back(result.steps[n].increment->state.contact.traction[model.points[p].multiplier]);
      ASSERT_EQ(pressure.size(), expected["normal"].size()) << what;
      double size = 0;
      for (const auto& t : expected["normal"]) size = std::max(size, std::abs(t.get<double>()));
      for (std::size_t p = 0; p < pressure.size(); ++p)
        EXPECT_NEAR(pressure[p], expected["normal"][p].get<double>(), same_solution * std::max(size, 1e-300))
            << what << " step " << n << " point " << p;
    }
  }
}

class Reference : public testing::TestWithParam<std::string> {};

TEST_P(Reference, AgreesWithEveryMethod) {
  std::ifstream file(folder / (GetParam() + ".json"));
  const json reference = json::parse(file);
  const auto& solutions = reference["solutions"];
  for (const json& scale : {json(1e-2), json("auto"), json(1e2)})
    compare(run_reference(reference["scene"], {{"monolithic_al", {{"scale", scale}}}}), solutions["exact"],
            GetParam() + " monolithic_al " + scale.dump());
  compare(run_reference(reference["scene"], {{"uzawa_al", {{"tolerance", 1e-12}, {"max_augmentations", 2000}}}}),
          solutions["exact"], GetParam() + " uzawa_al");
  if (solutions.contains("penalty"))
    compare(run_reference(reference["scene"], solutions["penalty"]["method"]), solutions["penalty"],
            GetParam() + " penalty");
}

std::vector<std::string> reference_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, Reference, testing::ValuesIn(reference_names()), [](const auto& info) {
  std::string name = info.param;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
  return name;
});

}  // namespace
}  // namespace stickslip
