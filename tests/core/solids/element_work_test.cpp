/// Derivatives of the work of an element's forces against the complex step of the forces themselves.
#include "core/solids/element_work.hpp"

#include <gtest/gtest.h>

#include "core/solids/materials.hpp"
#include "tests/support/derivatives.hpp"

namespace stickslip::element_work_test {
namespace {

/// A convex element away from the axis: the corners and middles of the reference element, moved a little.
template <class Shape>
Nodal<double, Shape> some_element() requires(Shape::dimension == 3) {
  Nodal<double, Shape> X;
  for (int a = 0; a < Shape::nodes; ++a)
    X.col(a) = Shape::is_simplex ? Vec<double, 3>(Vec<double, 3>(1, 0, 0) + 2 * natural_node<Shape>(a))
                                 : Vec<double, 3>(Vec<double, 3>(2, 1, 1) + natural_node<Shape>(a));
  return X + 0.1 * derivatives::arbitrary(dofs_of<Shape>).reshaped(3, Shape::nodes);
}
template <class Shape>
Nodal<double, Shape> some_element() requires(Shape::dimension == 2) {
  const Mat<double, 2, 8> reference{{1, 3, 3, 1, 2, 3, 2, 1}, {0, 0, 2, 2, 0, 1, 2, 1}};
  const Mat<double, 2, 6> triangle{{1, 3, 1, 2, 2, 1}, {0, 0, 2, 0, 1, 1}};
  Nodal<double, Shape> X;
  if constexpr (Shape::corners == 3) X = triangle.leftCols(Shape::nodes);
  if constexpr (Shape::corners == 4) X = reference.leftCols(Shape::nodes);
  return X + 0.1 * derivatives::arbitrary(2 * Shape::nodes).reshaped(2, Shape::nodes);
}

/// Inputs: coordinates, thickness, the law's numbers. `count`: of states; more than the element has nodes join in one
/// matrix, where the law is linear.
template <class Shape, Kinematics kinematics, class Law>
void expect_derivatives(const Law& law, int count = 3) {
  constexpr int dofs = dofs_of<Shape>, n = Shape::nodes, D = Shape::dimension;
  std::vector<StateOfElement<Shape>> states;
  for (int k = 0; k < count; ++k)
    states.push_back({0.05 * derivatives::arbitrary(dofs, 10 + k).reshaped(D, n),
                      derivatives::arbitrary(dofs, 20 + k).reshaped(D, n)});
  const Nodal<double, Shape> X = some_element<Shape>();
  Vector<double> inputs(dofs + 3);
  inputs << X.reshaped(), 0.7, law.numbers()[0], law.numbers()[1];
  const auto work = [&](const auto& x) {
    using T = typename std::decay_t<decltype(x)>::Scalar;
    const Nodal<T, Shape> coordinates = x.head(dofs).reshaped(D, n);
    const auto with = law.with(std::array<T, 2>{x[dofs + 1], x[dofs + 2]});
    T sum{};
    for (const auto& state : states) {
      const Nodal<T, Shape> u = state.motion.unaryExpr([](double v) { return T(v); });
      const auto forces = element_forces<T, Shape, kinematics>(with, coordinates, u, x[dofs]);
      for (int k = 0; k < dofs; ++k) sum += forces.data()[k] * T(state.weight.data()[k]);
    }
    return Vector<T>::Constant(1, sum).eval();
  };
  const auto found = element_work<Shape, kinematics>(law, X, 0.7, states);
  Matrix<double> derivative(1, dofs + 3);
  derivative << found.coordinates.reshaped().transpose(), found.depth, found.law[0], found.law[1];
  // Some thousand operations meet in a sum.
  EXPECT_LE(derivatives::relative_difference(derivative, derivatives::by_complex_step(work, inputs)), 1e-13);
}

TEST(ElementWork, HasTheDerivativesOfTheComplexStep) {
  const LinearElasticLaw<double> linear(3.0, 2.0);
  for (int count : {2, 9}) {  // fewer and more than an element has nodes
    expect_derivatives<Quad8, Kinematics::plane>(linear, count);
    expect_derivatives<Quad4, Kinematics::revolution_mean_dilatation>(linear, count);
    expect_derivatives<Tri6, Kinematics::revolution>(linear, count);
    expect_derivatives<Hex8, Kinematics::space>(linear, count);
    expect_derivatives<Hex8, Kinematics::space_mean_dilatation>(linear, count);
  }
  for (auto kind : {NeoHookean::Volumetric::quadratic, NeoHookean::Volumetric::log}) {
    const NeoHookeanLaw<double> finite(3.0, 2.0, kind);
    expect_derivatives<Quad4, Kinematics::plane>(finite);
    expect_derivatives<Quad4, Kinematics::plane_mean_dilatation>(finite);
    expect_derivatives<Quad4, Kinematics::revolution_mean_dilatation>(finite);
    expect_derivatives<Tet10, Kinematics::space>(finite);
    expect_derivatives<Hex8, Kinematics::space_mean_dilatation>(finite);
  }
}

/// Inputs: coordinates, thickness, the law's numbers (of its part), the motion, and what is remembered of the last
/// increment.
template <class Shape, Kinematics kinematics>
void expect_derivatives_of_flow(const J2Law<double>& law) {
  constexpr int dofs = dofs_of<Shape>, n = Shape::nodes, D = Shape::dimension;
  constexpr int each = memory_at<J2Law<double>, kinematics>(), memory = points_of<Shape>(kinematics) * each;
  StateOfElement<Shape> state{0.05 * derivatives::arbitrary(dofs, 10).reshaped(D, n),
                              derivatives::arbitrary(dofs, 20).reshaped(D, n),
                              0.01 * derivatives::arbitrary(memory, 30), derivatives::arbitrary(memory, 40)};
  for (int m = each - 1; m < memory; m += each) state.last_memory[m] = std::abs(state.last_memory[m]);
  const Nodal<double, Shape> X = some_element<Shape>();
  Vector<double> inputs(2 * dofs + 5 + memory);
  const auto numbers = law.numbers();
  inputs << X.reshaped(), 0.7, numbers[0], numbers[1], numbers[2], numbers[3], state.motion.reshaped(),
      state.last_memory;
  const auto work = [&](const auto& x) {
    using T = typename std::decay_t<decltype(x)>::Scalar;
    const Nodal<T, Shape> coordinates = x.head(dofs).reshaped(D, n), u = x.segment(dofs + 5, dofs).reshaped(D, n);
    const auto with = law.with(std::array<T, 4>{x[dofs + 1], x[dofs + 2], x[dofs + 3], x[dofs + 4]});
    const Vector<T> before = x.tail(memory);
    Vector<T> after(memory);
    element_flow<T, Shape, kinematics>(with, coordinates, u, before.data(), after.data());
    const auto forces = element_forces<T, Shape, kinematics>(with, coordinates, u, x[dofs], after.data());
    T sum{};
    for (int k = 0; k < dofs; ++k) sum += forces.data()[k] * T(state.weight.data()[k]);
    for (int m = 0; m < memory; ++m) sum += after[m] * T(state.memory[m]);
    return Vector<T>::Constant(1, sum).eval();
  };
  const auto found = element_work<Shape, kinematics>(law, X, 0.7, {state});
  Matrix<double> derivative(1, inputs.size());
  derivative << found.coordinates.reshaped().transpose(), found.depth, found.law[0], found.law[1], found.law[2],
      found.law[3], found.motion[0].reshaped().transpose(), found.last_memory[0].transpose();
  EXPECT_LE(derivatives::relative_difference(derivative, derivatives::by_complex_step(work, inputs)), 1e-12);
}

TEST(ElementWork, HasThoseOfAFlowAndOfWhatItRemembers) {
  for (bool finite : {false, true}) {
    const J2Law<double> metal{3.0, 2.0, {0.05, 0.3}, Space::plane_strain, finite};
    expect_derivatives_of_flow<Quad4, Kinematics::plane>(metal);
    expect_derivatives_of_flow<Tri6, Kinematics::revolution>(metal);
    expect_derivatives_of_flow<Quad4, Kinematics::plane_mean_dilatation>(metal);
    expect_derivatives_of_flow<Quad4, Kinematics::revolution_mean_dilatation>(metal);
    const J2Law<double> in_space{3.0, 2.0, {0.05, 0.3}, Space::solid, finite};
    expect_derivatives_of_flow<Tet4, Kinematics::space>(in_space);
    expect_derivatives_of_flow<Hex8, Kinematics::space_mean_dilatation>(in_space);
  }
  expect_derivatives_of_flow<Quad8, Kinematics::plane>(
      J2Law<double>{3.0, 2.0, {0.05, 0.3}, Space::plane_stress, false});
}

TEST(ElementWork, HasThoseOfEachRowOfAHardeningTable) {
  const Hardening<double> table{0.05, 0.0, {{0.004, 0.06}, {0.01, 0.065}, {0.02, 0.067}}};
  for (int part = 0; part < 3; ++part) {  // yield; rows 1 and 2; row 3
    for (bool finite : {false, true}) {
      const J2Law<double> metal{3.0, 2.0, table, Space::plane_strain, finite, part};
      EXPECT_EQ(metal.part_count(), 3);
      expect_derivatives_of_flow<Tri6, Kinematics::plane>(metal);
      expect_derivatives_of_flow<Quad4, Kinematics::revolution_mean_dilatation>(metal);
    }
    expect_derivatives_of_flow<Quad8, Kinematics::plane>(
        J2Law<double>{3.0, 2.0, table, Space::plane_stress, false, part});
  }
}

}  // namespace
}  // namespace stickslip::element_work_test
