#include "core/algebra/inertia.hpp"

#include <Eigen/SparseCholesky>

#include "core/algebra/backend.hpp"

namespace stickslip {

struct Inertia::Factors {
#ifdef STICKSLIP_WITH_CHOLMOD
  std::optional<CholmodFactor> cholesky;
#endif
  std::optional<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>> indefinite;  ///< made where it is needed
};

Inertia::Inertia(std::shared_ptr<const Pattern> pattern)
    : pattern_(std::move(pattern)), factors_(std::make_unique<Factors>()) {
  if (pattern_->size == 0) return;
#ifdef STICKSLIP_WITH_CHOLMOD
  size_ = factors_->cholesky.emplace(pattern_, 0).size();
#else
  size_ = predict_factor(pattern_, 0);
#endif
}
Inertia::~Inertia() = default;
Inertia::Inertia(Inertia&&) noexcept = default;
Inertia& Inertia::operator=(Inertia&&) noexcept = default;

std::optional<int> Inertia::negative_eigenvalues(const std::vector<double>& values, long& factorizations) {
  if (pattern_->size == 0) return 0;
#ifdef STICKSLIP_WITH_CHOLMOD
  ++factorizations;
  if (factors_->cholesky->factorise(values.data()).outcome == Factorisation::Outcome::done) return 0;
#endif
  const Eigen::Map<const Eigen::SparseMatrix<double>> matrix(pattern_->size, pattern_->size, pattern_->nonzeros(),
                                                             pattern_->column_start.data(), pattern_->row.data(),
                                                             values.data());
  auto& factor = factors_->indefinite;
  if (!factor) factor.emplace().analyzePattern(matrix);
  ++factorizations;
  factor->factorize(matrix);
  if (factor->info() != Eigen::Success || !factor->vectorD().allFinite()) return std::nullopt;
  return static_cast<int>((factor->vectorD().array() < 0).count());
}

}  // namespace stickslip
