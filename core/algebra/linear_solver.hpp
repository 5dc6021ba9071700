/// Sparse direct solvers behind one interface: analyse(pattern) once, factorise(values) often, solve blocks of
/// right-hand sides, transposed or not. What each backend is for and why: core/README.md, "Linear algebra".
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/algebra/scalar.hpp"

namespace stickslip {

/// Structure of a square sparse matrix, compressed columns, row indices ascending in each column. It stays as it is
/// for the life of a model: every state of a contact point finds its entry here, zero or not.
struct Pattern {
  int size = 0;
  std::vector<int> column_start;  ///< size + 1 offsets into row
  std::vector<int> row;           ///< row index of each stored entry
  int nonzeros() const { return static_cast<int>(row.size()); }
  long bytes() const { return static_cast<long>((row.size() + column_start.size()) * sizeof(int)); }
};

/// What is known of the matrix; it selects the backend and halves the work where symmetry allows.
enum class Symmetry {
  positive_definite,  ///< symmetric positive definite: Cholesky
  indefinite,         ///< symmetric, saddle point: LDL^T with pivoting where a backend has it
  general             ///< unsymmetric values (slip), symmetric structure: LU
};

/// How a matrix is taken, in a product or a solve; without conjugation.
enum class Taken { as_is, transposed };

enum class Backend { automatic, cholmod, mumps, eigen };

/// Work done so far; equal on every machine, so it is the primary measure of cost.
struct SolverCounters {
  long analyses = 0;
  long factorizations = 0;
  long backsolves = 0;   ///< right-hand sides, not calls
  long half_solves = 0;  ///< right-hand sides reduced and expanded; where either is a whole solve, not counted here
  long fallbacks = 0;    ///< factorisations repeated by another kind because the first failed
};

/// Right-hand sides b with their rows o eliminated. o: the rows that are not kept; k: the kept ones.
template <class T>
struct Reduction {
  Matrix<T> kept;    ///< b_k - A_ko A_oo^-1 b_o
  Matrix<T> others;  ///< what the second half of a solve takes of b_o, in the backend's order

  Reduction columns(Eigen::Index first, Eigen::Index count) const {
    return {kept.middleCols(first, count), others.middleCols(first, std::min(count, others.cols()))};
  }
};

/// What a factor will be, known before there is one.
struct FactorSize {
  double flops = 0;    ///< additions and multiplications
  double entries = 0;  ///< that are not zero
};

/// T is double or std::complex<double>; the complex one (the oracle's) is always Eigen's SparseLU.
/// The matrix is passed whole (both triangles) whatever the symmetry.
template <class T>
class LinearSolver {
 public:
  explicit LinearSolver(Backend backend = Backend::automatic);
  ~LinearSolver();
  LinearSolver(LinearSolver&&) noexcept;
  LinearSolver& operator=(LinearSolver&&) noexcept;

  /// Orders and analyses the pattern (kept by reference-counted pointer, so it may not change afterwards). `kept`: how
  /// many rows, at its end, schur_complement() is to keep; a backend that can orders them last.
  void analyse(std::shared_ptr<const Pattern> pattern, Symmetry symmetry, int kept = 0);

  /// Factorises the values (one per entry of the pattern). A Cholesky that meets a pivot that is not positive falls
  /// back to LDL^T or LU (`fallbacks` counts it). Returns false where the matrix is singular to working precision or
  /// not finite; `message` then says which pivot or row. pre: analyse(). Throws std::bad_alloc where memory ends.
  bool factorise(const T* values);

  /// Solves A X = B (or A^T X = B) for all columns of B in one call and returns X.
  /// pre: the last factorise() returned true.
  Matrix<T> solve(const Matrix<T>& right_hand_sides, Taken taken = Taken::as_is);

  /// Schur complement of all other rows on the kept ones, A_kk - A_ko A_oo^-1 A_ok: L_kk L_kk^T of a Cholesky factor
  /// that has them last (CHOLMOD), else the inverse of the kept block of A^-1, by a back-solve for each. pre: the last
  /// factorise() returned true.
  Matrix<T> schur_complement();

  /// A solve in two halves, between which x_k becomes known. reduce() takes b to the kept rows. expand() gives x_o of
  /// A_oo x_o + A_ok x_k = b_o; `others`: those of the reduction. A Cholesky factor that has the kept rows last
  /// (CHOLMOD) goes forwards in the first half and backwards in the second. With another factor each half is a whole
  /// solve. Halves are not refined: the triangular solves of a Cholesky factor are stable whatever the scales of the
  /// unknowns [Hig02, 10.1]. pre: the last factorise() returned true.
  /// `wanted`: the rows of x_o that are read, where not all are. The way back then leads through their ancestors in the
  /// elimination tree alone, and the other rows may be zero.
  Reduction<T> reduce(const Matrix<T>& right_hand_sides);
  Matrix<T> expand(const Matrix<T>& kept, Matrix<T> others, const std::vector<int>* wanted = nullptr);

  /// Sign of the determinant of the last factor, +1 or -1 (complex: of the real part of its phase).
  int determinant_sign() const;

  /// Relative backward error of the last solve, max_i |b - A x|_i / (|A||x| + |b|)_i over its columns (Oettli-Prager),
  /// with the values last factorised.
  double backward_error() const;

  /// Estimate of the 1-norm condition number (Hager-Higham, 5 solves, not counted); 0 where no factors are usable.
  double condition_estimate();

  const SolverCounters& counters() const;
  std::string name() const;            ///< e.g. "MUMPS 5.5.1 LU, PORD"; empty before analyse()
  const std::string& message() const;  ///< why the last factorise() failed
  /// Size of the factor by the analysis; where the backend does not tell it, that of predict_factor(). pre: analyse().
  FactorSize factor_size() const;
  long factor_nonzeros() const;  ///< entries of the last factor; 0 where the backend does not tell
  long factor_bytes() const;     ///< that the backend keeps of it, indices included

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Size of the Cholesky factor of a pattern whose last `kept` rows are eliminated last, by CHOLMOD's symbolic analysis.
/// Without CHOLMOD it is that of a square of cells in the plane.
FactorSize predict_factor(std::shared_ptr<const Pattern> pattern, int kept);

/// Names of the backends built in, for provenance: {"CHOLMOD 3.0.14", "MUMPS 5.5.1", "Eigen 3.4.0"}.
std::vector<std::string> linear_solver_libraries();
/// True where the backend is built in.
bool has_backend(Backend);
/// The BLAS that is loaded, as far as it tells ("OpenBLAS 0.3.21 serial ..."; "unknown (reference?)").
std::string blas_name();
/// Sets the BLAS to n threads where it knows how (weak symbol openblas_set_num_threads); returns whether it did.
bool set_blas_threads(int n);

}  // namespace stickslip
