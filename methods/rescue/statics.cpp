#include "methods/rescue/statics.hpp"

#include <Eigen/QR>
#include <vector>

namespace stickslip {

double unbalanced_share(const RigidStatics& statics) {
  const double size = norm(statics.load);
  if (!(size > 0)) return 0;
  // All factors are >= 0. A support has two columns, one for each sign.
  const Eigen::Index rows = statics.load.size(), limits = statics.limit.size();
  const Eigen::Index pushes = statics.pushes.cols(), holds = statics.holds.cols();
  Matrix<double> A = Matrix<double>::Zero(rows + 2 * limits, pushes + 2 * holds + 2 * limits);
  A.topLeftCorner(rows, pushes + 2 * holds) << statics.pushes, statics.holds, -statics.holds;
  Vector<double> b = Vector<double>::Zero(A.rows());
  b.head(rows) = -statics.load / size;
  for (Eigen::Index k = 0; k < 2 * limits; ++k) {  // +- tangential x + slack = limit, each row scaled to 1
    const double limit = statics.limit[k / 2] / size, scale = std::max(1.0, limit);
    A.row(rows + k).head(pushes) = (k % 2 == 0 ? 1 : -1) / scale * statics.tangential.row(k / 2);
    A(rows + k, pushes + 2 * holds + k) = 1;
    b[rows + k] = limit / scale;
  }
  const double negligible = 1e-13 * std::sqrt(static_cast<double>(A.rows()));  // rounding of a column of norm 1
  Vector<double> x = Vector<double>::Zero(A.cols());
  std::vector<int> passive;
  const auto least_squares = [&] {
    if (passive.empty()) return Vector<double>();  // (Eigen factorises no matrix without columns)
    Matrix<double> P(A.rows(), passive.size());
    for (std::size_t k = 0; k < passive.size(); ++k) P.col(k) = A.col(passive[k]);
    return Vector<double>(P.completeOrthogonalDecomposition().solve(b));
  };
  for (Eigen::Index round = 0; round < 3 * A.cols(); ++round) {
    const Vector<double> descent = A.transpose() * (b - A * x);
    int best = -1;
    for (int j = 0; j < descent.size(); ++j)
      if (x[j] == 0 && descent[j] > negligible && (best < 0 || descent[j] > descent[best])) best = j;
    if (best < 0) break;
    passive.push_back(best);
    Vector<double> z = least_squares();
    while (z.size() > 0 && z.minCoeff() <= 0) {  // return to the last x >= 0, and drop the columns that are 0 there
      double step = 1;
      for (std::size_t k = 0; k < passive.size(); ++k)
        if (z[k] <= 0) step = std::min(step, x[passive[k]] / (x[passive[k]] - z[k]));
      std::vector<int> kept;
      for (std::size_t k = 0; k < passive.size(); ++k) {
        double& of = x[passive[k]];
        of += step * (z[k] - of);
        if (of > 1e-15)
          kept.push_back(passive[k]);
        else
          of = 0;
      }
      if (kept.size() == passive.size()) break;
      passive = std::move(kept);
      z = least_squares();
    }
    for (std::size_t k = 0; k < passive.size(); ++k) x[passive[k]] = z[k];
  }
  return (b - A * x).norm();
}

}  // namespace stickslip
