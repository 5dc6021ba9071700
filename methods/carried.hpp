/// What a scalar carries beside its value, for which iterations go on once the value has converged: nothing on a
/// double. A scalar that carries a derivative through a whole run specialises it where it runs.
#pragma once

#include "core/algebra/scalar.hpp"

namespace stickslip {

template <class T>
struct Carried {
  static constexpr int newton_iterations = 0;         ///< after the one that has converged
  static constexpr int augmentations = 1;             ///< times as many as the method allows
  static double size(const Vector<T>&) { return 0; }  ///< of the largest entry's
};

}  // namespace stickslip
