/// Numbers whose squares under- or overflow: results are those of moderate numbers, by every method.
#include <gtest/gtest.h>

#include "tests/studies/cases.hpp"

namespace stickslip::extreme_numbers {
namespace {

using nlohmann::json;

/// A block, pressed on a floor and dragged along.
json block() {
  return {{"bodies",
           {{"b",
             {{"mesh", {{"box", {{"min", {0, 0}}, {"max", {1, 1}}, {"cells", {2, 2}}}}}},
              {"material", {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}}}}}}},
          {"obstacles", {{"floor", {{"plane", {{"point", {0, 0}}, {"normal", {0, 1}}}}}}}},
          {"contacts", {{"s", {{"slave", "b.bottom"}, {"master", "floor"}, {"friction", 0.3}}}}},
          {"supports", {{{"on", "b.top"}, {"move", {{"x", {{0, 0}, {1, 0.01}}}, {"y", {{0, 0}, {1, -0.01}}}}}}}},
          {"time", {{"end", 1}, {"steps", 2}}},
          {"responses",
           {{"N", {{"contact_force", {{"contact", "s"}, {"component", "normal"}}}}},
            {"T", {{"contact_force", {{"contact", "s"}, {"component", "x"}}}}}}}};
}

const std::vector<std::string> methods{"penalty", "uzawa_al", "monolithic_al"};

CaseResult run(const json& scene, const std::string& method) {
  auto result = cases::run(scene, {{method, json::object()}}, "block.json");
  EXPECT_TRUE(is_converged(result.status())) << method << ": " << result.message();
  return result;
}

/// Two runs of one problem: Uzawa's tolerance of 1e-10 is the larger of what is left.
constexpr double close = 1e-9;

void expect_same(const CaseResult& result, const CaseResult& moderate) {
  const auto &of = result.steps.back().responses, &expected = moderate.steps.back().responses;
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(of[i], expected[i], close * std::abs(expected[0]));
}

TEST(Friction, OfTheSmallestNumbersIsAsNone) {
  for (const char* strain : {"small", "finite"})
    for (const double mu : {1e-160, 1e-300}) {
      json scene = block();
      scene["strain"] = strain;
      if (strain == std::string("finite"))
        scene["bodies"]["b"]["material"] = {{"neo_hookean", {{"E", 1000}, {"nu", 0.3}}}};
      scene["contacts"]["s"]["friction"] = mu;
      for (const auto& method : methods) {
        const auto result = run(scene, method);
        const double N = result.steps.back().responses[0], T = result.steps.back().responses[1];
        EXPECT_NEAR(T / (mu * N), -1, close) << method << mu;
      }
    }
}

TEST(Normal, MayHaveAnyLengthButZero) {
  for (const auto& method : methods) {
    json scene = block();
    scene["obstacles"]["floor"]["plane"]["normal"] = {0.1, 1};
    const auto moderate = run(scene, method);
    for (const double length : {1e-300, 1e-160, 1e160, 1e300}) {
      scene["obstacles"]["floor"]["plane"]["normal"] = {0.1 * length, length};
      SCOPED_TRACE(length);
      expect_same(run(scene, method), moderate);
    }
  }
}

TEST(DirectionOfASupport, MayHaveAnyLengthButZero) {
  json scene = block();
  scene["supports"] = {{{"on", "b.top"}, {"along", {1, 2}}, {"value", {{0, 0}, {1, -0.01}}}},
                       {{"on", "b.left & b.top"}, {"along", {2, -1}}, {"value", 0}}};
  for (const auto& method : methods) {
    const auto moderate = run(scene, method);
    for (const double length : {1e-300, 1e300}) {
      json other = scene;
      other["supports"][0]["along"] = {length, 2 * length};
      other["supports"][1]["along"] = {2 * length, -length};
      SCOPED_TRACE(length);
      expect_same(run(other, method), moderate);
    }
  }
}

}  // namespace
}  // namespace stickslip::extreme_numbers
