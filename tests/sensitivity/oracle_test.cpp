/// Every scheme against the complex step of the whole program, and the properties that no scheme may miss.
#include "tests/support/oracle.hpp"

#include <gtest/gtest.h>

#include "core/model/response.hpp"
#include "sensitivity/gradcheck.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/solved.hpp"
#include "tests/support/solved_run.hpp"

namespace stickslip::oracle_test {
namespace {

using scenes::run;

/// Largest difference between scheme and oracle over all increments, responses and parameters, each relative to the
/// largest derivative of its response in the run, or to the response over the parameter. In units of what rounding
/// allows: oracle and scheme round differently, by 50 u cond; 1e-10 where that is less.
double worst_error(const Scene& scene, const Method& method) {
  const auto s = run(scene, method);
  EXPECT_EQ(s.gradients.of_responses.size(), s.trajectory.increments.size()) << s.gradients.message;
  Matrix<double> responses(scene.responses.size(), s.trajectory.increments.size());
  for (std::size_t n = 0; n < s.trajectory.increments.size(); ++n) {
    const auto& increment = s.trajectory.increments[n];
    responses.col(n) = evaluate_responses(s.model, s.slots, increment.state, increment.time);
  }
  double worst = 0;
  const double rounding = std::max(1e-10, 50 * 1.1e-16 * s.condition);
  for (int j = 0; j < static_cast<int>(scene.parameters.size()); ++j) {
    const Matrix<double> exact = oracle::complex_step(s.model, method, s.trajectory.step_table(), j);
    for (Eigen::Index i = 0; i < exact.rows(); ++i) {
      const double scale =
          std::max(largest_entry(exact.row(i)), largest_entry(responses.row(i)) / std::abs(scene.parameters[j].value));
      for (Eigen::Index n = 0; n < exact.cols(); ++n) {
        // a response that stays zero (no slip, no heat) has the derivative zero, to the last bit
        const double error = std::abs(s.gradients.of_responses[n](i, j) - exact(i, n)) / (scale > 0 ? scale : 1);
        EXPECT_LE(error, 1e-3) << name_of(method) << " " << scene.responses[i].name << "/" << scene.parameters[j].name
                               << " increment " << n << ": " << s.gradients.of_responses[n](i, j) << " " << exact(i, n);
        worst = larger(worst, error / rounding);
      }
    }
  }
  return worst;
}

TEST(Oracle, MonolithicSchemeIsExact) {
  for (const auto& scene : scenes::all()) EXPECT_LE(worst_error(scene, MonolithicAL{}), 1);
}

TEST(Oracle, EachResponseIsExactWhereItIsAskedForAlone) {
  // what no response reads is not computed: displacements inside the bodies, forces away from supports
  Scene boxes = scenes::two_boxes(3, 2), loaded = scenes::driven_block();
  boxes.responses.push_back(
      scenes::response("inside", Response::Kind::displacement, "upper.left", "x", Response::Take::max));
  boxes.responses.push_back(scenes::response("touching", Response::Kind::displacement, "upper.bottom", "x"));
  loaded.responses.push_back(scenes::response("energy", Response::Kind::strain_energy, ""));
  for (const Scene& all : {boxes, loaded})
    for (const auto& response : all.responses) {
      Scene alone = all;
      alone.responses = {response};
      EXPECT_LE(worst_error(alone, MonolithicAL{}), 1) << response.name;
    }
}

TEST(Oracle, EverySchemeIsExactForEveryElementAndSpace) {
  UzawaAL truncated;
  truncated.sensitivity = UzawaAL::Sensitivity::truncated;
  truncated.max_augmentations = 3;
  for (const auto& scene : scenes::of_every_element()) {
    EXPECT_LE(worst_error(scene, MonolithicAL{}), 1);
    EXPECT_LE(worst_error(scene, Penalty{scenes::relative(10)}), 1);
    EXPECT_LE(worst_error(scene, truncated), 1);
  }
}

TEST(Oracle, EverySchemeIsExactForShapeParameters) {
  UzawaAL iterated, truncated;
  iterated.tolerance = 1e-13;
  iterated.max_augmentations = 5000;
  truncated.sensitivity = UzawaAL::Sensitivity::truncated;
  truncated.max_augmentations = 3;
  for (const auto& scene : scenes::shaped())
    for (const Method& method :
         {Method(MonolithicAL{}), Method(Penalty{scenes::relative(10)}), Method(iterated), Method(truncated)})
      EXPECT_LE(worst_error(scene, method), 1) << name_of(method);
}

TEST(Oracle, MonolithicSchemeIsExactForTheOtherCone) {
  MonolithicAL method;
  method.cone = MonolithicAL::Cone::multiplier;
  for (const auto& scene : {scenes::greco_plate(8), scenes::two_boxes(6, 9)}) EXPECT_LE(worst_error(scene, method), 1);
}

TEST(Oracle, PenaltySchemeIsExactForThePenalisedProblem) {
  for (const auto& scene : scenes::all())
    for (double stiffness : {10.0, 1e3}) {
      Penalty method{scenes::relative(stiffness)};
      method.tangential_ratio = 0.4;
      EXPECT_LE(worst_error(scene, method), 1);
    }
}

TEST(Oracle, TruncatedUzawaSchemeIsTheDerivativeOfTheTruncatedLoop) {
  for (const auto& scene : scenes::all())
    for (int cap : {1, 3}) {
      UzawaAL method;
      method.sensitivity = UzawaAL::Sensitivity::truncated;
      method.max_augmentations = cap;
      EXPECT_LE(worst_error(scene, method), 1);
    }
}

TEST(Oracle, IteratedUzawaSchemeIsTheDerivativeOfTheConvergedSolution) {
  UzawaAL method;
  method.tolerance = 1e-13;
  method.max_augmentations = 5000;
  for (const auto& scene : scenes::all()) EXPECT_LE(worst_error(scene, method), 1);
}

TEST(Oracle, AutomaticAndRelativeStiffnessCarryTheirDependenceOnTheScene) {
  // a penalty of fixed multiple moves with E, so that the penetration does not: leaving that out would show at once
  const auto scene = scenes::two_boxes(6, 9);
  EXPECT_LE(worst_error(scene, Penalty{scenes::relative(2)}), 1);
  const auto fixed = run(scene, Penalty{scenes::absolute(5000)}), moving = run(scene, Penalty{});
  EXPECT_GT(std::abs(fixed.derivative("press", "E") - moving.derivative("press", "E")), 1e-6);
}

TEST(Oracle, OversizedSchemeErrorFallsWithItsFactor) {
  const auto scene = scenes::greco_plate(8);
  double before = 0;
  for (double kappa : {1e2, 1e3, 1e4}) {
    UzawaAL method;
    method.tolerance = 1e-13;
    method.adapt = false;
    method.sensitivity = UzawaAL::Sensitivity::oversized;
    method.oversize = kappa;
    const auto s = run(scene, method);
    const auto exact = run(scene, MonolithicAL{});
    const double error = std::abs(s.derivative("friction", "mu") / exact.derivative("friction", "mu") - 1);
    if (before > 0) {
      EXPECT_NEAR(std::log10(before / error), 1, 0.1) << kappa;
    }
    before = error;
  }
}

UzawaAL uzawa(double multiple, UzawaAL::Sensitivity sensitivity,
              UzawaAL::Acceleration acceleration = UzawaAL::Acceleration::none) {
  UzawaAL method;
  method.scale = scenes::relative(multiple);
  method.adapt = false;
  method.tolerance = 1e-13;
  method.max_augmentations = 20000;
  method.sensitivity = sensitivity;
  method.acceleration = acceleration;
  return method;
}

TEST(Oracle, DerivativesOfAcceleratedUpdatesAreThoseOfTheSolution) {
  using Sensitivity = UzawaAL::Sensitivity;
  for (const auto& scene : scenes::all())
    for (auto acceleration : {UzawaAL::Acceleration::aitken, UzawaAL::Acceleration::anderson})
      for (auto sensitivity : {Sensitivity::iterated, Sensitivity::preconditioned})
        // of the oracle the derivative follows by plain updates once the solution is there, so the scale is not small
        EXPECT_LE(worst_error(scene, uzawa(3, sensitivity, acceleration)), 1) << scene.responses[0].name;
}

/// Largest contraction of the updates, largest passes of the scheme, largest error against the monolithic derivatives.
struct Preconditioned {
  double contraction = 0, error = 0;
  int passes = 0;
};

Preconditioned preconditioned(const Scene& scene, const scenes::Solved& exact, double multiple) {
  const auto s = run(scene, uzawa(multiple, UzawaAL::Sensitivity::preconditioned, UzawaAL::Acceleration::anderson));
  Preconditioned out;
  const auto increments = static_cast<long>(s.trajectory.increments.size());
  EXPECT_EQ(s.gradients.of_responses.size(), exact.gradients.of_responses.size());
  const auto search = s.gradients.search;
  EXPECT_LE(s.gradients.counters.sensitivity_factorizations - search.sensitivity_factorizations, increments);
  long passes = 0;
  for (long n = 0; n < increments; ++n) {
    out.contraction = larger(out.contraction, s.trajectory.increments[n].contraction);
    out.passes = std::max<int>(out.passes, s.gradients.records[n].passes);
    passes += s.gradients.records[n].passes;
  }
  EXPECT_EQ(s.gradients.counters.sensitivity_backsolves - search.sensitivity_backsolves,
            passes * static_cast<long>(scene.parameters.size()));
  for (std::size_t i = 0; i < scene.responses.size(); ++i)
    for (std::size_t j = 0; j < scene.parameters.size(); ++j) {
      double scale = 0, error = 0;
      for (std::size_t n = 0; n < exact.gradients.of_responses.size(); ++n) {
        const double response = exact.value(scene.responses[i].name, static_cast<int>(n));
        scale = larger(scale, std::abs(exact.gradients.of_responses[n](i, j)));
        scale = larger(scale, std::abs(response / scene.parameters[j].value));
        error = larger(error, std::abs(s.gradients.of_responses[n](i, j) - exact.gradients.of_responses[n](i, j)));
      }
      if (scale != 0) out.error = larger(out.error, error / scale);
    }
  return out;
}

TEST(Oracle, PreconditionedSchemeTakesAtMostSixBacksolvesAParameterWhateverTheContraction) {
  double least = 1, most = 0;
  for (const auto& scene : scenes::all()) {
    const auto exact = run(scene, MonolithicAL{});
    for (double multiple : {0.01, 0.1, 1.0, 10.0}) {
      const auto result = preconditioned(scene, exact, multiple);
      EXPECT_LE(result.passes, 6) << multiple;
      // where 1 - q is 1e-5, a factor that makes up for it has rounding of its own
      EXPECT_LE(result.error, std::max(result.contraction < 0.995 ? 1e-10 : 5e-10, 50 * 1.1e-16 * exact.condition))
          << scene.responses[0].name << " " << multiple;
      least = smaller(least, result.contraction);
      most = larger(most, result.contraction);
    }
  }
  EXPECT_LE(least, 0.12);
  EXPECT_GE(most, 0.98);
}

TEST(Oracle, PreconditionedSchemeTakesAnyOversizeAndMoreOfItTakesFewerPasses) {
  const auto scene = scenes::greco_plate(8);
  int before = 100;
  for (double oversize : {10.0, 1e2, 1e3, 1e5}) {
    auto method = uzawa(0.1, UzawaAL::Sensitivity::preconditioned);
    method.oversize = oversize;
    EXPECT_LE(worst_error(scene, method), 1);
    const auto s = run(scene, method);
    EXPECT_EQ(s.gradients.records.back().oversize, oversize);
    EXPECT_LT(s.gradients.records.back().passes, before);
    before = s.gradients.records.back().passes;
  }
}

TEST(Oracle, FrozenConeHasTheDerivativesOfItsOwnMap) {
  for (const auto& scene : {scenes::wedge(1), scenes::slider({{0, 0}, {1, 0.1}, {2, -0.1}, {3, 0.04}}, 9),
                            scenes::two_boxes(6, 9), scenes::greco_plate(8, 0.3)}) {
    auto method = uzawa(10, UzawaAL::Sensitivity::iterated);
    method.cone = UzawaAL::Cone::frozen;
    EXPECT_LE(worst_error(scene, method), 1);
    method.sensitivity = UzawaAL::Sensitivity::truncated;
    for (int cap : {2, 4}) {
      method.max_augmentations = cap;
      EXPECT_LE(worst_error(scene, method), 1) << cap;
    }
  }
}

TEST(Oracle, DifferentiatingDoesNotChangeTheSolution) {
  for (const Method& method : {Method(Penalty{}), Method(UzawaAL{}), Method(MonolithicAL{})}) {
    const Scene scene = scenes::two_boxes(6, 9);
    Scene alone = scene;
    alone.parameters.clear();
    const auto expected = scenes::SolvedRun(alone, method).trajectory;
    scenes::SolvedRun run(scene, method);
    run.direct();
    expect_same_bits(run.trajectory, expected, std::string(name_of(method)) + " differentiated");
    expect_same_bits(run.again(), expected, std::string(name_of(method)) + " solved again after it");
  }
}

TEST(Oracle, OneBacksolveAParameterAndIncrementForTheMonolithicMethod) {
  const auto scene = scenes::two_boxes(6, 9);
  const auto s = run(scene, MonolithicAL{});
  EXPECT_EQ(s.gradients.counters.sensitivity_backsolves,
            static_cast<long>(scene.parameters.size() * s.trajectory.increments.size()));
  EXPECT_LE(s.gradients.counters.sensitivity_factorizations, static_cast<long>(s.trajectory.increments.size()));
}

TEST(GradientCheck, AgreesForEveryMethodToWhatADifferenceTells) {
  for (const Method& method : {Method(Penalty{}), Method(UzawaAL{}), Method(MonolithicAL{})}) {
    const auto check = check_gradients(make_model(scenes::slider({{0, 0}, {1, 0.1}, {2, -0.05}}, 6)), method, {});
    EXPECT_TRUE(check.passed()) << name_of(method);
    for (const auto& entry : check.entries) {
      EXPECT_LE(entry.allowed, std::max(1e-8, entry.estimate));
      EXPECT_LE(entry.error, entry.allowed);
      EXPECT_EQ(entry.verdict, GradientCheck::Verdict::agrees)
          << name_of(method) << " " << entry.response << "/" << entry.parameter << " " << entry.computed << " "
          << entry.difference << " error " << entry.error << " allowed " << entry.allowed;
    }
  }
}

TEST(GradientCheck, ChecksBothSidesOfATie) {
  // at F = k g0 exactly every step changes a state on one side
  const auto check = check_gradients(make_model(scenes::stop(10, 1000, 0.01)), MonolithicAL{}, {});
  EXPECT_TRUE(check.passed());
  for (const auto& entry : check.entries) EXPECT_NE(entry.side, 0) << entry.response << "/" << entry.parameter;
  EXPECT_GT(check.rejected, 0);
}

}  // namespace
}  // namespace stickslip::oracle_test
