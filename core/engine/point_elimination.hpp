/// Elimination of what single contact points determine of a dense system, before it is factorised.
///
///   [ K      B  ] [u]   [f]      K: dense; B, W, D: sparse, blocks of the contact points
///   [ W      D  ] [l] = [g]
///
/// Of a point whose multipliers l_p alone act on its slave node, with blocks as large as a node:
///
///   constraints, rows C in which no multiplier is    u_E = W_CE^-1 g_C - G u_F      one if it slides, all if it sticks
///   rows A: its law of friction, where it slides,    l_p = M_Al^-1 (f_A - M_Au u)   as many as it has multipliers
///   and for the others forces on its slave node
///
/// In the terms of Gauss these are pivots, chosen first because their rows or columns are sparse: what they add to
/// others is a combination of few. The reduced system has the displacements F that no constraint determines: of a point
/// that sticks none, of one that slides those along the surface; and all of points that are left. That is a point whose
/// blocks are nearly singular, and one that shares its slave node.
#pragma once

#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <vector>

#include "core/algebra/linear_solver.hpp"

namespace stickslip {

/// Number of unknowns of a dense system from which points are eliminated. Below it the factor takes no more time than
/// the rest.
inline constexpr Eigen::Index large_dense_system = 400;

template <class T>
class PointElimination {
 public:
  using Sparse = Eigen::SparseMatrix<T>;
  /// Rows of a point in the system: of its slave node's displacements, and of its multipliers.
  struct Point {
    std::vector<int> slave, multipliers;
  };

  /// `displacements`: K; `border`: B, W and D, of the size of the system; `points`: those that may be eliminated. No
  /// other multipliers than its own act on the slave node of each.
  PointElimination(Matrix<T> displacements, Sparse border, const std::vector<Point>& points);

  /// Whether no point was eliminated.
  bool is_empty() const { return multipliers_.size() == 0; }
  /// Whether the reduced system is symmetric where the system is.
  bool keeps_symmetry() const { return rows_.numbers == columns_.numbers; }
  /// What is left, until it is let go.
  const Matrix<T>& reduced() const { return reduced_; }
  void let_reduced_go() { reduced_.resize(0, 0); }
  /// Stored entries of the system, and what is kept of all, in bytes.
  long entries() const { return static_cast<long>(K_.size()) + static_cast<long>(border_.nonZeros()); }
  long bytes() const {
    const auto kept = entries() + constraint_inverse_.nonZeros() + balance_inverse_.nonZeros() + follows_.nonZeros() +
                      passed_on_.nonZeros();
    return static_cast<long>(kept * sizeof(T));
  }
  /// Sign of the determinant of the system over that of the reduced one.
  int sign() const { return sign_; }
  /// The system, or its transpose, times x.
  Matrix<T> times(const Matrix<T>& x, Taken taken) const;
  /// The solution of the system, or of its transpose. `solve_reduced(b)`: that of the reduced one, taken alike.
  template <class Solve>
  Matrix<T> solve(const Matrix<T>& b, Taken taken, Solve&& solve_reduced) const {
    return taken == Taken::transposed ? solve_transposed(b, solve_reduced) : solve_as_is(b, solve_reduced);
  }

 private:
  /// Rows or columns of the system, and where each of these is in the list; -1: it is not.
  struct Subset {
    std::vector<int> numbers, place;
    void set(std::vector<int> of, Eigen::Index size) {
      numbers = std::move(of);
      place.assign(size, -1);
      for (std::size_t k = 0; k < numbers.size(); ++k) place[numbers[k]] = static_cast<int>(k);
    }
    Eigen::Index size() const { return static_cast<Eigen::Index>(numbers.size()); }
  };

  void choose_pivots(const std::vector<Point>& points);
  std::vector<int> balances_of(const std::vector<int>& slave, const std::vector<int>& multipliers,
                               const std::vector<int>& laws) const;
  Matrix<T> entries(const std::vector<int>& rows, const std::vector<int>& columns) const;
  static std::vector<int> chosen(const std::vector<int>& from, std::vector<int> places) {
    for (int& k : places) k = from[k];
    return places;
  }
  Sparse border(const Subset& rows, const Subset& columns) const;
  template <class Solve>
  Matrix<T> solve_as_is(const Matrix<T>& b, Solve& solve_reduced) const;
  template <class Solve>
  Matrix<T> solve_transposed(const Matrix<T>& b, Solve& solve_reduced) const;
  Matrix<T> spread(const Subset& subset, const Matrix<T>& values) const {
    Matrix<T> all = Matrix<T>::Zero(border_.rows(), values.cols());
    all(subset.numbers, Eigen::all) = values;
    return all;
  }

  Matrix<T> K_;
  Sparse border_;
  Subset constraints_, determined_;              ///< rows C, columns E
  Subset balances_, multipliers_;                ///< rows A, columns l
  Subset rows_, columns_;                        ///< those that are left
  Sparse constraint_inverse_, balance_inverse_;  ///< W_CE^-1, M_Al^-1: blocks
  Sparse follows_;                               ///< G
  Sparse passed_on_;                             ///< entries of l in the rows that are left, times M_Al^-1
  Matrix<T> reduced_;
  int sign_ = 1;
};

namespace detail {

/// Columns that make a square block of all rows of a small matrix, by Gauss with complete pivoting; empty if a pivot is
/// less than a hundredth of the largest entry of its row, or a row of rounding beside the others.
template <class T>
std::vector<int> independent_columns(Matrix<T> matrix) {
  constexpr double least = 1e-2, rounding = 1e-8;
  std::vector<int> chosen;
  if (matrix.cols() < matrix.rows() || matrix.size() == 0) return chosen;
  const double largest = matrix.cwiseAbs().maxCoeff();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    const double size = matrix.row(r).cwiseAbs().maxCoeff();
    if (!(size > rounding * largest)) return {};
    matrix.row(r) /= T(size);
  }
  std::vector<char> done(matrix.rows(), 0);
  for (Eigen::Index k = 0; k < matrix.rows(); ++k) {
    Eigen::Index row = -1, column = -1;
    double most = 0;
    for (Eigen::Index r = 0; r < matrix.rows(); ++r)
      for (Eigen::Index c = 0; c < matrix.cols(); ++c)
        if (!done[r] && std::abs(matrix(r, c)) > most) {
          most = std::abs(matrix(r, c));
          row = r;
          column = c;
        }
    if (!(most >= least)) return {};
    done[row] = 1;
    chosen.push_back(static_cast<int>(column));
    for (Eigen::Index r = 0; r < matrix.rows(); ++r)
      if (!done[r]) matrix.row(r) -= matrix(r, column) / matrix(row, column) * matrix.row(row);
    for (Eigen::Index r = 0; r < matrix.rows(); ++r)
      if (!done[r]) matrix(r, column) = T(0);
  }
  return chosen;
}

/// Sign of the permutation that puts these numbers, each once, in order.
inline int sign_of_order(std::vector<int> numbers) {
  int sign = 1;
  for (std::size_t k = 0; k < numbers.size(); ++k)
    while (numbers[k] != static_cast<int>(k)) {
      std::swap(numbers[k], numbers[numbers[k]]);
      sign = -sign;
    }
  return sign;
}

}  // namespace detail

template <class T>
PointElimination<T>::PointElimination(Matrix<T> displacements, Sparse border_of, const std::vector<Point>& points)
    : K_(std::move(displacements)), border_(std::move(border_of)) {
  choose_pivots(points);
  follows_ = constraint_inverse_ * border(constraints_, columns_);
  passed_on_ = border(rows_, multipliers_) * balance_inverse_;
  const auto add_column = [this](int number, const T& factor, Vector<T>& to) {
    if (number < K_.cols()) to.head(K_.rows()) += factor * K_.col(number);
    for (typename Sparse::InnerIterator at(border_, number); at; ++at) to[at.row()] += factor * at.value();
  };
  reduced_.resize(rows_.size(), columns_.size());
  Vector<T> column(border_.rows());
  for (Eigen::Index j = 0; j < columns_.size(); ++j) {
    column.setZero();
    add_column(columns_.numbers[j], T(1), column);
    for (typename Sparse::InnerIterator at(follows_, j); at; ++at)
      add_column(determined_.numbers[at.row()], -at.value(), column);
    reduced_.col(j) = column(rows_.numbers) - passed_on_ * Vector<T>(column(balances_.numbers));
  }
}

template <class T>
Matrix<T> PointElimination<T>::entries(const std::vector<int>& rows, const std::vector<int>& columns) const {
  Matrix<T> block(rows.size(), columns.size());
  for (Eigen::Index i = 0; i < block.rows(); ++i)
    for (Eigen::Index j = 0; j < block.cols(); ++j) block(i, j) = border_.coeff(rows[i], columns[j]);
  return block;
}

/// Rows that determine the multipliers of a point: its laws, then rows of its slave node; empty if these are nearly
/// dependent.
template <class T>
std::vector<int> PointElimination<T>::balances_of(const std::vector<int>& slave, const std::vector<int>& multipliers,
                                                  const std::vector<int>& laws) const {
  std::vector<int> rows = laws, others = multipliers;  // multipliers that no law determines
  Matrix<T> forces = entries(slave, multipliers);
  if (!laws.empty()) {
    const auto own = chosen(multipliers, detail::independent_columns<T>(entries(laws, multipliers)));
    if (own.empty()) return {};
    std::erase_if(others, [&](int k) { return std::find(own.begin(), own.end(), k) != own.end(); });
    if (others.empty()) return rows;
    const Matrix<T> by_law = entries(laws, own).partialPivLu().solve(entries(laws, others));
    forces = entries(slave, others) - entries(slave, own) * by_law;
  }
  const auto pivots = chosen(slave, detail::independent_columns<T>(forces.transpose()));
  if (pivots.empty()) return {};
  rows.insert(rows.end(), pivots.begin(), pivots.end());
  return rows;
}

/// The pivots of each point that has good ones, the inverses of their blocks, and what is left.
template <class T>
void PointElimination<T>::choose_pivots(const std::vector<Point>& points) {
  std::vector<int> C, E, A, L;
  std::vector<Eigen::Triplet<T>> of_constraints, of_balances;
  const auto invert = [this](const Matrix<T>& block, std::size_t first, std::vector<Eigen::Triplet<T>>& all) {
    const Eigen::PartialPivLU<Matrix<T>> lu(block);
    const Matrix<T> inverse = lu.inverse();
    if (value(lu.determinant()) < 0) sign_ = -sign_;
    for (Eigen::Index i = 0; i < inverse.rows(); ++i)
      for (Eigen::Index j = 0; j < inverse.cols(); ++j)
        all.emplace_back(static_cast<int>(first + i), static_cast<int>(first + j), inverse(i, j));
  };
  for (const auto& [slave, multipliers] : points) {
    std::vector<int> constraints, laws;
    for (const int row : multipliers)
      (entries({row}, multipliers).cwiseAbs().maxCoeff() == 0 ? constraints : laws).push_back(row);
    const auto balances = balances_of(slave, multipliers, laws);
    if (balances.empty()) continue;
    // (the same rows and columns if that is well, so that a symmetric system stays so)
    const std::vector<int> forces(balances.begin() + static_cast<std::ptrdiff_t>(laws.size()), balances.end());
    std::vector<int> dofs = chosen(forces, detail::independent_columns<T>(entries(constraints, forces)));
    if (dofs.empty()) dofs = chosen(slave, detail::independent_columns<T>(entries(constraints, slave)));
    if (dofs.size() < constraints.size()) continue;
    if (!constraints.empty()) invert(entries(constraints, dofs), C.size(), of_constraints);
    invert(entries(balances, multipliers), A.size(), of_balances);
    C.insert(C.end(), constraints.begin(), constraints.end());
    E.insert(E.end(), dofs.begin(), dofs.end());
    A.insert(A.end(), balances.begin(), balances.end());
    L.insert(L.end(), multipliers.begin(), multipliers.end());
  }
  const Eigen::Index size = border_.rows();
  const auto left = [size](Subset& pivots, Subset& others, const Subset& rest) {
    std::vector<int> numbers;
    for (int k = 0; k < size; ++k)
      if (pivots.place[k] < 0 && rest.place[k] < 0) numbers.push_back(k);
    others.set(std::move(numbers), size);
  };
  constraints_.set(std::move(C), size);
  determined_.set(std::move(E), size);
  balances_.set(std::move(A), size);
  multipliers_.set(std::move(L), size);
  left(constraints_, rows_, balances_);
  left(determined_, columns_, multipliers_);
  for (const auto& lists :
       {std::array{&constraints_, &balances_, &rows_}, std::array{&determined_, &multipliers_, &columns_}}) {
    std::vector<int> order;
    for (const Subset* list : lists) order.insert(order.end(), list->numbers.begin(), list->numbers.end());
    sign_ *= detail::sign_of_order(std::move(order));
  }
  const auto blocks = [](Eigen::Index count, const std::vector<Eigen::Triplet<T>>& all) {
    Sparse matrix(count, count);
    matrix.setFromTriplets(all.begin(), all.end());
    return matrix;
  };
  constraint_inverse_ = blocks(constraints_.size(), of_constraints);
  balance_inverse_ = blocks(balances_.size(), of_balances);
}

template <class T>
typename PointElimination<T>::Sparse PointElimination<T>::border(const Subset& rows, const Subset& columns) const {
  std::vector<Eigen::Triplet<T>> entries;
  for (Eigen::Index j = 0; j < columns.size(); ++j)
    for (typename Sparse::InnerIterator at(border_, columns.numbers[j]); at; ++at)
      if (rows.place[at.row()] >= 0) entries.emplace_back(rows.place[at.row()], static_cast<int>(j), at.value());
  Sparse part(rows.size(), columns.size());
  part.setFromTriplets(entries.begin(), entries.end());
  return part;
}

template <class T>
Matrix<T> PointElimination<T>::times(const Matrix<T>& x, Taken taken) const {
  const Eigen::Index n = K_.rows();
  const bool transposed = taken == Taken::transposed;
  Matrix<T> product = transposed ? Matrix<T>(border_.transpose() * x) : Matrix<T>(border_ * x);
  product.topRows(n) += transposed ? Matrix<T>(K_.transpose() * x.topRows(n)) : Matrix<T>(K_ * x.topRows(n));
  return product;
}

template <class T>
template <class Solve>
Matrix<T> PointElimination<T>::solve_as_is(const Matrix<T>& b, Solve& solve_reduced) const {
  const Matrix<T> given = constraint_inverse_ * Matrix<T>(b(constraints_.numbers, Eigen::all));
  const Matrix<T> rest = b - times(spread(determined_, given), Taken::as_is);
  const Matrix<T> of_balances = rest(balances_.numbers, Eigen::all);
  const Matrix<T> others = rest(rows_.numbers, Eigen::all) - passed_on_ * of_balances;
  const Matrix<T> left = solve_reduced(others);
  Matrix<T> x = spread(columns_, left);
  x(determined_.numbers, Eigen::all) = given - follows_ * left;
  const Matrix<T> unbalanced = (b - times(x, Taken::as_is))(balances_.numbers, Eigen::all);
  x(multipliers_.numbers, Eigen::all) = balance_inverse_ * unbalanced;
  return x;
}

/// The transposed steps of solve_as_is(), last first.
template <class T>
template <class Solve>
Matrix<T> PointElimination<T>::solve_transposed(const Matrix<T>& b, Solve& solve_reduced) const {
  const Matrix<T> of_multipliers = b(multipliers_.numbers, Eigen::all);
  Matrix<T> x = spread(balances_, balance_inverse_.transpose() * of_multipliers);
  const Matrix<T> rest = b - times(x, Taken::transposed);
  const Matrix<T> determined = rest(determined_.numbers, Eigen::all);
  const Matrix<T> of_columns = rest(columns_.numbers, Eigen::all);
  const Matrix<T> others = of_columns - follows_.transpose() * determined;
  const Matrix<T> left = solve_reduced(others);
  Matrix<T> y = spread(rows_, left);
  y(balances_.numbers, Eigen::all) = -(passed_on_.transpose() * left);
  x += y;
  const Matrix<T> passed = times(y, Taken::transposed)(determined_.numbers, Eigen::all);
  x(constraints_.numbers, Eigen::all) = constraint_inverse_.transpose() * (determined - passed);
  return x;
}

extern template class PointElimination<double>;

}  // namespace stickslip
