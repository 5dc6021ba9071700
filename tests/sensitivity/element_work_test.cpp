/// The derivatives of what the bodies answer by all that they are made of, against the complex step: the work that the
/// adjoint mode pulls back (pull_back_bodies, core/solids/element_work.hpp), and direct differentiation.
#include "core/solids/element_work.hpp"

#include <gtest/gtest.h>

#include "sensitivity/pull_back.hpp"
#include "tests/support/compiled_slots.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::element_work_test {
namespace {

using Complex = std::complex<double>;

/// A box of one cell, away from the axis. What fills it has its numbers in slots, and so has its thickness.
struct Filled {
  std::string element;
  Space space = Space::plane_strain;
  bool finite = false;
};

Model model_of(const Filled& filled, const std::function<Material(Scene&)>& material) {
  Scene s;
  s.space = filled.space;
  s.finite_strain = filled.finite;
  s.legs = {{1, 1}};
  const bool solid = filled.space == Space::solid;
  BoxMesh box;
  box.min = solid ? std::vector<Number>{1.0, 0.0, 0.0} : std::vector<Number>{1.0, 0.0};
  box.max = solid ? std::vector<Number>{3.0, 2.0, 2.0} : std::vector<Number>{3.0, 2.0};
  box.cells.assign(solid ? 3 : 2, 1);
  Body body{"box", box, material(s), filled.element, 1.0};
  if (filled.space == Space::plane_strain || filled.space == Space::plane_stress)
    body.thickness = scenes::parameter(s, "thickness", 0.7);
  s.bodies = {body};
  return make_model(s);
}

/// Increments with motions and weights that are no special case.
struct Pairs : WorkPairs {
  Pairs(const Model& model, int count) {
    const auto random = [&](int rows, int first) {
      Matrix<double> m(rows, count);
      for (int k = 0; k < count; ++k) m.col(k) = derivatives::arbitrary(rows, first + k);
      return m;
    };
    motions = 0.05 * random(model.dof_count(), 10);
    weights = random(model.dof_count(), 30);
    flows.resize(count);
    if (model.memory_count == 0) return;
    last_memory = 0.01 * random(model.memory_count, 50);
    memory = random(model.memory_count, 70);
    const int each = memory_of(model.scene.bodies[0].material, layout_of(model.bodies[0].kinematics));
    for (int m = each - 1; m < model.memory_count; m += each)  // what has flowed in all is no less than nothing
      last_memory.row(m) = last_memory.row(m).cwiseAbs();
  }
};

/// Derivatives of the work by the numbers of the scene and the coordinates, and of an increment by its motion and by
/// what was remembered before.
struct ByInputs {
  Vector<double> shared;
  Matrix<double> own;  ///< a column an increment
};

ByInputs pulled_back(const Model& model, const Points<double>& points, const Pairs& pairs) {
  Tape tape;
  Numbers<Reverse> numbers = model.scene.as<Reverse>();
  for (auto& number : numbers.at_slot) number = Reverse::leaf(number.v, tape);
  const Points<Reverse> places = points.unaryExpr([&](double x) { return Reverse::leaf(x, tape); });
  const auto leaves = tape.size();
  const auto slots = make_body_slots<Reverse>(model, numbers, places);
  std::vector<double> by(tape.size(), 0);
  const auto left = pull_back_bodies(model, slots, tape, pairs, by);
  tape.pull_back(by, leaves);
  ByInputs found{Eigen::Map<const Vector<double>>(by.data(), leaves), {}};
  if (model.memory_count == 0) return found;
  found.own.resize(left.motion.rows() + left.last_memory.rows(), pairs.motions.cols());
  found.own << left.motion, left.last_memory;
  return found;
}

/// The work as a function of the inputs, in any scalar.
struct Work {
  const Model& model;
  const Pairs& pairs;

  template <class T>
  Slots<T> slots_at(const Vector<T>& shared) const {
    Numbers<T> numbers = model.scene.as<T>();
    const auto count = static_cast<Eigen::Index>(numbers.at_slot.size());
    for (Eigen::Index k = 0; k < count; ++k) numbers.at_slot[k] = shared[k];
    return make_body_slots<T>(model, numbers,
                              shared.tail(shared.size() - count).reshaped(model.dimension, Eigen::AutoSize));
  }
  template <class T>
  T of_increment(const Slots<T>& slots, Eigen::Index n, const Vector<T>& own) const {
    const Vector<T> motion = own.head(model.dof_count()), before = own.tail(model.memory_count);
    Vector<T> after;
    if (model.memory_count > 0) after = bulk_flow(model, slots, motion, before);
    T sum = pairs.weights.col(n).template cast<T>().dot(bulk_forces(model, slots, motion, after));
    if (model.memory_count > 0) sum += pairs.memory.col(n).template cast<T>().dot(after);
    return sum;
  }
  template <class T>
  Vector<T> of_all(const Vector<T>& shared) const {
    const auto slots = slots_at(shared);
    T sum(0);
    for (Eigen::Index n = 0; n < pairs.motions.cols(); ++n) sum += of_increment<T>(slots, n, own(n).template cast<T>());
    return Vector<T>::Constant(1, sum);
  }
  Vector<double> own(Eigen::Index n) const {
    Vector<double> all(model.dof_count() + model.memory_count);
    all.head(model.dof_count()) = pairs.motions.col(n);
    if (model.memory_count > 0) all.tail(model.memory_count) = pairs.last_memory.col(n);
    return all;
  }
};

/// Both modes against the complex step. `count`: of increments; more than an element has nodes join in one matrix,
/// where the law is linear.
void expect_derivatives(const Filled& filled, const std::function<Material(Scene&)>& material, int count) {
  const Model model = model_of(filled, material);
  const auto made = initial_points(model, model.scene.as<double>());
  const Points<double> points =
      made + 0.1 * derivatives::arbitrary(static_cast<int>(made.size())).reshaped(made.rows(), made.cols());
  const Pairs pairs(model, count);
  const Work work{model, pairs};
  const auto found = pulled_back(model, points, pairs);
  constexpr double rounding = 1e-13;  // some thousand operations meet in a sum; measured 5e-15
  const auto expect = [&](const Matrix<double>& derivative, const Matrix<double>& expected) {
    EXPECT_GT(largest_entry(expected), 0);
    EXPECT_LE(derivatives::relative_difference(derivative, expected), rounding) << filled.element;
  };
  const auto& numbers = model.scene.numbers;
  Vector<double> shared(numbers.size() + points.size());
  shared << Eigen::Map<const Vector<double>>(numbers.data(), static_cast<Eigen::Index>(numbers.size())),
      points.reshaped();
  const auto all = [&](const auto& x) { return work.of_all(x); };
  const auto expected = derivatives::by_complex_step(all, shared);
  expect(found.shared.transpose(), expected);
  expect(derivatives::by_dual(all, shared), expected);
  if (model.memory_count == 0) return;
  const auto slots = work.slots_at<Complex>(shared.cast<Complex>());
  for (int n = 0; n < count; ++n) {
    const auto of_increment = [&](const Vector<Complex>& x) {
      return Vector<Complex>::Constant(1, work.of_increment(slots, n, x)).eval();
    };
    expect(found.own.col(n).transpose(), derivatives::by_complex_step(of_increment, work.own(n)));
  }
}

constexpr double E = 3.0, nu = 0.3;
constexpr std::array plane_elements{"T3", "Q4", "T6", "Q8", "Q4_mean_dilatation"};

TEST(ElementWork, HasTheDerivativesOfTheComplexStep) {
  const auto linear = [](Scene& s) {
    return LinearElastic{scenes::parameter(s, "E", E), scenes::parameter(s, "nu", nu)};
  };
  for (int count : {2, 9, 28}) {  // fewer and more than an element has nodes
    for (const char* element : plane_elements)
      for (Space space : {Space::plane_strain, Space::axisymmetric})
        expect_derivatives({element, space}, linear, count);
    expect_derivatives({"Q8", Space::plane_stress}, linear, count);
    for (const char* element : {"T4", "H8", "T10", "H20", "H27", "H8_mean_dilatation"})
      expect_derivatives({element, Space::solid}, linear, count);
  }
}

TEST(ElementWork, HasThoseOfFiniteStrain) {
  for (auto kind : {NeoHookean::Volumetric::quadratic, NeoHookean::Volumetric::log}) {
    const auto rubber = [&](Scene& s) {
      return NeoHookean{scenes::parameter(s, "E", E), scenes::parameter(s, "nu", nu), kind};
    };
    for (const char* element : plane_elements)
      for (Space space : {Space::plane_strain, Space::axisymmetric})
        expect_derivatives({element, space, true}, rubber, 3);
    expect_derivatives({"Q8", Space::plane_stress, true}, rubber, 3);
    for (const char* element : {"T4", "H8", "T10", "H20", "H8_mean_dilatation"})
      expect_derivatives({element, Space::solid, true}, rubber, 3);
  }
}

/// Metal whose table, where there is one, has its numbers in slots as well.
std::function<Material(Scene&)> metal(const std::vector<std::array<double, 2>>& rows = {}) {
  return [=](Scene& s) {
    J2Plastic of{scenes::parameter(s, "E", E), scenes::parameter(s, "nu", nu), scenes::parameter(s, "yield", 0.05),
                 scenes::parameter(s, "hardening", rows.empty() ? 0.3 : 0.0)};
    for (std::size_t k = 0; k < rows.size(); ++k)
      of.table.push_back({scenes::parameter(s, "strain" + std::to_string(k), rows[k][0]),
                          scenes::parameter(s, "stress" + std::to_string(k), rows[k][1])});
    return of;
  };
}

TEST(ElementWork, HasThoseOfAFlowAndOfWhatItRemembers) {
  for (bool finite : {false, true}) {
    for (const char* element : {"T3", "Q4", "T6", "Q4_mean_dilatation"})
      for (Space space : {Space::plane_strain, Space::axisymmetric})
        expect_derivatives({element, space, finite}, metal(), 1);
    for (const char* element : {"T4", "H8", "H8_mean_dilatation"})
      expect_derivatives({element, Space::solid, finite}, metal(), 1);
  }
  expect_derivatives({"Q8", Space::plane_stress}, metal(), 1);
}

TEST(ElementWork, HasThoseOfEachRowOfAHardeningTable) {
  // (yield is a part of the law's numbers; rows 1 and 2; row 3)
  const auto table = metal({{0.004, 0.06}, {0.01, 0.065}, {0.02, 0.067}});
  for (bool finite : {false, true}) {
    expect_derivatives({"T6", Space::plane_strain, finite}, table, 1);
    expect_derivatives({"Q4_mean_dilatation", Space::axisymmetric, finite}, table, 1);
  }
  expect_derivatives({"Q8", Space::plane_stress}, table, 1);
}

}  // namespace
}  // namespace stickslip::element_work_test
