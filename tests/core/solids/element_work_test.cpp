/// Derivatives of the work of an element's forces against the complex step of the forces themselves.
#include "core/solids/element_work.hpp"

#include <gtest/gtest.h>

#include "core/solids/materials.hpp"
#include "tests/support/derivatives.hpp"

namespace stickslip {
namespace {

/// A convex element away from the axis: the corners and middles of the reference element, moved a little.
template <class Shape>
Mat<double, 2, Shape::nodes> some_element() {
  const Mat<double, 2, 8> reference{{1, 3, 3, 1, 2, 3, 2, 1}, {0, 0, 2, 2, 0, 1, 2, 1}};
  const Mat<double, 2, 6> triangle{{1, 3, 1, 2, 2, 1}, {0, 0, 2, 0, 1, 1}};
  Mat<double, 2, Shape::nodes> X;
  if constexpr (Shape::corners == 3) X = triangle.leftCols(Shape::nodes);
  if constexpr (Shape::corners == 4) X = reference.leftCols(Shape::nodes);
  return X + 0.1 * derivatives::arbitrary(2 * Shape::nodes).reshaped(2, Shape::nodes);
}

/// Inputs: coordinates, thickness, the law's numbers.
template <class Shape, Kinematics kinematics, class Law>
void expect_derivatives(const Law& law) {
  constexpr int n = Shape::nodes;
  std::vector<StateOfElement<n>> states;
  for (int k = 0; k < 3; ++k)
    states.push_back({0.05 * derivatives::arbitrary(2 * n, 10 + k).reshaped(2, n),
                      derivatives::arbitrary(2 * n, 20 + k).reshaped(2, n)});
  const Mat<double, 2, n> X = some_element<Shape>();
  Vector<double> inputs(2 * n + 3);
  inputs << X.reshaped(), 0.7, law.numbers()[0], law.numbers()[1];
  const auto work = [&](const auto& x) {
    using T = typename std::decay_t<decltype(x)>::Scalar;
    const Mat<T, 2, n> coordinates = x.head(2 * n).reshaped(2, n);
    const auto with = law.with(std::array<T, 2>{x[2 * n + 1], x[2 * n + 2]});
    T sum{};
    for (const auto& state : states) {
      const Mat<T, 2, n> u = state.motion.unaryExpr([](double v) { return T(v); });
      const auto forces = element_forces<T, Shape, kinematics>(with, coordinates, u, x[2 * n]);
      for (int k = 0; k < 2 * n; ++k) sum += forces.data()[k] * T(state.weight.data()[k]);
    }
    return Vector<T>::Constant(1, sum).eval();
  };
  const auto found = element_work<Shape, kinematics>(law, X, 0.7, states);
  Matrix<double> derivative(1, 2 * n + 3);
  derivative << found.coordinates.reshaped().transpose(), found.depth, found.law[0], found.law[1];
  // Some thousand operations meet in a sum.
  EXPECT_LE(derivatives::relative_difference(derivative, derivatives::by_complex_step(work, inputs)), 1e-13);
}

TEST(ElementWork, HasTheDerivativesOfTheComplexStep) {
  const LinearElasticLaw<double> linear(3.0, 2.0);
  expect_derivatives<Tri3, Kinematics::plane>(linear);
  expect_derivatives<Quad8, Kinematics::plane>(linear);
  expect_derivatives<Quad4, Kinematics::revolution>(linear);
  expect_derivatives<Quad4, Kinematics::plane_mean_dilatation>(linear);
  expect_derivatives<Quad4, Kinematics::revolution_mean_dilatation>(linear);
  expect_derivatives<Tri6, Kinematics::revolution>(linear);
  for (auto kind : {NeoHookean::Volumetric::quadratic, NeoHookean::Volumetric::log}) {
    const NeoHookeanLaw<double> finite(3.0, 2.0, kind);
    expect_derivatives<Quad4, Kinematics::plane>(finite);
    expect_derivatives<Tri6, Kinematics::plane>(finite);
  }
}

}  // namespace
}  // namespace stickslip
