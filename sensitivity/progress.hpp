/// Whether a linear iteration will get to its end.
#pragma once

#include <cmath>
#include <utility>

namespace stickslip::detail {

/// Watches whether a change falls fast enough to get to its end within `limit` passes.
class Progress {
 public:
  static constexpr int limit = 20000;
  /// Whether there is no hope: at the rate of the last `window` passes, the passes left do not take `change` down to
  /// `enough`. A linear iteration slows down, as its fast modes die out, and never speeds up.
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
