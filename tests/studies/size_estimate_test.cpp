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

/// The peak of a run, MB, and its size.
struct Measured {
  double megabytes;
  ProblemSize size;
};

void expect_within_a_factor_of_two(const Measured& run) {
  EXPECT_LT(estimated_bytes(run.size), 2e6 * run.megabytes) << run.size.displacements;
  EXPECT_GT(estimated_bytes(run.size), 0.5e6 * run.megabytes) << run.size.displacements;
}

/// Of a box on a floor.
TEST(SizeEstimate, IsWithinAFactorOfTwoOfWhatRunsTook) {
  constexpr Reduced bodies = Reduced::bodies, nothing = Reduced::nothing;
  for (const auto& run : {Measured{59, {20'200, 202, 101, 1, nothing}},
                          {216, {80'400, 402, 201, 1, nothing}},
                          {104, {40'040, 2002, 1001, 1, nothing}},
                          {140, {80'400, 402, 201, 1, bodies}},
                          {421, {80'100, 1602, 801, 1, bodies}},
                          {537, {40'040, 2002, 1001, 1, bodies}}})
    expect_within_a_factor_of_two(run);
  // 9000 steps of one point took 93 MB more than 300
  const double longer = estimated_bytes({2, 2, 1, 9000}) - estimated_bytes({2, 2, 1, 300});
  EXPECT_NEAR(longer, 93e6, 0.5 * 93e6);
}

/// Of a half ball on a slab, of rubber, and of a block on a floor, with friction but for the last two.
TEST(SizeEstimate, IsWithinAFactorOfTwoInSpace) {
  const auto rubber = [](double n, double contact, Reduced reduced) {
    return ProblemSize{n, contact, contact / 9, 2, reduced, 0, true, true, true};
  };
  const auto block = [](double n, double contact, Reduced reduced, bool has_friction) {
    return ProblemSize{n, contact, contact / 3, 3, reduced, 0, true, has_friction, false};
  };
  constexpr Reduced nothing = Reduced::nothing, bodies = Reduced::bodies, tangents = Reduced::tangents;
  for (const auto& run : {Measured{343, rubber(11'448, 2028, tangents)},
                          {949, rubber(25'584, 3414, tangents)},
                          {4335, rubber(84'744, 7602, tangents)},
                          {287, rubber(11'448, 2028, nothing)},
                          {762, rubber(25'584, 3414, nothing)},
                          {447, block(22'500, 1875, bodies, true)},
                          {1315, block(52'272, 3267, bodies, true)},
                          {352, block(22'500, 1875, nothing, true)},
                          {998, block(52'272, 3267, nothing, true)},
                          {199, block(22'500, 1875, nothing, false)},
                          {1180, block(100'860, 5043, nothing, false)}})
    expect_within_a_factor_of_two(run);
}

TEST(SizeEstimate, OfMillionsOfNodesIsBeyondASmallMachine) {
  EXPECT_GT(estimated_bytes({2 * estimated_nodes(box_of(3000), "Q4")}), 30e9);
  EXPECT_EQ(too_much(4.5e10, 1.6e10), "some 45 GB of memory, and there are 16 GB for this process");
  EXPECT_GT(memory_limit(), 1e7);
}

}  // namespace
}  // namespace stickslip
