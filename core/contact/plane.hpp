/// Rigid half-space.
#pragma once

#include <tuple>
#include <vector>

#include "core/algebra/described.hpp"
#include "core/contact/point_geometry.hpp"

namespace stickslip {

/// Behind a point; the normal points out of it, into the free space (need not be a unit vector).
struct Plane {
  static constexpr bool is_in_plane = true, is_in_space = true, is_flat = true;
  static constexpr const char *key = "plane", *about = "a half space";
  static constexpr const char* if_turned = "turn the normal of the plane round: it points out of the solid";
  std::vector<Number> point, normal;

  static constexpr auto keys() {
    return std::tuple{Key{&Plane::point, "point", "any of its surface (length)", Place2D{{0, 0}}},
                      Key{&Plane::normal, "normal", "out of the obstacle; of any length but 0",
                          Direction2D{"a vector that is not zero; it points out of the obstacle", {0, 1}}}};
  }
};

/// Geometry of the place X + w: that of X, and the gap that w adds. `numbers`: value of a number of the scene, as
/// Numbers<T> gives it.
template <class T, class Start, class Motion, class Read>
PointGeometry<T> against(const Start& X, const Motion& w, const Plane& plane, const Read& numbers) {
  const int D = static_cast<int>(X.size());
  Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 3, 1> n(D);
  for (int i = 0; i < D; ++i) n[i] = numbers(plane.normal[i]);
  const T length = norm(n);
  T gap{}, change{};
  for (int i = 0; i < D; ++i) {
    n[i] /= length;
    gap += (X[i] - numbers(plane.point[i])) * n[i];
  }
  PointGeometry<T> geometry = detail::rigid<T>(gap, n);
  for (int i = 0; i < D; ++i) change += w[i] * n[i];
  geometry.gap += change;
  return geometry;
}

}  // namespace stickslip
