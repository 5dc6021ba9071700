/// The factorisations behind LinearSolver, one class a library. Private to core/algebra: include linear_solver.hpp.
///
/// Each class holds one pattern, analysed in its constructor, and offers
///   Factorisation factorise(const T* values)                    a new factor, or why there is none; throws
///                                                               std::bad_alloc where memory ends
///   void solve(const Matrix<T>& b, Matrix<T>& x, Taken taken)   sets x; pre: the last factorise() was done
///   std::string name() const                                    library, version, kind, ordering
///   long factor_nonzeros() const                                entries of the last factor
///   long factor_bytes() const                                   what the library keeps of it
/// `Factor<T>` is the closed set of the classes built in. Data is what the library keeps. Its type is incomplete here,
/// so a shared_ptr holds it, which can destroy such a type; it is never shared.
#pragma once

#include <memory>
#include <string>
#include <variant>

#include "core/algebra/linear_solver.hpp"

namespace stickslip {

/// How one numeric factorisation ended.
struct Factorisation {
  enum class Outcome {
    done,
    not_positive_definite,  ///< a Cholesky met a pivot that is not positive: another kind may still succeed
    singular,               ///< an exact zero pivot
    failed                  ///< an error of the library
  };
  Outcome outcome = Outcome::done;
  std::string message;  ///< empty where done
  /// Smallest pivot over the largest entry of its column. Rows and columns are scaled, so the units of the unknowns do
  /// not matter. In (0, 1] or a little above. Only its order of magnitude has a meaning: a small one is a reason to
  /// look at the condition number.
  double smallest_pivot = 1;
  int determinant_sign = 1;  ///< +1 or -1; of the real part of the determinant's phase where complex
};

#ifdef STICKSLIP_WITH_CHOLMOD
/// Supernodal Cholesky factorisation; reads the lower triangle.
class CholmodFactor {
 public:
  /// The last `kept` rows are eliminated last. Throws std::bad_alloc where memory ends, std::runtime_error where the
  /// analysis fails otherwise.
  CholmodFactor(std::shared_ptr<const Pattern> pattern, int kept);
  Factorisation factorise(const double* values);
  FactorSize size() const;  ///< by the analysis
  /// Size of the factor that a pattern would have, without making it; throws as the constructor does.
  static FactorSize predict(std::shared_ptr<const Pattern> pattern, int kept);
  /// L_kk L_kk^T of the kept rows. pre: the last factorise() was done.
  Matrix<double> schur_complement() const;
  /// Supernodes::reduce and expand. pre: the last factorise() was done.
  Reduction<double> reduce(const Matrix<double>& b);
  Matrix<double> expand(const Matrix<double>& kept, const Matrix<double>& y, const std::vector<int>* wanted);
  void solve(const Matrix<double>& b, Matrix<double>& x, Taken taken);
  std::string name() const;
  long factor_nonzeros() const;
  long factor_bytes() const;
  static std::string library();

 private:
  struct Data;
  std::shared_ptr<Data> data_;
};
#endif

#ifdef STICKSLIP_WITH_MUMPS
/// Multifrontal LU, LDL^T (1 x 1 and 2 x 2 pivots) or LL^T factorisation by the symmetry, PORD ordering; the
/// symmetric ones read the lower triangle.
class MumpsFactor {
 public:
  /// Throws std::bad_alloc where memory ends, std::runtime_error where the analysis fails otherwise.
  MumpsFactor(std::shared_ptr<const Pattern> pattern, Symmetry symmetry);
  Factorisation factorise(const double* values);
  void solve(const Matrix<double>& b, Matrix<double>& x, Taken taken);
  std::string name() const;
  long factor_nonzeros() const;
  long factor_bytes() const;
  static std::string library();

 private:
  struct Data;
  std::shared_ptr<Data> data_;
};
#endif

/// Supernodal LU factorisation with partial pivoting of the row-scaled matrix, COLAMD ordering; always built in, and
/// the only one for complex matrices.
template <class T>
class EigenFactor {
 public:
  explicit EigenFactor(std::shared_ptr<const Pattern> pattern);
  Factorisation factorise(const T* values);
  void solve(const Matrix<T>& b, Matrix<T>& x, Taken taken);
  std::string name() const;
  long factor_nonzeros() const;
  long factor_bytes() const;

 private:
  struct Data;
  std::shared_ptr<Data> data_;
};
/// "Eigen 3.4.0".
std::string eigen_library();

template <class T>
struct FactorOf {
  using Type = std::variant<EigenFactor<T>>;
};
template <>
struct FactorOf<double> {
  using Type = std::variant<EigenFactor<double>
#ifdef STICKSLIP_WITH_CHOLMOD
                            ,
                            CholmodFactor
#endif
#ifdef STICKSLIP_WITH_MUMPS
                            ,
                            MumpsFactor
#endif
                            >;
};
template <class T>
using Factor = typename FactorOf<T>::Type;

/// A factor of a kind that suits the symmetry, where the backend is left open or does not. T: double, complex.
template <class T>
std::unique_ptr<Factor<T>> make_factor(Backend backend, std::shared_ptr<const Pattern> pattern, Symmetry symmetry,
                                       int kept);

}  // namespace stickslip
