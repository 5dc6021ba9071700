/// What a scalar carries beside its value, for example a derivative through a whole run. Iterations continue after the
/// value has converged until the carried part has. A double carries nothing. Other scalars specialise this template
/// where they run.
#pragma once

#include "core/algebra/scalar.hpp"

namespace stickslip {

template <class T>
struct Carried {
  static constexpr int newton_iterations = 0;         ///< iterations after the converged one
  static constexpr int augmentations = 1;             ///< factor on max_augmentations
  static double size(const Vector<T>&) { return 0; }  ///< largest size of a carried part
};

}  // namespace stickslip
