/// Prediction whether a linear iteration converges within its limit of passes.
#pragma once

#include <cmath>
#include <utility>

namespace stickslip::detail {

/// Observes the change per pass of a linear iteration.
class PassConvergence {
 public:
  static constexpr int limit = 20000;
  /// Whether, at the rate of the last `window` passes, `change` will not fall to `enough` in the remaining passes. A
  /// linear iteration slows down as its fast modes decay, and never speeds up.
  bool is_hopeless(int pass, double change, double enough) {
    if (pass % window != 0) return false;
    const double before = std::exchange(last_, change);
    if (!(before > 0) || !(enough > 0)) return false;
    const double rate = std::log(change / before), wanted = std::log(enough / change);
    return rate >= 0 || wanted / rate * window > limit - pass;
  }

 private:
  static constexpr int window = 500;
  double last_ = 0;
};

}  // namespace stickslip::detail
