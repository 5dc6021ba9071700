/// Shape functions and quadrature of the continuum elements: one small struct an element.
#pragma once

#include <array>

#include "core/algebra/scalar.hpp"

namespace stickslip {

/// Three-node triangle, one point (exact for a constant strain).
struct Tri3 {
  static constexpr int nodes = 3, dimension = 2, points = 1;
  struct Point {
    double weight;
    Mat<double, 2, 3> gradient;  ///< dN_a/dxi, one column a node
    Eigen::Vector3d value;       ///< N_a
  };
  static std::array<Point, points> quadrature() {
    Mat<double, 2, 3> g;
    g << -1, 1, 0, -1, 0, 1;
    return {{{0.5, g, Eigen::Vector3d::Constant(1.0 / 3)}}};
  }
};

/// Four-node quadrilateral, 2 x 2 points.
struct Quad4 {
  static constexpr int nodes = 4, dimension = 2, points = 4;
  struct Point {
    double weight;
    Mat<double, 2, 4> gradient;
    Eigen::Vector4d value;
  };
  static Point at(double x, double y, double weight) {
    static constexpr double sx[4] = {-1, 1, 1, -1}, sy[4] = {-1, -1, 1, 1};
    Point p;
    p.weight = weight;
    for (int a = 0; a < 4; ++a) {
      p.gradient(0, a) = 0.25 * sx[a] * (1 + sy[a] * y);
      p.gradient(1, a) = 0.25 * sy[a] * (1 + sx[a] * x);
      p.value[a] = 0.25 * (1 + sx[a] * x) * (1 + sy[a] * y);
    }
    return p;
  }
  static std::array<Point, points> quadrature() {
    const double g = 1 / std::sqrt(3.0);
    return {{at(-g, -g, 1), at(g, -g, 1), at(g, g, 1), at(-g, g, 1)}};
  }
};

}  // namespace stickslip
