/// CHOLMOD: supernodal Cholesky factorisation A = L L^T of symmetric positive definite matrices.
#include "core/algebra/backend.hpp"

#ifdef STICKSLIP_WITH_CHOLMOD

#include <cholmod.h>

#include <algorithm>
#include <new>
#include <stdexcept>

#include "core/algebra/supernodes.hpp"

// OpenMP's, where CHOLMOD was built with it, null elsewhere.
extern "C" {
__attribute__((weak)) int omp_get_max_active_levels();
__attribute__((weak)) void omp_set_max_active_levels(int);
}

namespace stickslip {
namespace {

/// While it lives, OpenMP takes one thread. CHOLMOD asks for four in its supernodes, whatever the machine has, to add
/// up what takes microseconds. On 2 cores a factorisation of 20 000 unknowns took 74 ms of CPU with four threads, 20 ms
/// with one.
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

  /// The ordering is AMD's. Where AMD's factor costs over 500 flops an entry and fills in fivefold, METIS is tried too
  /// and the better one taken: in 3D that is so; in 2D METIS takes ten times the analysis and gains nothing. With kept
  /// rows it is an AMD that is told to leave them for the end: a seventh more fill than without.
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

  /// The factor, once there is one; before that its places alone.
  Supernodes supernodes() const {
    const auto ints = [](const void* list) { return static_cast<const int*>(list); };
    return {static_cast<int>(factor->nsuper),
            ints(factor->super),
            ints(factor->pi),
            ints(factor->s),
            ints(factor->px),
            static_cast<const double*>(factor->x),
            ints(factor->Perm),
            pattern->size,
            pattern->size - kept};
  }
  bool keeps_rows_last() const { return !factor->is_super || supernodes().keep_rows_last(); }

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
  return {Outcome::done, "", d.supernodes().smallest_pivot([&](int row) { return values[d.diagonal[row]]; })};
}

void CholmodFactor::solve(const Matrix<double>& b, Matrix<double>& x, Taken /*symmetric*/) {
  Data& d = *data_;
  cholmod_dense rhs = Data::view(b);
  if (!cholmod_solve2(CHOLMOD_A, d.factor, &rhs, nullptr, &d.x, nullptr, &d.y, &d.e, &d.common))
    throw std::bad_alloc();  // the factor is good, so nothing else can go wrong
  x = Eigen::Map<const Matrix<double>>(static_cast<const double*>(d.x->x), b.rows(), b.cols());
}

Matrix<double> CholmodFactor::schur_complement() const { return data_->supernodes().schur_complement(); }

Reduction<double> CholmodFactor::reduce(const Matrix<double>& b) { return data_->supernodes().reduce(b); }

Matrix<double> CholmodFactor::expand(const Matrix<double>& kept, const Matrix<double>& y,
                                     const std::vector<int>* wanted) {
  return data_->supernodes().expand(kept, y, wanted);
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
