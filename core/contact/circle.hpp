/// Rigid disk, or the rim of a cup.
#pragma once

#include <array>
#include <tuple>

#include "core/algebra/described.hpp"
#include "core/contact/point_geometry.hpp"

namespace stickslip {

/// `inside`: the outside of a disk is solid, the free space is inside.
struct Circle {
  static constexpr bool is_in_plane = true, is_in_space = false, is_flat = false;
  static constexpr const char *key = "circle", *about = "a drum, or a cup; not in space";
  static constexpr const char* if_turned = R"(look at "inside" of the circle: true is a cup, solid outside)";
  std::array<Number, 2> center;
  Number radius;
  bool inside = false;

  static constexpr auto keys() {
    return std::tuple{Key{&Circle::center, "center", "of the circle (length)", Place2D{{0, 0}}},
                      Key{&Circle::radius, "radius", "of the circle (length)", InRange{Range::positive, 1}},
                      Key{&Circle::inside, "inside", "true: a cup, solid outside of the circle", Flag{}}};
  }
};

namespace detail {

/// Geometry of a place against a circle, a sphere or a cylinder: D is the arm from the centre, or from the axis and
/// across it, to the place of the start, w its displacement likewise. The distance grows by
/// |D + w| - |D| = (2 D + w).w / (|D + w| + |D|), which keeps the digits of w. Singular where D is zero.
template <class T, class Vector>
PointGeometry<T> against_round(const Vector& D, const Vector& w, const T& radius, bool inside) {
  Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 3, 1> n(D.size());
  T twice{};
  for (Eigen::Index i = 0; i < D.size(); ++i) {
    n[i] = D[i] + w[i];
    twice += (D[i] + n[i]) * w[i];
  }
  const T first = norm(D), distance = norm(n), sign(inside ? -1.0 : 1.0);
  for (Eigen::Index i = 0; i < D.size(); ++i) n[i] *= sign / distance;
  return rigid<T>(sign * (first - radius + twice / (distance + first)), n);
}

/// The same with a centre.
template <class T, class Start, class Motion, class Round, class Read>
PointGeometry<T> against_centred(const Start& X, const Motion& w, const Round& round, const Read& numbers) {
  const auto axes = static_cast<Eigen::Index>(round.center.size());
  Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 3, 1> D(axes), moved(axes);
  for (Eigen::Index i = 0; i < axes; ++i) {
    D[i] = X[i] - numbers(round.center[i]);
    moved[i] = w[i];
  }
  return against_round<T>(D, moved, T(numbers(round.radius)), round.inside);
}

}  // namespace detail

/// Geometry of the place X + w; arguments as of a plane.
template <class T, class Start, class Motion, class Read>
PointGeometry<T> against(const Start& X, const Motion& w, const Circle& circle, const Read& numbers) {
  return detail::against_centred<T>(X, w, circle, numbers);
}

/// The key of the surface that is wrong where x has no nearest place on it; nullptr where x has one.
template <class Point>
const char* ambiguous_at(const Point& x, const Circle& circle, const Numbers<double>& numbers) {
  return x[0] == numbers(circle.center[0]) && x[1] == numbers(circle.center[1]) ? "circle/center" : nullptr;
}

}  // namespace stickslip
