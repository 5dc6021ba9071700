/// Isotropic hardening: the stress that bounds a flow, over the equivalent plastic strain a.
///
///   bound(a) = yield + slope a;  with a table straight from (0, yield) to its first row, from row to row, and of the
///   slope behind the last
///
/// A flow ends on one of the straight pieces. Where it ends at a corner between two, it has no derivative.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/algebra/number.hpp"
#include "core/algebra/scalar.hpp"

namespace stickslip {

/// A row of a table, as a scene gives it.
struct HardeningRow {
  Number strain, stress;
};

/// How far a flow goes: the growth d of a, on the piece of this slope that has this bound where the flow began.
template <class U, class T>
struct Growth {
  U d, bound;
  T slope;
};

template <class T>
struct Hardening {
  struct Row {
    T strain, stress;
  };

  T yield, slope;
  std::vector<Row> rows = {};  ///< strains increase from above 0, stresses do not fall

  template <class U>
  U bound(const U& a) const {
    return bound(piece_at(value(a)), a);
  }

  /// The growth from a that solve(bound, slope) finds on the piece that it ends on. `solve`: the growth where this
  /// piece goes on for ever, with its bound at a.
  template <class U, class Solve>
  Growth<U, T> grow(const U& a, Solve&& solve) const {
    for (int k = piece_at(value(a));; ++k) {
      Growth<U, T> growth{U(0), bound(k, a), slope_of(k)};
      growth.d = solve(growth.bound, growth.slope);
      if (k == piece_count() - 1 || value(a) + value(growth.d) <= value(rows[k].strain)) return growth;
    }
  }

  /// How far a is from the nearest corner, over that one's strain; infinity where there is none.
  double distance_to_corner(double a) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Row& row : rows) least = std::min(least, std::abs(a / value(row.strain) - 1));
    return least;
  }

 private:
  int piece_count() const { return static_cast<int>(rows.size()) + 1; }
  /// The piece that a is on; at a corner the one behind it.
  int piece_at(double a) const {
    int k = 0;
    while (k < piece_count() - 1 && a >= value(rows[k].strain)) ++k;
    return k;
  }
  T slope_of(int k) const {
    if (k == piece_count() - 1) return slope;
    if (k == 0) return (rows[0].stress - yield) / rows[0].strain;
    return (rows[k].stress - rows[k - 1].stress) / (rows[k].strain - rows[k - 1].strain);
  }
  template <class U>
  U bound(int k, const U& a) const {
    if (k == 0) return U(yield) + U(slope_of(k)) * a;
    return U(rows[k - 1].stress) + U(slope_of(k)) * (a - U(rows[k - 1].strain));
  }
};

/// Of a scene's numbers.
template <class T>
Hardening<T> hardening_of(const Number& yield, const Number& slope, const std::vector<HardeningRow>& rows,
                          const Numbers<T>& numbers) {
  Hardening<T> hardening{numbers(yield), numbers(slope)};
  for (const HardeningRow& row : rows) hardening.rows.push_back({numbers(row.strain), numbers(row.stress)});
  return hardening;
}

}  // namespace stickslip
