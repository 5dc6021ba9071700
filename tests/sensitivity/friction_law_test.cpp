/// Derivatives by the numbers of a law of friction, on both of its pieces, at its corner and past it.
#include <gtest/gtest.h>

#include <array>

#include "core/model/response.hpp"
#include "sensitivity/one_sided.hpp"
#include "tests/support/blocks.hpp"
#include "tests/support/both_modes.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/oracle.hpp"

namespace stickslip::friction_law_test {
namespace {

using Law = FrictionLaw<Number>;

/// Block on a spring k = 1000 under N = 100, drawn to and fro by .5.
Scene limited_slider(double mu, double limit) {
  Scene s = scenes::slider({{0, 0}, {1, 0.5}, {2, -0.5}}, 8, 1000, mu, 100);
  const Number most = scenes::parameter(s, "limit", limit);
  std::get<Coulomb<Number>>(s.contacts[0].friction->law).limit = most;
  return s;
}

std::vector<Method> methods() {
  UzawaAL truncated, preconditioned;
  truncated.sensitivity = UzawaAL::Sensitivity::truncated;
  preconditioned.sensitivity = UzawaAL::Sensitivity::preconditioned;
  return {Penalty{}, UzawaAL{}, truncated, preconditioned, MonolithicAL{}};
}

TEST(FrictionLawDerivatives, BelongToThePieceThatHolds) {
  for (const Method& method : scenes::exact_methods()) {
    const auto limited = scenes::run(limited_slider(0.3, 25), method),
               sloping = scenes::run(limited_slider(0.3, 35), method);
    EXPECT_NEAR(limited.derivative("u", "limit", 3), -1e-3, 1e-9) << name_of(method);
    EXPECT_NEAR(limited.derivative("u", "mu", 3), 0, 1e-9);
    EXPECT_NEAR(limited.derivative("u", "N", 3), 0, 1e-9);
    EXPECT_NEAR(sloping.derivative("u", "limit", 3), 0, 1e-9);
    EXPECT_NEAR(sloping.derivative("u", "mu", 3), -0.1, 1e-9);
    EXPECT_NEAR(sloping.derivative("u", "N", 3), -3e-4, 1e-9);
  }
}

/// A block whose top is drawn to and fro over the floor: points stick, slip and reach the limit, and turn.
Scene sheared_block(const Law& law) {
  Scene s;
  s.legs = {{2, 6}};
  s.bodies = {scenes::box_body("block", {0, 0}, {4, 2}, {8, 4})};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  if (const auto* coulomb = std::get_if<Coulomb<Number>>(&law.law)) {
    const Number mu = scenes::parameter(s, "mu", coulomb->coefficient.value);
    s.contacts[0].friction = Law(Coulomb<Number>{mu, scenes::parameter(s, "limit", coulomb->limit->value)});
  } else {
    const double limit = std::get<Tresca<Number>>(law.law).limit.value;
    s.contacts[0].friction = Law(Tresca<Number>{scenes::parameter(s, "limit", limit)});
  }
  const Number pull = scenes::parameter(s, "pull", 0.012);
  s.supports = {scenes::support(
      "block.top", {{'x', scenes::table({{0, 0.0}, {1, pull}, {2, -0.01}})}, {'y', scenes::table({{0, -0.008}})}})};
  s.responses = {scenes::response("drag", Response::Kind::contact_force, "sole", "x"),
                 scenes::response("heat", Response::Kind::dissipation, "sole"),
                 scenes::response("energy", Response::Kind::strain_energy, "block")};
  return s;
}

TEST(FrictionLawDerivatives, EqualTheOracleInWhichEveryPieceOccurs) {
  for (const Law& law : {Law(Coulomb<Number>{0.4, 1.7}), Law(Tresca<Number>{1.5})})
    for (const Method& method : methods()) {
      const auto s = scenes::run(sheared_block(law), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
      std::array<long, 4> met{};
      for (const auto& increment : s.trajectory.increments)
        for (const ContactState state : increment.state.contact.state) ++met[static_cast<std::size_t>(state)];
      EXPECT_TRUE(met[1] > 0 && met[3] > 0) << met[1] << " " << met[3];
      EXPECT_EQ(met[2] > 0, law.has(ContactState::slip)) << met[2];
      const auto replayed = s.trajectory.step_table();
      for (int j = 0; j < static_cast<int>(s.model.scene.parameters.size()); ++j) {
        const auto exact = oracle::complex_step(s.model, method, replayed, j);
        const Vector<double> rounding =
            1e-11 / s.model.scene.parameters[j].value *
            evaluate_responses(s.model, s.slots, s.trajectory.increments.back().state, 2.0).cwiseAbs();
        for (Eigen::Index r = 0; r < exact.rows(); ++r)
          for (Eigen::Index n = 0; n < exact.cols(); ++n)
            // iterated schemes end at 1e-10 of the largest, and rounding is some 1e-13 of what a response is made of
            EXPECT_NEAR(s.gradients.of_responses[n](r, j), exact(r, n),
                        1e-7 * largest_entry(exact.row(r)) + rounding[r])
                << name_of(method) << " response " << r << " parameter " << j << " increment " << n;
      }
    }
}

TEST(FrictionLawDerivatives, HaveBothSidesAtTheCorner) {
  for (const Method& method : scenes::exact_methods()) {
    const Scene scene = limited_slider(0.25, 25);  // mu N = limit
    const auto sides = scenes::SolvedRun(scene, method).both_sides();
    ASSERT_TRUE(sides) << name_of(method);
    const auto side = [&](const Matrix<double>& of, const std::string& name) {  // of the first response, u
      int j = 0;
      while (scene.parameters[j].name != name) ++j;
      return of(0, j);
    };
    EXPECT_NEAR(side(sides->backward[3], "mu"), -0.1, 1e-8)
        << name_of(method) << ": the cone is the lesser bound below";
    EXPECT_NEAR(side(sides->forward[3], "mu"), 0, 1e-8) << name_of(method);
    EXPECT_NEAR(side(sides->backward[3], "limit"), -1e-3, 1e-8) << name_of(method);
    EXPECT_NEAR(side(sides->forward[3], "limit"), 0, 1e-8) << name_of(method);
  }
}

TEST(FrictionLawDerivatives, EqualTheAdjoint) {
  Scene scene = sheared_block(Coulomb<Number>{0.4, 1.7});
  scenes::ask_for_objectives(scene);
  // iterated schemes end at 1e-10 of the largest; the rest is rounding
  for (const Method& method : methods()) EXPECT_LE(scenes::difference_of_modes(scene, method), 1e-9) << name_of(method);
}

}  // namespace
}  // namespace stickslip::friction_law_test
