/// Sizes that NaN does not slip through: std::max(error, NaN) is `error`, and Eigen's maxCoeff() may drop it too.
/// tests/support/check_maxima.sh holds the tests to these and to larger().
#pragma once

#include "core/algebra/scalar.hpp"

namespace stickslip {

/// The smaller one; NaN where either is, as in larger().
inline double smaller(double a, double b) { return -larger(-a, -b); }

/// The largest absolute value of a matrix, 0 of an empty one; NaN where any entry is.
template <class A>
double largest_entry(const Eigen::MatrixBase<A>& a) {
  return a.size() > 0 ? a.cwiseAbs().template maxCoeff<Eigen::PropagateNaN>() : 0;
}

}  // namespace stickslip
