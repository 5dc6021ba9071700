#include "core/algebra/reverse.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "tests/core/algebra/every_operation.hpp"

namespace stickslip::reverse_test {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

static_assert(!std::is_convertible_v<Reverse, double>);
static_assert(std::is_convertible_v<double, Reverse>);

TEST(Reverse, GivesTheDerivativesOfDual) {
  for (double x : {0.6, 1.3, 1.9})
    for (double y : {0.7, 1.1}) {
      const auto forward = everything(Dual<2>::seed(x, 0), Dual<2>::seed(y, 1));
      Tape tape;
      const auto a = Reverse::leaf(x, tape), b = Reverse::leaf(y, tape);
      const auto f = everything(a, b);
      std::vector<double> by(tape.size());
      by[f.entry] = 1;
      tape.pull_back(by, 0);
      // a few dozen roundings, in another order
      EXPECT_NEAR(f.v, forward.v, 30 * epsilon * std::abs(forward.v));
      EXPECT_NEAR(by[a.entry], forward.d[0], 60 * epsilon * std::abs(forward.d[0]));
      EXPECT_NEAR(by[b.entry], forward.d[1], 60 * epsilon * std::abs(forward.d[1]));
    }
}

TEST(Reverse, ConstantsLeaveNothingOnTheTape) {
  Tape tape;
  const auto x = Reverse::leaf(2, tape);
  EXPECT_EQ((Reverse(3) * Reverse(4) + sqrt(Reverse(2))).entry, -1);
  EXPECT_EQ(tape.size(), 1);
  const auto y = x * Reverse(3);
  EXPECT_EQ(tape.size(), 2);
  EXPECT_EQ(y.v, 6);
}

TEST(Tape, GathersWhatSeveralSweepsSeed) {
  Tape tape;
  const auto x = Reverse::leaf(2, tape), y = Reverse::leaf(5, tape);
  const auto product = x * y, sum = product + x;
  std::vector<double> by(tape.size());
  by[product.entry] = 1;
  tape.pull_back(by, 0);
  EXPECT_EQ(by[x.entry], 5);
  EXPECT_EQ(by[y.entry], 2);
  EXPECT_EQ(by[product.entry], 0);  // moved on, so that the next sweep does not move it again
  by[sum.entry] = 10;
  tape.pull_back(by, 0);
  EXPECT_EQ(by[x.entry], 5 + 10 * 6);
  EXPECT_EQ(by[y.entry], 2 + 10 * 2);
}

TEST(Tape, StopsWhereASweepIsToStopAndForgetsWhatIsRewound) {
  Tape tape;
  const auto x = Reverse::leaf(2, tape);
  const auto square = x * x;
  const int start = tape.size();
  const auto cube = square * x;
  std::vector<double> by(tape.size());
  by[cube.entry] = 1;
  tape.pull_back(by, start);
  EXPECT_EQ(by[x.entry], 4);
  EXPECT_EQ(by[square.entry], 2);
  tape.rewind(start);
  by.resize(start);
  tape.pull_back(by, 0);
  EXPECT_EQ(by[x.entry], 12);
}

TEST(Tape, FoldsAFunctionToItsDerivatives) {
  const auto function = [](const Vector<Reverse>& x, const Reverse& before) {
    Reverse sum = x[0] * before;
    for (int k = 0; k < 20; ++k) sum = sum + sin(x[k % 2] * sum);
    return std::array<Reverse, 4>{sum, before, Reverse(7), x[1] / x[0]};
  };
  const auto derivatives = [&](bool folds, int& size) {
    Tape tape;
    const Vector<Reverse> x = leaves(Vec<double, 2>(1.3, 0.4), tape);
    const Reverse before = x[0] * x[1];
    const TapeMark<Reverse> mark(x);
    auto results = function(x, before);
    if (folds) mark.fold(results);
    size = tape.size();
    const Reverse end = results[0] * results[1] * results[2] + results[3];
    std::vector<double> by(tape.size());
    by[end.entry] = 1;
    tape.pull_back(by, 0);
    return Vec<double, 3>(end.v, by[x[0].entry], by[x[1].entry]);
  };
  int whole = 0, folded = 0;
  const auto expected = derivatives(false, whole), found = derivatives(true, folded);
  EXPECT_LE((found - expected).norm(), 100 * epsilon * expected.norm());  // sums of some forty products
  EXPECT_EQ(found[0], expected[0]);
  EXPECT_GT(whole, 60);
  EXPECT_EQ(folded, 3 + 3 + 2);  // the arguments and what was before; three partial derivatives, and two
}

TEST(Tape, FoldsNothingOfConstants) {
  const Vec<Reverse, 2> constants(1.0, 2.0);
  std::array<Reverse, 1> results{constants[0] + constants[1]};
  TapeMark<Reverse>(constants).fold(results);
  EXPECT_EQ(results[0].v, 3);
  EXPECT_EQ(results[0].tape, nullptr);
  std::array<double, 1> plain{3};
  TapeMark<double>(Vec<double, 2>(1, 2)).fold(plain);
  EXPECT_EQ(plain[0], 3);
}

}  // namespace
}  // namespace stickslip::reverse_test
