#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/studies/cases.hpp"

namespace stickslip::half_width {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A drum of radius 4 on a block of height 2, from x = `left` to 2; the drum comes down by `drop`.
json drum_on_block(double left, int cells, const json& supports, const json& about = nullptr, double drop = 0.02) {
  json scene = {{"bodies",
                 {{"b",
                   {{"mesh", {{"box", {{"min", {left, -2}}, {"max", {2, 0}}, {"cells", {cells, 10}}}}}},
                    {"material", {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}}}}}}},
                {"obstacles",
                 {{"o", {{"circle", {{"center", {0, 4}}, {"radius", 4}}}, {"move", {{"y", {{0, 0}, {1, -drop}}}}}}}}},
                {"contacts", {{"c", {{"slave", "b.top"}, {"master", "o"}}}}},
                {"supports", supports},
                {"time", {{"end", 1}, {"steps", 1}}},
                {"responses", {{"a", {{"contact_half_width", {{"contact", "c"}}}}}}},
                {"parameters", {{"drop", "/obstacles/o/move/y/1/1"}, {"radius", "/obstacles/o/circle/radius"}}}};
  if (!about.is_null()) scene["responses"]["a"]["contact_half_width"]["about"] = about;
  return scene;
}

const json clamped = {{"on", "b.bottom"}, {"move", {{"x", 0}, {"y", 0}}}},
           rolling = {{"on", "b.left"}, {"move", {{"x", 0}}}};
const json whole = json::array({clamped}), half = json::array({clamped, rolling});

CaseResult run(const json& scene, const char* method = "monolithic_al") {
  return cases::run(scene, {{method, json::object()}}, "scene.json");
}
double width(const json& scene) { return run(scene).steps.back().responses[0]; }

TEST(HalfWidth, OfAHalfModelIsThatOfTheWhole) {
  const double of_whole = width(drum_on_block(-2, 80, whole));
  EXPECT_GT(of_whole, 0.2);
  // the half model is the same mesh, of which x = 0 is held: to rounding
  EXPECT_NEAR(width(drum_on_block(0, 40, half)), of_whole, 1e-9 * of_whole);
}

TEST(HalfWidth, IsAboutThePointThatIsGiven) {
  const double of_whole = width(drum_on_block(-2, 80, whole));
  // along the tangent of the contact as a whole, which the half model tilts by a few hundredths: their square
  EXPECT_NEAR(width(drum_on_block(0, 40, half, {0, 0})), of_whole, 2e-3 * of_whole);
  EXPECT_NEAR(width(drum_on_block(-2, 80, whole, {0, 0})), of_whole, 1e-9 * of_whole);
  EXPECT_GT(width(drum_on_block(-2, 80, whole, {0.5, 0})), 1.0);  // 2 sqrt(0.5^2 + (a / 2)^2)
}

TEST(HalfWidth, OfAContactThatEndsAtNoPlaneIsFromItsMiddle) {
  // a wall at the left is no plane of symmetry of a contact that does not reach it
  const double of_whole = width(drum_on_block(-2, 80, whole));
  EXPECT_NEAR(width(drum_on_block(-2, 80, half)), of_whole, 0.05 * of_whole);  // it is stiffer on one side
}

TEST(HalfWidth, OfAHalfModelHasItsDerivatives) {
  for (const bool by_plane : {true, false}) {
    const json about = by_plane ? json() : json::array({0, 0});
    const auto scene = [&](double drop) { return drum_on_block(0, 40, half, about, drop); };
    const auto result = run(scene(0.02));
    const auto& d = result.steps.back().sensitivities;
    constexpr double h = 1e-6;
    const double difference = (width(scene(0.02 + h)) - width(scene(0.02 - h))) / (2 * h);
    EXPECT_NEAR(-d(0, 0), difference, 1e-6 * std::abs(difference));  // h^2 and rounding / h; drop is -y

    json adjoint = scene(0.02);
    adjoint["sensitivity"] = {{"mode", "adjoint"}};
    adjoint["objectives"] = {{"last", {{"of", "a"}, {"at", 1}}}};
    const auto backwards = run(adjoint);
    ASSERT_EQ(backwards.gradients.of_objectives.cols(), 2);
    for (int j = 0; j < 2; ++j)
      EXPECT_NEAR(backwards.gradients.of_objectives(0, j), d(0, j), 1e-9 * std::abs(d(0, j))) << j;
  }
}

TEST(HalfWidth, AroundAnAxisHasNoPoint) {
  json scene = drum_on_block(0, 40, json::array({clamped}), {0, 0});
  scene["space"] = "axisymmetric";
  try {
    run(scene);
    FAIL();
  } catch (const std::exception& error) {
    EXPECT_THAT(error.what(), HasSubstr("which is measured from the axis"));
  }
}

}  // namespace
}  // namespace stickslip::half_width
