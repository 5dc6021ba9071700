/// What is eliminated of contact points before a dense system is factorised: the solutions, those of the transposed
/// system and the sign of the determinant are those of the whole system.
#include "core/engine/point_elimination.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <complex>
#include <random>

#include "core/algebra/dense_factor.hpp"

namespace stickslip::point_elimination_test {
namespace {

/// Contact points on 4 master nodes and a slave node each, all of three displacements.
enum class Kind { sticks, slides, frictionless, open_with_friction, singular, shares_its_node };

template <class T>
struct System {
  Matrix<T> K, whole;
  std::vector<Eigen::Triplet<T>> border;
  std::vector<typename PointElimination<T>::Point> points;
  Eigen::Index eliminated = 0;  ///< unknowns that should be

  explicit System(const std::vector<Kind>& kinds) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> number(-1, 1);
    const int nodes = 4 + static_cast<int>(kinds.size()), free = 3 * nodes;
    const auto draw = [&](int rows, int columns) {
      return Matrix<T>(Matrix<double>::NullaryExpr(rows, columns, [&] { return number(random); }).template cast<T>());
    };
    const Matrix<T> A = draw(free, free);
    K = A * A.transpose() + T(0.3) * draw(free, free);
    int size = free;
    for (const Kind kind : kinds) size += kind == Kind::frictionless ? 1 : 3;
    whole = Matrix<T>::Zero(size, size);
    whole.topLeftCorner(free, free) = K;
    int next = free;
    for (std::size_t p = 0; p < kinds.size(); ++p) {
      const Kind kind = kinds[p];
      const int slave = 3 * (4 + static_cast<int>(p)), master = 3 * static_cast<int>(p % 4);
      const int count = kind == Kind::frictionless ? 1 : 3;
      const Eigen::HouseholderQR<Eigen::Matrix3d> qr(Eigen::Matrix3d::NullaryExpr([&] { return number(random); }));
      Matrix<T> frame = Matrix<double>(Eigen::Matrix3d(qr.householderQ())).leftCols(count).template cast<T>();
      const Matrix<T> directions = frame;
      if (kind == Kind::slides) {  // as of a law of friction: along the direction of the slip no force depends on l
        const double rest = 0.4, mu = 0.3;
        frame.col(0) -= T(mu) * directions.col(1);
        frame.col(1).setZero();
        frame.col(2) *= T(rest);
      }
      if (kind == Kind::singular) frame.col(2) = frame.col(1) + T(0.002) * frame.col(2);
      Matrix<T> rows = T(5) * (kind == Kind::slides ? directions : frame).transpose(),
                law = Matrix<T>::Zero(count, count);
      const int first_law = kind == Kind::slides ? 1 : kind == Kind::open_with_friction ? 0 : 3;
      for (int c = first_law; c < 3; ++c)
        for (int d = 0; d < 3; ++d) law(c, d) = T(number(random) + 2 * (c == d));
      if (kind == Kind::open_with_friction) rows.setZero();
      typename PointElimination<T>::Point point;
      for (int c = 0; c < count; ++c) point.multipliers.push_back(next + c);
      const int on = kind == Kind::shares_its_node ? slave - 3 : slave;  // the node of the point before it
      if (kind != Kind::shares_its_node)
        for (int i = 0; i < 3; ++i) point.slave.push_back(slave + i);
      const auto add = [&](int row, int column, const T& x) {
        border.emplace_back(row, column, x);
        whole(row, column) += x;
      };
      for (int c = 0; c < count; ++c) {
        for (int i = 0; i < 3; ++i) {
          add(on + i, next + c, frame(i, c));
          add(master + i, next + c, T(-0.7) * frame(i, c));
          add(next + c, on + i, rows(c, i));
          add(next + c, master + i, T(-0.7) * rows(c, i));
        }
        for (int d = 0; d < count; ++d)
          if (law(c, d) != T(0)) add(next + c, next + d, law(c, d));
      }
      if (kind == Kind::shares_its_node) points.back().slave.clear();  // (as whoever makes the lists finds)
      points.push_back(point);
      next += count;
    }
    for (std::size_t p = 0; p < kinds.size(); ++p) {
      if (points[p].slave.empty() || kinds[p] == Kind::singular) continue;
      const auto multipliers = static_cast<Eigen::Index>(points[p].multipliers.size());
      eliminated += multipliers + (kinds[p] == Kind::sticks         ? 3
                                   : kinds[p] == Kind::frictionless ? 1
                                   : kinds[p] == Kind::slides       ? 1
                                                                    : 0);
    }
  }
  PointElimination<T> elimination() const {
    typename PointElimination<T>::Sparse sparse(whole.rows(), whole.rows());
    sparse.setFromTriplets(border.begin(), border.end());
    return {K, sparse, points};
  }
};

template <class T>
class OfScalars : public testing::Test {};
using Scalars = testing::Types<double, std::complex<double>>;
TYPED_TEST_SUITE(OfScalars, Scalars);

TYPED_TEST(OfScalars, HasTheSolutionsAndTheSignOfTheWholeSystem) {
  using T = TypeParam;
  using enum Kind;
  const std::vector<std::vector<Kind>> cases{
      {sticks},
      {slides},
      {frictionless, frictionless},
      {sticks, slides, frictionless, open_with_friction, sticks},
      {slides, singular, sticks},
      {sticks, slides, shares_its_node, frictionless},
  };
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const System<T> system(cases[k]);
    const auto elimination = system.elimination();
    EXPECT_EQ(system.whole.rows() - elimination.reduced().rows(), system.eliminated) << k;
    DenseFactor<T> reduced, whole;
    long count = 0;
    ASSERT_TRUE(reduced.factorise(elimination.reduced(), Symmetry::general, count));
    ASSERT_TRUE(whole.factorise(system.whole, Symmetry::general, count));
    EXPECT_EQ(reduced.determinant_sign() * elimination.sign(), whole.determinant_sign()) << k;
    const Matrix<T> x = Matrix<double>::Random(system.whole.rows(), 3).template cast<T>();
    // rounding of solves: conditions are below 1e5
    for (const Taken taken : {Taken::as_is, Taken::transposed}) {
      const Matrix<T> matrix = taken == Taken::as_is ? system.whole : Matrix<T>(system.whole.transpose()),
                      b = matrix * x;
      EXPECT_LT((elimination.times(x, taken) - b).norm(), 1e-13 * b.norm()) << k;
      const Matrix<T> found = elimination.solve(b, taken, [&](const Matrix<T>& r) { return reduced.solve(r, taken); });
      EXPECT_LT((found - x).norm(), 1e-9 * x.norm()) << k << (taken == Taken::as_is ? "" : " transposed");
    }
  }
}

// Constraints that act as the forces do: what is left of a symmetric system is symmetric.
TEST(PointElimination, KeepsASymmetricSystemSo) {
  System<double> system({Kind::frictionless, Kind::sticks, Kind::frictionless});
  system.K = (system.K + system.K.transpose()).eval() / 2;
  const auto elimination = system.elimination();
  ASSERT_TRUE(elimination.keeps_symmetry());
  const Matrix<double>& left = elimination.reduced();
  EXPECT_LT((left - left.transpose()).norm(), 1e-13 * left.norm());
}

}  // namespace
}  // namespace stickslip::point_elimination_test
