/// A complex step carries its derivative in the imaginary part, which follows the value an iteration later, and settles
/// long after it where updates are slow.
#pragma once

#include <complex>

#include "methods/newton/carried.hpp"
#include "tests/support/largest.hpp"

namespace stickslip {

template <>
struct Carried<std::complex<double>> {
  static constexpr int newton_iterations = 3;
  static constexpr int augmentations = 20;
  static double size(const Vector<std::complex<double>>& v) { return largest_entry(v.imag()); }
};

}  // namespace stickslip
