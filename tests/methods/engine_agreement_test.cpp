/// A run through the sparse engine and the same through the condensed one: every field of every increment, and every
/// derivative of it, for every method. Solver and schemes are instantiated here from their headers.
#include <gtest/gtest.h>

#include <algorithm>

#include "methods/method.hpp"
#include "sensitivity/schemes.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::engine_agreement_test {
namespace {

/// Displacements and tractions of an increment with their derivatives, a column each parameter.
struct Snapshot {
  std::vector<ContactState> states;
  Vector<double> displacement, traction;
  Matrix<double> d_displacement, d_traction;
};

std::vector<Snapshot> run_through(LinearAlgebra::Engine kind, const Model& model, const Slots<double>& slots,
                                  const Method& method) {
  RunOptions options;
  options.linear_algebra.engine = kind;
  Workspace<double> workspace;
  const auto trajectory = solve(model, slots, method, options, workspace);
  EXPECT_TRUE(is_converged(trajectory.status)) << trajectory.message;
  const bool condensed = trajectory.engine.find("condensed") != std::string::npos;
  EXPECT_EQ(condensed, kind == LinearAlgebra::Engine::condensed) << trajectory.engine;
  EXPECT_EQ(trajectory.engine.starts_with("condensed"), condensed && model.effects.linear_bulk) << trajectory.engine;
  const int parameters = static_cast<int>(model.scene.parameters.size());
  auto blocks = parameter_blocks(model);
  std::vector<Snapshot> snapshots;
  Differentiation problem{method, model, slots, *workspace.engine, blocks, parameters, {}};
  const State<double>* previous = &trajectory.initial;
  for (const auto& increment : trajectory.increments) {
    EXPECT_TRUE(differentiate_alone(problem, *previous, increment)) << problem.message;
    const auto& state = increment.state;
    snapshots.push_back(
        {state.contact.state, state.displacement, state.contact.traction,
         gather(
             blocks, parameters, [](ParameterBlock & b, int) -> auto& { return b.current.displacement; }),
         gather(
             blocks, parameters, [](ParameterBlock & b, int) -> auto& { return b.current.contact.traction; })});
    for (auto& block : blocks) std::swap(block.previous, block.current);
    previous = &state;
  }
  return snapshots;
}

/// The largest entry that a field, or its derivative by one parameter, has anywhere in the run.
template <class Pick>
double largest(const std::vector<Snapshot>& run, Pick&& pick) {
  double size = 0;
  for (const auto& s : run) size = larger(size, largest_entry(pick(s)));
  return size;
}

template <class M>
void expect_agreement(const Scene& scene, const M& method) {
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  const auto sparse = run_through(LinearAlgebra::Engine::sparse, model, slots, method);
  const auto condensed = run_through(LinearAlgebra::Engine::condensed, model, slots, method);
  ASSERT_EQ(sparse.size(), condensed.size());
  ASSERT_FALSE(sparse.empty());
  // rounding times the condition of the bodies and of the largest rho (1e3 nodal stiffnesses), 1e6 in all
  constexpr double agreed = 1e-10;
  auto compare = [&](auto&& pick, const std::string& what, double size) {
    ASSERT_GT(size, 0) << what;
    for (std::size_t n = 0; n < sparse.size(); ++n)
      EXPECT_LE(largest_entry(pick(sparse[n]) - pick(condensed[n])), agreed * size)
          << method.name << " " << what << ", increment " << n;
  };
  for (std::size_t n = 0; n < sparse.size(); ++n) EXPECT_EQ(sparse[n].states, condensed[n].states) << method.name;
  auto displacement = [](const Snapshot& s) { return s.displacement; };
  auto traction = [](const Snapshot& s) { return s.traction; };
  compare(displacement, "displacement", largest(sparse, displacement));
  compare(traction, "traction", largest(sparse, traction));
  for (std::size_t j = 0; j < scene.parameters.size(); ++j) {
    const auto& parameter = scene.parameters[j];
    auto d_displacement = [&](const Snapshot& s) -> Vector<double> { return s.d_displacement.col(j); };
    auto d_traction = [&](const Snapshot& s) -> Vector<double> { return s.d_traction.col(j); };
    // a field may not depend on a parameter at all; the field over the parameter is then the measure
    compare(d_displacement, "displacement by " + parameter.name,
            std::max(largest(sparse, d_displacement), largest(sparse, displacement) / std::abs(parameter.value)));
    compare(d_traction, "traction by " + parameter.name,
            std::max(largest(sparse, d_traction), largest(sparse, traction) / std::abs(parameter.value)));
  }
}

template <class M>
class EngineAgreement : public testing::Test {};
using Methods = testing::Types<Penalty, UzawaAL, MonolithicAL>;
TYPED_TEST_SUITE(EngineAgreement, Methods);

TYPED_TEST(EngineAgreement, HoldsForTwoBodiesWithFriction) {
  expect_agreement(scenes::two_boxes(6, 9), TypeParam{});
  expect_agreement(scenes::two_boxes(5, 5, "T3"), TypeParam{});
}

TYPED_TEST(EngineAgreement, HoldsForTwoBodiesWithoutFriction) {
  auto scene = scenes::two_boxes(6, 9);
  scene.contacts[0].friction.reset();
  scene.parameters.erase(scene.parameters.begin());  // mu
  expect_agreement(scene, TypeParam{});
}

TYPED_TEST(EngineAgreement, HoldsForABodyThatContactAndASideHold) {
  expect_agreement(scenes::greco_plate(8), TypeParam{});
}

/// Whether each body of a run that flows does.
bool flows(const Scene& scene) {
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  Workspace<double> workspace;
  const auto trajectory = solve(model, slots, MonolithicAL{}, {}, workspace);
  return largest_entry(trajectory.increments.back().state.history.bodies) > 1e-4;
}

TYPED_TEST(EngineAgreement, HoldsWhereOneBodyIsCondensedAndTheOtherFlows) {
  for (bool inclined : {false, true}) {
    const auto scene = scenes::punched_metal(6, inclined ? 0.2 : 0.3, inclined);
    EXPECT_TRUE(flows(scene));
    expect_agreement(scene, TypeParam{});
  }
}

TYPED_TEST(EngineAgreement, HoldsForABodyThatFlowsAndOneThatOnlyContactHolds) {
  auto scene = scenes::punched_metal(6);
  scene.contacts[0].friction.reset();
  scene.parameters.erase(scene.parameters.begin());  // mu
  std::swap(scene.bodies[0].material, scene.bodies[1].material);
  std::swap(scene.bodies[0].element, scene.bodies[1].element);
  expect_agreement(scene, TypeParam{});
}

}  // namespace
}  // namespace stickslip::engine_agreement_test
