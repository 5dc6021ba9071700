/// What a picture shows of bodies: the elements of the plane; of solid bodies the faces that are seen from one side.
#pragma once

#include <optional>
#include <vector>

#include "studies/run/case.hpp"

namespace stickslip {

/// A parallel projection of space.
struct View {
  Vec<double, 3> right, up, toward;  ///< orthonormal, right-handed; `toward` the one who looks

  Vec<double, 2> seen(const Vec<double, 3>& x) const { return {right.dot(x), up.dot(x)}; }
};

/// The view of a problem in space with solid bodies; none of others. It is of the sides in contact, from aslant.
std::optional<View> view_of(const Problem& problem);

/// What is drawn in one colour.
struct Piece {
  int body = 0;
  int element = 0;  ///< counted over all bodies
  std::vector<int> nodes;
};

/// All elements; of solid bodies those faces of their boundary that are turned to the one who looks, the farthest
/// first, where a state has moved them to.
std::vector<Piece> pieces_of(const Problem& problem, const State<double>& state, const std::optional<View>& view);

}  // namespace stickslip
