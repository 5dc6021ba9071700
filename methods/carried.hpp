/// What a scalar carries beside its value. Once the value has converged, iterations go on for that. A double carries
/// nothing. A scalar that carries a derivative through a whole run specialises it where it runs.
#pragma once

#include "core/algebra/scalar.hpp"

namespace stickslip {

template <class T>
struct Carried {
  static constexpr int newton_iterations = 0;         ///< after the one that has converged
  static constexpr int augmentations = 1;             ///< factor on the number that the method allows
  static double size(const Vector<T>&) { return 0; }  ///< of the largest entry's
};

}  // namespace stickslip
