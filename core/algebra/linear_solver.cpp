/// What all backends share: counters, fallback, singularity, refinement, condition estimate.
#include "core/algebra/linear_solver.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>

#include "core/algebra/backend.hpp"
#include "core/algebra/kept_matrix.hpp"
#include "core/algebra/norm_estimate.hpp"

namespace stickslip {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// A pivot below this, relative to its column, calls for an estimate of the condition number. Such a pivot alone proves
/// nothing: a stiff penalty makes one. A matrix that is singular to working precision has pivots far below it.
constexpr double small_pivot = 1e-8;
/// The scaled matrix counts as singular where its condition number times epsilon exceeds this. Rounding gives an
/// exactly singular matrix some condition number beyond 1 / epsilon: 4e16 and more where a body floats. Of matrices
/// whose random rows depend on each other, one in 3500 stays below the limit.
constexpr double singular_condition = 0.1;

std::string scientific(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", x);
  return text;
}

}  // namespace

template <class T>
struct LinearSolver<T>::Implementation {
  Backend requested = Backend::automatic;
  std::shared_ptr<const Pattern> pattern;
  int kept = 0;                       ///< rows at the end, of schur_complement()
  KeptMatrix<T> matrix;               ///< of the last factorise()
  std::unique_ptr<Factor<T>> first;   ///< of the kind the symmetry asks for
  std::unique_ptr<Factor<T>> second;  ///< for a matrix that was not positive definite after all; made on demand
  Factor<T>* last = nullptr;          ///< of the two, the one factorised last
  bool usable = false;                ///< the last factorise() returned true
  SolverCounters counters;
  std::string message;
  double backward_error = 0;
  int determinant_sign = 1;
  Matrix<T> schur;  ///< of the last factor, where that does not show it; empty until it is asked for

  /// Calls `f` with the last factor where it solves by halves; returns whether it does.
  template <class F>
  bool by_halves(F&& f) {
    return std::visit(
        [&](auto& factor) {
          constexpr bool has_halves = requires { factor.schur_complement(); };
          if constexpr (has_halves) f(factor);
          return has_halves;
        },
        *last);
  }

  Matrix<T> backsolve(const Matrix<T>& b, Taken taken = Taken::as_is) {
    Matrix<T> x;
    std::visit([&](auto& factor) { factor.solve(b, x, taken); }, *last);
    return x;
  }

  Factorisation factorise(Factor<T>& factor) {
    last = &factor;
    ++counters.factorizations;
    return std::visit([&](auto& f) { return f.factorise(matrix.values()); }, factor);
  }

  /// Condition number in the 1-norm, of the scaled matrix or of the matrix itself, and a vector near the null space.
  std::pair<double, Vector<T>> condition(const Scaling* scale) {
    // (R A C)^-1 = C^-1 A^-1 R^-1. The adjoint conjugates, the transposed solve does not.
    const auto apply = [&](const Vector<T>& z) -> Vector<T> {
      if (!scale) return backsolve(z);
      return backsolve(z.cwiseQuotient(scale->row.template cast<T>())).cwiseQuotient(scale->column.template cast<T>());
    };
    const auto adjoint = [&](const Vector<T>& z) -> Vector<T> {
      if (!scale) return backsolve(z.conjugate(), Taken::transposed).conjugate();
      return backsolve(z.conjugate().cwiseQuotient(scale->column.template cast<T>()), Taken::transposed)
          .conjugate()
          .cwiseQuotient(scale->row.template cast<T>());
    };
    auto [inverse_norm, vector] = one_norm_estimate<T>(pattern->size, apply, adjoint);
    return {matrix.one_norm(scale) * inverse_norm, std::move(vector)};
  }

  /// Says why the matrix counts as singular to working precision; empty where it does not.
  std::string singularity(double smallest_pivot) {
    if (smallest_pivot > small_pivot) return "";
    const auto [condition_number, vector] = condition(&matrix.scaling());
    if (condition_number * epsilon <= singular_condition) return "";
    Eigen::Index row = 0;
    vector.cwiseAbs().maxCoeff(&row);
    return "singular to working precision: condition number " + scientific(condition_number) +
           " after scaling, its null vector is largest in row " + std::to_string(row);
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
  s.matrix = KeptMatrix<T>(s.pattern, symmetry);
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
  s.usable = false;
  s.backward_error = 0;
  s.schur.resize(0, 0);
  s.matrix.take(values);
  s.message = s.matrix.not_finite();
  if (!s.message.empty()) return false;
  if (s.pattern->size == 0) return s.usable = true;
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
Matrix<T> LinearSolver<T>::solve(const Matrix<T>& right_hand_sides, Taken taken) {
  Implementation& s = *implementation_;
  if (!s.usable) throw std::logic_error("LinearSolver: solve without a factorisation");
  if (right_hand_sides.rows() != s.pattern->size)
    throw std::logic_error("LinearSolver: right-hand side of another size");
  s.backward_error = 0;
  if (right_hand_sides.size() == 0) return right_hand_sides;
  Matrix<T> x = s.backsolve(right_hand_sides, taken);
  s.counters.backsolves += static_cast<long>(x.cols());
  s.backward_error = s.matrix.backward_error(x, right_hand_sides, taken);
  if (s.backward_error <= refine_above) return x;
  auto check = s.matrix.check(x, right_hand_sides, taken);
  if (check.error > refine_above) {
    Matrix<T> refined = x + s.backsolve(check.residual, taken);
    s.counters.backsolves += static_cast<long>(x.cols());
    const auto checked = s.matrix.check(refined, right_hand_sides, taken);
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
  Matrix<T> shown;
  if (s.by_halves([&](auto& factor) { shown = factor.schur_complement(); })) return shown;
  if (s.schur.size() > 0) return s.schur;
  constexpr int columns_at_a_time = 64;
  const int eliminated = s.pattern->size - s.kept;
  Matrix<T> inverse(s.kept, s.kept);
  for (int first = 0; first < s.kept; first += columns_at_a_time) {
    const int count = std::min(columns_at_a_time, s.kept - first);
    Matrix<T> unit = Matrix<T>::Zero(s.pattern->size, count);
    unit.block(eliminated + first, 0, count, count).setIdentity();
    inverse.middleCols(first, count) = solve(unit).bottomRows(s.kept);
  }
  return s.schur = inverse.partialPivLu().inverse();
}

template <class T>
Reduction<T> LinearSolver<T>::reduce(const Matrix<T>& right_hand_sides) {
  Implementation& s = *implementation_;
  if (!s.usable) throw std::logic_error("LinearSolver: reduction without a factorisation");
  Reduction<T> reduction;
  if (s.by_halves([&](auto& factor) { reduction = factor.reduce(right_hand_sides); })) {
    s.counters.half_solves += static_cast<long>(right_hand_sides.cols());
    return reduction;
  }
  reduction.kept = schur_complement() * solve(right_hand_sides).bottomRows(s.kept);  // S x_k of A x = b
  reduction.others = right_hand_sides;
  reduction.others.bottomRows(s.kept) -= reduction.kept;  // leaves A_ko A_oo^-1 b_o
  return reduction;
}

template <class T>
Matrix<T> LinearSolver<T>::expand(const Matrix<T>& kept, Matrix<T> others, const std::vector<int>* wanted) {
  Implementation& s = *implementation_;
  if (!s.usable) throw std::logic_error("LinearSolver: expansion without a factorisation");
  Matrix<T> x;
  if (s.by_halves([&](auto& factor) { x = factor.expand(kept, others, wanted); })) {
    s.counters.half_solves += static_cast<long>(kept.cols());
    return x;
  }
  others.bottomRows(s.kept) += schur_complement() * kept;
  return solve(others).topRows(s.pattern->size - s.kept);
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
FactorSize LinearSolver<T>::factor_size() const {
  const Implementation& s = *implementation_;
  return std::visit(
      [&](const auto& factor) {
        if constexpr (requires { factor.size(); })
          return factor.size();
        else
          return predict_factor(s.pattern, s.kept);
      },
      *s.first);
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

}  // namespace stickslip
