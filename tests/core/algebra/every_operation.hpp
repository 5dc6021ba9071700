#pragma once

#include <cmath>

namespace stickslip {

/// Every operation of a scalar in one expression; positive where it meets log, sqrt and pow for x, y in (0.5, 2).
template <class T>
T everything(const T& x, const T& y) {
  using std::cos, std::exp, std::log, std::pow, std::sin, std::sqrt;
  T z = x * y - y / x + T(2);
  z += sqrt(x + T(1));
  z -= exp(-y) * T(0.5);
  z *= T(1) + sin(x * y) * T(0.1);
  z /= log(y + T(2)) + cos(x);
  return pow(z * z + T(1), 1.7) + -x;
}

}  // namespace stickslip
