/// Rigid cylinder without end, or a bore, in space.
#pragma once

#include <tuple>
#include <vector>

#include "core/algebra/described.hpp"
#include "core/contact/circle.hpp"

namespace stickslip {

/// `inside`: the outside of a cylinder is solid, the free space is inside.
struct Cylinder {
  static constexpr bool is_in_plane = false, is_in_space = true, is_flat = false;
  static constexpr const char *key = "cylinder", *about = "a drum without end, or a bore; in space alone";
  static constexpr const char* if_turned = R"(look at "inside" of the cylinder: true is a bore, solid outside)";
  std::vector<Number> point, axis;
  Number radius;
  bool inside = false;

  static constexpr auto keys() {
    return std::tuple{Key{&Cylinder::point, "point", "any of its axis (length)", Place3D{{0, 0, 1}}},
                      Key{&Cylinder::axis, "axis", "along it; of any length but 0",
                          Direction3D{"a vector that is not zero, along the axis", {0, 1, 0}}},
                      Key{&Cylinder::radius, "radius", "of the cylinder (length)", InRange{Range::positive, 1}},
                      Key{&Cylinder::inside, "inside", "true: a bore, solid outside of the cylinder", Flag{}}};
  }
};

namespace detail {

/// The part of a vector that is perpendicular to the axis, and the unit vector along it.
template <class T, class Read>
struct AcrossAxis {
  Vec<T, 3> axis;
  AcrossAxis(const Cylinder& cylinder, const Read& numbers) {
    for (int i = 0; i < 3; ++i) axis[i] = numbers(cylinder.axis[i]);
    const T length = norm(axis);
    for (int i = 0; i < 3; ++i) axis[i] /= length;
  }
  Vec<T, 3> operator()(const Vec<T, 3>& x) const { return x - dot(x, axis) * axis; }
};

}  // namespace detail

/// Geometry of the place X + w; arguments as of a plane. As of a circle in the plane that is perpendicular to the axis.
template <class T, class Start, class Motion, class Read>
PointGeometry<T> against(const Start& X, const Motion& w, const Cylinder& cylinder, const Read& numbers) {
  const detail::AcrossAxis<T, Read> across(cylinder, numbers);
  Vec<T, 3> start, motion;
  for (int i = 0; i < 3; ++i) {
    start[i] = X[i] - numbers(cylinder.point[i]);
    motion[i] = w[i];
  }
  return detail::against_round<T>(across(start), across(motion), T(numbers(cylinder.radius)), cylinder.inside);
}

/// The key of the surface that is wrong where x has no nearest place on it; nullptr where x has one.
template <class Point>
const char* ambiguous_at(const Point& x, const Cylinder& cylinder, const Numbers<double>& numbers) {
  const detail::AcrossAxis<double, Numbers<double>> across(cylinder, numbers);
  Vec<double, 3> arm;
  for (int i = 0; i < 3; ++i) arm[i] = x[i] - numbers(cylinder.point[i]);
  return across(arm).norm() <= 4 * unit_roundoff * arm.norm() ? "cylinder/point" : nullptr;
}

}  // namespace stickslip
