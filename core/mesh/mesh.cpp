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
  }
  return 0;
}

bool is_continuum(ElementShape shape) { return shape != ElementShape::point && shape != ElementShape::bar2; }
bool is_quadratic(ElementShape shape) { return shape == ElementShape::tri6 || shape == ElementShape::quad8; }
int corners_of(ElementShape shape) { return is_quadratic(shape) ? nodes_of(shape) / 2 : nodes_of(shape); }

}  // namespace stickslip
