#include "core/algebra/supernodes.hpp"

#include <algorithm>

namespace stickslip {
namespace {

/// Right-hand sides, rows in the order of elimination.
template <int width>
using Panel = Eigen::Matrix<double, Eigen::Dynamic, width, Eigen::RowMajor>;
template <int width>
using Row = Eigen::Array<double, width, 1>;

template <int width>
Eigen::Map<Row<width>, Eigen::AlignedMax> row_of(Panel<width>& panel, int place) {
  return Eigen::Map<Row<width>, Eigen::AlignedMax>(panel.data() + static_cast<std::ptrdiff_t>(place) * width);
}

/// Eliminates what is not kept: y_o, and r_k in the rows of what is.
template <int width>
void eliminate(const Supernodes& factor, Panel<width>& y) {
  for (int s = 0; s < factor.count; ++s) {
    const int own = factor.eliminated_columns_of(s), count = factor.rows_of(s), first = factor.column[s];
    const int* const rows = factor.row_list(s);
    const double* const L = factor.block(s);
    for (int i = 0; i < count && own > 0; ++i) {
      Row<width> sum = row_of<width>(y, rows[i]);
      const int before = std::min(i, own);
      for (int j = 0; j < before; ++j)
        sum -= L[i + static_cast<std::ptrdiff_t>(j) * count] * row_of<width>(y, first + j);
      if (i < own) sum /= L[i + static_cast<std::ptrdiff_t>(i) * count];
      row_of<width>(y, rows[i]) = sum;
    }
  }
}

/// The same of one right-hand side, with the same bits: column by column, as the factor is stored.
void eliminate(const Supernodes& factor, Vector<double>& y) {
  Vector<double> own_rows(factor.size);
  for (int s = 0; s < factor.count; ++s) {
    const int own = factor.eliminated_columns_of(s), count = factor.rows_of(s);
    if (own == 0) continue;
    const int* const rows = factor.row_list(s);
    for (int i = 0; i < count; ++i) own_rows[i] = y[rows[i]];
    for (int j = 0; j < own; ++j) {
      const double* const L = factor.block(s) + static_cast<std::ptrdiff_t>(j) * count;
      const double solved = own_rows[j] /= L[j];
      for (int i = j + 1; i < count; ++i) own_rows[i] -= L[i] * solved;
    }
    for (int i = 0; i < count; ++i) y[rows[i]] = own_rows[i];
  }
}

/// Replaces y_o by x_o in marked supernodes; the rows of what is kept are x_k.
template <int width>
void substitute_back(const Supernodes& factor, const std::vector<char>& marked, Panel<width>& y) {
  for (int s = factor.count - 1; s >= 0; --s) {
    const int own = factor.eliminated_columns_of(s), count = factor.rows_of(s), first = factor.column[s];
    const int* const rows = factor.row_list(s);
    for (int j = own - 1; j >= 0 && marked[s]; --j) {
      const double* const L = factor.block(s) + static_cast<std::ptrdiff_t>(j) * count;
      Row<width> sum = row_of<width>(y, first + j);
      for (int i = j + 1; i < count; ++i) sum -= L[i] * row_of<width>(y, rows[i]);
      row_of<width>(y, first + j) = sum / L[j];
    }
  }
}

/// Calls f(panel of so many columns, first column, their number) for all of some columns, most of them 16 by 16.
template <class F>
void for_each_panel(Eigen::Index rows, Eigen::Index columns, F&& f) {
  for (Eigen::Index first = 0; first < columns; first += 16) {
    const Eigen::Index count = std::min<Eigen::Index>(16, columns - first);
    if (count > 8)
      f(Panel<16>(rows, 16), first, count);
    else if (count > 4)
      f(Panel<8>(rows, 8), first, count);
    else
      f(Panel<4>(rows, 4), first, count);
  }
}

}  // namespace

int Supernodes::eliminated_columns_of(int s) const {
  int own = columns_of(s);
  while (own > 0 && is_kept(column[s] + own - 1)) --own;
  return own;
}

bool Supernodes::keep_rows_last() const {
  for (int s = 0; s < count; ++s)
    if (!std::is_sorted(row_list(s), row_list(s) + rows_of(s), [&](int a, int b) { return !is_kept(a) && is_kept(b); }))
      return false;
  return true;
}

Matrix<double> Supernodes::schur_complement() const {
  const int kept = size - eliminated;
  Matrix<double> L = Matrix<double>::Zero(kept, kept), complement = L;
  Eigen::Index to = 0;
  for (int s = 0; s < count; ++s)
    for (int k = eliminated_columns_of(s); k < columns_of(s); ++k, ++to)
      for (int i = k; i < rows_of(s); ++i)
        L(permutation[row_list(s)[i]] - eliminated, to) = block(s)[i + static_cast<std::ptrdiff_t>(k) * rows_of(s)];
  complement.selfadjointView<Eigen::Lower>().rankUpdate(L);
  complement.triangularView<Eigen::StrictlyUpper>() = complement.transpose();
  return complement;
}

Reduction<double> Supernodes::reduce(const Matrix<double>& b) const {
  Reduction<double> reduced{Matrix<double>(size - eliminated, b.cols()), Matrix<double>(size, b.cols())};
  if (b.cols() == 1) {
    Vector<double> y(size);
    for (int k = 0; k < size; ++k) y[k] = b(permutation[k], 0);
    eliminate(*this, y);
    for (int k = 0; k < size; ++k)
      if (is_kept(k)) reduced.kept(permutation[k] - eliminated, 0) = y[k];
    reduced.others = y;
    return reduced;
  }
  for_each_panel(size, b.cols(), [&]<int width>(Panel<width> y, Eigen::Index first, Eigen::Index columns) {
    if (columns < width) y.setZero();
    for (int k = 0; k < size; ++k)
      for (Eigen::Index c = 0; c < columns; ++c) y(k, c) = b(permutation[k], first + c);
    eliminate<width>(*this, y);
    for (int k = 0; k < size; ++k) {
      for (Eigen::Index c = 0; c < columns; ++c) reduced.others(k, first + c) = y(k, c);
      if (is_kept(k))
        for (Eigen::Index c = 0; c < columns; ++c) reduced.kept(permutation[k] - eliminated, first + c) = y(k, c);
    }
  });
  return reduced;
}

Matrix<double> Supernodes::expand(const Matrix<double>& kept, const Matrix<double>& others,
                                  const std::vector<int>* wanted) const {
  const auto marked = wanted ? ancestors_of(*wanted) : std::vector<char>(count, true);
  Matrix<double> x = Matrix<double>::Zero(eliminated, others.cols());
  const auto for_each_place = [&](auto&& f) {  // (what is not marked is not read either)
    for (int s = 0; s < count; ++s)
      for (int k = column[s]; k < column[s + 1] && marked[s]; ++k) f(k);
  };
  for_each_panel(size, others.cols(), [&]<int width>(Panel<width> y, Eigen::Index first, Eigen::Index columns) {
    if (columns < width) y.setZero();
    for_each_place([&](int k) {
      for (Eigen::Index c = 0; c < columns; ++c)
        y(k, c) = is_kept(k) ? kept(permutation[k] - eliminated, first + c) : others(k, first + c);
    });
    substitute_back<width>(*this, marked, y);
    for_each_place([&](int k) {
      for (Eigen::Index c = 0; c < columns && !is_kept(k); ++c) x(permutation[k], first + c) = y(k, c);
    });
  });
  return x;
}

std::vector<char> Supernodes::ancestors_of(const std::vector<int>& wanted) const {
  std::vector<char> is_wanted(size, false), marked(count, false);
  for (int row : wanted) is_wanted[row] = true;
  std::vector<int> supernode_of(size);
  for (int s = 0; s < count; ++s)
    for (int k = column[s]; k < column[s + 1]; ++k) {
      supernode_of[k] = s;
      if (is_wanted[permutation[k]]) marked[s] = true;
    }
  for (int s = 0; s < count; ++s)  // (a parent stands behind its children)
    if (marked[s] && columns_of(s) < rows_of(s)) marked[supernode_of[row_list(s)[columns_of(s)]]] = true;
  return marked;
}

}  // namespace stickslip
