/// Eigen: supernodal LU factorisation P R A Q = L U, R the row scaling; in any scalar, with nothing to link.
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <new>

#include "core/algebra/backend.hpp"

namespace stickslip {

template <class T>
struct EigenFactor<T>::Data {
  using Sparse = Eigen::SparseMatrix<T, Eigen::ColMajor, int>;
  std::shared_ptr<const Pattern> pattern;
  Sparse matrix;              ///< R A
  Eigen::VectorXd row_scale;  ///< R: powers of two, so that scaling rounds nothing
  Eigen::SparseLU<Sparse, Eigen::COLAMDOrdering<int>> lu;

  /// Smallest |u_kk| over the largest entry of the row-scaled column it came from.
  double smallest_pivot() const {
    const auto& upper = lu.matrixL().m_mapL;  // the supernodes hold the diagonal blocks of U
    double smallest = 1;
    for (int j = 0; j < pattern->size; ++j) {
      const int k = lu.colsPermutation().indices()[j];
      double largest = 0, pivot = 0;
      for (typename Sparse::InnerIterator it(matrix, j); it; ++it) largest = std::max(largest, std::abs(it.value()));
      for (typename std::decay_t<decltype(upper)>::InnerIterator it(upper, k); it; ++it)
        if (it.row() == k) pivot = std::abs(it.value());
      const double ratio = pivot / largest;
      if (!(ratio >= smallest)) smallest = ratio;  // also where it is not a number
    }
    return smallest;
  }

  /// Sign of the real part of the phase of det A. (SparseLU has it for real matrices alone.)
  int determinant_sign() const {
    const auto& upper = lu.matrixL().m_mapL;
    T phase(static_cast<double>(lu.rowsPermutation().determinant() * lu.colsPermutation().determinant()));
    for (int k = 0; k < pattern->size; ++k)
      for (typename std::decay_t<decltype(upper)>::InnerIterator it(upper, k); it; ++it)
        if (it.row() == k) phase *= it.value() / std::abs(it.value());
    return std::real(phase) < 0 ? -1 : 1;
  }
};

template <class T>
EigenFactor<T>::EigenFactor(std::shared_ptr<const Pattern> pattern) : data_(std::make_shared<Data>()) {
  Data& d = *data_;
  d.pattern = std::move(pattern);
  const Pattern& p = *d.pattern;
  const std::vector<T> ones(p.row.size(), T(1));
  d.matrix = Eigen::Map<const typename Data::Sparse>(p.size, p.size, p.nonzeros(), p.column_start.data(), p.row.data(),
                                                     ones.data());
  d.lu.analyzePattern(d.matrix);
}

template <class T>
Factorisation EigenFactor<T>::factorise(const T* values) {
  using Outcome = Factorisation::Outcome;
  Data& d = *data_;
  const Pattern& p = *d.pattern;
  d.row_scale.setZero(p.size);
  for (int e = 0; e < p.nonzeros(); ++e) d.row_scale[p.row[e]] = std::max(d.row_scale[p.row[e]], std::abs(values[e]));
  for (int i = 0; i < p.size; ++i) {
    if (!(d.row_scale[i] > 0)) return {Outcome::singular, "row " + std::to_string(i) + " is zero"};
    d.row_scale[i] = std::exp2(-std::ilogb(d.row_scale[i]));
  }
  std::vector<bool> filled(p.size, false);
  for (int j = 0; j < p.size; ++j)
    for (int e = p.column_start[j]; e < p.column_start[j + 1]; ++e) {
      d.matrix.valuePtr()[e] = d.row_scale[p.row[e]] * values[e];
      if (std::abs(values[e]) > 0) filled[j] = true;
    }
  const auto empty = std::find(filled.begin(), filled.end(), false);
  if (empty != filled.end())
    return {Outcome::singular, "column " + std::to_string(empty - filled.begin()) + " is zero"};
  d.lu.factorize(d.matrix);
  if (d.lu.lastErrorMessage().find("MEMORY") != std::string::npos) throw std::bad_alloc();
  if (d.lu.info() != Eigen::Success) {
    // The elimination stopped at the last row that got a place; the column there is the one without a pivot.
    const int step = d.lu.rowsPermutation().indices().maxCoeff();
    const auto& order = d.lu.colsPermutation().indices();
    const auto column = std::find(order.begin(), order.end(), step) - order.begin();
    return {Outcome::singular, "pivot of column " + std::to_string(column) + " is zero"};
  }
  return {Outcome::done, "", d.smallest_pivot(), d.determinant_sign()};
}

template <class T>
void EigenFactor<T>::solve(const Matrix<T>& b, Matrix<T>& x, Taken taken) {
  Data& d = *data_;
  if (taken == Taken::transposed) {
    x = d.lu.transpose().solve(b);  // (R A)^T y = b, x = R y
    x = d.row_scale.asDiagonal() * x;
  } else {
    x = d.lu.solve(Matrix<T>(d.row_scale.asDiagonal() * b));
  }
}

template <class T>
std::string EigenFactor<T>::name() const {
  return eigen_library() + " SparseLU, COLAMD";
}

template <class T>
long EigenFactor<T>::factor_nonzeros() const {
  return static_cast<long>(data_->lu.nnzL() + data_->lu.nnzU());
}

template <class T>
long EigenFactor<T>::factor_bytes() const {
  return factor_nonzeros() * static_cast<long>(sizeof(T) + sizeof(int));
}

std::string eigen_library() {
  return "Eigen " + std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "." +
         std::to_string(EIGEN_MINOR_VERSION);
}

template class EigenFactor<double>;
template class EigenFactor<std::complex<double>>;

}  // namespace stickslip
