/// A supernodal Cholesky factor L, as CHOLMOD lays it out, of a matrix whose last rows are kept. The two halves of a
/// solve stop at the kept rows:
///
///   A = [ L_oo       ] [ ... ]^T     reduce:  L_oo y_o = b_o,   r_k = b_k - L_ko y_o
///       [ L_ko  L_kk ]               expand:  L_oo^T x_o = y_o - L_ko^T x_k
///
/// Up to 16 right-hand sides go through L together, the entries of each row side by side in memory. For 8 to 32 of them
/// CHOLMOD's own phases take 1.1 to 2.3 times as long, for a single one 0.8 (docs/decisions.md).
#pragma once

#include <vector>

#include "core/algebra/linear_solver.hpp"

namespace stickslip {

struct Supernodes {
  int count = 0;
  const int* column = nullptr;       ///< the first column of each, and one more
  const int* row_start = nullptr;    ///< where its rows begin
  const int* rows = nullptr;         ///< in the order of elimination; those of its own columns come first
  const int* value_start = nullptr;  ///< where its block begins, column by column; above the diagonal it means nothing
  const double* values = nullptr;
  const int* permutation = nullptr;  ///< row of the matrix at each place of the order
  int size = 0;                      ///< rows of the matrix
  int eliminated = 0;                ///< of these, rows that are not kept

  int columns_of(int s) const { return column[s + 1] - column[s]; }
  int rows_of(int s) const { return row_start[s + 1] - row_start[s]; }
  const int* row_list(int s) const { return rows + row_start[s]; }
  const double* block(int s) const { return values + value_start[s]; }
  bool is_kept(int place) const { return permutation[place] >= eliminated; }
  /// Its columns that are eliminated; the kept ones stand behind them.
  int eliminated_columns_of(int s) const;
  /// Whether in each supernode the kept rows stand behind the others, as the rest asks for.
  bool keep_rows_last() const;

  /// L_kk L_kk^T.
  Matrix<double> schur_complement() const;
  /// y_o, in the order of elimination (other rows mean nothing), and r_k.
  Reduction<double> reduce(const Matrix<double>& b) const;
  /// x_o, in the order of the matrix. `wanted`: rows of it that are asked for; the others may then be zero.
  Matrix<double> expand(const Matrix<double>& kept, const Matrix<double>& y, const std::vector<int>* wanted) const;
  /// Smallest l_kk^2 / a_kk: a pivot over the diagonal entry that it came from. No diagonal scaling changes it.
  /// `diagonal`: of the matrix, by row.
  template <class Diagonal>
  double smallest_pivot(Diagonal&& diagonal) const {
    double smallest = 1;
    for (int s = 0; s < count; ++s)
      for (int k = 0; k < columns_of(s); ++k) {
        const double l = block(s)[static_cast<std::ptrdiff_t>(k) * (rows_of(s) + 1)];
        const double ratio = l * l / diagonal(permutation[column[s] + k]);
        if (!(ratio >= smallest)) smallest = ratio;  // also where it is not a number
      }
    return smallest;
  }

 private:
  /// Supernodes on the way from some rows of the matrix up to the roots of the elimination tree.
  std::vector<char> ancestors_of(const std::vector<int>& wanted) const;
};

}  // namespace stickslip
