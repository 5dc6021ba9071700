/// Gregory patches of a smooth surface over triangles and quadrilaterals: their basis functions, and their control
/// points as weights of the nodes. Formulas and sources: gregory.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/contact/surface.hpp"

namespace stickslip::detail {

/// A quadrilateral has 20 control points, a triangle 15; in this order, and each for corner 0, 1, ...: the corner, the
/// point on the edge to the next corner, that on the edge to the corner before, the inner point of the first edge, that
/// of the second.
inline constexpr int points_per_corner = 5;

template <class T>
struct Basis {
  std::array<T, 4 * points_per_corner> value{}, along_s{}, along_t{};
};

/// Basis functions and their derivatives by s and t at a place of a patch, not beyond its edges.
template <class T>
Basis<T> gregory_basis(int corners, const T& s, const T& t);

/// Sets the control points of patches that are joined: `across`, `goes_on`. Corners of borders: per vertex.
void set_control_points(Surface<3>& patches, Smoothing smoothing, const std::vector<char>& is_corner);

/// One function of two coordinates, with its slopes.
template <class T>
struct Sloped {
  T value, along_s, along_t;
  friend Sloped operator*(const Sloped& f, const Sloped& g) {
    return {f.value * g.value, f.along_s * g.value + f.value * g.along_s, f.along_t * g.value + f.value * g.along_t};
  }
  friend Sloped operator+(const Sloped& f, const Sloped& g) {
    return {f.value + g.value, f.along_s + g.along_s, f.along_t + g.along_t};
  }
  friend Sloped operator*(double factor, const Sloped& f) {
    const T by(factor);
    return {by * f.value, by * f.along_s, by * f.along_t};
  }
};

/// s^2 t / (s + t) of s, t >= 0, but for rounding. Only the ratio a = s / (s + t) is divided. The second derivatives
/// 2 b^3, a^2 (1 + 2 b), -2 a^3 with b = 1 - a depend on a alone. At the corner, where every direction has its own,
/// they are those of a = 1/2.
template <class T>
Sloped<T> corner_bump(const Sloped<T>& s, const Sloped<T>& t) {
  constexpr double at_corner = 1e-9;
  T phi, by_s, by_t;
  if (value(s.value) + value(t.value) > at_corner) {
    const T a = s.value / (s.value + t.value), b = T(1) - a;
    phi = s.value * t.value * a;
    by_s = s.value * b * (T(1) + b);
    by_t = s.value * a * a;
  } else {
    const T ss(0.25), st(0.5), tt(-0.25);
    by_s = ss * s.value + st * t.value;
    by_t = st * s.value + tt * t.value;
    phi = T(0.5) * (by_s * s.value + by_t * t.value);
  }
  return {phi, by_s * s.along_s + by_t * t.along_s, by_s * s.along_t + by_t * t.along_t};
}

template <class T>
Basis<T> gregory_basis(int corners, const T& s, const T& t) {
  const T zero(0), one(1);
  const Sloped<T> unit{one, zero, zero};
  const auto complement = [&](const Sloped<T>& f) { return unit + -1.0 * f; };
  const Sloped<T> u{s, one, zero}, v{t, zero, one}, w = complement(u + v);
  Basis<T> basis;
  const auto set = [&](int kind, int corner, const Sloped<T>& f) {
    const int k = kind * corners + corner;
    basis.value[k] = f.value;
    basis.along_s[k] = f.along_s;
    basis.along_t[k] = f.along_t;
  };
  for (int j = 0; j < corners; ++j) {
    if (corners == 4) {  // x, y: along the edges to the next corner and to the one before
      const Sloped<T> x = j == 0 ? u : j == 1 ? v : complement(j == 2 ? u : v);
      const Sloped<T> y = j == 0 ? v : j == 3 ? u : complement(j == 1 ? u : v);
      const auto from_x = complement(x), from_y = complement(y);
      const auto xx = from_x * from_x, yy = from_y * from_y;
      set(0, j, xx * from_x * yy * from_y);
      set(1, j, 3.0 * x * xx * yy * from_y);
      set(2, j, 3.0 * y * yy * xx * from_x);
      set(3, j, 9.0 * xx * yy * corner_bump(x, y));
      set(4, j, 9.0 * xx * yy * corner_bump(y, x));
    } else {  // barycentric: `here` is 1 at the corner, x at the next, y at the one before
      const std::array<Sloped<T>, 3> at{w, u, v};
      const auto &here = at[j], &x = at[(j + 1) % 3], &y = at[(j + 2) % 3];
      const auto square = here * here, cube = square * here;
      set(0, j, cube * (here + x + y));
      set(1, j, 3.0 * square * x * (here + x));
      set(2, j, 3.0 * square * y * (here + y));
      set(3, j, 12.0 * square * corner_bump(x, y));
      set(4, j, 12.0 * square * corner_bump(y, x));
    }
  }
  return basis;
}

}  // namespace stickslip::detail
