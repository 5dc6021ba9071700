#include "core/mesh/quality.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <vector>

#include "core/mesh/shapes.hpp"

namespace stickslip {
namespace {

/// The three neighbours of each corner of a solid element, right-handed.
std::vector<std::array<int, 3>> corners_in_space(ElementShape shape) {
  if (linear_shape(shape) == ElementShape::tet4) return {{1, 2, 3}, {2, 0, 3}, {0, 1, 3}, {0, 2, 1}};
  return {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7}, {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};
}

/// The three edges of a solid element that leave each of its corners: f(place of the corner, edges in columns).
template <class F>
void for_each_corner_in_space(const int* nodes, ElementShape shape, const Points<double>& points, F&& f) {
  const auto neighbours = corners_in_space(shape);
  for (std::size_t corner = 0; corner < neighbours.size(); ++corner) {
    const Vec<double, 3> here = points.col(nodes[corner]);
    Mat<double, 3> edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = points.col(nodes[neighbours[corner][k]]) - here;
    f(here, edges);
  }
}

/// Whether a quadratic solid element has a positive volume at its nodes and at the points of its quadrature.
bool has_volume(const int* nodes, ElementShape shape, const Points<double>& points) {
  bool positive = true;
  with_shape(shape, [&]<class Shape>(Shape) {
    if constexpr (Shape::dimension == 3) {
      const Vec<double, 3> origin = points.col(nodes[0]);
      Nodal<double, Shape> X;
      for (int a = 0; a < Shape::nodes; ++a) X.col(a) = points.col(nodes[a]) - origin;
      const double reach = origin.norm() + X.colwise().norm().maxCoeff();
      const auto check = [&](const typename Shape::Point& at) {
        const Mat<double, 3> J = X * at.gradient.transpose();
        const double size = J.colwise().norm().maxCoeff();
        const double rounding = std::numeric_limits<double>::epsilon() * (reach + size);
        positive &= J.determinant() > 3 * rounding * size * size;
      };
      static const auto at_nodes = [] {
        std::vector<typename Shape::Point> at;
        for (int a = 0; a < Shape::nodes; ++a) {
          const auto place = natural_node<Shape>(a);
          at.push_back(Shape::at(place[0], place[1], place[2], 0));
        }
        return at;
      }();
      static const auto inside = Shape::quadrature();
      for (const auto& at : at_nodes) check(at);
      for (const auto& at : inside) check(at);
    }
  });
  return positive;
}

/// Whether the volume at each corner of a solid element is positive, and of a quadratic one at all nodes and points of
/// its quadrature.
bool is_convex_in_space(const int* nodes, ElementShape shape, const Points<double>& points) {
  if (is_quadratic(shape)) return has_volume(nodes, shape, points);
  bool convex = true;
  for_each_corner_in_space(nodes, shape, points, [&](const Vec<double, 3>& here, const Mat<double, 3>& edges) {
    const double size = edges.colwise().norm().maxCoeff();
    const double rounding = std::numeric_limits<double>::epsilon() * (here.norm() + size);
    convex &= edges.determinant() > 3 * rounding * size * size;
  });
  return convex;
}

/// Least height of a corner of a solid element over a face of its neighbours.
double thickness_in_space(const int* nodes, ElementShape shape, const Points<double>& points) {
  double least = std::numeric_limits<double>::infinity();
  for_each_corner_in_space(nodes, shape, points, [&](const Vec<double, 3>&, const Mat<double, 3>& edges) {
    double largest = 0;
    for (int k = 0; k < 3; ++k) largest = std::max(largest, edges.col(k).cross(edges.col((k + 1) % 3)).norm());
    least = std::min(least, std::abs(edges.determinant()) / largest);
  });
  return least;
}

/// Whether all corners turn left. The sides of a quadratic element leave a corner along 4 (middle - corner) - (next
/// corner - corner).
bool is_convex(const int* nodes, ElementShape shape, const Points<double>& points) {
  if (is_solid(shape)) return is_convex_in_space(nodes, shape, points);
  const int count = corners_of(shape);
  auto at = [&](int k) -> Vec<double, 2> { return points.col(nodes[k]).head<2>(); };
  for (int corner = 0; corner < count; ++corner) {
    const int next = (corner + 1) % count, last = (corner + count - 1) % count;
    const Vec<double, 2> here = at(corner);
    Vec<double, 2> out = at(next) - here, back = at(last) - here;
    if (is_quadratic(shape)) {
      out = 4 * (at(count + corner) - here) - out;
      back = 4 * (at(count + last) - here) - back;
    }
    // coordinates are known to their own rounding, which is what a difference of them may hide
    const double rounding = std::numeric_limits<double>::epsilon() * (here.norm() + out.norm() + back.norm());
    if (!(out[0] * back[1] - out[1] * back[0] > rounding * (out.norm() + back.norm()))) return false;
  }
  return true;
}

/// Least distance of a corner of an element from a side at its neighbour: that of a bar is its length.
double thickness(const int* nodes, ElementShape shape, const Points<double>& points) {
  if (is_solid(shape)) return thickness_in_space(nodes, shape, points);
  const auto at = [&](int k) -> Vec<double, 2> { return points.col(nodes[k]).head<2>(); };
  const int count = corners_of(shape);
  double least = std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < count; ++corner) {
    const Vec<double, 2> here = at(corner);
    const Vec<double, 2> out = at((corner + 1) % count) - here, back = at((corner + count - 1) % count) - here;
    least = std::min(least, std::abs(out[0] * back[1] - out[1] * back[0]) / std::max(out.norm(), back.norm()));
  }
  return least;
}

}  // namespace

std::optional<ThinElement> first_thin_element(const Mesh& mesh, const Points<double>& points) {
  constexpr double least_share = std::numeric_limits<double>::epsilon() / most_strain_rounding;
  if (mesh.shape == ElementShape::point) return std::nullopt;
  // displacements are of the size of the body at most, and coordinates round as they are
  const double size =
      std::max((points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm(), points.cwiseAbs().maxCoeff());
  const int count = nodes_of(mesh.shape);
  for (int element = 0; element < mesh.element_count(); ++element) {
    const int* nodes = mesh.connectivity.data() + element * count;
    const double thick = mesh.shape == ElementShape::bar2 ? (points.col(nodes[1]) - points.col(nodes[0])).norm()
                                                          : thickness(nodes, mesh.shape, points);
    if (thick < least_share * size) return ThinElement{element, thick, size};
  }
  return std::nullopt;
}

std::optional<int> first_inverted_element(const Mesh& mesh, const Points<double>& points) {
  const int count = nodes_of(mesh.shape);
  for (int element = 0; element < mesh.element_count(); ++element) {
    const int* nodes = mesh.connectivity.data() + element * count;
    if (mesh.shape == ElementShape::bar2) {
      if (!((points.col(nodes[1]) - points.col(nodes[0])).norm() > 0)) return element;
    } else if (mesh.shape != ElementShape::point && !is_convex(nodes, mesh.shape, points)) {
      return element;
    }
  }
  return std::nullopt;
}

std::optional<StrayMiddle> stray_middle(const Mesh& mesh, const Points<double>& points, int element) {
  const int* nodes = mesh.connectivity.data() + element * nodes_of(mesh.shape);
  if (!is_quadratic(mesh.shape) || !is_convex(nodes, linear_shape(mesh.shape), points)) return std::nullopt;
  StrayMiddle worst;
  for (const auto& side : sides_of(mesh.shape)) {
    const int corners = is_solid(mesh.shape) ? corners_of_face(side.size()) : 2, edges = corners == 2 ? 1 : corners;
    for (int k = 0; k < edges; ++k) {
      const auto from = points.col(nodes[side[k]]), to = points.col(nodes[side[(k + 1) % corners]]);
      const int middle = nodes[side[corners + k]];
      const double share = (points.col(middle) - (from + to) / 2).norm() / (to - from).norm();
      if (share > worst.share) worst = {middle, share};
    }
  }
  return worst;
}

std::optional<std::pair<int, int>> nodes_at_one_place(const Mesh& mesh, const Points<double>& points) {
  constexpr double near = 1e-6, cell = 1e-3;  // of the shortest edge; a cell holds nodes that are near one another
  const int count = nodes_of(mesh.shape), corners = corners_of(mesh.shape);
  double least = std::numeric_limits<double>::infinity();
  for (int e = 0; e < mesh.element_count(); ++e)
    for (int a = 0; a < corners; ++a)
      for (int b = 0; b < a; ++b) {
        const int* nodes = mesh.connectivity.data() + static_cast<std::ptrdiff_t>(e) * count;
        least = std::min(least, (points.col(nodes[a]) - points.col(nodes[b])).norm());
      }
  std::map<std::array<double, 3>, int> first_in;
  for (int n = 0; n < static_cast<int>(points.cols()); ++n) {
    std::array<std::array<double, 3>, 2> ends{};  // cells of the node moved by `near` down and up, nearly always one
    for (int i = 0; i < points.rows(); ++i)
      for (int up : {0, 1}) ends[up][i] = std::floor((points(i, n) / least + (up ? near : -near)) / cell);
    for (int side = 0; side < 8; ++side) {
      std::array<double, 3> at = ends[0];
      bool is_first = true;  // of the sides with this cell
      for (int i = 0; i < 3; ++i)
        if (side >> i & 1) {
          is_first &= ends[0][i] != ends[1][i];
          at[i] = ends[1][i];
        }
      if (!is_first) continue;
      const auto [other, is_new] = first_in.try_emplace(at, n);
      if (!is_new && (points.col(other->second) - points.col(n)).norm() <= near * least)
        return std::pair(other->second, n);
    }
  }
  return std::nullopt;
}

int count_of_parts(const Mesh& mesh) {
  const int count = nodes_of(mesh.shape);
  std::vector<int> part(mesh.node_count);
  std::iota(part.begin(), part.end(), 0);
  const auto root = [&](int node) {
    while (part[node] != node) node = part[node] = part[part[node]];
    return node;
  };
  for (int e = 0; e < mesh.element_count(); ++e) {
    const int* nodes = mesh.connectivity.data() + static_cast<std::ptrdiff_t>(e) * count;
    for (int k = 1; k < count; ++k) part[root(nodes[k])] = root(nodes[0]);
  }
  int parts = 0;
  for (int node = 0; node < mesh.node_count; ++node) parts += part[node] == node;
  return parts;
}

}  // namespace stickslip
