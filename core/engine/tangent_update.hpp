/// A tangent that differs from a factorised one, K, at few contact points: K + U V^T, with one column for each rank of
/// the change of a point. Fronts of slip run over a side a few points an iteration; each new column costs a back-solve
/// where a factorisation would cost tens of them. Sherman, Morrison and Woodbury:
///
///   (K + U V^T)^-1 b = y - Z C^-1 V^T y,   y = K^-1 b,  Z = K^-1 U,  C = I + V^T Z
///
/// its transpose  (K + U V^T)^-T b = K^-T (b - V C^-T Z^T b),  and det(K + U V^T) = det K det C. W. W. Hager, Updating
/// the inverse of a matrix, SIAM Rev. 31 (1989) 221-239.
#pragma once

#include <Eigen/LU>
#include <functional>
#include <vector>

#include "core/algebra/scalar.hpp"
#include "core/model/result.hpp"

namespace stickslip {

class TangentUpdate {
 public:
  using Product = std::function<Matrix<double>(const Matrix<double>&)>;  ///< of a matrix, or of its inverse
  static constexpr std::size_t most = 32;                                ///< columns: Z is to stay small

  /// What one point changes: `block` over its rows of the factor, -1: not there.
  struct Change {
    int point = 0;
    std::vector<int> rows;
    Matrix<double> block;
  };

  void clear() {
    columns_.clear();
    inverse_ = {};
  }
  bool empty() const { return columns_.empty(); }
  long bytes() const;  ///< of the columns
  /// Whether det C is negative.
  bool turns_sign() const { return !empty() && inverse_.determinant() < 0; }

  /// Takes the changes in place of those before; solve(U) = K^-1 U, K of `size` rows. False, and nothing is taken,
  /// where a factorisation is cheaper, or the change loses more than six digits: |C^-1| max(1, |V^T Z|) > 1e6.
  bool take(std::vector<Change> changes, Eigen::Index size, Counters& counters, const Product& solve);

  /// (K + U V^T)^-1 b. What K^-1 loses is multiplied by what C^-1 does. solve(b) = K^-1 b.
  Matrix<double> solve(const Matrix<double>& b, const Product& solve) const;
  /// The same refined once, for another solve. multiply(x) = K x.
  Matrix<double> solve(const Matrix<double>& b, const Product& solve, const Product& multiply) const;
  /// (K + U V^T)^-T b, refined once. solve(b) = K^-T b, multiply(x) = K^T x.
  Matrix<double> solve_transposed(const Matrix<double>& b, const Product& solve, const Product& multiply) const;

 private:
  struct Column {
    int point = 0;
    std::vector<int> rows;
    Matrix<double> block;  // the point's, to tell whether it changed again
    Vector<double> u, v;   // over `rows`
    Vector<double> z;      // K^-1 u, all rows
  };

  /// K^-1 b -> (K + U V^T)^-1 b, column by column.
  void correct(Matrix<double>& x) const;
  /// b -> b - V C^-T Z^T b.
  Matrix<double> prepared(Matrix<double> b) const;
  /// Takes left right^T x, `left` and `right` being U and V or V and U, from rows.
  void subtract_product(Vector<double> Column::*left, Vector<double> Column::*right, const Matrix<double>& x,
                        Matrix<double>& rows) const;

  bool append_kept(const Change& change, std::vector<Column>& columns) const;
  static void append_new(Change change, std::vector<Column>& columns, std::vector<std::size_t>& fresh);

  std::vector<Column> columns_;
  Eigen::PartialPivLU<Matrix<double>> inverse_;
};

}  // namespace stickslip
