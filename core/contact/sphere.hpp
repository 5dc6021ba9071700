/// Rigid ball, or a cup in space.
#pragma once

#include <tuple>
#include <vector>

#include "core/contact/circle.hpp"

namespace stickslip {

/// `inside`: the outside of a ball is solid, the free space is inside.
struct Sphere {
  static constexpr bool is_in_plane = false, is_in_space = true, is_flat = false;
  static constexpr const char *key = "sphere", *about = "a ball, or a cup; in space alone",
                              *example = R"({"center": [0, 0, 1], "radius": 1})";
  static constexpr const char* if_turned = R"(look at "inside" of the sphere: true is a cup, solid outside)";
  std::vector<Number> center;
  Number radius;
  bool inside = false;

  static constexpr auto keys() {
    return std::tuple{Key{&Sphere::center, "center", "of the sphere (length)", Place3D{{0, 0, 1}}},
                      Key{&Sphere::radius, "radius", "of the sphere (length)", InRange{Range::positive, 1}},
                      Key{&Sphere::inside, "inside", "true: a cup, solid outside of the sphere", Flag{}}};
  }
};

/// Geometry of the place X + w; arguments as of a plane.
template <class T, class Start, class Motion, class Read>
PointGeometry<T> against(const Start& X, const Motion& w, const Sphere& sphere, const Read& numbers) {
  return detail::against_centred<T>(X, w, sphere, numbers);
}

/// The key of the surface that is wrong where x has no nearest place on it; nullptr where x has one.
template <class Point>
const char* ambiguous_at(const Point& x, const Sphere& sphere, const Numbers<double>& numbers) {
  bool same = true;
  for (int i = 0; i < 3; ++i) same &= x[i] == numbers(sphere.center[i]);
  return same ? "sphere/center" : nullptr;
}

}  // namespace stickslip
