/// Derivatives of scenes of which one body is condensed and another flows: both modes, by every scheme, and the complex
/// step of the whole program. (Direct ones are those of the engine in full: tests/methods/engine_agreement_test.cpp.)
#include <gtest/gtest.h>

#include "methods/stepping/engine_choice.hpp"
#include "tests/support/finite_strain.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::mixed_engine_test {
namespace {

using Sensitivity = UzawaAL::Sensitivity;

Method uzawa(Sensitivity scheme) {
  UzawaAL method;
  method.sensitivity = scheme;
  return method;
}

TEST(MixedEngine, HasOneDerivativeInBothModes) {
  for (bool inclined : {false, true}) {
    Scene scene = scenes::punched_metal(5, 0.2, inclined);
    scenes::ask_for_objectives(scene);
    for (const Method& method : {Method(Penalty{}), uzawa(Sensitivity::iterated), uzawa(Sensitivity::truncated),
                                 uzawa(Sensitivity::preconditioned), Method(MonolithicAL{})}) {
      EXPECT_TRUE(condenses(make_model(scene), method, LinearAlgebra::Engine::automatic)) << name_of(method);
      // 50 roundings times the condition, estimated: 3e2 with multipliers; 1e5 with a penalty, which Uzawa's rho nears
      EXPECT_LE(scenes::difference_of_modes(scene, method), std::holds_alternative<MonolithicAL>(method) ? 1e-11 : 1e-9)
          << name_of(method) << (inclined ? " inclined" : "");
    }
  }
}

TEST(MixedEngine, HasTheDerivativesOfTheWholeRun) {
  const Scene scene = scenes::punched_metal(3);
  for (const Method& method : {Method(Penalty{}), uzawa(Sensitivity::iterated), Method(MonolithicAL{})}) {
    EXPECT_TRUE(condenses(make_model(scene), method, LinearAlgebra::Engine::automatic)) << name_of(method);
    scenes::expect_derivatives_of_the_oracle(scene, method);
  }
}

}  // namespace
}  // namespace stickslip::mixed_engine_test
