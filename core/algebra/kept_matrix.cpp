#include "core/algebra/kept_matrix.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace stickslip {
namespace {

/// Rows of X side by side, so that one pass over the matrix serves all right-hand sides.
template <class T>
using RowMajor = Eigen::Array<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// r -= A x and s += |A||x| for `columns` vectors stored row by row; A^T instead of A where transposed. K is the
/// number of vectors where it is known at compile time, else 0.
template <int K, class T>
void subtract_product(const Pattern& pattern, const T* values, Taken taken, const RowMajor<T>& x,
                      const RowMajor<double>& size_of_x, RowMajor<T>& r, RowMajor<double>& s) {
  const int k = K > 0 ? K : static_cast<int>(x.cols());
  for (int j = 0; j < pattern.size; ++j)
    for (int e = pattern.column_start[j]; e < pattern.column_start[j + 1]; ++e) {
      const auto to = static_cast<std::ptrdiff_t>(taken == Taken::transposed ? j : pattern.row[e]) * k;
      const auto from = static_cast<std::ptrdiff_t>(taken == Taken::transposed ? pattern.row[e] : j) * k;
      const T a = values[e];
      const double size_of_a = std::abs(a);
      for (int c = 0; c < k; ++c) {
        r.data()[to + c] -= a * x.data()[from + c];
        s.data()[to + c] += size_of_a * size_of_x.data()[from + c];
      }
    }
}

/// Where the entries of A^T are in A, of a pattern that is symmetric; empty of another.
std::vector<int> transposed_entries(const Pattern& pattern) {
  std::vector<int> entry(pattern.row.size()), next(pattern.column_start.begin(), pattern.column_start.end() - 1);
  for (int j = 0; j < pattern.size; ++j)
    for (int e = pattern.column_start[j]; e < pattern.column_start[j + 1]; ++e) {
      const int i = pattern.row[e], place = next[i]++;
      if (place >= pattern.column_start[i + 1] || pattern.row[place] != j) return {};
      entry[place] = e;
    }
  return entry;
}

/// Oettli and Prager's backward error of up to K columns: the largest |b - A x|_i / (|A||x| + |b|)_i. Not a number
/// where an entry of the columns is none. `entry`: where the entries of a column of A^T are; null where A^T is meant,
/// or A is symmetric. One pass that keeps nothing, because a run that solves for many right-hand sides pays for it each
/// time.
template <int K, class T, class Columns>
double oettli_prager(const Pattern& pattern, const T* values, const int* entry, const T* x, const Columns& b) {
  double error = 0;
  const int columns = static_cast<int>(b.cols());
  for (int i = 0; i < pattern.size; ++i) {
    std::array<T, K> rest{};
    std::array<double, K> size{};
    for (int c = 0; c < columns; ++c) {
      rest[c] = b(i, c);
      size[c] = std::abs(rest[c]);
    }
    for (int e = pattern.column_start[i]; e < pattern.column_start[i + 1]; ++e) {
      const T a = values[entry ? entry[e] : e];
      const double size_of_a = std::abs(a);
      const T* of_row = x + static_cast<std::ptrdiff_t>(pattern.row[e]) * K;
      for (int c = 0; c < K; ++c) {
        rest[c] -= a * of_row[c];
        size[c] += size_of_a * std::abs(of_row[c]);
      }
    }
    for (int c = 0; c < columns; ++c)
      if (const double left = std::abs(rest[c]); !(left <= error * size[c])) {
        error = left / size[c];
        if (std::isnan(error)) return error;
      }
  }
  return error;
}

template <class T>
Scaling equilibrate(const Pattern& pattern, const T* values) {
  const auto to_factor = [](double largest) { return largest > 0 ? std::exp2(-std::ilogb(largest)) : 1.0; };
  Scaling scaling{Eigen::VectorXd::Zero(pattern.size), Eigen::VectorXd::Zero(pattern.size)};
  for (int e = 0; e < pattern.nonzeros(); ++e) {
    double& largest = scaling.row[pattern.row[e]];
    largest = std::max(largest, std::abs(values[e]));
  }
  scaling.row = scaling.row.unaryExpr(to_factor);
  for (int j = 0; j < pattern.size; ++j)
    for (int e = pattern.column_start[j]; e < pattern.column_start[j + 1]; ++e)
      scaling.column[j] = std::max(scaling.column[j], scaling.row[pattern.row[e]] * std::abs(values[e]));
  scaling.column = scaling.column.unaryExpr(to_factor);
  return scaling;
}

}  // namespace

template <class T>
void KeptMatrix<T>::take(const T* values) {
  values_.assign(values, values + pattern_->nonzeros());
  scaling_.reset();
}

template <class T>
std::string KeptMatrix<T>::not_finite() const {
  for (int j = 0; j < pattern_->size; ++j)
    for (int e = pattern_->column_start[j]; e < pattern_->column_start[j + 1]; ++e)
      if (!std::isfinite(std::abs(values_[e])))
        return "entry of row " + std::to_string(pattern_->row[e]) + ", column " + std::to_string(j) + " is not finite";
  return "";
}

template <class T>
const Scaling& KeptMatrix<T>::scaling() {
  if (!scaling_) scaling_ = equilibrate(*pattern_, values_.data());
  return *scaling_;
}

template <class T>
double KeptMatrix<T>::one_norm(const Scaling* scaling) const {
  double norm = 0;
  for (int j = 0; j < pattern_->size; ++j) {
    double sum = 0;
    for (int e = pattern_->column_start[j]; e < pattern_->column_start[j + 1]; ++e)
      sum += std::abs(values_[e]) * (scaling ? scaling->row[pattern_->row[e]] * scaling->column[j] : 1.0);
    norm = std::max(norm, sum);
  }
  return norm;
}

template <class T>
double KeptMatrix<T>::backward_error(const Matrix<T>& x, const Matrix<T>& b, Taken taken) {
  const int* entry = nullptr;
  if (!is_stored_by_rows(taken)) {
    if (!by_rows_) by_rows_ = transposed_entries(*pattern_);
    if (by_rows_->empty()) return std::numeric_limits<double>::quiet_NaN();
    entry = by_rows_->data();
  }
  if (b.cols() == 1) return oettli_prager<1>(*pattern_, values_.data(), entry, x.data(), b);
  double error = 0;
  RowMajor<T> side_by_side = RowMajor<T>::Zero(x.rows(), checked_together);
  for (Eigen::Index first = 0; first < b.cols(); first += checked_together) {
    const Eigen::Index count = std::min<Eigen::Index>(checked_together, b.cols() - first);
    side_by_side.leftCols(count) = x.middleCols(first, count).array();
    const double part = oettli_prager<checked_together>(*pattern_, values_.data(), entry, side_by_side.data(),
                                                        b.middleCols(first, count));
    error = larger(error, part);
  }
  return error;
}

template <class T>
typename KeptMatrix<T>::Check KeptMatrix<T>::check(const Matrix<T>& solution, const Matrix<T>& b, Taken taken) {
  Check result{0, Matrix<T>(b.rows(), b.cols())};
  for (Eigen::Index first = 0; first < b.cols(); first += checked_together) {
    const Eigen::Index count = std::min<Eigen::Index>(checked_together, b.cols() - first);
    const Check part = check_columns(solution.middleCols(first, count), b.middleCols(first, count), taken);
    result.error = larger(result.error, part.error);
    result.residual.middleCols(first, count) = part.residual;
  }
  return result;
}

template <class T>
typename KeptMatrix<T>::Check KeptMatrix<T>::check_columns(const Matrix<T>& solution, const Matrix<T>& b, Taken taken) {
  const Taken rows = is_stored_by_rows(taken) ? Taken::transposed : Taken::as_is;  // a gather is faster than a scatter
  const RowMajor<T> x = solution.array();
  const RowMajor<double> size_of_x = x.abs();
  RowMajor<T> r = b.array();
  RowMajor<double> denominator = r.abs();
  if (x.cols() == 1)
    subtract_product<1>(*pattern_, values_.data(), rows, x, size_of_x, r, denominator);
  else if (x.cols() == checked_together)
    subtract_product<checked_together>(*pattern_, values_.data(), rows, x, size_of_x, r, denominator);
  else
    subtract_product<0>(*pattern_, values_.data(), rows, x, size_of_x, r, denominator);
  Check result{0, r.matrix()};
  const auto worst = [&] {
    double error = 0;
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const double size = std::abs(r.data()[i]);
      if (size == 0) continue;
      const double ratio = size / denominator.data()[i];
      if (std::isnan(ratio)) return ratio;
      error = std::max(error, ratio);
    }
    return error;
  };
  result.error = worst();
  if (!(result.error > refine_above)) return result;
  const bool turned = taken == Taken::transposed;
  const Eigen::ArrayXd of_row = (turned ? scaling().column : scaling().row).array();
  const Eigen::ArrayXd of_unknown = (turned ? scaling().row : scaling().column).array();
  // Arioli, Demmel and Duff's tau.
  const double noise = 1000.0 * pattern_->size * std::numeric_limits<double>::epsilon();
  for (Eigen::Index c = 0; c < x.cols(); ++c) {
    const double largest = (size_of_x.col(c) / of_unknown).maxCoeff();
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
      const double size_of_b = std::abs(b(i, c));
      // The largest entry of a scaled row is about one, so ||A_i|| ||x|| is `largest`.
      if (denominator(i, c) * of_row[i] <= noise * (largest + of_row[i] * size_of_b))
        denominator(i, c) += largest / of_row[i] - size_of_b;
    }
  }
  result.error = worst();
  return result;
}

template class KeptMatrix<double>;
template class KeptMatrix<std::complex<double>>;

}  // namespace stickslip
