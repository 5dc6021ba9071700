/// Negative eigenvalues of symmetric sparse matrices of one pattern, counted.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/algebra/linear_solver.hpp"

namespace stickslip {

/// By Cholesky factorisation, which succeeds if there are none (CHOLMOD, where it is built in); else by the signs of
/// the pivots of L D L^T, which are those of the eigenvalues (Sylvester's law of inertia), without pivoting (Eigen).
class Inertia {
 public:
  /// Orders and analyses the pattern.
  explicit Inertia(std::shared_ptr<const Pattern> pattern);
  ~Inertia();
  Inertia(Inertia&&) noexcept;
  Inertia& operator=(Inertia&&) noexcept;

  /// `values`: one per entry of the pattern. Adds to `factorizations` how many were made. Nothing where a pivot
  /// vanishes.
  std::optional<int> negative_eigenvalues(const std::vector<double>& values, long& factorizations);
  /// Size of the factor.
  FactorSize size() const { return size_; }

 private:
  struct Factors;
  std::shared_ptr<const Pattern> pattern_;
  FactorSize size_;
  std::unique_ptr<Factors> factors_;
};

}  // namespace stickslip
