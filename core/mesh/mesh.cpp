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
  }
  return 0;
}

}  // namespace stickslip
