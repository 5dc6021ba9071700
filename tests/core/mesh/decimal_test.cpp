#include "core/mesh/decimal.hpp"

#include <gtest/gtest.h>

namespace stickslip::decimal_test {
namespace {

TEST(Decimal, ReadsWholeTexts) {
  EXPECT_EQ(decimal("0.1"), 0.1);
  EXPECT_EQ(decimal("-2.5e-3"), -2.5e-3);
  EXPECT_EQ(decimal("17"), 17.0);
}

TEST(Decimal, RefusesWhatIsNoNumberOrOutOfRange) {
  for (const char* text : {"", "x", "1x", "+1", " 1", "1 ", "0x10", "1e999"}) EXPECT_FALSE(decimal(text)) << text;
}

}  // namespace
}  // namespace stickslip::decimal_test
