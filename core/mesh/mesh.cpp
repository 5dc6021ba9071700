#include "core/mesh/mesh.hpp"

#include <algorithm>

namespace stickslip {
namespace {

using Lists = std::vector<std::vector<int>>;

/// The corners and then nodes between the ends of edges, and the corners of faces and of the element.
Lists with_corners(int corners, const Lists& between) {
  Lists around;
  for (int a = 0; a < corners; ++a) around.push_back({a});
  around.insert(around.end(), between.begin(), between.end());
  return around;
}

Lists edges_of_hexahedron() {
  return {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
}

/// Faces of a quadratic element: the corners of each, and the nodes between them.
Lists with_nodes_between(const Lists& linear, const Lists& around) {
  Lists sides = linear;
  for (auto& side : sides) {
    const std::vector<int> corners = side;
    const auto add = [&](std::vector<int> between) {
      const auto found = std::find_if(around.begin(), around.end(), [&](const std::vector<int>& of) {
        return std::is_permutation(of.begin(), of.end(), between.begin(), between.end());
      });
      if (found != around.end()) side.push_back(static_cast<int>(found - around.begin()));
    };
    const std::size_t count = corners.size();
    for (std::size_t k = 0; k < count; ++k) add({corners[k], corners[(k + 1) % count]});
    if (count == 4) add(corners);
  }
  return sides;
}

}  // namespace

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
    case ElementShape::tet10:
      return 10;
    case ElementShape::hex20:
      return 20;
    case ElementShape::hex27:
      return 27;
  }
  return 0;
}

bool is_continuum(ElementShape shape) { return shape != ElementShape::point && shape != ElementShape::bar2; }
bool is_quadratic(ElementShape shape) { return is_continuum(shape) && linear_shape(shape) != shape; }

bool is_solid(ElementShape shape) {
  return linear_shape(shape) == ElementShape::tet4 || linear_shape(shape) == ElementShape::hex8;
}

int corners_of(ElementShape shape) { return nodes_of(linear_shape(shape)); }

ElementShape linear_shape(ElementShape shape) {
  switch (shape) {
    case ElementShape::tri6:
      return ElementShape::tri3;
    case ElementShape::quad8:
      return ElementShape::quad4;
    case ElementShape::tet10:
      return ElementShape::tet4;
    case ElementShape::hex20:
    case ElementShape::hex27:
      return ElementShape::hex8;
    default:
      return shape;
  }
}

const Lists& corners_around(ElementShape shape) {
  static const Lists none;
  switch (shape) {
    case ElementShape::tri6: {
      static const Lists around = with_corners(3, {{0, 1}, {1, 2}, {2, 0}});
      return around;
    }
    case ElementShape::quad8: {
      static const Lists around = with_corners(4, {{0, 1}, {1, 2}, {2, 3}, {3, 0}});
      return around;
    }
    case ElementShape::tet10: {
      static const Lists around = with_corners(4, {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}});
      return around;
    }
    case ElementShape::hex20: {
      static const Lists around = with_corners(8, edges_of_hexahedron());
      return around;
    }
    case ElementShape::hex27: {
      static const Lists around = [] {
        Lists all = edges_of_hexahedron();
        for (const auto& corners : Lists{{0, 4, 7, 3},
                                         {1, 2, 6, 5},
                                         {0, 1, 5, 4},
                                         {3, 7, 6, 2},
                                         {0, 3, 2, 1},
                                         {4, 5, 6, 7},
                                         {0, 1, 2, 3, 4, 5, 6, 7}})
          all.push_back(corners);
        return with_corners(8, all);
      }();
      return around;
    }
    case ElementShape::tri3: {
      static const Lists around = with_corners(3, {});
      return around;
    }
    case ElementShape::quad4:
    case ElementShape::tet4: {
      static const Lists around = with_corners(4, {});
      return around;
    }
    case ElementShape::hex8: {
      static const Lists around = with_corners(8, {});
      return around;
    }
    default:
      return none;
  }
}

const Lists& sides_of(ElementShape shape) {
  static const Lists none;
  switch (shape) {
    case ElementShape::tri3: {
      static const Lists sides{{0, 1}, {1, 2}, {2, 0}};
      return sides;
    }
    case ElementShape::quad4: {
      static const Lists sides{{0, 1}, {1, 2}, {2, 3}, {3, 0}};
      return sides;
    }
    case ElementShape::tri6: {
      static const Lists sides{{0, 1, 3}, {1, 2, 4}, {2, 0, 5}};
      return sides;
    }
    case ElementShape::quad8: {
      static const Lists sides{{0, 1, 4}, {1, 2, 5}, {2, 3, 6}, {3, 0, 7}};
      return sides;
    }
    case ElementShape::tet4: {
      static const Lists sides{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
      return sides;
    }
    case ElementShape::hex8: {
      static const Lists sides{{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
      return sides;
    }
    case ElementShape::tet10: {
      static const Lists sides = with_nodes_between(sides_of(ElementShape::tet4), corners_around(shape));
      return sides;
    }
    case ElementShape::hex20: {
      static const Lists sides = with_nodes_between(sides_of(ElementShape::hex8), corners_around(shape));
      return sides;
    }
    case ElementShape::hex27: {
      static const Lists sides = with_nodes_between(sides_of(ElementShape::hex8), corners_around(shape));
      return sides;
    }
    default:
      return none;
  }
}

Lists facets_of_side(const std::vector<int>& side, int dimension) {
  const auto& n = side;
  if (dimension == 2) return n.size() == 3 ? Lists{{n[0], n[2]}, {n[2], n[1]}} : Lists{n};
  switch (n.size()) {
    case 6:
      return {{n[0], n[3], n[5]}, {n[1], n[4], n[3]}, {n[2], n[5], n[4]}, {n[3], n[4], n[5]}};
    case 8:
      return {{n[0], n[4], n[7]}, {n[1], n[5], n[4]}, {n[2], n[6], n[5]}, {n[3], n[7], n[6]}, {n[4], n[5], n[6], n[7]}};
    case 9:
      return {{n[0], n[4], n[8], n[7]}, {n[1], n[5], n[8], n[4]}, {n[2], n[6], n[8], n[5]}, {n[3], n[7], n[8], n[6]}};
    default:
      return {n};
  }
}

}  // namespace stickslip
