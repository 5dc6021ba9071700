/// Derivatives at and after ties by every scheme: each side against the complex step of its own discrete problem on a
/// path that is moved to that side.
#include "tests/support/sides.hpp"

namespace stickslip::ties_test {
namespace {

using namespace scenes;

TEST(Ties, OfABarWhoseFrontOfSlipStopsOnANode) {
  // let go by a quarter of the load, the reversed slip takes the third node to the edge of its cone and no further;
  // all nodes behind it stay on theirs, without a slip
  for (const auto& scheme : schemes())
    for (int n : {10, 30}) {
      const int kinks = expect_sides(pull_out(n, {0, 1, 0}, 4), scheme);
      // (of the penalised problem the front stops beside the node)
      EXPECT_EQ(kinks > 0, scheme.name != "penalty") << n;
    }
}

}  // namespace
}  // namespace stickslip::ties_test
