/// Bodies at finite strain under loads of 1e-2 to 1e-9 of their modulus, at the origin and far from it: gaps and slips
/// are differences of displacements, so that neither the load nor the place decides how many digits forces have.
#include <gtest/gtest.h>

#include <cmath>

#include "studies/run/accuracy.hpp"
#include "tests/studies/cases.hpp"

namespace stickslip::light_loads {
namespace {

using nlohmann::json;

constexpr double E = 1000;
const double loads[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9};
const double distances[] = {0, 1, 1e2, 1e4, 1e6};
const json methods[] = {
    {{"penalty", json::object()}}, {{"uzawa_al", json::object()}}, {{"monolithic_al", json::object()}}};
constexpr double friction = 0.3;

json box(double x0, double y0, double x1, double y1, int nx, int ny) {
  return {{"box", {{"min", {x0, y0}}, {"max", {x1, y1}}, {"cells", {nx, ny}}}}};
}

/// A block of 2 x 1 on something that is flat at its foot: an obstacle, or a slab as "facets", "segments" or smoothed.
/// `slides`: with friction that bears a force of a fifth of the load, and nothing else holds the block; without, its
/// left side is held.
json scene_of(const std::string& floor, double L, double load, bool slides) {
  const json rubber = {{"neo_hookean", {{"E", E}, {"nu", 0.3}}}};
  json s = {{"space", "plane_strain"},
            {"strain", "finite"},
            {"bodies", {{"block", {{"mesh", box(L, L, L + 2, L + 1, 4, 1)}, {"material", rubber}}}}},
            {"contacts", {{"sole", {{"slave", "block.bottom"}, {"master", "floor"}}}}},
            {"supports", json::array()},
            {"loads", {{{"on", "block.top"}, {"traction", {slides ? 0.2 * load * E : 0, -load * E}}}}},
            {"time", {{"end", 1}, {"steps", 1}}}};
  for (const char* component : {"x", "y"})
    s["responses"][component] = {{"contact_force", {{"contact", "sole"}, {"component", component}}}};
  s["responses"]["sunk"] = {{"displacement", {{"on", "block.top"}, {"component", "y"}}}};
  json& contact = s["contacts"]["sole"];
  if (slides)
    contact["friction"] = friction;
  else
    s["supports"].push_back({{"on", "block.left"}, {"move", {{"x", 0}}}});
  if (floor == "plane") {
    s["obstacles"]["floor"]["plane"] = {{"point", {L, L}}, {"normal", {0, 1}}};
  } else if (floor == "circle") {  // (it would tip)
    s["obstacles"]["floor"]["circle"] = {{"center", {L + 1, L - 8}}, {"radius", 8}};
    s["supports"].push_back({{"on", "block.top"}, {"move", {{"x", 0}}}});
    s["loads"] = json::array({{{"on", "block"}, {"body_force", {0, -load * E}}}});
  } else if (floor == "polyline") {
    s["obstacles"]["floor"]["polyline"]["points"] = {{L - 3, L}, {L + 1.25, L}, {L + 5, L}};
  } else {
    s["bodies"]["slab"] = {{"mesh", box(L - 1, L - 1, L + 3, L, 3, 1)}, {"material", rubber}};
    s["supports"].push_back({{"on", "slab.bottom"}, {"move", {{"x", 0}, {"y", 0}}}});
    contact["master"] = "slab.top";
    if (floor == "segments") contact["discretization"] = "segment";
    if (floor == "catmull_rom" || floor == "b_spline") contact["surface"]["smooth"] = floor;
  }
  return s;
}

/// Largest relative difference of forces and displacements that rounding of the coordinates explains: the elements of
/// the facets' length h have sides of L u / h where coordinates are rounded to L u. Those here are not, but their shape
/// functions round what they are multiplied by.
double digits_of_coordinates(double L) { return 16 * unit_roundoff * (L + 2) / 0.5; }

class LightLoads : public testing::TestWithParam<std::tuple<const char*, bool>> {};

TEST_P(LightLoads, HaveTheDigitsOfHeavyOnesWhereverTheyAre) {
  const auto [floor, slides] = GetParam();
  for (const json& method : methods)
    for (const double load : loads) {
      Vector<double> at_origin;
      for (const double L : distances) {
        const std::string where =
            method.begin().key() + ", load " + std::to_string(std::log10(load)) + ", at " + std::to_string(L);
        auto result = cases::run(scene_of(floor, L, load, slides), method, "light.json");
        check_accuracy(result.problem->model, result.problem->slots, result.method, result.trajectory);
        ASSERT_EQ(result.trajectory.status, Status::converged) << where << ": " << result.trajectory.message;
        const Vector<double>& found = result.steps.back().responses;
        const double sunk = found[0], x = found[1], y = found[2];  // (a document sorts them by name)
        // the block is in equilibrium to Newton's tolerance, 1e-10 of a nodal force
        const double weight = 2 * load * E, most = 1e-9;
        EXPECT_NEAR(y, weight, most * weight) << where;
        const bool known = slides && std::string(floor) != "circle";
        if (known) {
          EXPECT_NEAR(x, -0.2 * weight, most * weight) << where;
        }
        if (at_origin.size() == 0) at_origin = found;
        const double same = std::max(most, digits_of_coordinates(L));
        EXPECT_NEAR(sunk, at_origin[0], same * std::abs(at_origin[0])) << where;
        EXPECT_NEAR(x, at_origin[1], same * weight) << where;
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Floors, LightLoads,
                         testing::Combine(testing::Values("plane", "circle", "polyline", "facets", "catmull_rom",
                                                          "b_spline", "segments"),
                                          testing::Bool()),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param)) +
                                  (std::get<1>(info.param) ? "_with_friction" : "");
                         });

/// A ring in a ring whose inner side is one of quadratic elements, which bulge by 0.015, with an overlap of 7e-5 and of
/// 7e-7: the gap is a difference of bulges, and its rounding, not the overlap, says when Newton's method is done.
TEST(CurvedSides, ThatOverlapByLittleAreSolvedToTheRoundingOfTheirBulges) {
  const auto ring = [](double inner, double outer, int around) -> json {
    return {{"ring", {{"center", {0, 0}}, {"inner", inner}, {"outer", outer}, {"cells", {3, around}}}}};
  };
  const json rubber = {{"neo_hookean", {{"E", E}, {"nu", 0.3}}}};
  for (const double overlap : {7e-5, 7e-7}) {
    const double touching = 1.7056022614136969;  // where the means of the gaps of 27 straight sides and 24 curved are 0
    const json s = {
        {"space", "plane_strain"},
        {"strain", "finite"},
        {"bodies",
         {{"a", {{"mesh", ring(0.76, 1.7133050301632236, 27)}, {"material", rubber}}},
          {"b", {{"mesh", ring(touching - overlap, 2.5, 24)}, {"material", rubber}, {"element", "T6"}}}}},
        {"contacts", {{"c", {{"slave", "a.outer"}, {"master", "b.inner"}, {"friction", 0.2}}}}},
        {"supports",
         {{{"on", "b.outer"}, {"move", {{"x", 0}, {"y", 0}}}}, {{"on", "a.inner"}, {"move", {{"x", 0}, {"y", 0}}}}}},
        {"time", {{"end", 1}, {"steps", 1}}},
        {"responses", {{"press", {{"contact_force", {{"contact", "c"}, {"component", "normal"}}}}}}}};
    std::vector<double> press;
    for (const json& method : methods) {
      auto result = cases::run(s, method, "rings.json");
      check_accuracy(result.problem->model, result.problem->slots, result.method, result.trajectory);
      ASSERT_TRUE(is_converged(result.trajectory.status)) << method << overlap << ": " << result.trajectory.message;
      EXPECT_LE(result.trajectory.counters.newton, 25) << method << overlap;
      press.push_back(result.steps.back().responses[0]);
    }
    EXPECT_GT(press[2], 0);
    // a few roundings of the bulges, of the overlap; the springs yield by 1e-3 of the rings
    const double rounding = 100 * unit_roundoff * 0.015 / overlap;
    EXPECT_NEAR(press[1], press[2], (1e-9 + rounding) * press[2]) << overlap;
    EXPECT_NEAR(press[0], press[2], 2e-3 * press[2]) << overlap;
  }
}

}  // namespace
}  // namespace stickslip::light_loads
