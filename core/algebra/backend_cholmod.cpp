/// CHOLMOD: supernodal Cholesky factorisation A = L L^T of symmetric positive definite matrices.
#include "core/algebra/backend.hpp"

#ifdef STICKSLIP_WITH_CHOLMOD

#include <cholmod.h>

#include <algorithm>
#include <new>
#include <stdexcept>

namespace stickslip {

struct CholmodFactor::Data {
  std::shared_ptr<const Pattern> pattern;
  int kept = 0;               ///< rows at the end that are eliminated last
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
    }
    check("analyse");
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
  return {data.common.fl, data.common.lnz};
}

Factorisation CholmodFactor::factorise(const double* values) {
  using Outcome = Factorisation::Outcome;
  Data& d = *data_;
  const auto no_diagonal =
      std::find_if(d.diagonal.begin(), d.diagonal.end(), [&](int entry) { return entry < 0 || !(values[entry] > 0); });
  if (no_diagonal != d.diagonal.end())
    return {Outcome::not_positive_definite,
            "diagonal entry of row " + std::to_string(no_diagonal - d.diagonal.begin()) + " is not positive"};
  cholmod_sparse a = d.matrix(values);
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
  cholmod_dense rhs{};
  rhs.nrow = rhs.d = static_cast<std::size_t>(b.rows());
  rhs.ncol = static_cast<std::size_t>(b.cols());
  rhs.nzmax = rhs.nrow * rhs.ncol;
  rhs.x = const_cast<double*>(b.data());
  rhs.xtype = CHOLMOD_REAL;
  rhs.dtype = CHOLMOD_DOUBLE;
  if (!cholmod_solve2(CHOLMOD_A, d.factor, &rhs, nullptr, &d.x, nullptr, &d.y, &d.e, &d.common))
    throw std::bad_alloc();  // the factor is good, so nothing else can go wrong
  x = Eigen::Map<const Matrix<double>>(static_cast<const double*>(d.x->x), b.rows(), b.cols());
}

Matrix<double> CholmodFactor::schur_complement() const {
  const Data& d = *data_;
  const auto* x_of = static_cast<const double*>(d.factor->x);
  const auto* super = static_cast<const int*>(d.factor->super);
  const auto* pi = static_cast<const int*>(d.factor->pi);
  const auto* px = static_cast<const int*>(d.factor->px);
  const auto* rows = static_cast<const int*>(d.factor->s);
  const auto* permutation = static_cast<const int*>(d.factor->Perm);
  // No kept row has an eliminated one after it in its tree, but one tree may stand before another: each body has its
  // own.
  const int first = d.pattern->size - d.kept;
  std::vector<int> place(d.pattern->size, -1), order;  // of the kept rows among themselves, as they are eliminated
  for (int k = 0; k < d.pattern->size; ++k)
    if (permutation[k] >= first) {
      place[k] = static_cast<int>(order.size());
      order.push_back(permutation[k] - first);
    }
  Matrix<double> L = Matrix<double>::Zero(d.kept, d.kept);
  for (std::size_t s = 0; s < d.factor->nsuper; ++s)
    for (int k = super[s]; k < super[s + 1]; ++k) {
      if (place[k] < 0) continue;
      const int local = k - super[s], count = pi[s + 1] - pi[s];
      const double* column = x_of + px[s] + static_cast<std::ptrdiff_t>(local) * count;
      for (int i = local; i < count; ++i) L(place[rows[pi[s] + i]], place[k]) = column[i];
    }
  Matrix<double> product = Matrix<double>::Zero(d.kept, d.kept), complement(d.kept, d.kept);
  product.selfadjointView<Eigen::Lower>().rankUpdate(L);
  for (int j = 0; j < d.kept; ++j)
    for (int i = j; i < d.kept; ++i) complement(order[i], order[j]) = complement(order[j], order[i]) = product(i, j);
  return complement;
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
