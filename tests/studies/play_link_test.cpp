#include "studies/report/play_link.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace stickslip::report {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(PlayLink, HoldsTheSceneAndLeadsFromTheReportToThePage) {
  const json picture = {{"scene", {{"title", "a + b & \"c\""}}}};
  const std::string link = play_link("/tree/results/run", picture, "/tree/build/wasm/stickslip.html");
  EXPECT_THAT(link, HasSubstr("href=\"../../build/wasm/stickslip.html#json=%7B%22title%22%3A%22a%20%2B%20b%20%26%20"));
}

TEST(PlayLink, IsMissingWithoutAPageOrAScene) {
  const json picture = {{"scene", {{"title", "t"}}}};
  EXPECT_THAT(play_link("results", picture, ""), IsEmpty());
  EXPECT_THAT(play_link("results", json::object(), "/page.html"), IsEmpty());
  EXPECT_THAT(play_link("results", nullptr, "/page.html"), IsEmpty());
}

TEST(PlayLink, IsMissingIfTheSceneReadsMeshes) {
  const json picture = {{"scene", {{"bodies", {{"a", {{"mesh", {{"gmsh", "a.msh"}}}}}}}}}};
  EXPECT_THAT(play_link("results", picture, "/page.html"), IsEmpty());
}

}  // namespace
}  // namespace stickslip::report
