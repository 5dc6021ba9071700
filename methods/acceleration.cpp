#include "methods/acceleration.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace stickslip {

double contraction(const std::vector<Secant>& secants) {
  const Secant& last = secants.back();
  const auto m = static_cast<Eigen::Index>(secants.size());
  Matrix<double> space(last.argument.size(), m), image(last.argument.size(), m);
  for (Eigen::Index j = 0; j < m; ++j) {
    const double length = secants[j].argument.norm();
    space.col(j) = secants[j].argument / length;
    image.col(j) = secants[j].image / length;
  }
  Eigen::ColPivHouseholderQR<Matrix<double>> qr;
  qr.setThreshold(0.02);
  qr.compute(space);
  const Eigen::Index rank = qr.rank();
  if (rank < 2) return last.image.norm() / last.argument.norm();
  const Matrix<double> turned = qr.householderQ().adjoint() * (image * qr.colsPermutation());
  const Matrix<double> R = qr.matrixQR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>();
  const Matrix<double> A = R.transpose().partialPivLu().solve(turned.topLeftCorner(rank, rank).transpose());
  return A.eigenvalues().cwiseAbs().maxCoeff();  // of A transposed, which has the same
}

Vector<double> anderson_weights(const Matrix<double>& differences, const Vector<double>& residual, double noise) {
  constexpr double worst_condition = 1e8;
  const Vector<double> lengths = differences.colwise().norm();
  Vector<double> gamma = Vector<double>::Zero(lengths.size());
  Eigen::Index dropped = 0;
  for (Eigen::Index i = 0; i < lengths.size(); ++i)
    if (lengths[i] <= noise) dropped = i + 1;
  for (; dropped < lengths.size(); ++dropped) {
    const Eigen::Index count = lengths.size() - dropped;
    const Matrix<double> used = differences.rightCols(count) * lengths.tail(count).cwiseInverse().asDiagonal();
    const Eigen::HouseholderQR<Matrix<double>> qr(used);
    const Eigen::Index rank = std::min(used.rows(), count);
    const Matrix<double> R = qr.matrixQR().topRows(rank).triangularView<Eigen::Upper>();
    const auto singular = Eigen::JacobiSVD<Matrix<double>>(R).singularValues();
    if (rank < count || singular[0] > worst_condition * singular[rank - 1]) continue;
    gamma.tail(count) = qr.solve(residual).cwiseQuotient(lengths.tail(count));
    break;
  }
  return gamma;
}

}  // namespace stickslip
