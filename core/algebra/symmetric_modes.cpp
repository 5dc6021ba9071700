#include "core/algebra/symmetric_modes.hpp"

#include <Eigen/Eigenvalues>

namespace stickslip {
namespace {

template <class T>
int count_negative(const Matrix<T>& matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix<T>> modes(matrix, Eigen::EigenvaluesOnly);
  return static_cast<int>((modes.eigenvalues().array() < 0).count());
}

}  // namespace

SymmetricModes symmetric_modes(const Matrix<double>& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Matrix<double>> modes(symmetric);
  return {modes.eigenvalues(), modes.eigenvectors()};
}

int count_negative_eigenvalues(const Matrix<double>& symmetric) { return count_negative(symmetric); }
int count_negative_eigenvalues(const Matrix<std::complex<double>>& adjoint) { return count_negative(adjoint); }

}  // namespace stickslip
