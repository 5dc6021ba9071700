#include "studies/input/size_estimate.hpp"

#include <gtest/gtest.h>

namespace stickslip {
namespace {

BoxMesh box_of(int n) {
  BoxMesh mesh;
  mesh.cells = {n, n};
  return mesh;
}

TEST(SizeEstimate, CountsNodesBeforeTheyAreMade) {
  EXPECT_NEAR(estimated_nodes(box_of(100), "Q4"), 101 * 101, 0.05 * 101 * 101);
  EXPECT_NEAR(estimated_nodes(box_of(100), "Q8"), 3 * 101 * 101, 0.05 * 3 * 101 * 101);
  EXPECT_NEAR(estimated_nodes(box_of(100), "T6"), 201 * 201, 0.05 * 201 * 201);
  BoxMesh block;
  block.min = {0.0, 0.0, 0.0};
  block.max = {1.0, 1.0, 1.0};
  block.cells = {50, 50, 50};
  const double doubled = std::pow(101, 3);
  EXPECT_NEAR(estimated_nodes(block, "H8"), std::pow(51, 3), 0.1 * std::pow(51, 3));
  EXPECT_NEAR(estimated_nodes(block, "H20"), doubled / 2, 0.05 * doubled);
  for (const char* element : {"H27", "T10"}) EXPECT_NEAR(estimated_nodes(block, element), doubled, 0.05 * doubled);
}

/// Peaks that runs of a box on a floor had (MB, displacements, contact dofs, condensed).
TEST(SizeEstimate, IsWithinAFactorOfTwoOfWhatRunsTook) {
  struct Run {
    double megabytes, displacements, contact_dofs;
    bool condensed;
  };
  for (const auto& run : {Run{59, 20'200, 202, false},
                          {216, 80'400, 402, false},
                          {104, 40'040, 2002, false},
                          {140, 80'400, 402, true},
                          {421, 80'100, 1602, true},
                          {537, 40'040, 2002, true}}) {
    const double estimate =
        estimated_bytes({run.displacements, run.contact_dofs, run.contact_dofs / 2, 1, run.condensed});
    EXPECT_LT(estimate, 2e6 * run.megabytes) << run.displacements;
    EXPECT_GT(estimate, 0.5e6 * run.megabytes) << run.displacements;
  }
  // 9000 steps of one point took 93 MB more than 300
  const double longer = estimated_bytes({2, 2, 1, 9000, false}) - estimated_bytes({2, 2, 1, 300, false});
  EXPECT_NEAR(longer, 93e6, 0.5 * 93e6);
}

TEST(SizeEstimate, OfMillionsOfNodesIsBeyondASmallMachine) {
  EXPECT_GT(estimated_bytes({2 * estimated_nodes(box_of(3000), "Q4")}), 30e9);
  EXPECT_EQ(too_much(4.5e10, 1.6e10), "some 45 GB of memory, and there are 16 GB for this process");
  EXPECT_GT(memory_limit(), 1e7);
}

}  // namespace
}  // namespace stickslip
