/// Numbers of a scene: values that keep their names, so that a parameter can be any of them.
#pragma once

#include <vector>

namespace stickslip {

/// A number of the scene. slot < 0: a constant nobody can differentiate with respect to.
struct Number {
  double value = 0;
  int slot = -1;
  Number() = default;
  Number(double v) : value(v) {}  // NOLINT: scenes are written in C++ too
  Number(double v, int s) : value(v), slot(s) {}
};

/// What a number of a scene must be. (studies/input/ranges.hpp has words and schema of each.)
enum class Range { any, positive, not_negative, poisson_ratio, below_one, above_one };

/// All numbers of a scene in the scalar T.
template <class T>
struct Numbers {
  std::vector<T> at_slot;
  T operator()(const Number& n) const { return n.slot < 0 ? T(n.value) : at_slot[n.slot]; }
};

}  // namespace stickslip
