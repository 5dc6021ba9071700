/// A point that moves.
#pragma once

#include "core/algebra/scalar.hpp"

namespace stickslip {

/// Initial position and displacement of a point. They are kept apart: the difference of two initial positions is exact
/// where they are near one another, so that differences of places keep the digits of the displacements, however small
/// these are beside the distance from the origin.
///
///   T  scalar of the initial position
///   U  scalar of the displacement, built on T
template <class U, class T = U, int D = 2>
struct Placed {
  Vec<T, D> start;
  Vec<U, D> moved;

  /// The vector from another point to this one.
  friend Vec<U, D> operator-(const Placed& a, const Placed& b) {
    Vec<U, D> way;
    for (int i = 0; i < D; ++i) way[i] = U(a.start[i] - b.start[i]) + (a.moved[i] - b.moved[i]);
    return way;
  }
};

/// A point where it was at the start.
template <class T>
Placed<T> at_start(const Vec<T, 2>& x) {
  return {x, Vec<T, 2>::Constant(T(0))};
}

}  // namespace stickslip
