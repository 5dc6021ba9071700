/// A point of the plane that moves.
#pragma once

#include "core/algebra/scalar.hpp"

namespace stickslip {

/// Initial position and displacement of a point. They are kept apart: the difference of two initial positions is exact
/// where they are near one another, so that differences of places keep the digits of the displacements, however small
/// these are beside the distance from the origin.
///
///   T  scalar of the initial position
///   U  scalar of the displacement, built on T
template <class U, class T = U>
struct Placed {
  Vec<T, 2> start;
  Vec<U, 2> moved;

  /// The vector from another point to this one.
  friend Vec<U, 2> operator-(const Placed& a, const Placed& b) {
    return {U(a.start[0] - b.start[0]) + (a.moved[0] - b.moved[0]),
            U(a.start[1] - b.start[1]) + (a.moved[1] - b.moved[1])};
  }
};

/// A point where it was at the start.
template <class T>
Placed<T> at_start(const Vec<T, 2>& x) {
  return {x, Vec<T, 2>::Constant(T(0))};
}

}  // namespace stickslip
