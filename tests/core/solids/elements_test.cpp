/// Every element in every kinematics: tangent, rigid motions, rank, patch test, volumes; and the shares of their edges.
#include "core/solids/elements.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <complex>
#include <limits>

#include "core/mesh/generators.hpp"
#include "core/mesh/quality.hpp"
#include "core/solids/edges.hpp"
#include "core/solids/linear_elastic.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::elements_test {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double E = 1000, nu = 0.3;
const double pi = std::acos(-1.0);

template <class S, Kinematics k>
struct Setting {
  using Shape = S;
  static constexpr Kinematics kinematics = k;
};

/// An element away from the axis with no two edges alike; the middles of its sides lie off their chords.
template <class Shape>
Nodal<double, Shape> distorted() requires(Shape::dimension == 3) {
  using Linear = std::conditional_t<Shape::is_simplex, Tet4, Hex8>;
  Nodal<double, Linear> corners;
  if constexpr (Shape::is_simplex)
    corners << 2.1, 3.3, 2.4, 2.2, -0.2, 0.3, 1.1, 0.2, 0.1, -0.1, 0.2, 1.3;
  else
    corners << 2.1, 3.3, 3.0, 1.8, 2.0, 3.1, 3.2, 2.1,  //
        -0.2, 0.1, 1.4, 0.9, -0.1, 0.2, 1.1, 1.0,       //
        0.1, -0.1, 0.2, 0.0, 1.2, 1.0, 1.3, 0.9;
  Nodal<double, Shape> X;
  for (int a = 0; a < Shape::nodes; ++a) {
    const Vec<double, 3> at = natural_node<Shape>(a);
    X.col(a) = corners * Linear::at(at[0], at[1], at[2], 0).value;
    if (a >= Shape::corners) X.col(a) += 0.03 * Vec<double, 3>(std::sin(a), std::cos(2.0 * a), std::sin(3.0 * a));
  }
  return X;
}
template <class Shape>
Mat<double, 2, Shape::nodes> distorted() requires(Shape::dimension == 2) {
  Mat<double, 2, Shape::corners> corners;
  if constexpr (Shape::corners == 3)
    corners << 2.1, 3.3, 2.4, -0.2, 0.3, 1.1;
  else
    corners << 2.1, 3.3, 3.0, 1.8, -0.2, 0.1, 1.4, 0.9;
  Mat<double, 2, Shape::nodes> X;
  X.template leftCols<Shape::corners>() = corners;
  for (int a = Shape::corners; a < Shape::nodes; ++a) {
    const int first = a - Shape::corners, second = (first + 1) % Shape::corners;
    X.col(a) = 0.5 * (corners.col(first) + corners.col(second)) + 0.03 * (first + 1) * Vec<double, 2>(1, -0.5);
  }
  return X;
}

template <class T>
LinearElasticLaw<T> law(Kinematics kinematics) {
  if (is_in_space(kinematics)) return {T(E), T(nu), Space::solid};
  return {T(E), T(nu), is_of_revolution(kinematics) ? Space::axisymmetric : Space::plane_strain};
}

/// Displacements that are no special case.
template <class Shape>
Nodal<double, Shape> arbitrary() {
  Nodal<double, Shape> u;
  for (int k = 0; k < u.size(); ++k) u.data()[k] = std::sin(1.7 * k + 0.3);
  return u;
}

template <class S>
class Elements : public testing::Test {
 protected:
  using Shape = typename S::Shape;
  static constexpr Kinematics kinematics = S::kinematics;
  static constexpr int n = Shape::nodes, dimension = Shape::dimension, dofs = dofs_of<Shape>;
  static constexpr bool revolved = is_of_revolution(kinematics);
  template <class T>
  using At = Nodal<T, Shape>;
  using Local = At<double>;
  const Local X = distorted<Shape>();

  template <class T>
  static At<T> forces(const At<T>& at, const At<T>& u) {
    return element_forces<T, Shape, kinematics>(law<T>(kinematics), at, u);
  }
  /// (of dynamic size, so that what is made of it is compiled once)
  static Matrix<double> tangent(const Local& at) {
    return element_tangent<double, Shape, kinematics>(law<double>(kinematics), at, Local::Zero());
  }
};
using Settings = testing::Types<
    Setting<Tri3, Kinematics::plane>, Setting<Quad4, Kinematics::plane>, Setting<Tri6, Kinematics::plane>,
    Setting<Quad8, Kinematics::plane>, Setting<Tri3, Kinematics::revolution>, Setting<Quad4, Kinematics::revolution>,
    Setting<Tri6, Kinematics::revolution>, Setting<Quad8, Kinematics::revolution>,
    Setting<Quad4, Kinematics::plane_mean_dilatation>, Setting<Quad4, Kinematics::revolution_mean_dilatation>,
    Setting<Tet4, Kinematics::space>, Setting<Hex8, Kinematics::space>,
    Setting<Hex8, Kinematics::space_mean_dilatation>, Setting<Tet10, Kinematics::space>,
    Setting<Hex20, Kinematics::space>, Setting<Hex27, Kinematics::space>>;
TYPED_TEST_SUITE(Elements, Settings);

TYPED_TEST(Elements, HaveTheTangentOfTheComplexStep) {
  constexpr int dofs = TestFixture::dofs;
  using Complex = std::complex<double>;
  using Local = typename TestFixture::template At<Complex>;
  const auto u = arbitrary<typename TestFixture::Shape>();
  const auto K = this->tangent(this->X);
  const double rounding = 50 * epsilon * largest_entry(K);  // sums of up to some hundred products
  for (int l = 0; l < dofs; ++l) {
    Local moved = u.template cast<Complex>();
    moved.data()[l] += Complex(0, 1e-30);  // its square is lost beside one
    const Local forces = TestFixture::template forces<Complex>(this->X.template cast<Complex>(), moved);
    for (int k = 0; k < dofs; ++k) EXPECT_NEAR(K(k, l), forces.data()[k].imag() / 1e-30, rounding);
  }
  // linear: the forces are the tangent times the displacements
  const auto forces = TestFixture::template forces<double>(this->X, u);
  const Vector<double> product = K * Vector<double>(u.reshaped());
  for (int k = 0; k < dofs; ++k) EXPECT_NEAR(forces.data()[k], product[k], rounding * std::sqrt(double(dofs)));
  EXPECT_LE(largest_entry(K - K.transpose()), rounding);
}

TYPED_TEST(Elements, HaveTheirRigidMotionsAndNoOtherMotionWithoutEnergy) {
  using Local = typename TestFixture::Local;
  constexpr int D = TestFixture::dimension;
  const auto K = this->tangent(this->X);
  const double largest = largest_entry(K);
  std::vector<Local> rigid;
  for (int i = TestFixture::revolved ? 1 : 0; i < D; ++i) {
    rigid.emplace_back(Local::Zero());
    rigid.back().row(i).setConstant(1);
  }
  for (int i = 0; i < D && !TestFixture::revolved; ++i)
    for (int j = i + 1; j < D; ++j) {
      rigid.emplace_back(Local::Zero());
      rigid.back().row(i) = -this->X.row(j);
      rigid.back().row(j) = this->X.row(i);
    }
  for (const auto& mode : rigid)
    EXPECT_LE(largest_entry(K * Vector<double>(mode.reshaped())),
              100 * epsilon * largest);  // sums that cancel, of lengths 3
  const auto values = Eigen::SelfAdjointEigenSolver<Matrix<double>>(K).eigenvalues();
  EXPECT_LE(values[rigid.size() - 1], 200 * epsilon * largest);
  EXPECT_GE(values[rigid.size()], 1e-3 * largest);  // far from rounding: no hourglass
}

/// What the eight-node quadrilateral would be with 2 x 2 points.
struct Quad8Reduced : Quad8 {
  static std::array<Point, 4> quadrature() {
    const double g = 1 / std::sqrt(3.0);
    return {{at(-g, -g, 1), at(g, -g, 1), at(g, g, 1), at(-g, g, 1)}};
  }
};
/// What the twenty-node hexahedron would be with 2 x 2 x 2 points.
struct Hex20Reduced : Hex20 {
  static std::array<Point, 8> quadrature() {
    std::array<Point, 8> points;
    const double g = 1 / std::sqrt(3.0);
    for (std::size_t q = 0; q < points.size(); ++q) points[q] = at(q & 1 ? g : -g, q & 2 ? g : -g, q & 4 ? g : -g, 1);
    return points;
  }
};
/// What the three-node triangle of revolution would be with one point.
struct Tri3Reduced : Tri3 {
  static std::array<Point, 1> quadrature_of_revolution() { return quadrature(); }
};

TEST(Quadrature, WithFewerPointsWouldLeaveMotionsWithoutEnergy) {
  const auto plane = element_tangent<double, Quad8Reduced>(law<double>(Kinematics::plane), distorted<Quad8>(),
                                                           Mat<double, 2, 8>::Zero());
  const auto revolved = element_tangent<double, Tri3Reduced, Kinematics::revolution>(
      law<double>(Kinematics::revolution), distorted<Tri3>(), Mat<double, 2, 3>::Zero());
  auto zeros = [](const Matrix<double>& K) {
    return (Eigen::SelfAdjointEigenSolver<Matrix<double>>(K).eigenvalues().array() < 1e-12 * largest_entry(K)).count();
  };
  const auto solid = element_tangent<double, Hex20Reduced>(law<double>(Kinematics::space), distorted<Hex20>(),
                                                           Mat<double, 3, 20>::Zero());
  EXPECT_EQ(zeros(solid), 60 - 6 * 8);  // six rigid and six more
  EXPECT_EQ(zeros(plane), 4);           // three rigid, one hourglass
  EXPECT_EQ(zeros(revolved), 2);        // one rigid, a rotation about the point
}

template <class Shape, Kinematics kinematics>
std::string element_name() {
  if (Shape::dimension == 3) {
    if (has_mean_dilatation(kinematics)) return "H8_mean_dilatation";
    return (Shape::is_simplex ? "T" : "H") + std::to_string(Shape::nodes);
  }
  if (has_mean_dilatation(kinematics)) return "Q4_mean_dilatation";
  return Shape::nodes == 3 ? "T3" : Shape::nodes == 4 ? "Q4" : Shape::nodes == 6 ? "T6" : "Q8";
}

/// A box of 5 x 4 cells, [1, 6] x [0, 4], in space of 5 x 4 x 3, whose inner corners are moved by up to a quarter of a
/// cell, in space by a sixth.
struct Patch {
  Mesh mesh;
  Points<double> points;
  bool inner(int node) const {
    const auto x = points.col(node);
    return x[0] > 1 && x[0] < 6 && x[1] > 0 && x[1] < 4 && (x.size() == 2 || (x[2] > 0 && x[2] < 3));
  }
};
Patch irregular_patch(const std::string& element, int dimension) {
  BoxMesh box;
  box.min = {1.0, 0.0, 0.0};
  box.max = {6.0, 4.0, 3.0};
  box.cells = {5, 4, 3};
  for (auto* corner : {&box.min, &box.max}) corner->resize(dimension);
  box.cells.resize(dimension);
  Patch patch{make_mesh(box, element, dimension), make_points<double>(box, Numbers<double>{}, dimension)};
  const auto regular = patch;
  for (int node = 0; node < patch.points.cols(); ++node)
    for (int i = 0; i < dimension && regular.inner(node); ++i)
      patch.points(i, node) +=
          (dimension == 2 ? 0.25 : 1.0 / 6) * (i == 1 ? std::cos(2.3 * node) : std::sin(3.1 * node + i));
  if (!patch.mesh.middles.empty()) patch.points = with_middles(patch.mesh, patch.points);
  return patch;
}

TYPED_TEST(Elements, PassThePatchTestOnAnIrregularMesh) {
  using Shape = typename TestFixture::Shape;
  constexpr int n = TestFixture::n, D = TestFixture::dimension;
  const Patch patch = irregular_patch(element_name<Shape, TestFixture::kinematics>(), Shape::dimension);
  ASSERT_FALSE(first_inverted_element(patch.mesh, patch.points));
  const int nodes = patch.mesh.node_count;
  // of revolution constant strain means u_r = a r, u_y = b y: a shear or a constant u_r would need body forces
  Mat<double, D> H;
  H.template topLeftCorner<2, 2>() << 0.003, -0.007, 0.002, 0.011;
  if constexpr (D == 3) {
    H.row(2) << -0.004, 0.006, 0.005;
    H.col(2).template head<2>() << 0.008, -0.001;
  }
  if (TestFixture::revolved) H(0, 1) = H(1, 0) = 0;
  const Matrix<double> linear = H * patch.points;
  Matrix<double> K = Matrix<double>::Zero(D * nodes, D * nodes), forces = Matrix<double>::Zero(D, nodes);
  for (int e = 0; e < patch.mesh.element_count(); ++e) {
    const int* list = patch.mesh.connectivity.data() + e * n;
    typename TestFixture::Local X, u;
    for (int a = 0; a < n; ++a) X.col(a) = patch.points.col(list[a]), u.col(a) = linear.col(list[a]);
    const auto f = TestFixture::template forces<double>(X, u);
    const auto k = this->tangent(X);
    for (int a = 0; a < n; ++a) {
      forces.col(list[a]) += f.col(a);
      for (int b = 0; b < n; ++b) K.block<D, D>(D * list[a], D * list[b]) += k.template block<D, D>(D * a, D * b);
    }
  }
  std::vector<int> inner, edge;
  for (int dof = 0; dof < D * nodes; ++dof) (patch.inner(dof / D) ? inner : edge).push_back(dof);
  const double largest = largest_entry(forces);
  double unbalanced = 0;
  for (int node = 0; node < nodes; ++node)
    if (patch.inner(node)) unbalanced = larger(unbalanced, forces.col(node).norm());
  EXPECT_LE(unbalanced, 200 * epsilon * largest);  // sums of some hundred products
  // the inner nodes find the linear field from the boundary alone; the condition of the patch is some 100
  const Vector<double> exact = linear.reshaped();
  const Vector<double> solved = K(inner, inner).ldlt().solve(-K(inner, edge) * exact(edge));
  EXPECT_LE(largest_entry(solved - exact(inner)), 1e-13 * largest_entry(exact));
}

TYPED_TEST(Elements, FillTheVolumeOfTheirBody) {
  using Shape = typename TestFixture::Shape;
  const Patch patch = irregular_patch(element_name<Shape, TestFixture::kinematics>(), Shape::dimension);
  double volume = 0;
  for (int e = 0; e < patch.mesh.element_count(); ++e) {
    typename TestFixture::Local X;
    for (int a = 0; a < TestFixture::n; ++a)
      X.col(a) = patch.points.col(patch.mesh.connectivity[e * TestFixture::n + a]);
    for_each_gradient<double, Shape, TestFixture::kinematics>(X, 0.5,
                                                              [&](const auto& gradient) { volume += gradient.volume; });
  }
  const double exact = TestFixture::dimension == 3 ? 5 * 4 * 3
                       : TestFixture::revolved     ? pi * (36 - 1) * 4
                                                   : 5 * 4 * 0.5;
  EXPECT_NEAR(volume, exact, 200 * epsilon * exact);  // a sum of some hundred products
}

TEST(MeanDilatation, IsTheSameAtAllPointsAndThatOfTheElementsVolume) {
  const auto X = distorted<Quad4>();
  const auto u = arbitrary<Quad4>();
  auto traces = [&]<Kinematics kinematics>() {
    std::vector<std::pair<double, double>> all;
    for_each_gradient<double, Quad4, kinematics>(X, 1,
                                                 [&](const auto& g) { all.emplace_back(g.of(u).trace(), g.volume); });
    return all;
  };
  auto expect_mean = [](const auto& plain, const auto& averaged) {
    double mean = 0, volume = 0;
    for (const auto& [trace, v] : plain) mean += trace * v, volume += v;
    for (const auto& [trace, v] : averaged) EXPECT_NEAR(trace, mean / volume, 50 * epsilon);  // some twenty operations
  };
  expect_mean(traces.operator()<Kinematics::plane>(), traces.operator()<Kinematics::plane_mean_dilatation>());
  expect_mean(traces.operator()<Kinematics::revolution>(), traces.operator()<Kinematics::revolution_mean_dilatation>());
}

TEST(SideShares, AreConsistent) {
  Points<double> X(2, 3);
  X << 1, 4, 2.5, 2, 6, 4;  // from (1, 2) to (4, 6), length 5, and its middle
  const Depth<double> slice{false, 0.5}, turn{true, 1};
  const double L = 5, rounding = 100 * epsilon;  // some ten operations on numbers up to 100
  const auto linear = side_shares(X, {0, 1}, slice), quadratic = side_shares(X, {0, 1, 2}, slice);
  EXPECT_NEAR(linear[0], 0.5 * L / 2, rounding);
  EXPECT_NEAR(linear[1], 0.5 * L / 2, rounding);
  EXPECT_NEAR(quadratic[0], 0.5 * L / 6, rounding);
  EXPECT_NEAR(quadratic[1], 0.5 * L / 6, rounding);
  EXPECT_NEAR(quadratic[2], 0.5 * L * 4 / 6, rounding);
  // int N_a 2 pi r ds, r from 1 to 4
  const auto cone = side_shares(X, {0, 1}, turn), fine = side_shares(X, {0, 1, 2}, turn);
  EXPECT_NEAR(cone[0], 2 * pi * L * (2 * 1 + 4) / 6, rounding);
  EXPECT_NEAR(cone[1], 2 * pi * L * (1 + 2 * 4) / 6, rounding);
  EXPECT_NEAR(fine[0], 2 * pi * L * 1 / 6, rounding);
  EXPECT_NEAR(fine[1], 2 * pi * L * 4 / 6, rounding);
  EXPECT_NEAR(fine[2], 2 * pi * L * 4 * 2.5 / 6, rounding);
}

TEST(SideShares, OfFacesAreConsistent) {
  Points<double> X(3, 4);  // a parallelogram of area |(2, 0, 1) x (0, 3, 0)| = 3 sqrt 5
  X << 0, 2, 2, 0, 0, 0, 3, 3, 0, 1, 1, 0;
  const double area = 3 * std::sqrt(5.0), rounding = 100 * epsilon;  // some ten operations on numbers up to 10
  const auto quadrilateral = side_shares(X, {0, 1, 2, 3}, Depth<double>{}),
             triangle = side_shares(X, {0, 1, 2}, Depth<double>{});
  for (int a = 0; a < 4; ++a) EXPECT_NEAR(quadrilateral[a], area / 4, rounding);
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(triangle[a], area / 6, rounding);
  Vec<double, 3> outward = Vec<double, 3>::Zero();  // right-handed with the order of the nodes
  for_each_side_point(X, {0, 1, 2, 3}, Depth<double>{}, [&](const auto&, const auto& out, double) { outward += out; });
  EXPECT_NEAR((outward - Vec<double, 3>(-3, 0, 6)).norm(), 0, rounding);
}

TEST(SideShares, OfAQuadraticEdgeSumUpToTheArcItFollowsToFourthOrder) {
  auto error = [](double half) {
    Points<double> X(2, 3);
    X << std::sin(half), std::sin(-half), 0, std::cos(half), std::cos(half), 1;
    const auto shares = side_shares(X, {0, 1, 2}, Depth<double>{});
    return std::abs((shares[0] + shares[1] + shares[2]) / (2 * half) - 1);
  };
  EXPECT_LT(error(0.2), 1e-4);
  EXPECT_NEAR(std::log2(error(0.2) / error(0.1)), 4, 0.2);  // next order: 4 % of half a radian squared
}

}  // namespace
}  // namespace stickslip::elements_test
