/// The element template with both shapes in both plane spaces: tangent, rigid motions, patch test, stresses.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>

#include "core/mesh/generators.hpp"
#include "core/solids/elements.hpp"
#include "core/solids/linear_elastic.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::continuum_test {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double E = 1000, nu = 0.3;

/// An element of the shape with no two edges alike.
template <class Shape>
Mat<double, 2, Shape::nodes> distorted() {
  Mat<double, 2, Shape::nodes> X;
  if constexpr (Shape::nodes == 3)
    X << 0.1, 1.3, 0.4, -0.2, 0.3, 1.1;
  else
    X << 0.1, 1.3, 1.0, -0.2, -0.2, 0.1, 1.4, 0.9;
  return X;
}

template <class S, Space space_>
struct Setting {
  using Shape = S;
  static constexpr Space space = space_;
};

template <class Setting>
class Continuum : public testing::Test {
 protected:
  using Shape = typename Setting::Shape;
  static constexpr int n = Shape::nodes, dofs = 2 * n;
  using Local = Mat<double, 2, n>;

  const LinearElasticLaw<double> law{E, nu, Setting::space};
  const Local X = distorted<Shape>();

  Mat<double, dofs> tangent(const Local& at) const { return element_tangent<double, Shape>(law, X, at); }
};
using Settings = testing::Types<Setting<Tri3, Space::plane_strain>, Setting<Quad4, Space::plane_strain>,
                                Setting<Tri3, Space::plane_stress>, Setting<Quad4, Space::plane_stress>>;
TYPED_TEST_SUITE(Continuum, Settings);

TYPED_TEST(Continuum, TangentIsTheDualOfTheWholeElement) {
  using Shape = typename TypeParam::Shape;
  const int n = Shape::nodes;
  const Vector<double> u = derivatives::arbitrary(2 * n);
  auto forces = [&](const auto& v) {
    using T = typename std::decay_t<decltype(v)>::Scalar;
    const LinearElasticLaw<T> law(T(E), T(nu), TypeParam::space);
    const Mat<T, 2, Shape::nodes> X = this->X.unaryExpr([](double x) { return T(x); });
    const Mat<T, 2, Shape::nodes> local = v.reshaped(2, n);
    return Vector<T>(element_forces<T, Shape>(law, X, local).reshaped());
  };
  const Matrix<double> whole = derivatives::by_dual(forces, u), K = this->tangent(u.reshaped(2, n));
  EXPECT_LE(derivatives::relative_difference(K, whole), 20 * epsilon);  // sums of some ten products
  // linear: the forces are the tangent times the displacements
  EXPECT_LE(largest_entry(K * u - forces(u)), 20 * epsilon * largest_entry(K));
}

TYPED_TEST(Continuum, TangentIsSymmetricWithThreeRigidModesAndNoOther) {
  using Shape = typename TypeParam::Shape;
  const auto K = this->tangent(Mat<double, 2, Shape::nodes>::Zero().eval());
  const double largest = largest_entry(K);
  EXPECT_LE(largest_entry(K - K.transpose()), 10 * epsilon * largest);  // sums in another order
  Vector<double> x_motion(2 * Shape::nodes), y_motion = x_motion, rotation = x_motion;
  for (int a = 0; a < Shape::nodes; ++a) {
    x_motion.segment<2>(2 * a) << 1, 0;
    y_motion.segment<2>(2 * a) << 0, 1;
    rotation.segment<2>(2 * a) << -this->X(1, a), this->X(0, a);
  }
  for (const auto& mode : {x_motion, y_motion, rotation})
    EXPECT_LE(largest_entry(K * mode), 20 * epsilon * largest);  // a sum of 2 n products that cancel
  const auto values = Eigen::SelfAdjointEigenSolver<Matrix<double>>(K).eigenvalues();
  EXPECT_LE(values[2], 100 * epsilon * largest);
  EXPECT_GE(values[3], 0.01 * largest);  // far from rounding: no hourglass
}

TYPED_TEST(Continuum, HasTheAreaOfItsPolygonAndGradientsOfLinearFieldsExactly) {
  using Shape = typename TypeParam::Shape;
  const auto& X = this->X;
  double polygon = 0, area = 0;
  for (int a = 0; a < Shape::nodes; ++a) {
    const int b = (a + 1) % Shape::nodes;
    polygon += 0.5 * (X(0, a) * X(1, b) - X(0, b) * X(1, a));
  }
  Mat<double, 2> H;
  H << 0.3, -0.7, 0.2, 1.1;
  const Mat<double, 2, Shape::nodes> u = H * X;
  for (const auto& point : Shape::quadrature()) {
    const Gradient<double, Shape> gradient(point, X);
    area += gradient.volume;
    EXPECT_LE(largest_entry(gradient.of(u).full() - H), 20 * epsilon);  // some ten operations
    EXPECT_NEAR(point.value.sum(), 1, 4 * epsilon);
    EXPECT_LE(largest_entry(gradient.dN.rowwise().sum()), 20 * epsilon);
  }
  EXPECT_NEAR(area, polygon, 10 * epsilon);  // sums of four products
}

TYPED_TEST(Continuum, HasTheEnergyThatItsForcesDoToFirstOrderAndInAll) {
  using Shape = typename TypeParam::Shape;
  const int n = Shape::nodes;
  auto energy = [&](const auto& v) {
    using T = typename std::decay_t<decltype(v)>::Scalar;
    const LinearElasticLaw<T> law(T(E), T(nu), TypeParam::space);
    const Mat<T, 2, Shape::nodes> X = this->X.unaryExpr([](double x) { return T(x); });
    const Mat<T, 2, Shape::nodes> local = v.reshaped(2, n);
    return Vector<T>::Constant(1, element_energy<T, Shape>(law, X, local)).eval();
  };
  const Vector<double> u = derivatives::arbitrary(2 * n, 5);
  const Mat<double, 2, Shape::nodes> local = u.reshaped(2, n);
  const Vector<double> forces = element_forces<double, Shape>(this->law, this->X, local).reshaped();
  EXPECT_LE(derivatives::relative_difference(derivatives::by_dual(energy, u).transpose(), forces), 50 * epsilon);
  EXPECT_NEAR(energy(u)[0], 0.5 * u.dot(this->tangent(local) * u), 50 * epsilon * energy(u)[0]);
}

TYPED_TEST(Continuum, HasTheDerivativesOfTheComplexStepWithRespectToShapeAndMaterial) {
  using Shape = typename TypeParam::Shape;
  const int n = Shape::nodes;
  auto forces = [&](const auto& v) {  // coordinates, displacements, E, nu
    using T = typename std::decay_t<decltype(v)>::Scalar;
    const LinearElasticLaw<T> law(v[4 * n], v[4 * n + 1], TypeParam::space);
    const Mat<T, 2, Shape::nodes> X = v.head(2 * n).reshaped(2, n), local = v.segment(2 * n, 2 * n).reshaped(2, n);
    return Vector<T>(element_forces<T, Shape>(law, X, local).reshaped());
  };
  Vector<double> v(4 * n + 2);
  v << this->X.reshaped(), derivatives::arbitrary(2 * n), 1.0, nu;  // E of one, so that no column outweighs another
  const auto dual = derivatives::by_dual(forces, v), exact = derivatives::by_complex_step(forces, v);
  EXPECT_LE(derivatives::relative_difference(dual, exact), 100 * epsilon);  // some fifty operations
}

/// A box of 5 x 4 cells whose inner nodes are moved by up to a quarter of a cell.
struct Patch {
  Mesh mesh;
  Points<double> points;
  std::vector<bool> inner;
};
Patch irregular_patch(const std::string& element) {
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {5.0, 4.0};
  box.cells = {5, 4};
  Patch patch{make_mesh(box, element, 2), make_points<double>(box, Numbers<double>{}, 2), {}};
  const Vector<double> moves = derivatives::arbitrary(2 * patch.mesh.node_count);
  for (int node = 0; node < patch.mesh.node_count; ++node) {
    auto x = patch.points.col(node);
    patch.inner.push_back(x[0] > 0 && x[0] < 5 && x[1] > 0 && x[1] < 4);
    if (patch.inner.back()) x += 0.25 * moves.segment<2>(2 * node);
  }
  return patch;
}

/// Coordinates (or displacements) of an element's nodes.
template <class Shape>
Mat<double, 2, Shape::nodes> of_element(const Patch& patch, int e, const Matrix<double>& field) {
  Mat<double, 2, Shape::nodes> local;
  for (int a = 0; a < Shape::nodes; ++a) local.col(a) = field.col(patch.mesh.connectivity[e * Shape::nodes + a]);
  return local;
}

TYPED_TEST(Continuum, PassesThePatchTestOnAnIrregularMesh) {
  using Shape = typename TypeParam::Shape;
  const Patch patch = irregular_patch(Shape::nodes == 3 ? "T3" : "Q4");
  const int nodes = patch.mesh.node_count;
  Mat<double, 2> H;
  H << 0.003, -0.007, 0.002, 0.011;
  const Matrix<double> linear = H * patch.points;
  Matrix<double> K = Matrix<double>::Zero(2 * nodes, 2 * nodes), forces = Matrix<double>::Zero(2, nodes);
  for (int e = 0; e < patch.mesh.element_count(); ++e) {
    const auto X = of_element<Shape>(patch, e, patch.points), u = of_element<Shape>(patch, e, linear);
    const auto f = element_forces<double, Shape>(this->law, X, u);
    const auto k = element_tangent<double, Shape>(this->law, X, u);
    for (int a = 0; a < Shape::nodes; ++a) {
      const int i = patch.mesh.connectivity[e * Shape::nodes + a];
      forces.col(i) += f.col(a);
      for (int b = 0; b < Shape::nodes; ++b)
        K.block<2, 2>(2 * i, 2 * patch.mesh.connectivity[e * Shape::nodes + b]) += k.template block<2, 2>(2 * a, 2 * b);
    }
  }
  const Mat<double, 2> sigma = this->law.stress(PlaneGradient<double>(H)).full();
  // forces of about E |H| times a length, some fifty of them in a sum
  const double rounding = 50 * epsilon * E * H.norm() * 5;
  Vec<double, 2> right = Vec<double, 2>::Zero();
  for (int node = 0; node < nodes; ++node) {
    if (patch.inner[node]) {
      EXPECT_LE(forces.col(node).norm(), rounding);
    }
    if (patch.points(0, node) == 5) right += forces.col(node);
  }
  // what the corners get from top and bottom cancels between them
  EXPECT_LE((right - 4 * sigma.col(0)).norm(), rounding);

  // the inner nodes find the linear field from the boundary alone
  std::vector<int> inner, edge;
  for (int dof = 0; dof < 2 * nodes; ++dof) (patch.inner[dof / 2] ? inner : edge).push_back(dof);
  const Vector<double> exact = linear.reshaped();
  const Vector<double> solved = K(inner, inner).ldlt().solve(-K(inner, edge) * exact(edge));
  EXPECT_LE(largest_entry(solved - exact(inner)), 1e-13 * largest_entry(exact));  // condition of 100
}

TEST(LinearElasticLaw, HasTheStressesOfHookesLaw) {
  Mat<double, 2> stretch = Mat<double, 2>::Zero(), shear = stretch;
  stretch(0, 0) = 1e-3;
  shear(0, 1) = 1e-3;
  const double G = E / (2 * (1 + nu));
  const auto strain =
      LinearElasticLaw<double>(E, nu, Space::plane_strain).stress(PlaneGradient<double>(stretch)).full();
  EXPECT_NEAR(strain(0, 0), 1e-3 * E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)), 1e-14);  // some ten roundings of one
  EXPECT_NEAR(strain(1, 1), 1e-3 * E * nu / ((1 + nu) * (1 - 2 * nu)), 1e-14);
  const auto stress =
      LinearElasticLaw<double>(E, nu, Space::plane_stress).stress(PlaneGradient<double>(stretch)).full();
  EXPECT_NEAR(stress(0, 0), 1e-3 * E / (1 - nu * nu), 1e-14);
  EXPECT_NEAR(stress(1, 1), 1e-3 * E * nu / (1 - nu * nu), 1e-14);
  for (Space space : {Space::plane_strain, Space::plane_stress}) {
    const auto sheared = LinearElasticLaw<double>(E, nu, space).stress(PlaneGradient<double>(shear)).full();
    EXPECT_NEAR(sheared(0, 1), 1e-3 * G, 1e-15);
    EXPECT_EQ(sheared(0, 1), sheared(1, 0));
    EXPECT_EQ(sheared(0, 0), 0);
  }
}

}  // namespace
}  // namespace stickslip::continuum_test
