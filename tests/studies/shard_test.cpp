#include "studies/sweep/shard.hpp"

#include <gtest/gtest.h>

namespace stickslip {
namespace {

TEST(Shard, ReadsItsPlaceAndTheirNumber) {
  const auto shard = parse_shard("3/8");
  ASSERT_TRUE(shard);
  EXPECT_EQ(shard->index, 3);
  EXPECT_EQ(shard->count, 8);
  EXPECT_EQ(shard->text(), "3/8");
}

TEST(Shard, RefusesWhatIsNoShare) {
  for (const char* text : {"", "3", "3/", "/8", "0/8", "9/8", "-1/8", "3/8x", "3 /8", "1.0/2", "a/b"})
    EXPECT_FALSE(parse_shard(text)) << text;
}

TEST(Shard, GivesEachCellToOneShareAndNoShareTwoMoreThanAnother) {
  for (const int count : {1, 3, 7, 100}) {
    int least = 1000, most = 0;
    for (int index = 1; index <= count; ++index) {
      int own = 0;
      for (std::size_t cell = 0; cell < 30; ++cell) own += Shard{index, count}.holds(cell);
      least = std::min<int>(least, own);
      most = std::max<int>(most, own);
    }
    EXPECT_LE(most - least, 1);
  }
  for (std::size_t cell = 0; cell < 30; ++cell) {
    int holders = 0;
    for (int index = 1; index <= 7; ++index) holders += Shard{index, 7}.holds(cell);
    EXPECT_EQ(holders, 1);
  }
}

}  // namespace
}  // namespace stickslip
