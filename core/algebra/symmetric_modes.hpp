/// Eigenvalues and eigenvectors of symmetric matrices, in one place: the algorithm's templates take long to compile.
#pragma once

#include "core/algebra/linear_solver.hpp"

namespace stickslip {

struct SymmetricModes {
  Vector<double> values;   ///< ascending
  Matrix<double> vectors;  ///< one a column, of unit length
};
/// `symmetric`: the lower triangle is read.
SymmetricModes symmetric_modes(const Matrix<double>& symmetric);

/// How many eigenvalues are negative. In complex, of a matrix that is its own adjoint.
int count_negative_eigenvalues(const Matrix<double>& symmetric);
int count_negative_eigenvalues(const Matrix<std::complex<double>>& adjoint);

}  // namespace stickslip
