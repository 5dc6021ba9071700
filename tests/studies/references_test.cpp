/// The program against an independent one: tests/references (Python; Lemke pivoting or sweeps to find the states, one
/// direct solve of those, every inequality verified, derivatives by complex step; at finite strain
/// finite_reference.py).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "studies/run/fields.hpp"
#include "tests/studies/cases.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

const fs::path reference_folder = fs::path(STICKSLIP_SOURCE_DIR) / "tests" / "references";

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

double largest_of(const json& numbers) {
  double largest = 0;
  for (const auto& x : numbers.flatten()) largest = larger(largest, std::abs(x.get<double>()));
  return largest;
}

/// Holds place, area, state, force on the slave, gap and slip of the step of every point of a contact against
/// those of the file.
/// `before`: state of the last step.
void compare_contact(const Problem& problem, const State<double>& before, const State<double>& state,
                     const std::string& name, const json& expected, const std::string& what) {
  const auto& [model, slots, unused] = problem;
  const int D = model.dimension, contact = model.contact_index(name);
  const double force = largest_of(expected.at("force")), size = largest_of(expected.at("x"));
  const double length = std::max(largest_nodal_norm(state.displacement, D), largest_of(expected.at("gap")));
  const auto vector = [&](const char* key, std::size_t i) {
    const auto x = expected.at(key).at(i).get<std::vector<double>>();
    return Vector<double>(Eigen::Map<const Vector<double>>(x.data(), static_cast<Eigen::Index>(x.size())));
  };
  std::size_t i = 0;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    if (point.contact != contact) continue;
    ASSERT_LT(i, expected.at("state").size()) << what;
    const std::string where = what + " point " + std::to_string(i);
    const auto& geometry = slots.geometry[p];
    EXPECT_LE((slots.points.col(point.nodes[0]) - vector("x", i)).norm(), same_solution * size) << where;
    EXPECT_NEAR(geometry.area, expected["area"][i].get<double>(), same_solution * geometry.area) << where;
    static const char* const names[] = {"open", "stick", "slip"};
    EXPECT_EQ(names[static_cast<int>(state.contact.state[p])], expected["state"][i].get<std::string>()) << where;
    EXPECT_LE((geometry.area * traction_vector(problem, state, p) - vector("force", i)).norm(), same_solution * force)
        << where;
    EXPECT_NEAR(state.contact.gap[p], expected["gap"][i].get<double>(), same_solution * length) << where;
    const Vector<double> placed = state.history.placement - before.history.placement;
    const Vector<double> slip = geometry_in(state.contact, slots, p).tangents.leftCols(point.tangents) *
                                placed.segment(tangential_offset(model, p), point.tangents);
    EXPECT_LE((slip - vector("slip", i)).norm(), same_solution * length) << where;
    ++i;
  }
  EXPECT_EQ(i, expected.at("state").size()) << what;
}

/// Holds responses, derivatives and contacts of every step against a solution of the reference file.
void compare(const CaseResult& result, const json& solution, const std::string& what) {
  const auto& scene = result.problem->model.scene;
  ASSERT_TRUE(is_converged(result.status())) << what << ": " << result.message();
  const auto& steps = solution["steps"];
  ASSERT_EQ(result.steps.size(), steps.size()) << what;
  double largest = 0;  // stands in for the size of a response that is zero throughout
  for (const auto& step : steps)
    for (const auto& response : step["responses"]) largest = larger(largest, std::abs(response.get<double>()));
  for (std::size_t i = 0; i < scene.responses.size(); ++i) {
    const auto& name = scene.responses[i].name;
    double size = 0;
    for (const auto& step : steps) size = larger(size, std::abs(step["responses"].at(name).get<double>()));
    if (size == 0) size = largest;
    for (std::size_t n = 0; n < steps.size(); ++n) {
      EXPECT_NEAR(result.steps[n].responses[i], steps[n]["responses"].at(name).get<double>(), same_solution * size)
          << what << " step " << n << " " << name;
      for (std::size_t j = 0; j < scene.parameters.size(); ++j) {
        const auto& parameter = scene.parameters[j];
        double scale = parameter.value != 0 ? size / std::abs(parameter.value) : 0;
        const auto exact = [&](const json& step) {
          return step.at("sensitivities").at(name).at(parameter.name).get<double>();
        };
        for (const auto& step : steps) scale = larger(scale, std::abs(exact(step)));
        EXPECT_NEAR(result.steps[n].sensitivities(i, j), exact(steps[n]), same_derivative * scale)
            << what << " step " << n << " " << name << "/" << parameter.name;
      }
    }
  }
  EXPECT_TRUE(steps.back().contains("contacts")) << what;
  const State<double>* before = &result.trajectory.initial;
  for (std::size_t n = 0; n < steps.size(); before = &result.steps[n++].increment->state) {
    const json contacts = steps[n].value("contacts", json::object());
    for (const auto& [name, expected] : contacts.items())
      compare_contact(*result.problem, *before, result.steps[n].increment->state, name, expected,
                      what + " step " + std::to_string(n) + " " + name);
  }
}

class Reference : public testing::TestWithParam<std::string> {};

TEST_P(Reference, AgreesWithEveryMethod) {
  std::ifstream file(reference_folder / (GetParam() + ".json"));
  const json reference = json::parse(file);
  const auto& solutions = reference["solutions"];
  for (const json& scale : cases::scales_of(reference["scene"]))
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
  for (const auto& entry : fs::directory_iterator(reference_folder))
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
