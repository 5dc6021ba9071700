/// Contact of whole boundaries that a user names by hand is that of the faces that touch.
#include <gtest/gtest.h>

#include "tests/studies/cases.hpp"

namespace stickslip::whole_boundaries {
namespace {

using nlohmann::json;

/// Two blocks, one on the other, 1 wide from `left`, pressed together by 0.02.
json blocks(const char* space, double left, const std::string& slave, const std::string& master,
            const char* discretization) {
  const auto block = [&](double low) {
    return json{{"mesh", {{"box", {{"min", {left, low}}, {"max", {left + 1, low + 1}}, {"cells", {2, 2}}}}}},
                {"material", {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}}}};
  };
  return {{"space", space},
          {"bodies", {{"low", block(0)}, {"high", block(1)}}},
          {"contacts", {{"c", {{"slave", slave}, {"master", master}, {"discretization", discretization}}}}},
          {"supports",
           {{{"on", "low.bottom"}, {"move", {{"y", 0}}}},
            {{"on", "high.top"}, {"move", {{"y", -0.02}}}},
            {{"on", "low.bottom & low.left"}, {"move", {{"x", 0}}}},
            {{"on", "high.top & high.left"}, {"move", {{"x", 0}}}}}},
          {"responses", {{"F", {{"contact_force", {{"contact", "c"}, {"component", "normal"}}}}}}},
          {"time", {{"end", 1}, {"steps", 1}}}};
}

double force(const json& scene, const char* method) {
  const auto result = cases::run(scene, {{method, json::object()}}, "blocks.json");
  EXPECT_TRUE(is_converged(result.status())) << method << result.message();
  return result.steps.back().responses[0];
}

/// Corner lies on corner: of the two facets of the master's corner one opposes the slave, and it is that one's point.
TEST(WholeBoundaries, PressAsTheirFacesDo) {
  for (const char* discretization : {"node", "segment"})
    for (const auto& [space, left] : {std::pair{"plane_strain", 0.0}, {"plane_strain", -0.5}, {"axisymmetric", 0.0}})
      for (const auto& [slave, master] : {std::pair{"low", "high"}, {"high", "low"}})
        for (const char* method : {"penalty", "monolithic_al"}) {
          const auto face = [](const std::string& body) { return body + (body == "low" ? ".top" : ".bottom"); };
          const std::string a = slave, b = master;
          json scene = blocks(space, left, a + ".boundary", b + ".boundary", discretization);
          if (std::string(space) == "axisymmetric") {  // the axis holds them
            scene["supports"].erase(3);
            scene["supports"].erase(2);
          }
          json faces = scene;
          faces["contacts"]["c"]["slave"] = face(a);
          faces["contacts"]["c"]["master"] = face(b);
          const double whole = force(scene, method), of_faces = force(faces, method);
          EXPECT_NEAR(whole, of_faces, 1e-12 * of_faces) << space << left << a << discretization << method;
        }
}

/// A ring in a ring, whose nodes lie on one another: a pair of `between` presses as the two sides named by hand do,
/// with the bisector of two facets as normal, and so as symmetric as the scene.
TEST(WholeBoundaries, OfAPairPressAsTheSidesThatTouch) {
  const auto ring = [](double inner, double outer) {
    return json{{"mesh", {{"ring", {{"center", {0, 0}}, {"inner", inner}, {"outer", outer}, {"cells", {2, 24}}}}}},
                {"material", {{"linear_elastic", {{"E", 100}, {"nu", 0.3}}}}}};
  };
  json scene = {{"bodies", {{"low", ring(0.5, 1)}, {"up", ring(1, 1.5)}}},
                {"contacts", {{"c", {{"slave", "up.inner"}, {"master", "low.outer"}, {"friction", 0.3}}}}},
                {"supports",
                 {{{"on", "low.inner"}, {"move", {{"x", 0}, {"y", 0}}}},
                  {{"on", "up.outer"}, {"move", {{"x", 0}, {"y", -0.01}}}}}},
                {"responses",
                 {{"y", {{"reaction", {{"on", "up.outer"}, {"component", "y"}}}}},
                  {"x", {{"reaction", {{"on", "up.outer"}, {"component", "x"}}}}}}},
                {"time", {{"end", 1}, {"steps", 1}}}};
  const auto reactions = [&](const json& of, const char* method) {
    const auto result = cases::run(of, {{method, json::object()}}, "rings.json");
    EXPECT_TRUE(is_converged(result.status())) << method << result.message();
    return result.steps.back().responses;
  };
  json pair = scene;
  pair["contacts"] = {{"c", {{"between", {"up", "low"}}, {"friction", 0.3}}}};
  for (const char* method : {"penalty", "monolithic_al"}) {
    const auto sides = reactions(scene, method), whole = reactions(pair, method);
    EXPECT_LT(sides[1], -1) << method;                                                              // {x, y}
    for (const auto& of : {sides, whole}) EXPECT_NEAR(of[0], 0, 1e-9 * std::abs(of[1])) << method;  // as it is solved
    EXPECT_NEAR(whole[1], sides[1], 1e-3 * std::abs(sides[1])) << method;  // springs: of the size of a whole boundary
  }
}

/// Each disc keeps E times its strain: 1000 times 0.01 over the area pi.
TEST(WholeBoundaries, OfDiscsPressByTheirClosedForm) {
  json scene = blocks("axisymmetric", 0, "high.boundary", "low.boundary", "node");
  scene["supports"].erase(3);
  scene["supports"].erase(2);
  EXPECT_NEAR(force(scene, "monolithic_al"), 10 * M_PI, 1e-12 * 10 * M_PI);  // a dozen unknowns
}

}  // namespace
}  // namespace stickslip::whole_boundaries
