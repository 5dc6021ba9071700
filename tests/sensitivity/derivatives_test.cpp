/// What derivatives cost: those that follow a run against those at its end, several increments at once against one at a
/// time, and the elements that are visited.
#include <gtest/gtest.h>

#include "core/model/response.hpp"
#include "sensitivity/schemes.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/solved.hpp"
#include "tests/support/solved_run.hpp"

namespace stickslip::derivatives_test {
namespace {

using EngineKind = LinearAlgebra::Engine;

struct Differentiated {
  Trajectory<double> trajectory;
  Gradients gradients;
};

Differentiated direct_gradients(const Model& model, const Slots<double>& slots, const Method& method, EngineKind engine,
                                bool follow) {
  Differentiated out;
  Workspace<double> workspace;
  RunOptions options;
  options.linear_algebra.engine = engine;
  Derivatives derivatives(model, slots, method, workspace);
  if (follow) options.on_step = [&] { derivatives.follow(out.trajectory); };
  solve(model, slots, method, options, workspace, out.trajectory);
  out.gradients = derivatives.finish(out.trajectory);
  return out;
}

void expect_same(const std::vector<Matrix<double>>& found, const std::vector<Matrix<double>>& expected,
                 const std::string& what, double tolerance = 1e-11) {  // rounding, by condition numbers up to 1e4
  ASSERT_EQ(found.size(), expected.size()) << what;
  double size = 0;
  for (const auto& of : expected) size = larger(size, largest_entry(of));
  for (std::size_t n = 0; n < found.size(); ++n)
    EXPECT_LE(largest_entry(Matrix<double>(found[n] - expected[n])), tolerance * size) << what << " " << n;
}

TEST(Derivatives, ThatFollowARunFactoriseNothing) {
  UzawaAL iterated;
  iterated.sensitivity = UzawaAL::Sensitivity::iterated;
  for (const Method& method : {Method(Penalty{}), Method(iterated), Method(MonolithicAL{})}) {
    const auto scene = scenes::two_boxes(6, 4);
    const Model model = make_model(scene);
    const auto slots = make_slots<double>(model, scene.as<double>());
    const auto following = direct_gradients(model, slots, method, EngineKind::sparse, true);
    const auto at_the_end = direct_gradients(model, slots, method, EngineKind::sparse, false);
    ASSERT_TRUE(is_converged(following.trajectory.status)) << following.trajectory.message;
    ASSERT_TRUE(is_converged(following.gradients.status)) << following.gradients.message;
    EXPECT_EQ(following.gradients.counters.sensitivity_factorizations, 0) << name_of(method);
    EXPECT_GT(at_the_end.gradients.counters.sensitivity_factorizations, 0) << name_of(method);
    EXPECT_EQ(following.trajectory.counters.factorizations, at_the_end.trajectory.counters.factorizations);
    const auto &with = following.trajectory.increments, &without = at_the_end.trajectory.increments;
    ASSERT_EQ(with.size(), without.size());
    for (std::size_t n = 0; n < with.size(); ++n) {
      // (to rounding: the next increment goes on from a factor that is updated differently)
      const Vector<double> change = with[n].state.displacement - without[n].state.displacement;
      EXPECT_LE(largest_entry(change), 1e-12 * largest_entry(without[n].state.displacement)) << name_of(method) << n;
    }
    expect_same(following.gradients.of_responses, at_the_end.gradients.of_responses, std::string(name_of(method)));
  }
}

// A stiff penalty magnifies what is left of a gap's derivative: by a factor that was updated no more than by a fresh
// one.
TEST(Derivatives, ThatFollowARunLoseNoMoreUnderAStiffPenalty) {
  const auto scene = scenes::two_boxes(6, 4);
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  for (const double stiffness : {1e5, 1e7}) {
    const Method method = Penalty{scenes::relative(stiffness)};
    const auto following = direct_gradients(model, slots, method, EngineKind::sparse, true);
    const auto at_the_end = direct_gradients(model, slots, method, EngineKind::sparse, false);
    ASSERT_TRUE(is_converged(following.trajectory.status)) << following.trajectory.message;
    ASSERT_TRUE(is_converged(following.gradients.status)) << following.gradients.message;
    // rounding times the stiffness, and a hundred terms in a row
    expect_same(following.gradients.of_responses, at_the_end.gradients.of_responses, "penalty", 1e-14 * stiffness);
  }
}

// Parameters that touch elements are swept together, whatever the order they are named in; each has the derivative that
// it has alone.
TEST(Derivatives, OfManyParametersAreThoseOfEachAlone) {
  Scene scene = scenes::greco_plate(6);  // mu, E, F, height
  const auto named = scene.parameters;
  for (const auto& parameter : named) scene.parameters.push_back(parameter);
  EXPECT_EQ(parameter_groups(make_model(scene)), (std::vector<std::vector<int>>{{1, 3, 5, 7}, {0, 2, 4, 6}}));
  Vector<double> responses;
  const auto gradient_of = [&](const Scene& of) {
    scenes::SolvedRun run(of, MonolithicAL{});
    responses = evaluate_responses(run.model, run.slots, run.trajectory.increments[0].state, 1.0);
    return run.direct().of_responses[0];
  };
  const Matrix<double> all = gradient_of(scene);
  constexpr double rounding = 1e-11;  // by condition numbers up to 1e4, of a response over the parameter
  for (std::size_t j = 0; j < named.size(); ++j) {
    scene.parameters = {named[j]};
    const Matrix<double> alone = gradient_of(scene);
    for (std::size_t copy : {j, j + named.size()})
      for (Eigen::Index i = 0; i < alone.rows(); ++i)
        EXPECT_NEAR(all(i, static_cast<Eigen::Index>(copy)), alone(i, 0),
                    rounding * std::abs(responses[i]) / scene.parameters[0].value)
            << named[j].name << " " << i;
  }
}

TEST(Derivatives, OfSeveralIncrementsAtOnceAreThoseOfOneAtATime) {
  for (const Method& method : {Method(Penalty{}), Method(UzawaAL{}), Method(MonolithicAL{})}) {
    Scene scene = scenes::driven_block();
    scene.legs = {{scene.legs.back().end, 11}};
    const Model model = make_model(scene);
    const auto slots = make_slots<double>(model, scene.as<double>());
    Workspace<double> workspace;
    RunOptions options;
    options.linear_algebra.engine = EngineKind::condensed;
    const auto trajectory = solve(model, slots, method, options, workspace);
    const auto together = differentiate(model, slots, method, trajectory, workspace);
    ASSERT_TRUE(is_converged(together.status)) << together.message;
    auto blocks = parameter_blocks(model);
    const int parameters = static_cast<int>(scene.parameters.size());
    std::vector<Matrix<double>> alone;
    Differentiation problem{method, model, slots, *workspace.engine, blocks, parameters, {}};
    const State<double>* previous = &trajectory.initial;
    for (const auto& increment : trajectory.increments) {
      ASSERT_TRUE(differentiate_alone(problem, *previous, increment)) << problem.message;
      std::vector<Vector<Direction>> responses;
      for (auto& block : blocks) {
        responses.push_back(evaluate_responses(model, block.slots, block.current, increment.time));
        std::swap(block.previous, block.current);
      }
      alone.push_back(gather(
          blocks, parameters, [&](auto&, int b) -> auto& { return responses[b]; }));
      previous = &increment.state;
    }
    expect_same(together.of_responses, alone, std::string(name_of(method)));
  }
}

// Where no response reads the inside of a body, displacements are expanded at the last increment alone: the derivatives
// are those that come with all of them.
TEST(Derivatives, OfContactResponsesNeedNoDisplacementsInside) {
  const Scene full = scenes::two_boxes(6, 4);
  Scene contact_alone = full;
  std::erase_if(contact_alone.responses, [](const Response& r) {
    return r.kind == Response::Kind::strain_energy || r.kind == Response::Kind::reaction;
  });
  for (const Method& method : {Method(Penalty{}), Method(UzawaAL{}), Method(MonolithicAL{})}) {
    const auto differentiated = [&](const Scene& scene) {
      const Model model = make_model(scene);
      return direct_gradients(model, make_slots<double>(model, scene.as<double>()), method, EngineKind::condensed,
                              false)
          .gradients;
    };
    const auto found = differentiated(contact_alone), expected = differentiated(full);
    ASSERT_TRUE(is_converged(found.status)) << found.message;
    ASSERT_EQ(found.of_responses.size(), expected.of_responses.size());
    std::vector<Matrix<double>> kept;
    for (std::size_t n = 0; n < expected.of_responses.size(); ++n) {
      Matrix<double> rows(found.of_responses[n].rows(), found.of_responses[n].cols());
      for (std::size_t i = 0; i < contact_alone.responses.size(); ++i)
        for (std::size_t k = 0; k < full.responses.size(); ++k)
          if (full.responses[k].name == contact_alone.responses[i].name) rows.row(i) = expected.of_responses[n].row(k);
      kept.push_back(rows);
    }
    expect_same(found.of_responses, kept, std::string(name_of(method)));
    expect_same({found.last_displacement}, {expected.last_displacement}, "displacement");
  }
}

// A reaction needs the forces at its support alone: elsewhere, elements could be anything.
TEST(Responses, OfReactionsVisitTheElementsAtTheirSupport) {
  const auto scene = scenes::greco_plate(6);
  const Model model = make_model(scene);
  std::size_t visited = 0, all = 0;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    visited += model.at_reactions[b].size();
    all += static_cast<std::size_t>(model.bodies[b].mesh.element_count());
  }
  const bool asks = std::any_of(scene.responses.begin(), scene.responses.end(),
                                [](const Response& r) { return r.kind == Response::Kind::reaction; });
  ASSERT_TRUE(asks);
  EXPECT_GT(visited, 0u);
  EXPECT_LE(visited, all / 6);  // a side of a square of 6 x 6
}

}  // namespace
}  // namespace stickslip::derivatives_test
