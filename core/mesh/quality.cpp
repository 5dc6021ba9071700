#include "core/mesh/quality.hpp"

#include <limits>

namespace stickslip {
namespace {

/// Whether the corners of a polygon all turn left.
bool is_convex(const int* nodes, int count, const Points<double>& points) {
  for (int corner = 0; corner < count; ++corner) {
    const Vec<double, 2> here = points.col(nodes[corner]).head<2>();
    const Vec<double, 2> out = points.col(nodes[(corner + 1) % count]).head<2>() - here;
    const Vec<double, 2> back = points.col(nodes[(corner + count - 1) % count]).head<2>() - here;
    // coordinates are known to their own rounding, which is what a difference of them may hide
    const double rounding = std::numeric_limits<double>::epsilon() * (here.norm() + out.norm() + back.norm());
    if (!(out[0] * back[1] - out[1] * back[0] > rounding * (out.norm() + back.norm()))) return false;
  }
  return true;
}

}  // namespace

std::optional<int> first_inverted_element(const Mesh& mesh, const Points<double>& points) {
  const int count = nodes_of(mesh.shape);
  for (int element = 0; element < mesh.element_count(); ++element) {
    const int* nodes = mesh.connectivity.data() + element * count;
    if (mesh.shape == ElementShape::bar2) {
      if (!((points.col(nodes[1]) - points.col(nodes[0])).norm() > 0)) return element;
    } else if (mesh.shape != ElementShape::point && !is_convex(nodes, count, points)) {
      return element;
    }
  }
  return std::nullopt;
}

}  // namespace stickslip
