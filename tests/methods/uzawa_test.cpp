/// The outer loop of Uzawa's method: its accelerations, the frozen cone, and how it gives up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "methods/augmentation/augmentation_status.hpp"
#include "methods/augmentation/projection.hpp"
#include "methods/newton/regularisation.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::uzawa_test {
namespace {

using scenes::run;
using Acceleration = UzawaAL::Acceleration;

UzawaAL plain(double multiple) {
  UzawaAL method;
  method.scale = scenes::relative(multiple);
  method.adapt = false;
  method.tolerance = 1e-12;
  method.max_augmentations = 20000;
  return method;
}

/// Evaluations of a linear map with the eigenvalues `q`, turned by a rotation of all planes, until |f(x) - x| is 1e-12.
int evaluations(Acceleration kind, const std::vector<double>& q) {
  const auto n = static_cast<Eigen::Index>(q.size());
  Matrix<double> turn = Matrix<double>::Identity(n, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    Matrix<double> plane = Matrix<double>::Identity(n, n);
    plane.block(i, i, 2, 2) << std::cos(1.0), -std::sin(1.0), std::sin(1.0), std::cos(1.0);
    turn *= plane;
  }
  const Matrix<double> A = turn * Eigen::Map<const Vector<double>>(q.data(), n).asDiagonal() * turn.transpose();
  const Vector<double> b = Vector<double>::LinSpaced(n, 1, 2);
  Vector<double> x = Vector<double>::Zero(n);
  Accelerator<double> accelerator(kind);
  for (int count = 1; count < 10000; ++count) {
    const Vector<double> image = A * x + b;
    if ((image - x).norm() <= 1e-12 * b.norm()) return count;
    x = accelerator.next(x, image, true, *std::max_element(q.begin(), q.end()), [](const auto& y) { return y; });
  }
  return 10000;
}

TEST(Acceleration, EndsALinearMapOfOneUnknownInThreeEvaluations) {
  for (double q : {0.5, 0.8, -0.7, -2.0}) {  // Aitken's weight 1 / (1 - q) within [0.1, 10]
    EXPECT_LE(evaluations(Acceleration::aitken, {q}), 3) << q;
    EXPECT_LE(evaluations(Acceleration::anderson, {q}), 3) << q;
  }
  EXPECT_LE(evaluations(Acceleration::anderson, {3.0}), 3);
}

TEST(Acceleration, ByAndersonEndsALinearMapOfFiveUnknownsInSevenEvaluations) {
  // two to begin with, and one a dimension
  EXPECT_LE(evaluations(Acceleration::anderson, {0.95, 0.8, 0.5, 0.2, 0.1}), 7);
}

TEST(Acceleration, IsNeverMuchWorseThanPlain) {
  for (const auto& q : {std::vector{0.99},
                        {0.99, 0.9, 0.5, 0.1},
                        {0.5, -0.5},
                        {0.9, -0.9, 0.89, -0.89, 0.7, 0.3, 0.0},
                        {0.05, 0.04, 0.03},
                        {0.999, 0.0}}) {
    const int none = evaluations(Acceleration::none, q);
    for (auto kind : {Acceleration::aitken, Acceleration::anderson}) EXPECT_LE(evaluations(kind, q), none + 2) << q[0];
  }
}

/// Those of all kinds, of further elements, and with slip that passes node by node.
std::vector<Scene> many_scenes() {
  auto many = scenes::all();
  for (const auto& scene : {scenes::two_drums(4, 3, "Q4_mean_dilatation"), scenes::two_slices(3, 4, "Q8"),
                            scenes::fitted_rings("Q8"), scenes::pull_out(12, {0, 1, -1, 0.5}, 2)})
    many.push_back(scene);
  return many;
}

TEST(Acceleration, StaysAtItsFixedPointDownToRounding) {
  // differences of residuals are noise there, and would extrapolate to anywhere
  const Matrix<double> A = Vector<double>{{0.9, 0.5, 0.3, -0.2, 0.1}}.asDiagonal();
  const Vector<double> b{{1, 3, -7, 0.1, 11}}, fixed = (Matrix<double>::Identity(5, 5) - A).lu().solve(b);
  for (auto kind : {Acceleration::aitken, Acceleration::anderson}) {
    Accelerator<double> accelerator(kind);
    Vector<double> x = Vector<double>::Zero(5);
    for (int count = 0; count < 300; ++count) {
      x = accelerator.next(x, A * x + b, true, 0.9, [](const auto& y) { return y; });
      // 20 roundings over 1 - 0.9, of the largest
      if (count <= 250) continue;
      EXPECT_LE((x - fixed).norm(), 200 * 1.1e-16 * fixed.norm());
    }
  }
}

TEST(Acceleration, ConvergesToTheSameSolutionAsPlainUpdates) {
  for (const auto& scene : many_scenes())
    for (bool adapt : {false, true}) {
      auto method = plain(0.3);
      method.adapt = adapt;
      const auto none = run(scene, method);
      ASSERT_TRUE(is_converged(none.trajectory.status)) << none.trajectory.message;
      for (auto kind : {Acceleration::aitken, Acceleration::anderson}) {
        method.acceleration = kind;
        const auto s = run(scene, method);
        ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
        ASSERT_EQ(s.trajectory.increments.size(), none.trajectory.increments.size());
        for (std::size_t n = 0; n < s.trajectory.increments.size(); ++n) {
          const auto &a = s.trajectory.increments[n].state, &b = none.trajectory.increments[n].state;
          // Each is within its tolerance of 1e-12, which a path of two dozen increments adds up. (States are free
          // where a point has come to rest on its cone, as in the bar.)
          EXPECT_LE((a.contact.traction - b.contact.traction).norm(), 1e-10 * b.contact.traction.norm());
          EXPECT_LE((a.displacement - b.displacement).norm(), 1e-9 * b.displacement.norm());
          // two extrapolations that are taken back are free; at 1e-12, rounding ends either run an augmentation later
          EXPECT_LE(s.trajectory.increments[n].augmentations, none.trajectory.increments[n].augmentations + 3);
        }
      }
    }
}

TEST(Acceleration, SparesMostAugmentationsWhereTheScaleIsSmall) {
  for (const auto& scene : {scenes::greco_plate(8), scenes::two_boxes(6, 9), scenes::two_boxes(5, 4, "T3", 0.25)})
    // Contractions of about 0.99, 0.92 and 0.55; measured in docs/decisions.md.
    for (const auto& [multiple, aitken, anderson] :
         {std::tuple{0.01, 1.01, 0.15}, {0.1, 0.5, 0.25}, {1.0, 0.65, 0.55}}) {
      auto method = plain(multiple);
      const double none = static_cast<double>(run(scene, method).trajectory.counters.augmentations);
      method.acceleration = Acceleration::aitken;
      EXPECT_LE(run(scene, method).trajectory.counters.augmentations, aitken * none) << multiple;
      method.acceleration = Acceleration::anderson;
      EXPECT_LE(run(scene, method).trajectory.counters.augmentations, anderson * none) << multiple;
    }
}

TEST(Augmentations, EndWithinTheirToleranceOfTheFixedPointHoweverSlowlyTheyGetThere) {
  const auto scene = scenes::greco_plate(8);
  const auto exact = run(scene, MonolithicAL{});
  const auto& end = exact.trajectory.increments.back().state.contact.traction;
  for (double multiple : {0.02, 0.1, 0.5}) {  // contractions of about 0.98, 0.92 and 0.7
    auto method = plain(multiple);
    method.tolerance = 1e-5;
    const auto s = run(scene, method);
    ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
    const double error = (s.trajectory.increments.back().state.contact.traction - end).norm() / end.norm();
    EXPECT_LE(error, 2 * method.tolerance) << multiple;  // a contraction is measured to some percent
  }
}

TEST(InnerSolves, OnTheWayEndBeforePointsThatHardlySlipHaveMadeUpTheirMinds) {
  constexpr int cells = 100;
  for (bool adapt : {true, false}) {
    auto method = plain(10);
    method.adapt = adapt;
    const auto s = run(scenes::pull_out(cells, {0, 1, 0}, 4), method);
    method.sensitivity = UzawaAL::Sensitivity::truncated;  // differentiates each inner solve, so that all are exact
    const auto exact = run(scenes::pull_out(cells, {0, 1, 0}, 4), method);
    ASSERT_TRUE(is_converged(s.trajectory.status) && is_converged(exact.trajectory.status)) << s.trajectory.message;
    const auto &counters = s.trajectory.counters, &of_exact = exact.trajectory.counters;
    // the front passes 2 n / 3 nodes out and n / 3 back, one an iteration; measured: 225 and 354 of 611 and 941
    EXPECT_LE(counters.newton, cells + 2 * counters.augmentations);
    EXPECT_LE(2.5 * static_cast<double>(counters.newton), static_cast<double>(of_exact.newton));
    EXPECT_LE(counters.augmentations, 1.1 * static_cast<double>(of_exact.augmentations));
    const auto &a = s.trajectory.increments.back().state.contact, &b = exact.trajectory.increments.back().state.contact;
    EXPECT_EQ(a.state, b.state);
    EXPECT_LE((a.traction - b.traction).norm(), 1e-10 * b.traction.norm());  // tolerance 1e-12, eight increments
  }
}

TEST(InnerSolves, LeaveAnEquilibriumExactToRoundingWhereTheAugmentationsEnd) {
  for (const auto& scene : {scenes::pull_out(30, {0, 1, 0}, 4), scenes::two_boxes(6, 9), scenes::greco_plate(8)})
    for (int limit : {1, 2, 3, 2000}) {  // cut off, too
      auto method = plain(10);
      method.max_augmentations = limit;
      const auto s = run(scene, method);
      for (const auto& increment : s.trajectory.increments)
        EXPECT_LE(increment.history.back().equilibrium, 1e-12) << limit;  // Newton's own tolerance
    }
}

UzawaAL frozen(double multiple) {
  auto method = plain(multiple);
  method.cone = UzawaAL::Cone::frozen;
  return method;
}

TEST(FrozenCone, ConvergesToTheSameSolutionByTheFactorOfMuOverTheSlopeOfTheLoadPath) {
  constexpr double slope = 2;  // k / coupling of the wedge
  for (double mu : {0.4, 1.0, 1.6, 1.9}) {
    // N = press + (push - mu N) / s
    const double press = (10 + 100 / slope) / (1 + mu / slope);
    const auto s = run(scenes::wedge(mu), frozen(1e4)), augmented = run(scenes::wedge(mu), plain(1e4));
    ASSERT_TRUE(is_converged(s.trajectory.status)) << mu << s.trajectory.message;
    EXPECT_NEAR(s.value("press"), press, 1e-10 * press);  // the tolerance of 1e-12, over 1 - mu / s
    EXPECT_NEAR(augmented.value("press"), press, 1e-10 * press);
    // normal updates of contraction 1e-4 ride on it
    EXPECT_NEAR(s.trajectory.increments.back().contraction, mu / slope, 1e-3) << mu;
    EXPECT_LT(augmented.trajectory.counters.augmentations, 10) << mu;
  }
}

TEST(FrozenCone, EndsInATwoCycleBeyondTheSlopeAndSaysSo) {
  for (double mu : {2.5, 4.0, 8.0})
    for (double multiple : {1e2, 1e4}) {
      const auto s = run(scenes::wedge(mu), frozen(multiple));
      EXPECT_EQ(s.trajectory.status, Status::cycle) << mu << " " << multiple << " " << s.value("press");
      EXPECT_THAT(s.trajectory.message, testing::HasSubstr("use the augmented cone"));
      EXPECT_EQ(run(scenes::wedge(mu), plain(multiple)).trajectory.status, Status::converged) << mu;
    }
}

TEST(FrozenCone, IsNeverWrongInSilence) {
  // a small scale takes short steps of the pressure, and some of these still converge
  for (double mu : {1.9, 2.0, 2.1, 2.5, 4.0, 8.0})
    for (double multiple : {0.1, 1.0, 10.0, 1e2, 1e4}) {
      const auto s = run(scenes::wedge(mu), frozen(multiple));
      const double press = (10 + 100 / 2.0) / (1 + mu / 2);
      if (is_converged(s.trajectory.status)) {
        EXPECT_NEAR(s.value("press"), press, 1e-9 * press) << mu << " " << multiple;  // 1e-12, over |1 - mu / s|
      }
    }
}

TEST(FrozenCone, HasASymmetricTangentAndTheSolutionOfTheAugmentedOne) {
  RunOptions sparse, condensed;
  sparse.linear_algebra.engine = LinearAlgebra::Engine::sparse;
  condensed.linear_algebra.engine = LinearAlgebra::Engine::condensed;
  for (const auto& scene : {scenes::greco_plate(8, 0.3), scenes::two_boxes(6, 9)}) {
    const auto reference = run(scene, plain(10), condensed);
    EXPECT_THAT(reference.trajectory.engine, testing::HasSubstr("dense LU"));
    for (const auto& options : {sparse, condensed}) {
      const auto s = run(scene, frozen(10), options);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
      if (options.linear_algebra.engine == LinearAlgebra::Engine::condensed) {
        EXPECT_THAT(s.trajectory.engine, testing::HasSubstr("dense LL^T"));
      }
      const auto &a = s.trajectory.increments.back().state.contact,
                 &b = reference.trajectory.increments.back().state.contact;
      EXPECT_EQ(a.state, b.state);
      EXPECT_LE((a.traction - b.traction).norm(), 1e-9 * b.traction.norm());  // a path of 12 increments to 1e-12 each
    }
  }
}

/// C8: a block whose sole is moved into the floor by `depth`.
Scene infeasible(double depth) {
  Scene scene;
  scene.legs = {{1, 1}};
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {2.0, 1.0};
  box.cells = {4, 2};
  scene.bodies = {{"block", box, LinearElastic{1000.0, 0.3}, "", 1.0}};
  scene.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  scene.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  scene.supports = {scenes::support("block.bottom & block.left",
                                    {{'x', scenes::table({{0, 0.0}})}, {'y', scenes::table({{0, 0.0}, {1, -depth}})}}),
                    scenes::support("block.top", {{'y', scenes::table({{0, 0.0}})}})};
  scene.responses = {scenes::response("press", Response::Kind::contact_force, "sole", "normal")};
  return scene;
}

TEST(Status, NamesThePointWhoseMotionIsPrescribedIntoTheObstacle) {
  for (bool adapt : {true, false})
    for (double multiple : {0.1, 10.0})
      for (auto kind : {Acceleration::none, Acceleration::aitken, Acceleration::anderson}) {
        auto method = plain(multiple);
        method.adapt = adapt;
        method.acceleration = kind;
        const auto s = run(infeasible(1e-3), method);
        EXPECT_EQ(s.trajectory.status, Status::infeasible) << adapt << multiple << s.trajectory.message;
        EXPECT_THAT(s.trajectory.message, testing::HasSubstr("sole at (0, 0) penetrates by 0.001, and supports"));
        EXPECT_LE(s.trajectory.increments.back().augmentations, 12);
      }
}

TEST(Status, OfAVerySlowIterationIsCapAndNotInfeasible) {
  for (double multiple : {1e-9, 1e-6, 1e-3}) {
    auto method = plain(multiple);
    method.max_augmentations = 30;
    for (const auto& scene : {scenes::stop(), scenes::greco_plate(8)})
      EXPECT_EQ(run(scene, method).trajectory.status, Status::cap) << multiple;
  }
}

TEST(Status, OfAdaptedScaleConvergesFromAnySmallOne) {
  for (double multiple : {1e-9, 1e-6, 1e-3}) {
    auto method = plain(multiple);
    method.adapt = true;
    method.max_augmentations = 60;
    const auto s = run(scenes::greco_plate(8), method);
    EXPECT_EQ(s.trajectory.status, Status::converged) << multiple;
    for (double factor : s.trajectory.increments.back().rho_factor)
      EXPECT_LE(factor * multiple, 1e3 * (1 + 1e-12)) << "capped at 1e3 nodal stiffnesses, but for rounding";
  }
}

TEST(Adaption, BeginsAnIncrementWithNoLargerScaleThanTheAutomaticOne) {
  // of the last factors 1, 30, 1e5 at a scale of s: 1 and 30 stay below 100 / s, beyond which none begins
  const auto at_small_strain = UzawaAL::automatic_multiple.of(false);
  for (double multiple : {1e-3, 1.0, 1e3}) {
    const auto method = plain(multiple);
    const auto s = run(scenes::greco_plate(8), method);
    const auto initial = initial_regularisation(s.slots, method);
    std::vector<double> last(initial.size(), 1);
    last[1] = 30;
    last[2] = 1e5;
    const auto first = detail::first_factors(s.slots, initial, last);
    const double most = std::max(1.0, at_small_strain / multiple);
    EXPECT_EQ(first[0], 1) << multiple;
    EXPECT_EQ(first[1], std::min(30.0, most)) << multiple;
    EXPECT_NEAR(first[2], std::min(1e5, most), 1e-12 * most) << "rounding of the products; " << multiple;
  }
}

/// Of a slider with mu = 0.3: tension goes, friction is cut to the bound, what is in the cone stays.
TEST(Projection, IsOntoTheCone) {
  const Model model = make_model(scenes::slider({{1, 0.1}}, 1));
  const auto slots = make_slots<double>(model, model.scene.as<double>());
  const auto projected = [&](double normal, double tangential) {
    Vector<double> multiplier(2);
    multiplier << normal, tangential;
    return Vector<double>(detail::projected_multiplier(model, slots, multiplier));
  };
  EXPECT_EQ(projected(2, 1), Vector<double>(Eigen::Vector2d(0, 0)));
  EXPECT_EQ(projected(-10, -2), Vector<double>(Eigen::Vector2d(-10, -2)));
  EXPECT_LT((projected(-10, -4) - Eigen::Vector2d(-10, -3)).norm(), 1e-15 * 10);  // (a rounding of each)
}

}  // namespace
}  // namespace stickslip::uzawa_test
