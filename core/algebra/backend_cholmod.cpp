/// CHOLMOD: supernodal Cholesky factorisation A = L L^T of symmetric positive definite matrices.
#include "core/algebra/backend.hpp"

#ifdef STICKSLIP_WITH_CHOLMOD

#include <cholmod.h>

#include <algorithm>
#include <new>
#include <stdexcept>

// OpenMP's, where CHOLMOD was built with it, null elsewhere.
extern "C" {
__attribute__((weak)) int omp_get_max_active_levels();
__attribute__((weak)) void omp_set_max_active_levels(int);
}

namespace stickslip {
namespace {

/// While it lives, OpenMP takes one thread. CHOLMOD asks for four in its supernodes, whatever the machine has, to add
/// up what takes microseconds: on 2 cores a factorisation of 20 000 unknowns took 74 ms of CPU with them, 20 without.
class OneThread {
 public:
  OneThread() {
    if (omp_set_max_active_levels) omp_set_max_active_levels(0);
  }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;
  ~OneThread() {
    if (omp_set_max_active_levels) omp_set_max_active_levels(before_);
  }

 private:
  int before_ = omp_get_max_active_levels ? omp_get_max_active_levels() : 0;
};

}  // namespace

struct CholmodFactor::Data {
  std::shared_ptr<const Pattern> pattern;
  int kept = 0;               ///< rows at the end that are eliminated last
  FactorSize size;            ///< by the analysis
  std::vector<int> diagonal;  ///< place of entry (j, j), -1 where the pattern has none
  cholmod_common common;
  cholmod_factor* factor = nullptr;
  // Workspaces of cholmod_solve2, kept from one solve to the next.
  cholmod_dense* x = nullptr;
  cholmod_dense* y = nullptr;
  cholmod_dense* e = nullptr;

  Data(std::shared_ptr<const Pattern> p, int k) : pattern(std::move(p)), kept(k) {
    cholmod_start(&common);
    common.print = 0;
    common.error_handler = nullptr;
    common.try_catch = true;  // no text on stdout: the status is read after each call
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.quick_return_if_not_posdef = true;
  }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;
  ~Data() {
    cholmod_free_dense(&x, &common);
    cholmod_free_dense(&y, &common);
    cholmod_free_dense(&e, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }

  /// The whole matrix as CHOLMOD sees it: stype < 0 makes it skip the upper triangle, so nothing is copied.
  cholmod_sparse matrix(const double* values) const {
    cholmod_sparse a{};
    a.nrow = a.ncol = static_cast<std::size_t>(pattern->size);
    a.nzmax = pattern->row.size();
    a.p = const_cast<int*>(pattern->column_start.data());  // CHOLMOD has no const; it does not write
    a.i = const_cast<int*>(pattern->row.data());
    a.x = const_cast<double*>(values);
    a.stype = -1;
    a.itype = CHOLMOD_INT;
    a.xtype = values ? CHOLMOD_REAL : CHOLMOD_PATTERN;
    a.dtype = CHOLMOD_DOUBLE;
    a.sorted = true;
    a.packed = true;
    return a;
  }

  void check(const char* what) const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE) throw std::bad_alloc();
    if (common.status < CHOLMOD_OK)
      throw std::runtime_error("CHOLMOD could not " + std::string(what) + " the matrix (status " +
                               std::to_string(common.status) + ")");
  }

  /// AMD; METIS too, and the better of the two, where AMD's factor costs over 500 flops an entry and fills in
  /// fivefold: in 3D it does, in 2D METIS takes ten times the analysis for a tie. With kept rows an AMD that is told to
  /// leave them for the end: a seventh more fill than without.
  void analyse() {
    cholmod_sparse a = matrix(nullptr);
    if (kept == 0) {
      common.nmethods = 0;
      factor = cholmod_analyze(&a, &common);
    } else {
      std::vector<int> order(pattern->size), last(pattern->size, 0);
      std::fill(last.end() - kept, last.end(), 1);
      cholmod_camd(&a, nullptr, 0, last.data(), order.data(), &common);
      check("order");
      common.nmethods = 1;
      common.method[0].ordering = CHOLMOD_GIVEN;
      factor = cholmod_analyze_p(&a, order.data(), nullptr, 0, &common);
      if (factor && !keeps_rows_last()) {
        cholmod_free_factor(&factor, &common);
        for (auto& columns : common.nrelax) columns = 0;
        for (auto& zeros : common.zrelax) zeros = 0;
        factor = cholmod_analyze_p(&a, order.data(), nullptr, 0, &common);
      }
      if (factor && !keeps_rows_last()) throw std::runtime_error("CHOLMOD does not leave the kept rows for the end");
    }
    check("analyse");
    size = {common.fl, common.lnz};
  }

  /// Whether in each supernode the kept rows stand behind the others. Supernodes that are joined for speed, at the
  /// price of stored zeros, may join those of two bodies.
  bool keeps_rows_last() const {
    const auto* pi = static_cast<const int*>(factor->pi);
    const auto* rows = static_cast<const int*>(factor->s);
    const auto* permutation = static_cast<const int*>(factor->Perm);
    const int eliminated = pattern->size - kept;
    for (std::size_t s = 0; factor->is_super && s < factor->nsuper; ++s)
      if (!std::is_sorted(rows + pi[s], rows + pi[s + 1],
                          [&](int a, int b) { return permutation[a] < eliminated && permutation[b] >= eliminated; }))
        return false;
    return true;
  }

  /// Replaces b by x of L x = b (cholmod_super_lsolve) or L^T x = b (cholmod_super_ltsolve), rows in the order of
  /// elimination.
  template <class Triangle>
  void solve_triangle(Triangle&& solve, Matrix<double>& b) {
    cholmod_dense columns = view(b);
    const bool done = cholmod_ensure_dense(&e, columns.ncol, factor->maxesize, columns.ncol, CHOLMOD_REAL, &common) &&
                      solve(factor, &columns, e, &common);
    if (!done) throw std::bad_alloc();  // the factor is good, so nothing else can go wrong
  }

  static cholmod_dense view(const Matrix<double>& b) {
    cholmod_dense rhs{};
    rhs.nrow = rhs.d = static_cast<std::size_t>(b.rows());
    rhs.ncol = static_cast<std::size_t>(b.cols());
    rhs.nzmax = rhs.nrow * rhs.ncol;
    rhs.x = const_cast<double*>(b.data());  // CHOLMOD has no const; it writes where it solves in place
    rhs.xtype = CHOLMOD_REAL;
    rhs.dtype = CHOLMOD_DOUBLE;
    return rhs;
  }

  /// Calls f(first column, their number, the rows of each as kept ones, L of these rows and columns) for all columns of
  /// L that belong to kept rows, supernode by supernode. No kept row has an eliminated one after it in its tree, but
  /// one tree may stand before another: each body has its own. The upper triangle of L means nothing.
  template <class F>
  void for_each_kept_block(F&& f) const {
    using Block = Eigen::Map<const Matrix<double>, 0, Eigen::OuterStride<>>;
    const auto* x_of = static_cast<const double*>(factor->x);
    const auto* super = static_cast<const int*>(factor->super);
    const auto* pi = static_cast<const int*>(factor->pi);
    const auto* px = static_cast<const int*>(factor->px);
    const auto* rows = static_cast<const int*>(factor->s);
    const auto* permutation = static_cast<const int*>(factor->Perm);
    const int eliminated = pattern->size - kept;
    std::vector<int> places;
    for (std::size_t s = 0; s < factor->nsuper; ++s) {
      int first = super[s];
      while (first < super[s + 1] && permutation[first] < eliminated) ++first;
      if (first == super[s + 1]) continue;
      const int local = first - super[s], count = pi[s + 1] - pi[s];
      places.clear();
      for (int i = local; i < count; ++i) places.push_back(permutation[rows[pi[s] + i]] - eliminated);
      f(first, super[s + 1] - first, places,
        Block(x_of + px[s] + static_cast<std::ptrdiff_t>(local) * (count + 1), count - local, super[s + 1] - first,
              Eigen::OuterStride<>(count)));
    }
  }

  /// Supernodes on the way from some rows (as in the pattern) up to the roots of the elimination tree.
  std::vector<char> ancestors_of(const std::vector<int>& wanted) const {
    const auto* super = static_cast<const int*>(factor->super);
    const auto* pi = static_cast<const int*>(factor->pi);
    const auto* rows = static_cast<const int*>(factor->s);
    const auto* permutation = static_cast<const int*>(factor->Perm);
    std::vector<char> is_wanted(pattern->size, false), marked(factor->nsuper, false);
    for (int row : wanted) is_wanted[row] = true;
    std::vector<int> supernode_of(pattern->size);
    for (std::size_t s = 0; s < factor->nsuper; ++s)
      for (int k = super[s]; k < super[s + 1]; ++k) {
        supernode_of[k] = static_cast<int>(s);
        if (is_wanted[permutation[k]]) marked[s] = true;
      }
    for (std::size_t s = 0; s < factor->nsuper; ++s) {  // (a parent stands behind its children)
      const int parent = pi[s] + super[s + 1] - super[s];
      if (marked[s] && parent < pi[s + 1]) marked[supernode_of[rows[parent]]] = true;
    }
    return marked;
  }

  /// Replaces y by x of L^T x = y, rows in the order of elimination, in the supernodes that some rows (as in the
  /// pattern) hang on; elsewhere by zero.
  void solve_back(const std::vector<int>& wanted, Matrix<double>& y) const {
    using Block = Eigen::Map<const Matrix<double>, 0, Eigen::OuterStride<>>;
    const auto* x_of = static_cast<const double*>(factor->x);
    const auto* super = static_cast<const int*>(factor->super);
    const auto* pi = static_cast<const int*>(factor->pi);
    const auto* px = static_cast<const int*>(factor->px);
    const auto* rows = static_cast<const int*>(factor->s);
    const auto marked = ancestors_of(wanted);
    Matrix<double> known;
    for (std::size_t s = factor->nsuper; s-- > 0;) {
      const int own = super[s + 1] - super[s], count = pi[s + 1] - pi[s], below = count - own;
      const Block L(x_of + px[s], count, own, Eigen::OuterStride<>(count));
      auto x = y.middleRows(super[s], own);
      if (!marked[s]) {
        x.setZero();
        continue;
      }
      known.resize(below, y.cols());
      for (Eigen::Index c = 0; c < y.cols(); ++c)
        for (int i = 0; i < below; ++i) known(i, c) = y(rows[pi[s] + own + i], c);
      x.noalias() -= L.bottomRows(below).transpose() * known;
      L.topRows(own).template triangularView<Eigen::Lower>().transpose().solveInPlace(x);
    }
  }

  /// Smallest l_kk^2 / a_kk: a pivot over the diagonal entry it came from, which no diagonal scaling changes.
  double smallest_pivot(const double* values) const {
    const auto* x_of = static_cast<const double*>(factor->x);
    const auto* super = static_cast<const int*>(factor->super);
    const auto* pi = static_cast<const int*>(factor->pi);
    const auto* px = static_cast<const int*>(factor->px);
    const auto* permutation = static_cast<const int*>(factor->Perm);
    double smallest = 1;
    for (std::size_t s = 0; s < factor->nsuper; ++s) {
      const int rows = pi[s + 1] - pi[s];
      for (int k = super[s]; k < super[s + 1]; ++k) {
        const int local = k - super[s];
        const double l = x_of[px[s] + static_cast<std::ptrdiff_t>(local) * (rows + 1)];
        const double ratio = l * l / values[diagonal[permutation[k]]];
        if (!(ratio >= smallest)) smallest = ratio;  // also where it is not a number
      }
    }
    return smallest;
  }
};

CholmodFactor::CholmodFactor(std::shared_ptr<const Pattern> pattern, int kept)
    : data_(std::make_shared<Data>(std::move(pattern), kept)) {
  Data& d = *data_;
  const Pattern& p = *d.pattern;
  d.diagonal.assign(p.size, -1);
  for (int j = 0; j < p.size; ++j) {
    const auto first = p.row.begin() + p.column_start[j], last = p.row.begin() + p.column_start[j + 1];
    const auto it = std::lower_bound(first, last, j);
    if (it != last && *it == j) d.diagonal[j] = static_cast<int>(it - p.row.begin());
  }
  d.analyse();
}

FactorSize CholmodFactor::predict(std::shared_ptr<const Pattern> pattern, int kept) {
  Data data(std::move(pattern), kept);
  data.common.supernodal = CHOLMOD_SIMPLICIAL;  // supernodes are not needed to count
  data.analyse();
  return data.size;
}

FactorSize CholmodFactor::size() const { return data_->size; }

Factorisation CholmodFactor::factorise(const double* values) {
  using Outcome = Factorisation::Outcome;
  Data& d = *data_;
  const auto no_diagonal =
      std::find_if(d.diagonal.begin(), d.diagonal.end(), [&](int entry) { return entry < 0 || !(values[entry] > 0); });
  if (no_diagonal != d.diagonal.end())
    return {Outcome::not_positive_definite,
            "diagonal entry of row " + std::to_string(no_diagonal - d.diagonal.begin()) + " is not positive"};
  cholmod_sparse a = d.matrix(values);
  const OneThread alone;
  cholmod_factorize(&a, d.factor, &d.common);
  d.check("factorise");
  if (d.factor->minor < d.factor->n)
    return {Outcome::not_positive_definite,
            "pivot of row " + std::to_string(static_cast<const int*>(d.factor->Perm)[d.factor->minor]) +
                " is not positive"};
  return {Outcome::done, "", d.smallest_pivot(values)};
}

void CholmodFactor::solve(const Matrix<double>& b, Matrix<double>& x, bool /*transposed: symmetric*/) {
  Data& d = *data_;
  cholmod_dense rhs = Data::view(b);
  if (!cholmod_solve2(CHOLMOD_A, d.factor, &rhs, nullptr, &d.x, nullptr, &d.y, &d.e, &d.common))
    throw std::bad_alloc();  // the factor is good, so nothing else can go wrong
  x = Eigen::Map<const Matrix<double>>(static_cast<const double*>(d.x->x), b.rows(), b.cols());
}

Matrix<double> CholmodFactor::schur_complement() const {
  const Data& d = *data_;
  Matrix<double> complement = Matrix<double>::Zero(d.kept, d.kept);
  Matrix<double> L = Matrix<double>::Zero(d.kept, d.kept);
  Eigen::Index column = 0;
  d.for_each_kept_block([&](int, int columns, const std::vector<int>& rows, const auto& block) {
    for (int k = 0; k < columns; ++k, ++column)
      for (std::size_t i = k; i < rows.size(); ++i) L(rows[i], column) = block(i, k);
  });
  complement.selfadjointView<Eigen::Lower>().rankUpdate(L);
  complement.triangularView<Eigen::StrictlyUpper>() = complement.transpose();
  return complement;
}

Reduction<double> CholmodFactor::reduce(const Matrix<double>& b) {
  Data& d = *data_;
  const Eigen::Map<const Eigen::VectorXi> order(static_cast<const int*>(d.factor->Perm), b.rows());
  Reduction<double> reduced{Matrix<double>::Zero(d.kept, b.cols()), b(order, Eigen::all)};
  d.solve_triangle(cholmod_super_lsolve, reduced.others);
  d.for_each_kept_block([&](int first, int columns, const std::vector<int>& rows, const auto& block) {
    const auto y = reduced.others.middleRows(first, columns);
    const Eigen::Index below = block.rows() - columns;
    Matrix<double> product(block.rows(), b.cols());
    product.topRows(columns) = block.topRows(columns).template triangularView<Eigen::Lower>() * y;
    product.bottomRows(below) = block.bottomRows(below) * y;
    reduced.kept(rows, Eigen::all) += product;
  });
  return reduced;
}

Matrix<double> CholmodFactor::expand(const Matrix<double>& kept, Matrix<double> y, const std::vector<int>* wanted) {
  Data& d = *data_;
  d.for_each_kept_block([&](int first, int columns, const std::vector<int>& rows, const auto& block) {
    const Matrix<double> x = kept(rows, Eigen::all);
    const Eigen::Index below = block.rows() - columns;
    auto to = y.middleRows(first, columns);  // L_kk^T x_k
    to = block.topRows(columns).template triangularView<Eigen::Lower>().transpose() * x.topRows(columns);
    to += block.bottomRows(below).transpose() * x.bottomRows(below);
  });
  if (wanted)
    d.solve_back(*wanted, y);
  else
    d.solve_triangle(cholmod_super_ltsolve, y);
  const auto* permutation = static_cast<const int*>(d.factor->Perm);
  const int eliminated = d.pattern->size - d.kept;
  Matrix<double> x(eliminated, y.cols());
  for (int c = 0; c < y.cols(); ++c)
    for (int k = 0; k < y.rows(); ++k)
      if (permutation[k] < eliminated) x(permutation[k], c) = y(k, c);
  return x;
}

std::string CholmodFactor::name() const {
  const Data& d = *data_;
  return library() + " supernodal, " +
         (d.kept > 0                            ? "constrained AMD"
          : d.factor->ordering == CHOLMOD_METIS ? "METIS"
                                                : "AMD");
}

long CholmodFactor::factor_nonzeros() const { return static_cast<long>(data_->common.lnz); }

long CholmodFactor::factor_bytes() const {
  const cholmod_factor& factor = *data_->factor;
  return static_cast<long>(factor.xsize * sizeof(double) + factor.ssize * sizeof(int));
}

std::string CholmodFactor::library() {
  int version[3] = {0, 0, 0};
  cholmod_version(version);
  return "CHOLMOD " + std::to_string(version[0]) + "." + std::to_string(version[1]) + "." + std::to_string(version[2]);
}

}  // namespace stickslip

#endif
