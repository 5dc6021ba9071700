/// UMFPACK: unsymmetric multifrontal LU factorisation P R A Q = L U, R the row scaling.
#include "core/algebra/backend.hpp"

#ifdef STICKSLIP_WITH_UMFPACK

#include <umfpack.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>

namespace stickslip {

struct UmfpackFactor::Data {
  std::shared_ptr<const Pattern> pattern;
  double control[UMFPACK_CONTROL];
  double info[UMFPACK_INFO] = {};
  void* symbolic = nullptr;
  void* numeric = nullptr;
  std::vector<int> integer_work;
  std::vector<double> work, pivots, row_scale;
  std::vector<int> column_order;

  explicit Data(std::shared_ptr<const Pattern> p) : pattern(std::move(p)) {
    umfpack_di_defaults(control);
    control[UMFPACK_PRL] = 0;
    control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
    control[UMFPACK_ORDERING] = UMFPACK_ORDERING_METIS;
    control[UMFPACK_IRSTEP] = 0;  // LinearSolver refines where it pays
    const auto n = static_cast<std::size_t>(pattern->size);
    integer_work.resize(n);
    work.resize(n);
    pivots.resize(n);
    row_scale.resize(n);
    column_order.resize(n);
  }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;
  ~Data() {
    umfpack_di_free_numeric(&numeric);
    umfpack_di_free_symbolic(&symbolic);
  }

  const int* starts() const { return pattern->column_start.data(); }
  const int* rows() const { return pattern->row.data(); }

  /// Reads pivots, column order and row scales of the factor.
  void read_pivots() {
    int reciprocal = 0;
    umfpack_di_get_numeric(nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, column_order.data(),
                           pivots.data(), &reciprocal, row_scale.data(), numeric);
    if (!reciprocal)
      for (double& r : row_scale) r = 1 / r;
  }

  /// Smallest |u_kk| over the largest entry of the row-scaled column it came from.
  double smallest_pivot(const double* values) const {
    double smallest = 1;
    for (int k = 0; k < pattern->size; ++k) {
      const int j = column_order[k];
      double largest = 0;
      for (int e = pattern->column_start[j]; e < pattern->column_start[j + 1]; ++e)
        largest = std::max(largest, row_scale[pattern->row[e]] * std::abs(values[e]));
      const double ratio = std::abs(pivots[k]) / largest;
      if (!(ratio >= smallest)) smallest = ratio;  // also where it is not a number
    }
    return smallest;
  }
};

UmfpackFactor::UmfpackFactor(std::shared_ptr<const Pattern> pattern)
    : data_(std::make_shared<Data>(std::move(pattern))) {
  Data& d = *data_;
  const int n = d.pattern->size;
  const int status = umfpack_di_symbolic(n, n, d.starts(), d.rows(), nullptr, &d.symbolic, d.control, d.info);
  if (status == UMFPACK_ERROR_out_of_memory) throw std::bad_alloc();
  if (status < UMFPACK_OK)
    throw std::runtime_error("UMFPACK could not analyse the matrix (status " + std::to_string(status) + ")");
}

Factorisation UmfpackFactor::factorise(const double* values) {
  using Outcome = Factorisation::Outcome;
  Data& d = *data_;
  umfpack_di_free_numeric(&d.numeric);
  const int status = umfpack_di_numeric(d.starts(), d.rows(), values, d.symbolic, &d.numeric, d.control, d.info);
  if (status == UMFPACK_ERROR_out_of_memory) throw std::bad_alloc();
  if (status < UMFPACK_OK) return {Outcome::failed, "UMFPACK: error " + std::to_string(status)};
  d.read_pivots();
  if (status == UMFPACK_WARNING_singular_matrix) {
    const auto zero = std::find_if(d.pivots.begin(), d.pivots.end(), [](double u) { return !(std::abs(u) > 0); });
    const auto k = zero == d.pivots.end() ? 0 : zero - d.pivots.begin();
    return {Outcome::singular, "pivot of column " + std::to_string(d.column_order[k]) + " is zero"};
  }
  double mantissa = 1, exponent = 0;
  umfpack_di_get_determinant(&mantissa, &exponent, d.numeric, nullptr);
  return {Outcome::done, "", d.smallest_pivot(values), mantissa < 0 ? -1 : 1};
}

void UmfpackFactor::solve(const Matrix<double>& b, Matrix<double>& x, bool transposed) {
  Data& d = *data_;
  x.resize(b.rows(), b.cols());
  for (Eigen::Index c = 0; c < b.cols(); ++c) {
    const int status =
        umfpack_di_wsolve(transposed ? UMFPACK_At : UMFPACK_A, nullptr, nullptr, nullptr, x.col(c).data(),
                          b.col(c).data(), d.numeric, d.control, nullptr, d.integer_work.data(), d.work.data());
    if (status < UMFPACK_OK) throw std::bad_alloc();  // the factor is good, so nothing else can go wrong
  }
}

std::string UmfpackFactor::name() const { return library() + " LU, METIS"; }

long UmfpackFactor::factor_nonzeros() const {
  return static_cast<long>(data_->info[UMFPACK_LNZ] + data_->info[UMFPACK_UNZ]);
}

long UmfpackFactor::factor_bytes() const {
  return static_cast<long>(data_->info[UMFPACK_NUMERIC_SIZE] * data_->info[UMFPACK_SIZE_OF_UNIT]);
}

std::string UmfpackFactor::library() {
  return "UMFPACK " + std::to_string(UMFPACK_MAIN_VERSION) + "." + std::to_string(UMFPACK_SUB_VERSION) + "." +
         std::to_string(UMFPACK_SUBSUB_VERSION);
}

}  // namespace stickslip

#endif
