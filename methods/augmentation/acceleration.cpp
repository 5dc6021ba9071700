#include "methods/augmentation/acceleration.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

namespace stickslip {

double contraction(const std::vector<Secant>& secants) {
  constexpr double tolerable = 0.02;
  const auto m = static_cast<Eigen::Index>(secants.size());
  Matrix<double> space(secants[0].argument.size(), m), image(space.rows(), m);
  Vector<double> noise(m);
  Eigen::Index rank = 0;
  for (const Secant& secant : secants) {
    const double size = norm(secant.argument);
    Vector<double> direction = secant.argument / size, its_image = secant.image / size;
    double squared = secant.noise * secant.noise;
    for (int twice = 0; twice < 2; ++twice) {
      const Vector<double> known = space.leftCols(rank).transpose() * direction;
      direction -= space.leftCols(rank) * known;
      its_image -= image.leftCols(rank) * known;
      if (twice == 0) squared += known.cwiseProduct(noise.head(rank)).squaredNorm();
    }
    const double novel = direction.norm();
    if (!(squared < std::pow(tolerable * novel, 2))) continue;
    space.col(rank) = direction / novel;
    image.col(rank) = its_image / novel;
    noise[rank++] = std::sqrt(squared) / novel;
  }
  if (rank < 2) return norm(secants.back().image) / norm(secants.back().argument);
  const Matrix<double> A = space.leftCols(rank).transpose() * image.leftCols(rank);
  return A.eigenvalues().cwiseAbs().maxCoeff();
}

Vector<double> anderson_weights(const Matrix<double>& differences, const Vector<double>& residual, double noise) {
  constexpr double worst_condition = 1e8;
  const Vector<double> norms = differences.colwise().norm();
  Vector<double> gamma = Vector<double>::Zero(norms.size());
  Eigen::Index dropped = 0;
  for (Eigen::Index i = 0; i < norms.size(); ++i)
    if (norms[i] <= noise) dropped = i + 1;
  for (; dropped < norms.size(); ++dropped) {
    const Eigen::Index count = norms.size() - dropped;
    const Matrix<double> used = differences.rightCols(count) * norms.tail(count).cwiseInverse().asDiagonal();
    const Eigen::HouseholderQR<Matrix<double>> qr(used);
    const Eigen::Index rank = std::min(used.rows(), count);
    const Matrix<double> R = qr.matrixQR().topRows(rank).triangularView<Eigen::Upper>();
    const auto singular = Eigen::JacobiSVD<Matrix<double>>(R).singularValues();
    if (rank < count || singular[0] > worst_condition * singular[rank - 1]) continue;
    gamma.tail(count) = qr.solve(residual).cwiseQuotient(norms.tail(count));
    break;
  }
  return gamma;
}

}  // namespace stickslip
