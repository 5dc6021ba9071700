/// A stiff body with several nodes on one facet of a soft one: how its nodes share the force is the stiff body's
/// matter, and the friction of the middle node follows from it.
#include <gtest/gtest.h>

#include "tests/studies/cases.hpp"

namespace stickslip::stiff_on_soft {
namespace {

using nlohmann::json;

/// A block of two cells on a slab of one, `ratio` times softer, pressed by 0.02 and hardly moved aside.
json block_on_slab(double ratio, const char* engine) {
  json scene = cases::block_on_a_slab(2, 1000 / ratio);
  scene["linear_solver"] = {{"engine", engine}};
  scene["responses"]["N"] = {{"contact_force", {{"contact", "t"}, {"component", "normal"}}}};
  return scene;
}

/// The tangential force over the normal one.
double share(double ratio, const char* method, const char* engine) {
  const auto result = cases::run(block_on_slab(ratio, engine), {{method, json::object()}}, "block.json");
  EXPECT_TRUE(is_converged(result.trajectory.status)) << method << " " << engine << result.trajectory.message;
  const auto& responses = result.steps.back().responses;
  return responses[0] / responses[1];  // Fx, N
}

TEST(AStiffBodyOnASoftOne, HasTheFrictionThatExactContactHasByTheDefaultPenalty) {
  const double exact = share(1e4, "monolithic_al", "sparse");
  EXPECT_LT(std::abs(exact), 1e-3);  // the middle node bears nothing; where it does, it is 0.028
  // springs of 1e3 k_i are off by 1 % of what the block's nodes share among themselves, at most
  for (const char* engine : {"sparse", "condensed"}) EXPECT_NEAR(share(1e4, "penalty", engine), exact, 1e-3) << engine;
}

TEST(AStiffBodyOnASoftOne, HasOneAnswerByEveryEngineWhereItIsNearlyRigid) {
  const double exact = share(3e8, "monolithic_al", "sparse");
  for (const char* method : {"monolithic_al", "uzawa_al"})
    for (const char* engine : {"sparse", "condensed"})
      EXPECT_NEAR(share(3e8, method, engine), exact, 1e-6) << method << engine;  // the bodies' forces round by 3e-8
  EXPECT_NEAR(share(3e8, "penalty", "sparse"), share(3e8, "penalty", "condensed"), 1e-6);
}

}  // namespace
}  // namespace stickslip::stiff_on_soft
