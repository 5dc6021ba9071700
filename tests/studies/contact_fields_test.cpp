#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "studies/io/atomic_file.hpp"
#include "studies/run/fields.hpp"
#include "studies/run/run_files.hpp"
#include "tests/studies/cases.hpp"
#include "tests/studies/temporary_folder.hpp"
#include "tests/studies/vtu_reader.hpp"

namespace stickslip::contact_fields {
namespace {

using nlohmann::json;

struct Fields {
  CaseResult result;
  std::string file;
  explicit Fields(const json& scene) : result(cases::run(scene, {{"monolithic_al", json::object()}}, "scene.json")) {
    const TemporaryFolder own;
    write_fields(own.path, result, 0);
    file = read_file(own.path / ("fields_000" + std::to_string(result.steps.size()) + ".vtu"));
  }
  std::vector<double> array(const std::string& name) const { return vtu::array_named(file, name).values<double>(); }
};

json block(const json& corners, const json& cells) {
  return {{"mesh", {{"quad", {{"corners", corners}, {"cells", cells}}}}},
          {"material", {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}}}};
}

TEST(ContactFields, HaveTheGapOfOpenNodesAndNoNumberElsewhere) {
  json scene = {{"bodies", {{"b", block({{0, 0}, {1, 0.05}, {1, 1}, {0, 1}}, {2, 1})}}},
                {"obstacles", {{"floor", {{"plane", {{"point", {0, 0}}, {"normal", {0, 1}}}}}}}},
                {"contacts", {{"s", {{"slave", "b.bottom"}, {"master", "floor"}, {"friction", 0.3}}}}},
                {"supports", {{{"on", "b.top"}, {"move", {{"x", 0}, {"y", -0.01}}}}}},
                {"time", {{"end", 1}, {"steps", 1}}}};
  const Fields made(scene);
  const auto gap = made.array("gap"), u = made.array("displacement"), force = made.array("contact_force");
  const auto& points = made.result.problem->slots.points;
  double sum = 0, pressed = 0;
  for (int n = 0; n < points.cols(); ++n) {
    if (points(1, n) > 0.1) {
      EXPECT_TRUE(std::isnan(gap[n])) << n;
      EXPECT_EQ(force[3 * n + 1], 0);
      continue;
    }
    EXPECT_NEAR(gap[n], points(1, n) + u[3 * n + 1], 1e-15);  // above the floor
    sum += force[3 * n + 1];
    pressed += gap[n] < 1e-12;
  }
  EXPECT_EQ(pressed, 1);
  EXPECT_NEAR(sum, 3.9346853307, 1e-9);  // of the response contact_force
}

TEST(ContactFields, HaveTheForcesOnBothSidesAndNoGapWhereNothingIsFaced) {
  json scene = {{"strain", "finite"},
                {"bodies",
                 {{"low", block({{0, 0}, {2, 0}, {2, 1}, {0, 1}}, {3, 2})},
                  {"high", block({{1, 1}, {3, 1}, {3, 2}, {1, 2}}, {4, 2})}}},
                {"contacts", {{"c", {{"slave", "high.bottom"}, {"master", "low.top"}}}}},
                {"supports",
                 {{{"on", "low.bottom"}, {"move", {{"x", 0}, {"y", 0}}}},
                  {{"on", "high.top"}, {"move", {{"x", 0}, {"y", -0.05}}}}}},
                {"time", {{"end", 1}, {"steps", 2}}}};
  for (const char* name : {"low", "high"})
    scene["bodies"][name]["material"] = {{"neo_hookean", {{"E", 1000}, {"nu", 0.3}}}};
  const Fields made(scene);
  ASSERT_TRUE(is_converged(made.result.status())) << made.result.message();
  const auto gap = made.array("gap"), force = made.array("contact_force");
  const auto& model = made.result.problem->model;
  double on_low = 0, on_high = 0;
  for (int n = 0; n < model.node_count; ++n) (n < model.bodies[1].first_node ? on_high : on_low) += force[3 * n + 1];
  EXPECT_GT(on_high, 10);
  EXPECT_NEAR(on_low, -on_high, 1e-12 * on_high);
  for (int node : model.side("high.bottom").nodes)  // x = 2.5 and 3 are past the end of the master
    EXPECT_EQ(std::isnan(gap[node]), made.result.problem->slots.points(0, node) > 2.1) << node;
}

}  // namespace
}  // namespace stickslip::contact_fields
