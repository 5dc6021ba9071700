#include "core/engine/tangent_update.hpp"

#include <Eigen/SVD>
#include <algorithm>

namespace stickslip {
namespace {

constexpr std::size_t most_new = 8;  // in the plane a factorisation is worth 10 to 15 back-solves
constexpr double most_loss = 1e6;
constexpr double negligible = 1e-13;

double norm_1(const Matrix<double>& a) { return a.cwiseAbs().colwise().sum().maxCoeff(); }

/// a^T x of a vector over some rows.
template <class X>
double along(const std::vector<int>& rows, const Vector<double>& a, const X& x) {
  double sum = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i] >= 0) sum += a[i] * x[rows[i]];
  return sum;
}

/// Takes a vector over some rows, times a factor, from x.
template <class X>
void subtract(const std::vector<int>& rows, const Vector<double>& a, double factor, X&& x) {
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i] >= 0) x[rows[i]] -= factor * a[i];
}

void drop_absent_rows(TangentUpdate::Change& change) {
  for (std::size_t i = 0; i < change.rows.size(); ++i)
    if (change.rows[i] < 0) {
      change.block.row(i).setZero();
      change.block.col(i).setZero();
    }
}

}  // namespace

long TangentUpdate::bytes() const {
  Eigen::Index numbers = 0;
  for (const auto& column : columns_)
    numbers += column.block.size() + column.u.size() + column.v.size() + column.z.size();
  return static_cast<long>(numbers * sizeof(double));
}

bool TangentUpdate::take(std::vector<Change> changes, Eigen::Index size, Counters& counters, const Product& solve) {
  std::vector<Column> columns;
  std::vector<std::size_t> fresh;
  for (auto& change : changes) {
    if (!change.block.allFinite()) return false;
    drop_absent_rows(change);
    if (append_kept(change, columns)) continue;
    append_new(std::move(change), columns, fresh);
  }
  const auto count = static_cast<Eigen::Index>(columns.size());
  if (fresh.size() > most_new || columns.size() > most || 8 * count > size) return false;
  Matrix<double> U = Matrix<double>::Zero(size, static_cast<Eigen::Index>(fresh.size()));
  for (std::size_t k = 0; k < fresh.size(); ++k)
    for (std::size_t i = 0; i < columns[fresh[k]].rows.size(); ++i)
      if (const int row = columns[fresh[k]].rows[i]; row >= 0) U(row, k) += columns[fresh[k]].u[i];
  if (!fresh.empty()) {
    const Matrix<double> Z = solve(U);
    counters.backsolves += U.cols();
    for (std::size_t k = 0; k < fresh.size(); ++k) columns[fresh[k]].z = Z.col(k);
  }
  Matrix<double> C(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j) C(i, j) = along(columns[i].rows, columns[i].v, columns[j].z);
  Eigen::PartialPivLU<Matrix<double>> inverse;
  if (count > 0) {
    const double before = std::max(1.0, norm_1(C));  // what cancels where the change makes the tangent singular
    C.diagonal().array() += 1;
    inverse.compute(C);
    const double inverse_norm = 1 / (inverse.rcond() * norm_1(C));
    if (!(inverse_norm * before < most_loss)) return false;
  }
  columns_ = std::move(columns);
  inverse_ = std::move(inverse);
  return true;
}

Matrix<double> TangentUpdate::solve(const Matrix<double>& b, const Product& solve) const {
  Matrix<double> x = solve(b);
  correct(x);
  return x;
}

Matrix<double> TangentUpdate::solve(const Matrix<double>& b, const Product& solve, const Product& multiply) const {
  const Matrix<double> x = this->solve(b, solve);
  Matrix<double> rest = b - multiply(x);
  subtract_product(&Column::u, &Column::v, x, rest);
  return x + this->solve(rest, solve);
}

Matrix<double> TangentUpdate::solve_transposed(const Matrix<double>& b, const Product& solve,
                                               const Product& multiply) const {
  const Matrix<double> x = solve(prepared(b));
  Matrix<double> rest = b - multiply(x);
  subtract_product(&Column::v, &Column::u, x, rest);
  return x + solve(prepared(std::move(rest)));
}

void TangentUpdate::subtract_product(Vector<double> Column::*left, Vector<double> Column::*right,
                                     const Matrix<double>& x, Matrix<double>& rows) const {
  for (const auto& column : columns_)
    for (Eigen::Index c = 0; c < x.cols(); ++c)
      subtract(column.rows, column.*left, along(column.rows, column.*right, x.col(c)), rows.col(c));
}

Matrix<double> TangentUpdate::prepared(Matrix<double> b) const {
  Matrix<double> w(static_cast<Eigen::Index>(columns_.size()), b.cols());
  for (std::size_t k = 0; k < columns_.size(); ++k) w.row(k) = columns_[k].z.transpose() * b;
  w = inverse_.transpose().solve(w).eval();
  for (std::size_t k = 0; k < columns_.size(); ++k)
    for (Eigen::Index c = 0; c < b.cols(); ++c) subtract(columns_[k].rows, columns_[k].v, w(k, c), b.col(c));
  return b;
}

void TangentUpdate::correct(Matrix<double>& x) const {
  Matrix<double> w(static_cast<Eigen::Index>(columns_.size()), x.cols());
  for (std::size_t k = 0; k < columns_.size(); ++k)
    for (Eigen::Index c = 0; c < x.cols(); ++c) w(k, c) = along(columns_[k].rows, columns_[k].v, x.col(c));
  w = inverse_.solve(w).eval();
  for (std::size_t k = 0; k < columns_.size(); ++k) x -= columns_[k].z * w.row(k);
}

bool TangentUpdate::append_kept(const Change& change, std::vector<Column>& columns) const {
  bool found = false;
  for (const auto& column : columns_)
    if (column.point == change.point && column.block == change.block) {
      columns.push_back(column);
      found = true;
    }
  return found;
}

void TangentUpdate::append_new(Change change, std::vector<Column>& columns, std::vector<std::size_t>& fresh) {
  const Eigen::JacobiSVD<Matrix<double>> svd(change.block, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const auto& s = svd.singularValues();
  for (Eigen::Index k = 0; k < s.size() && s[k] > negligible * s[0]; ++k) {
    fresh.push_back(columns.size());
    columns.push_back(
        {change.point, change.rows, change.block, s[k] * svd.matrixU().col(k), svd.matrixV().col(k), Vector<double>()});
  }
}

}  // namespace stickslip
