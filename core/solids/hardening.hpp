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

/// A row of a table of hardening.
struct HardeningRow {
  Number strain, stress;
};

/// The branch that a flow takes. Derivatives at a tie between two take one that is given
/// (sensitivity/ties/flow_tie.hpp).
namespace flow_branch {
inline constexpr int by_values = 0;    ///< that of its values
inline constexpr int none = 1;         ///< stays within the bound
inline constexpr int first_piece = 2;  ///< ends on this piece of the bound, or as many behind it
}  // namespace flow_branch

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

  /// The growth of a, on the piece of the bound where it ends. solve(bound, slope): the growth if the piece with this
  /// slope, and this bound at a, went on for ever. `branch`: a piece, or by_values.
  template <class U, class Solve>
  Growth<U, T> grow(const U& a, Solve&& solve, int branch = flow_branch::by_values) const {
    const bool given = branch >= flow_branch::first_piece;
    for (int k = given ? branch - flow_branch::first_piece : piece_at(value(a));; ++k) {
      Growth<U, T> growth{U(0), bound(k, a), slope_of(k)};
      growth.d = solve(growth.bound, growth.slope);
      if (given || k == piece_count() - 1 || value(a) + value(growth.d) <= value(rows[k].strain)) return growth;
    }
  }

  /// How far a is from the nearest corner, over that one's strain; infinity where there is none.
  double distance_to_corner(double a) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Row& row : rows) least = std::min(least, std::abs(a / value(row.strain) - 1));
    return least;
  }

  int piece_count() const { return static_cast<int>(rows.size()) + 1; }
  /// The piece that a is on; at a corner the one behind it.
  int piece_at(double a) const {
    int k = 0;
    while (k < piece_count() - 1 && a >= value(rows[k].strain)) ++k;
    return k;
  }
  /// Bound at a on piece k, or where that would be if it went on.
  template <class U>
  U bound(int k, const U& a) const {
    if (k == 0) return U(yield) + U(slope_of(k)) * a;
    return U(rows[k - 1].stress) + U(slope_of(k)) * (a - U(rows[k - 1].strain));
  }

 private:
  T slope_of(int k) const {
    if (k == piece_count() - 1) return slope;
    if (k == 0) return (rows[0].stress - yield) / rows[0].strain;
    return (rows[k].stress - rows[k - 1].stress) / (rows[k].strain - rows[k - 1].strain);
  }
};

/// The numbers that decide which branch a flow takes.
template <class T>
struct FlowTrial {
  T stress;         ///< that would be without a flow, as the bound counts it
  T before, after;  ///< a
  T modulus;        ///< that a flow takes off the stress, per growth of a

  /// How far a motion is from where the law has no derivative, the lesser of two distances: of the trial stress from
  /// the bound, over the bound; of a from a corner of the table, over that corner's strain.
  double margin(const Hardening<T>& hardening) const {
    return std::min(std::abs(value(stress) / value(hardening.bound(before)) - 1),
                    hardening.distance_to_corner(value(after)));
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
