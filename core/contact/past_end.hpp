/// Where a rigid surface in space ends: at a border, or at an edge behind which no patch opposes the slave side.
///
/// A node that presses would lose all of its force at once where it comes past the end. Without that force it may be
/// back on the surface, so that neither is an equilibrium. For this reason ends are rounded off: the gap of a node
/// whose foot is beyond an end, on the patch extended, is
///
///   g + 0.01 l (1 / (1 - beta) - 1)^2      beta = (b - b_0) / (b_1 - b_0)      b_1 = min(l / (2 w), 0.5)
///
///   b     how far the foot is beyond the end, in coordinates of the patch (beyond_edge())
///   w     width of the patch there at the start, length
///   l     size of the slave facets at the node at the start: mean length of their edges
///   b_0   0.01, at most b_1 / 5: until there the node is on the surface
///
/// So the force fades over half a slave facet. From beta = 0.95 on the node faces nothing; there the term is 3.6 l. At
/// a corner of the surface both ends have such a term. It has no potential, since the force stays along the normal of
/// the patch: the tangent is unsymmetric. Theory: core/README.md, Past a free end.
#pragma once

#include "core/algebra/scalar.hpp"

namespace stickslip {

/// Share of a patch by which a foot may lie past the end of a surface that it still faces. Why: two sides that end
/// together overlap only roughly. Example: two blocks pressed to 0.7 of their height; there the compliance of a
/// penalty, or the first augmentation, moves the last node off its master and back for ever. In space the normal at a
/// border is that of one side, so a node in a plane of symmetry, where a body is cut, projects a little past it.
inline constexpr double past_end_of_surface = 0.01;
/// Share of a patch by which what is past its end, outside of a wall, is inside by it at most.
inline constexpr double deepest_past_end = 0.25;

/// b_0 and b_1 (above).
template <class T>
struct RoundedEnd {
  T from, to;
  static constexpr double last = 0.95;  ///< beta

  /// `size`: l; `width`: w. pre: l > 0.
  RoundedEnd(const T& size, const T& width) {
    constexpr double widest = 0.5, part = 0.2;
    to = T(0.5) * size / width;
    if (value(to) > widest) to = T(widest);
    from = T(part) * to;
    if (value(from) > past_end_of_surface) from = T(past_end_of_surface);
  }
  /// From where on a point faces nothing.
  T furthest() const { return from + T(last) * (to - from); }
};

/// The term by which the gap of a point is larger that leaves its surface: 0.01 l (q - 1)^2, length.
///
///   q  `fading`: 1 where the relief begins, infinite where the point has left
///   l  `size`: length of the slave facets there
template <class U, class T>
U end_relief(const U& fading, const T& size) {
  constexpr double height = 0.01;
  const U lacking = fading - U(1);
  return U(T(height) * size) * lacking * lacking;
}

/// The same of a foot that is beyond an end by b, between b_0 and that of beta = 1: q = 1 / (1 - beta).
template <class U, class T>
U end_relief(const RoundedEnd<T>& end, const U& beyond, const T& size) {
  return end_relief<U, T>(U(end.to - end.from) / (U(end.to) - beyond), size);
}

}  // namespace stickslip
