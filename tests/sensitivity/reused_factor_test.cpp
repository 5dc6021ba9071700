/// A factor that Newton leaves behind serves the derivatives where it solves their rows; where it does not, they are
/// refined, or the tangent is factorised anew. Held by engines that hand on a factor of another tangent.
#include <gtest/gtest.h>

#include "core/engine/sparse_system.hpp"
#include "core/model/point_tangent.hpp"
#include "methods/newton/regularisation.hpp"
#include "sensitivity/schemes.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::reused_factor_test {
namespace {

using namespace scenes;

/// Says of whatever factor it has that it is that of the tangents asked for.
class CarelessSystem : public SparseSystem<double> {
 public:
  using SparseSystem::SparseSystem;
  bool update(const std::vector<PointTangent<double>>&, const Vector<double>&, Counters&) override { return true; }
};

struct Outcome {
  Matrix<double> derivatives;  ///< of the displacements, a column a parameter
  Counters counters;
};

/// Derivatives of the last increment's displacements, what came before held fixed. `factor`: how many times as stiff
/// the contact is that the engine has a factor of when it is asked; none: it has no factor.
template <class M>
Outcome differentiate_last(const Scene& scene, const M& method, std::optional<double> factor) {
  const auto run = scenes::run(scene, method);
  const auto& increments = run.trajectory.increments;
  const State<double>& previous =
      increments.size() > 1 ? increments[increments.size() - 2].state : run.trajectory.initial;
  const auto kind = system_kind(run.model, method.multipliers, method.cone_radius(), Backend::automatic);
  auto bodies = std::make_unique<FullBodies<double>>(run.model, run.slots);
  auto system = std::make_unique<CarelessSystem>(run.model, run.slots, kind, *bodies);
  Engine<double> engine(run.model, run.slots, std::move(bodies), std::move(system));
  auto blocks = parameter_blocks(run.model);
  for (auto& block : blocks) {
    block.previous.multiplier = lift(previous.multiplier);
    for_each_part([](Vector<Direction>& part, const Vector<double>& values) { part = lift(values); },
                  block.previous.history, previous.history);
    block.previous.contact.traction = lift(previous.contact.traction);
  }
  const Method own = method;
  Differentiation problem{
      own, run.model, run.slots, engine, blocks, static_cast<int>(run.model.scene.parameters.size()), {}};
  if (factor) {
    const auto rho = initial_regularisation(run.slots, method);
    const ContactInput<double> input{
        run.model, run.slots, rho, previous.history, method.cone_radius(), increments.back().time};
    auto tangents = converged_tangents(input, increments.back().state);
    for (auto& tangent : tangents)
      for (auto* part : {&tangent.force_w, &tangent.force_l}) *part *= *factor;
    Counters spent;
    EXPECT_TRUE(engine.factorise(tangents, spent));
    problem.follows = true;
  }
  EXPECT_TRUE(differentiate_alone(problem, previous, increments.back())) << problem.message;
  const auto derivatives = gather(
      blocks, problem.parameters, [&](auto&, int b) -> auto& { return blocks[b].current.displacement; });
  return {derivatives, problem.counters};
}

template <class M>
void expect_found_out(const M& method) {
  for (const Scene& scene : {driven_block(), two_boxes(6, 9)}) {
    const auto fresh = differentiate_last(scene, method, std::nullopt);
    EXPECT_EQ(fresh.counters.sensitivity_factorizations, 1);
    const double size = largest_entry(fresh.derivatives);
    // (the same tangent, solved in another order of operations: rounding, times its condition of some 1e4)
    const auto right = differentiate_last(scene, method, 1.0);
    EXPECT_EQ(right.counters.sensitivity_factorizations, 0);
    EXPECT_LE(largest_entry(right.derivatives - fresh.derivatives), 1e-11 * size) << scene.title;
    for (double factor : {0.5, 1.001, 3.0}) {
      const auto wrong = differentiate_last(scene, method, factor);
      EXPECT_EQ(wrong.counters.sensitivity_factorizations, 1) << scene.title << " " << factor;
      EXPECT_LE(largest_entry(wrong.derivatives - fresh.derivatives), 1e-11 * size) << scene.title << " " << factor;
    }
  }
}

TEST(ReusedFactor, OfAnotherTangentIsFoundOutByThePenaltyMethod) { expect_found_out(Penalty{}); }

TEST(ReusedFactor, OfAnotherTangentIsFoundOutByTheMonolithicMethod) { expect_found_out(MonolithicAL{}); }

}  // namespace
}  // namespace stickslip::reused_factor_test
