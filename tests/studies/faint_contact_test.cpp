/// Derivatives of contact that has come from afar, or presses faintly beside what the run has moved.
#include <gtest/gtest.h>

#include "tests/studies/cases.hpp"

namespace stickslip::faint_contact {
namespace {

using nlohmann::json;

/// The arch, up to where its crown has come down by 28 of its 96. The least pressure is 1e-9 of what such a way would
/// make of the stiffness of a node.
CaseResult folded(double friction) {
  const std::filesystem::path file = cases::shipped / "arch.json";
  json scene = cases::load(file);
  scene["time"] = {{"end", 21.0 / 45}, {"steps", 21}};
  scene["contacts"]["touch"]["friction"] = friction;
  return cases::run(scene, {{"monolithic_al", json::object()}}, file);
}

TEST(FaintContact, HasTheDerivativesOfItsOwnBranch) {
  constexpr double friction = 0.5, step = 1e-4;
  const auto at = folded(friction), less = folded(friction - step), more = folded(friction + step);
  for (const auto* run : {&at, &less, &more}) ASSERT_TRUE(is_converged(run->status())) << run->message();
  const auto& parameters = at.problem->model.scene.parameters;
  const Eigen::Index mu = parameters[0].name == "mu" ? 0 : 1;
  Vector<double> largest = Vector<double>::Zero(at.steps[0].responses.size());
  for (std::size_t n = 0; n < at.steps.size(); ++n) {
    EXPECT_TRUE(at.steps[n].differentiable) << n;
    const Vector<double> difference = (more.steps[n].responses - less.steps[n].responses) / (2 * step);
    const Vector<double> computed = at.steps[n].sensitivities.col(mu);
    largest = largest.cwiseMax(difference.cwiseAbs());
    // (the differences err by the square of their step, and by rounding over it)
    for (Eigen::Index r = 0; r < computed.size(); ++r)
      EXPECT_NEAR(computed[r], difference[r], 1e-6 * largest[r]) << n << ", response " << r;
  }
}

}  // namespace
}  // namespace stickslip::faint_contact
