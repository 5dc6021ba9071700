/// The contraction that the secants of an iteration show.
#include "methods/augmentation/acceleration.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace stickslip::acceleration_test {
namespace {

/// Symmetric, with these eigenvalues; modes across all entries (a Householder reflection).
Matrix<double> symmetric(const Vector<double>& eigenvalues) {
  const auto n = eigenvalues.size();
  const Vector<double> v = Vector<double>::LinSpaced(n, 1, 2).normalized();
  const Matrix<double> Q = Matrix<double>::Identity(n, n) - 2 * v * v.transpose();
  return Q * eigenvalues.asDiagonal() * Q;
}

/// Secants of x <- A x, one after the other.
std::vector<Secant> iterate(const Matrix<double>& A, Vector<double> x, int count) {
  std::vector<Secant> secants;
  for (; count > 0; --count) {
    const Vector<double> image = A * x;
    secants.push_back({x, image, 1e-16 * secants.size()});
    x = image;
  }
  return secants;
}

TEST(Contraction, OfOneSecantIsItsRatio) {
  const Matrix<double> A = symmetric(Vector<double>::LinSpaced(5, 0.1, 0.5));
  const auto secants = iterate(A, Vector<double>::Unit(5, 0), 1);
  EXPECT_DOUBLE_EQ(contraction(secants), secants[0].image.norm());
}

TEST(Contraction, IsTheSpectralRadiusOnceTheSpaceIsFull) {
  Vector<double> eigenvalues(4);
  eigenvalues << 0.9, -0.3, 0.2, 0.1;
  // the slowest mode has a share of a thousandth, and has not grown to be seen in the ratio
  Vector<double> modes(4);
  modes << 1e-3, 1, 1, 1;
  const Vector<double> v = Vector<double>::LinSpaced(4, 1, 2).normalized();
  const Vector<double> x = modes - 2 * v * v.dot(modes);
  const auto secants = iterate(symmetric(eigenvalues), x, 4);
  EXPECT_LT(secants.back().image.norm() / secants.back().argument.norm(), 0.5);
  EXPECT_NEAR(contraction(secants), 0.9, 1e-9);  // rounding times the condition of four powers, 1e6
}

TEST(Contraction, LeavesOutWhatIsNoise) {
  const Matrix<double> A = symmetric(Vector<double>::LinSpaced(6, 0.1, 0.6));
  auto secants = iterate(A, Vector<double>::Unit(6, 2), 3);
  const double q = contraction(secants);
  EXPECT_GT(q, 0);
  const Vector<double> argument = Vector<double>::LinSpaced(6, -1, 3);
  secants.push_back({argument, 10 * argument, 0.05 * argument.norm()});  // known to be useless
  EXPECT_EQ(contraction(secants), q);
  secants.back().noise = 1e-12;  // taken at its word it counts
  EXPECT_GT(contraction(secants), 1);
}

TEST(Contraction, OfASecantThatRepeatsIsNotUndefined) {
  const Matrix<double> A = symmetric(Vector<double>::LinSpaced(3, 0.2, 0.4));
  auto secants = iterate(A, Vector<double>::Unit(3, 0), 1);
  secants.push_back(secants[0]);
  secants.push_back(secants[0]);
  EXPECT_DOUBLE_EQ(contraction(secants), secants[0].image.norm());
}

}  // namespace
}  // namespace stickslip::acceleration_test
