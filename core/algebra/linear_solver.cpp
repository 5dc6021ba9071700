/// What all backends share: choice, counters, fallback, singularity, backward error, refinement, condition estimate.
#include "core/algebra/linear_solver.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>

#include "core/algebra/backend.hpp"
#include "core/algebra/norm_estimate.hpp"

// OpenBLAS where it is loaded, null elsewhere: the BLAS is the system's choice at run time, not ours at link time.
extern "C" {
__attribute__((weak)) char* openblas_get_config();
__attribute__((weak)) int openblas_get_parallel();
__attribute__((weak)) void openblas_set_num_threads(int);
}

namespace stickslip {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Above this backward error one step of iterative refinement is worth a solve.
constexpr double refine_above = 1e-10;
/// A pivot below this, relative to its column, calls for a look at the condition number: of itself it proves nothing
/// (a stiff penalty makes one), and above it a matrix that is singular to working precision is not in sight.
constexpr double small_pivot = 1e-8;
/// The scaled matrix counts as singular where its condition number times epsilon exceeds this. Rounding gives an
/// exactly singular matrix some condition number beyond 1 / epsilon: 4e16 and more where a body floats; where random
/// rows depend on each other, one in 3500 stays below the limit.
constexpr double singular_condition = 0.1;

/// Rows of X side by side, so that one pass over the matrix serves all right-hand sides.
template <class T>
using RowMajor = Eigen::Array<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// r -= A x and s += |A||x| for `columns` vectors stored row by row; A^T instead of A where transposed. K is the
/// number of vectors where it is known at compile time, else 0.
template <int K, class T>
void subtract_product(const Pattern& pattern, const T* values, bool transposed, const RowMajor<T>& x,
                      const RowMajor<double>& size_of_x, RowMajor<T>& r, RowMajor<double>& s) {
  const int k = K > 0 ? K : static_cast<int>(x.cols());
  for (int j = 0; j < pattern.size; ++j)
    for (int e = pattern.column_start[j]; e < pattern.column_start[j + 1]; ++e) {
      const auto to = static_cast<std::ptrdiff_t>(transposed ? j : pattern.row[e]) * k;
      const auto from = static_cast<std::ptrdiff_t>(transposed ? pattern.row[e] : j) * k;
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

/// Oettli and Prager's backward error of up to K columns, |b - A x|_i / (|A||x| + |b|)_i at its largest. `entry`: where
/// the entries of a column of A^T are; null where A^T is meant, or A is symmetric. Not a number where an entry is none.
/// One pass, that keeps nothing: what it costs counts where a run solves for many right-hand sides.
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

/// Powers of two that bring the largest entry of each row of diag(row) A diag(column) near one, and then of each
/// column: what is said of that matrix does not depend on the units of equations and unknowns.
struct Scaling {
  Eigen::VectorXd row, column;
};

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

/// Largest sum of |row_i a_ij column_j| over a column.
template <class T>
double one_norm(const Pattern& pattern, const T* values, const Scaling* scaling) {
  double norm = 0;
  for (int j = 0; j < pattern.size; ++j) {
    double sum = 0;
    for (int e = pattern.column_start[j]; e < pattern.column_start[j + 1]; ++e)
      sum += std::abs(values[e]) * (scaling ? scaling->row[pattern.row[e]] * scaling->column[j] : 1.0);
    norm = std::max(norm, sum);
  }
  return norm;
}

std::string scientific(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", x);
  return text;
}

/// Below this size the fixed cost of a call of MUMPS (40 us) outweighs its faster kernels.
constexpr int small_matrix = 250;

/// The backend that `automatic` stands for; the measurements are in core/README.md, "Linear algebra".
Backend preferred(Symmetry symmetry, int size) {
  if (symmetry == Symmetry::positive_definite && has_backend(Backend::cholmod)) return Backend::cholmod;
  if (size < small_matrix) return Backend::eigen;
  if (has_backend(Backend::mumps)) return Backend::mumps;
  if (has_backend(Backend::umfpack)) return Backend::umfpack;
  return Backend::eigen;
}

template <class T>
std::unique_ptr<Factor<T>> make_factor(Backend backend, std::shared_ptr<const Pattern> pattern, Symmetry symmetry,
                                       [[maybe_unused]] int kept) {
  if constexpr (std::is_same_v<T, double>) {
    // CHOLMOD knows positive definite matrices alone.
    if (backend == Backend::automatic || (backend == Backend::cholmod && symmetry != Symmetry::positive_definite))
      backend = preferred(symmetry, pattern->size);
#ifdef STICKSLIP_WITH_CHOLMOD
    if (backend == Backend::cholmod) return std::make_unique<Factor<T>>(CholmodFactor(std::move(pattern), kept));
#endif
#ifdef STICKSLIP_WITH_UMFPACK
    if (backend == Backend::umfpack) return std::make_unique<Factor<T>>(UmfpackFactor(std::move(pattern)));
#endif
#ifdef STICKSLIP_WITH_MUMPS
    if (backend == Backend::mumps) return std::make_unique<Factor<T>>(MumpsFactor(std::move(pattern), symmetry));
#endif
  }
  return std::make_unique<Factor<T>>(EigenFactor<T>(std::move(pattern)));
}

}  // namespace

template <class T>
struct LinearSolver<T>::Implementation {
  Backend requested = Backend::automatic;
  std::shared_ptr<const Pattern> pattern;
  Symmetry symmetry = Symmetry::general;
  int kept = 0;                             ///< rows at the end, of schur_complement()
  std::optional<std::vector<int>> by_rows;  ///< transposed_entries of the pattern, made on demand
  std::vector<T> values;                    ///< of the last factorise(): the caller's may be overwritten by then
  std::unique_ptr<Factor<T>> first;         ///< of the kind the symmetry asks for
  std::unique_ptr<Factor<T>> second;        ///< for a matrix that was not positive definite after all; made on demand
  Factor<T>* last = nullptr;                ///< of the two, the one factorised last
  bool usable = false;                      ///< the last factorise() returned true
  std::optional<Scaling> scaling;           ///< of `values`, made on demand
  SolverCounters counters;
  std::string message;
  double backward_error = 0;
  int determinant_sign = 1;

  const Scaling& scales() {
    if (!scaling) scaling = equilibrate(*pattern, values.data());
    return *scaling;
  }

  Matrix<T> backsolve(const Matrix<T>& b, bool transposed) {
    Matrix<T> x;
    std::visit([&](auto& factor) { factor.solve(b, x, transposed); }, *last);
    return x;
  }

  Factorisation factorise(Factor<T>& factor) {
    last = &factor;
    ++counters.factorizations;
    return std::visit([&](auto& f) { return f.factorise(values.data()); }, factor);
  }

  /// Condition number in the 1-norm, of the scaled matrix or of the matrix itself, and a vector near the null space.
  std::pair<double, Vector<T>> condition(const Scaling* scale) {
    // (R A C)^-1 = C^-1 A^-1 R^-1. The adjoint conjugates, the transposed solve does not.
    const auto apply = [&](const Vector<T>& z) -> Vector<T> {
      if (!scale) return backsolve(z, false);
      return backsolve(z.cwiseQuotient(scale->row.template cast<T>()), false)
          .cwiseQuotient(scale->column.template cast<T>());
    };
    const auto adjoint = [&](const Vector<T>& z) -> Vector<T> {
      if (!scale) return backsolve(z.conjugate(), true).conjugate();
      return backsolve(z.conjugate().cwiseQuotient(scale->column.template cast<T>()), true)
          .conjugate()
          .cwiseQuotient(scale->row.template cast<T>());
    };
    auto [inverse_norm, vector] = one_norm_estimate<T>(pattern->size, apply, adjoint);
    return {one_norm(*pattern, values.data(), scale) * inverse_norm, std::move(vector)};
  }

  /// Says why the matrix counts as singular to working precision; empty where it does not.
  std::string singularity(double smallest_pivot) {
    if (smallest_pivot > small_pivot) return "";
    const auto [condition_number, vector] = condition(&scales());
    if (condition_number * epsilon <= singular_condition) return "";
    Eigen::Index row = 0;
    vector.cwiseAbs().maxCoeff(&row);
    return "singular to working precision: condition number " + scientific(condition_number) +
           " after scaling, its null vector is largest in row " + std::to_string(row);
  }

  bool is_stored_by_rows(bool transposed) const { return transposed || symmetry != Symmetry::general; }

  /// Oettli and Prager's backward error of X; not a number where rows of an unsymmetric pattern are not at hand.
  double backward_error_of(const Matrix<T>& x, const Matrix<T>& b, bool transposed) {
    const int* entry = nullptr;
    if (!is_stored_by_rows(transposed)) {
      if (!by_rows) by_rows = transposed_entries(*pattern);
      if (by_rows->empty()) return std::numeric_limits<double>::quiet_NaN();
      entry = by_rows->data();
    }
    if (b.cols() == 1) return oettli_prager<1>(*pattern, values.data(), entry, x.data(), b);
    double error = 0;
    RowMajor<T> side_by_side = RowMajor<T>::Zero(x.rows(), checked_together);
    for (Eigen::Index first = 0; first < b.cols(); first += checked_together) {
      const Eigen::Index count = std::min<Eigen::Index>(checked_together, b.cols() - first);
      side_by_side.leftCols(count) = x.middleCols(first, count).array();
      const double part = oettli_prager<checked_together>(*pattern, values.data(), entry, side_by_side.data(),
                                                          b.middleCols(first, count));
      error = larger(error, part);
    }
    return error;
  }

  struct Check {
    double error = 0;
    Matrix<T> residual;
  };

  /// Backward error of X and the residual B - A X. Oettli and Prager's |r|_i / (|A||x| + |b|)_i says nothing where a
  /// row holds rounding noise alone (displacements that are zero by symmetry); there the denominator is that of
  /// M. Arioli, J. W. Demmel, I. S. Duff, SIAM J. Matrix Anal. Appl. 10 (1989) 165-190, with the matrix equilibrated.
  Check check(const Matrix<T>& solution, const Matrix<T>& b, bool transposed) {
    Check result{0, Matrix<T>(b.rows(), b.cols())};
    for (Eigen::Index first = 0; first < b.cols(); first += checked_together) {
      const Eigen::Index count = std::min<Eigen::Index>(checked_together, b.cols() - first);
      const Check part = check_columns(solution.middleCols(first, count), b.middleCols(first, count), transposed);
      result.error = larger(result.error, part.error);
      result.residual.middleCols(first, count) = part.residual;
    }
    return result;
  }

  static constexpr int checked_together = 8;  // that fit into registers

  Check check_columns(const Matrix<T>& solution, const Matrix<T>& b, bool transposed) {
    const bool as_rows = is_stored_by_rows(transposed);  // a gather is faster than a scatter
    const RowMajor<T> x = solution.array();
    const RowMajor<double> size_of_x = x.abs();
    RowMajor<T> r = b.array();
    RowMajor<double> denominator = r.abs();
    if (x.cols() == 1)
      subtract_product<1>(*pattern, values.data(), as_rows, x, size_of_x, r, denominator);
    else if (x.cols() == checked_together)
      subtract_product<checked_together>(*pattern, values.data(), as_rows, x, size_of_x, r, denominator);
    else
      subtract_product<0>(*pattern, values.data(), as_rows, x, size_of_x, r, denominator);
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
    const Eigen::ArrayXd of_row = (transposed ? scales().column : scales().row).array();
    const Eigen::ArrayXd of_unknown = (transposed ? scales().row : scales().column).array();
    const double noise = 1000.0 * pattern->size * epsilon;  // Arioli, Demmel and Duff's tau
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
};

template <class T>
LinearSolver<T>::LinearSolver(Backend backend) : implementation_(std::make_unique<Implementation>()) {
  if (!has_backend(backend)) throw std::invalid_argument("this linear solver is not built in");
  implementation_->requested = backend;
}
template <class T>
LinearSolver<T>::~LinearSolver() = default;
template <class T>
LinearSolver<T>::LinearSolver(LinearSolver&&) noexcept = default;
template <class T>
LinearSolver<T>& LinearSolver<T>::operator=(LinearSolver&&) noexcept = default;

template <class T>
void LinearSolver<T>::analyse(std::shared_ptr<const Pattern> pattern, Symmetry symmetry, int kept) {
  Implementation& s = *implementation_;
  s.usable = false;
  s.last = nullptr;
  s.second.reset();
  s.first.reset();  // before the new one: two sets of factors need not be held
  s.pattern = std::move(pattern);
  s.by_rows.reset();
  s.symmetry = symmetry;
  s.kept = kept;
  if (s.pattern->size > 0) s.first = make_factor<T>(s.requested, s.pattern, symmetry, kept);
  s.last = s.first.get();
  ++s.counters.analyses;
}

template <class T>
bool LinearSolver<T>::factorise(const T* values) {
  using Outcome = Factorisation::Outcome;
  Implementation& s = *implementation_;
  if (!s.pattern) throw std::logic_error("LinearSolver: factorise before analyse");
  const Pattern& pattern = *s.pattern;
  s.usable = false;
  s.message.clear();
  s.scaling.reset();
  s.backward_error = 0;
  s.values.assign(values, values + pattern.nonzeros());
  for (int j = 0; j < pattern.size; ++j)
    for (int e = pattern.column_start[j]; e < pattern.column_start[j + 1]; ++e)
      if (!std::isfinite(std::abs(s.values[e]))) {
        s.message =
            "entry of row " + std::to_string(pattern.row[e]) + ", column " + std::to_string(j) + " is not finite";
        return false;
      }
  if (pattern.size == 0) return s.usable = true;
  try {
    Factorisation result = s.factorise(*s.first);
    if (result.outcome == Outcome::not_positive_definite) {
      if (!s.second) {
        s.second = make_factor<T>(s.requested, s.pattern, Symmetry::indefinite, s.kept);
        ++s.counters.analyses;
      }
      ++s.counters.fallbacks;
      result = s.factorise(*s.second);
    }
    s.message = result.outcome == Outcome::done ? s.singularity(result.smallest_pivot) : result.message;
    if (result.outcome == Outcome::singular) s.message = "singular: " + s.message;
    s.determinant_sign = result.determinant_sign;
  } catch (const std::runtime_error& error) {  // the fallback's analysis
    s.message = error.what();
  }
  return s.usable = s.message.empty();
}

template <class T>
Matrix<T> LinearSolver<T>::solve(const Matrix<T>& right_hand_sides, bool transposed) {
  Implementation& s = *implementation_;
  if (!s.usable) throw std::logic_error("LinearSolver: solve without a factorisation");
  if (right_hand_sides.rows() != s.pattern->size)
    throw std::logic_error("LinearSolver: right-hand side of another size");
  s.backward_error = 0;
  if (right_hand_sides.size() == 0) return right_hand_sides;
  Matrix<T> x = s.backsolve(right_hand_sides, transposed);
  s.counters.backsolves += static_cast<long>(x.cols());
  s.backward_error = s.backward_error_of(x, right_hand_sides, transposed);
  if (s.backward_error <= refine_above) return x;
  auto check = s.check(x, right_hand_sides, transposed);
  if (check.error > refine_above) {
    Matrix<T> refined = x + s.backsolve(check.residual, transposed);
    s.counters.backsolves += static_cast<long>(x.cols());
    const auto checked = s.check(refined, right_hand_sides, transposed);
    if (checked.error < check.error) {
      x = std::move(refined);
      check.error = checked.error;
    }
  }
  s.backward_error = check.error;
  return x;
}

template <class T>
Matrix<T> LinearSolver<T>::schur_complement() {
  Implementation& s = *implementation_;
  if (!s.usable) throw std::logic_error("LinearSolver: Schur complement without a factorisation");
#ifdef STICKSLIP_WITH_CHOLMOD
  if constexpr (std::is_same_v<T, double>)
    if (const auto* cholesky = std::get_if<CholmodFactor>(s.last)) return cholesky->schur_complement();
#endif
  constexpr int columns_at_a_time = 64;
  const int eliminated = s.pattern->size - s.kept;
  Matrix<T> inverse(s.kept, s.kept);
  for (int first = 0; first < s.kept; first += columns_at_a_time) {
    const int count = std::min(columns_at_a_time, s.kept - first);
    Matrix<T> unit = Matrix<T>::Zero(s.pattern->size, count);
    unit.block(eliminated + first, 0, count, count).setIdentity();
    inverse.middleCols(first, count) = solve(unit).bottomRows(s.kept);
  }
  return inverse.partialPivLu().inverse();
}

template <class T>
int LinearSolver<T>::determinant_sign() const {
  return implementation_->determinant_sign;
}

template <class T>
double LinearSolver<T>::backward_error() const {
  return implementation_->backward_error;
}

template <class T>
double LinearSolver<T>::condition_estimate() {
  Implementation& s = *implementation_;
  if (!s.usable) return 0;
  return s.pattern->size == 0 ? 1.0 : s.condition(nullptr).first;
}

template <class T>
const SolverCounters& LinearSolver<T>::counters() const {
  return implementation_->counters;
}

template <class T>
std::string LinearSolver<T>::name() const {
  const Implementation& s = *implementation_;
  if (!s.last) return "";
  return std::visit([](const auto& factor) { return factor.name(); }, *s.last);
}

template <class T>
const std::string& LinearSolver<T>::message() const {
  return implementation_->message;
}

template <class T>
long LinearSolver<T>::factor_nonzeros() const {
  const Implementation& s = *implementation_;
  if (!s.last || !s.usable) return 0;
  return std::visit([](const auto& factor) { return factor.factor_nonzeros(); }, *s.last);
}

template <class T>
long LinearSolver<T>::factor_bytes() const {
  const Implementation& s = *implementation_;
  if (!s.last || !s.usable) return 0;
  return std::visit([](const auto& factor) { return factor.factor_bytes(); }, *s.last);
}

template class LinearSolver<double>;
template class LinearSolver<std::complex<double>>;

bool has_backend(Backend backend) {
  switch (backend) {
    case Backend::automatic:
    case Backend::eigen:
      return true;
    case Backend::cholmod:
#ifdef STICKSLIP_WITH_CHOLMOD
      return true;
#else
      return false;
#endif
    case Backend::umfpack:
#ifdef STICKSLIP_WITH_UMFPACK
      return true;
#else
      return false;
#endif
    case Backend::mumps:
#ifdef STICKSLIP_WITH_MUMPS
      return true;
#else
      return false;
#endif
  }
  return false;
}

FactorSize predict_factor(std::shared_ptr<const Pattern> pattern, [[maybe_unused]] int kept) {
  if (pattern->size == 0) return {};
#ifdef STICKSLIP_WITH_CHOLMOD
  return CholmodFactor::predict(std::move(pattern), kept);
#else
  const double n = pattern->size;  // nested dissection of a square of cells, two unknowns a node
  return {60 * std::pow(n, 1.5), 6 * n * std::log2(n + 1)};
#endif
}

std::vector<std::string> linear_solver_libraries() {
  return {
#ifdef STICKSLIP_WITH_CHOLMOD
      CholmodFactor::library(),
#endif
#ifdef STICKSLIP_WITH_UMFPACK
      UmfpackFactor::library(),
#endif
#ifdef STICKSLIP_WITH_MUMPS
      MumpsFactor::library(),
#endif
      eigen_library()};
}

std::string blas_name() {
  if (!openblas_get_config) {
    if (linear_solver_libraries().size() == 1) return "none (Eigen's own kernels)";
    return "unknown (reference?)";
  }
  std::string name = openblas_get_config();
  if (openblas_get_parallel) {
    const int parallel = openblas_get_parallel();
    name += parallel == 0 ? " serial" : parallel == 1 ? " pthreads" : " OpenMP";
  }
  return name;
}

bool set_blas_threads(int n) {
  if (!openblas_set_num_threads) return false;
  openblas_set_num_threads(n);
  return true;
}

}  // namespace stickslip
