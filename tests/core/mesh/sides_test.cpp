#include "core/mesh/sides.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "core/mesh/generators.hpp"

namespace stickslip::sides_test {
namespace {

/// 3 x 2 cells; nodes 0 .. 3 at the bottom, 8 .. 11 at the top.
Mesh block() {
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {3.0, 2.0};
  box.cells = {3, 2};
  return make_mesh(box, "Q4", 2);
}

using Nodes = std::vector<int>;
using Facets = std::vector<std::vector<int>>;

TEST(Sides, RunCounterClockwiseWithTheirFacetsInOrder) {
  EXPECT_EQ(evaluate_side(block(), "bottom").nodes, (Nodes{0, 1, 2, 3}));
  EXPECT_EQ(evaluate_side(block(), "top").nodes, (Nodes{11, 10, 9, 8}));
  EXPECT_EQ(evaluate_side(block(), "left").facets, (Facets{{8, 4}, {4, 0}}));
}

TEST(Sides, IntersectAtACornerWithoutFacets) {
  const Side corner = evaluate_side(block(), parse_side_expression("block.left & block.bottom"));
  EXPECT_EQ(corner.nodes, Nodes{0});
  EXPECT_TRUE(corner.facets.empty());
}

TEST(Sides, LeaveNodesOutButKeepTheFacetsOfTheNodesThatAreLeft) {
  const Side side = evaluate_side(block(), parse_side_expression("block.bottom - block.right"));
  EXPECT_EQ(side.nodes, (Nodes{0, 1, 2}));
  EXPECT_EQ(side.facets, (Facets{{0, 1}, {1, 2}, {2, 3}}));
  const Side inner = evaluate_side(block(), "right - top - bottom");
  EXPECT_EQ(inner.nodes, Nodes{7});
  EXPECT_EQ(inner.facets, (Facets{{3, 7}, {7, 11}}));
}

TEST(Sides, KeepTheFacetsCommonToBothWhenTheyIntersect) {
  Mesh mesh = block();
  mesh.sides["part"] = {{1, 2, 3}, {{1, 2}, {2, 3}}};
  const Side side = evaluate_side(mesh, "bottom & part");
  EXPECT_EQ(side.nodes, (Nodes{1, 2, 3}));
  EXPECT_EQ(side.facets, (Facets{{1, 2}, {2, 3}}));
}

TEST(SideExpressions, AreParsedIntoBodySideAndOperations) {
  const SideExpression e = parse_side_expression("  block.bottom - block.right&block.flat-part ");
  EXPECT_EQ(e.error, "");
  EXPECT_EQ(e.body, "block");
  EXPECT_EQ(e.side, "bottom");
  ASSERT_EQ(e.operations.size(), 2u);
  EXPECT_EQ(e.operations[0], std::pair(SideOperation::leave_out, std::string("right")));
  EXPECT_EQ(e.operations[1], std::pair(SideOperation::intersect, std::string("flat-part")));
}

TEST(SideExpressions, ThatAreMalformedSayWhatIsWrong) {
  for (const auto& [text, part] :
       std::vector<std::pair<std::string, std::string>>{{"", "missing"},
                                                        {"block", "not BODY.SIDE"},
                                                        {"block.", "not BODY.SIDE"},
                                                        {".left", "not BODY.SIDE"},
                                                        {"block.left &", "missing"},
                                                        {"& block.left", "missing"},
                                                        {"block.left & disk.arc", "two bodies, block and disk"},
                                                        {"block.bottom-block.right", "write a space"}})
    EXPECT_NE(parse_side_expression(text).error.find(part), std::string::npos)
        << text << ": " << parse_side_expression(text).error;
}

TEST(SideExpressions, ThatNameNoSideAreAnsweredWithTheNearest) {
  const std::string error = side_error(block(), parse_side_expression("block.bottom - block.rigth"));
  EXPECT_NE(error.find("did you mean \"right\"?"), std::string::npos) << error;
  EXPECT_NE(error.find("bottom, left, right, top"), std::string::npos) << error;
  EXPECT_EQ(side_error(block(), parse_side_expression("block.bottom")), "");
  EXPECT_THROW(evaluate_side(block(), "botom"), std::invalid_argument);
}

TEST(SideExpressions, ThatLeaveNoNodeAreRefused) {
  EXPECT_NE(side_error(block(), parse_side_expression("block.bottom & block.top")).find("no node"), std::string::npos);
}

TEST(NearestName, HasTheLeastNumberOfEdits) {
  EXPECT_EQ(nearest_name("botom", {"top", "bottom"}), "bottom");
  EXPECT_EQ(nearest_name("tpo", {"bottom", "top"}), "top");
  EXPECT_EQ(nearest_name("x", {}), "");
}

}  // namespace
}  // namespace stickslip::sides_test
