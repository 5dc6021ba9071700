#include "core/mesh/mesh.hpp"

namespace stickslip {

int nodes_of(ElementShape shape) {
  switch (shape) {
    case ElementShape::point:
      return 2;
    case ElementShape::bar2:
      return 2;
    case ElementShape::tri3:
      return 3;
    case ElementShape::quad4:
      return 4;
    case ElementShape::tri6:
      return 6;
    case ElementShape::quad8:
      return 8;
    case ElementShape::tet4:
      return 4;
    case ElementShape::hex8:
      return 8;
  }
  return 0;
}

bool is_continuum(ElementShape shape) { return shape != ElementShape::point && shape != ElementShape::bar2; }
bool is_quadratic(ElementShape shape) { return shape == ElementShape::tri6 || shape == ElementShape::quad8; }
bool is_solid(ElementShape shape) { return shape == ElementShape::tet4 || shape == ElementShape::hex8; }
int corners_of(ElementShape shape) { return is_quadratic(shape) ? nodes_of(shape) / 2 : nodes_of(shape); }

const std::vector<std::vector<int>>& sides_of(ElementShape shape) {
  using Sides = std::vector<std::vector<int>>;
  static const Sides none, tri3{{0, 1}, {1, 2}, {2, 0}}, quad4{{0, 1}, {1, 2}, {2, 3}, {3, 0}},
      tri6{{0, 1, 3}, {1, 2, 4}, {2, 0, 5}}, quad8{{0, 1, 4}, {1, 2, 5}, {2, 3, 6}, {3, 0, 7}},
      tet4{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}},
      hex8{{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  switch (shape) {
    case ElementShape::tri3:
      return tri3;
    case ElementShape::quad4:
      return quad4;
    case ElementShape::tri6:
      return tri6;
    case ElementShape::quad8:
      return quad8;
    case ElementShape::tet4:
      return tet4;
    case ElementShape::hex8:
      return hex8;
    default:
      return none;
  }
}

}  // namespace stickslip
