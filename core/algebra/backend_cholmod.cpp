/// CHOLMOD: supernodal Cholesky factorisation A = L L^T of symmetric positive definite matrices.
#include "core/algebra/backend.hpp"

#ifdef STICKSLIP_WITH_CHOLMOD

#include <cholmod.h>

#include <algorithm>
#include <stdexcept>

namespace stickslip {

struct CholmodFactor::Data {
  std::shared_ptr<const Pattern> pattern;
  std::vector<int> diagonal;  ///< place of entry (j, j), -1 where the pattern has none
  cholmod_common common;
  cholmod_factor* factor = nullptr;
  // Workspaces of cholmod_solve2, kept from one solve to the next.
  cholmod_dense* x = nullptr;
  cholmod_dense* y = nullptr;
  cholmod_dense* e = nullptr;

  explicit Data(std::shared_ptr<const Pattern> p) : pattern(std::move(p)) {
    cholmod_start(&common);
    common.print = 0;
    common.error_handler = nullptr;
    common.try_catch = true;  // no text on stdout: the status is read after each call
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.quick_return_if_not_posdef = true;
    // AMD; METIS too, and the better of the two, where AMD's factor costs over 500 flops an entry and fills in
    // fivefold: in 3D it does, in 2D METIS takes ten times the analysis for a tie.
    common.nmethods = 0;
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

CholmodFactor::CholmodFactor(std::shared_ptr<const Pattern> pattern)
    : data_(std::make_shared<Data>(std::move(pattern))) {
  Data& d = *data_;
  const Pattern& p = *d.pattern;
  d.diagonal.assign(p.size, -1);
  for (int j = 0; j < p.size; ++j) {
    const auto first = p.row.begin() + p.column_start[j], last = p.row.begin() + p.column_start[j + 1];
    const auto it = std::lower_bound(first, last, j);
    if (it != last && *it == j) d.diagonal[j] = static_cast<int>(it - p.row.begin());
  }
  cholmod_sparse a = d.matrix(nullptr);
  d.factor = cholmod_analyze(&a, &d.common);
  if (!d.factor || d.common.status < CHOLMOD_OK)
    throw std::runtime_error("CHOLMOD could not analyse the matrix (status " + std::to_string(d.common.status) + ")");
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
  if (d.common.status < CHOLMOD_OK)
    return {Outcome::failed, d.common.status == CHOLMOD_OUT_OF_MEMORY || d.common.status == CHOLMOD_TOO_LARGE
                                 ? "CHOLMOD: not enough memory"
                                 : "CHOLMOD: error " + std::to_string(d.common.status)};
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

std::string CholmodFactor::name() const {
  const Data& d = *data_;
  return library() + " supernodal, " + (d.factor->ordering == CHOLMOD_METIS ? "METIS" : "AMD");
}

long CholmodFactor::factor_nonzeros() const { return static_cast<long>(data_->common.lnz); }

std::string CholmodFactor::library() {
  int version[3] = {0, 0, 0};
  cholmod_version(version);
  return "CHOLMOD " + std::to_string(version[0]) + "." + std::to_string(version[1]) + "." + std::to_string(version[2]);
}

}  // namespace stickslip

#endif
