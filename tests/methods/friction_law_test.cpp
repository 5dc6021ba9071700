/// Laws of friction other than Coulomb's (core/contact/friction_law.hpp), by every method: closed forms of a point on
/// a spring, all solutions of random problems found apart from the solver, and balance of a block.
#include <gtest/gtest.h>

#include "methods/rescue/statics.hpp"
#include "tests/support/blocks.hpp"
#include "tests/support/every_branch.hpp"
#include "tests/support/random_contacts.hpp"

namespace stickslip::friction_law_test {
namespace {

using scenes::relative;
using Law = FrictionLaw<Number>;
using Limited = Coulomb<Number>;

constexpr double solved = 1e-8;  // Uzawa's tolerance of 1e-10 times condition numbers up to some hundred

/// The penalty so stiff that its overlap is no part of what is compared.
std::vector<Method> stiff_methods() {
  Penalty penalty;
  penalty.stiffness = relative(1e8);
  return {penalty, UzawaAL{}, MonolithicAL{}};
}

struct LawRun {
  Model model;
  Slots<double> slots;
  Trajectory<double> trajectory;
  const State<double>& last() const { return trajectory.increments.back().state; }
};

LawRun solve_scene(const Scene& scene, const Method& method, const RunOptions& options = {}) {
  LawRun r{make_model(scene), {}, {}};
  r.slots = make_slots<double>(r.model, scene.as<double>());
  Workspace<double> workspace;
  r.trajectory = solve(r.model, r.slots, method, options, workspace);
  return r;
}

TEST(FrictionLaw, IsTheLeastOfConeAndLimit) {
  const FrictionLaw<double> coulomb = 0.5, limited(Coulomb<double>{0.5, 2.0}), tresca(Tresca<double>{2.0});
  EXPECT_EQ(coulomb.bound(6), 3);
  EXPECT_EQ(limited.bound(6), 2);
  EXPECT_EQ(limited.bound(3), 1.5);
  EXPECT_EQ(limited.piece(4), ContactState::slip) << "at the corner";
  EXPECT_EQ(limited.piece(4.1), ContactState::limited);
  EXPECT_EQ(tresca.bound(0), 2);
  EXPECT_TRUE(coulomb.has_apex() && limited.has_apex() && !tresca.has_apex());
  EXPECT_TRUE(coulomb.couples() && limited.couples() && !tresca.couples());
  EXPECT_EQ(limited.slope_at_infinity(), 0);
  EXPECT_TRUE(FrictionLaw<double>(0.0).bears_nothing() &&
              FrictionLaw<double>(Coulomb<double>{0.3, 0.0}).bears_nothing() && !limited.bears_nothing());
}

/// Block on a spring k = 1000 under N = 100, drawn by .5: it follows until the spring bears the bound.
double place(const Law& law, const Method& method) {
  Scene s = scenes::slider({{0, 0}, {1, 0.5}}, 5, 1000, 0.3, 100);
  s.contacts[0].friction = law;
  const auto r = solve_scene(s, method);
  EXPECT_EQ(r.trajectory.status, Status::converged) << name_of(method);
  return r.last().displacement[0];
}

TEST(FrictionLaw, HoldsASliderByItsBound) {
  for (const auto& method : stiff_methods()) {
    EXPECT_NEAR(place(Limited{0.3, 25.0}, method), 0.5 - 0.025, 1e-6) << name_of(method) << ": the limit";
    EXPECT_NEAR(place(Limited{0.3, 35.0}, method), 0.5 - 0.03, 1e-6) << name_of(method) << ": the cone";
    EXPECT_NEAR(place(Tresca<Number>{25.0}, method), 0.5 - 0.025, 1e-6) << name_of(method) << ": Tresca";
    EXPECT_NEAR(place(Limited{0.3, 0.0}, method), 0.5, 1e-6) << name_of(method) << ": no friction";
  }
}

TEST(FrictionLaw, ForgetsItsLimitWhereItIsNotReached) {
  for (const auto& method : stiff_methods())
    EXPECT_EQ(place(Limited{0.3, 1e6}, method), place(0.3, method)) << name_of(method);
}

TEST(FrictionLaw, LimitsAPointInSpace) {
  Scene s = scenes::dragged_point({{{0, 0, 0}, {1, 30, 40}}}, 10, 3);
  s.contacts[0].friction = Limited{0.3, 20.0};  // mu N = 30; k = 10: 2 behind the anchor in the limit
  for (const auto& method : stiff_methods()) {
    const auto r = solve_scene(s, method);
    ASSERT_EQ(r.trajectory.status, Status::converged) << name_of(method);
    EXPECT_NEAR(r.last().displacement[0], 30 - 2 * 0.6, 1e-5) << name_of(method);
    EXPECT_NEAR(r.last().displacement[1], 40 - 2 * 0.8, 1e-5) << name_of(method);
  }
}

class RandomLaws : public testing::TestWithParam<int> {};

TEST_P(RandomLaws, EndInOneOfAllSolutions) {
  std::mt19937 random(20 + GetParam());
  std::uniform_real_distribution<> uniform(0, 1);
  int there = 0, none = 0;
  for (int n = 0; n < 40; ++n) {
    const double mu = 0.2 + 2 * uniform(random);
    Scene s = GetParam() == 0   ? scenes::random_point(random, 2, mu)
              : GetParam() == 1 ? scenes::random_corner(random, mu)
                                : scenes::random_strip(random, 3, mu);
    for (auto& c : s.contacts) c.friction = Limited{mu, (GetParam() == 2 ? 0.05 : 1.0) * uniform(random)};
    const Model model = make_model(s);
    const auto slots = make_slots<double>(model, s.as<double>());
    const auto all = scenes::every_solution(model, slots, 1);
    for (const Method& method : {Method(UzawaAL{}), Method(MonolithicAL{})}) {
      const auto r = solve_scene(s, method);
      if (all.empty()) {
        EXPECT_FALSE(is_converged(r.trajectory.status)) << name_of(method) << n;
        ++none;
        continue;
      }
      ++there;
      ASSERT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << n << " " << r.trajectory.message;
      EXPECT_LE(scenes::coulomb_error(model, slots, r.trajectory.initial, r.last()), solved) << name_of(method) << n;
      const double length = std::max(r.last().displacement.norm(), scenes::free_motion(model, slots, 1));
      EXPECT_TRUE(
          std::any_of(all.begin(), all.end(),
                      [&](const auto& found) { return (found.u - r.last().displacement).norm() <= solved * length; }))
          << name_of(method) << n;
    }
  }
  EXPECT_GE(there, 60) << "of 80, " << none << " without any";
}

INSTANTIATE_TEST_SUITE_P(FrictionLaw, RandomLaws, testing::Values(0, 1, 2));

/// Block 4 x 2 on a floor, pressed by 1 per length, drawn by `shear` per length.
Scene drawn_block(const Law& law, double shear) {
  Scene s;
  s.legs = {{1, 1}};
  s.bodies = {scenes::box_body("block", {0, 0}, {4, 2}, {8, 4})};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  s.contacts[0].friction = law;
  s.loads = {scenes::traction("block.top", {shear, -1.0})};
  return s;
}

TEST(FrictionLaw, HoldsABlockUpToItsLimitAndNotBeyond) {
  for (const Law& law : {Law(Limited{0.6, 0.2}), Law(Tresca<Number>{0.2})})
    for (const auto& method : scenes::all_methods()) {
      EXPECT_TRUE(is_converged(solve_scene(drawn_block(law, 0.15), method).trajectory.status)) << name_of(method);
      const auto beyond = solve_scene(drawn_block(law, 0.21), method);
      EXPECT_EQ(beyond.trajectory.status, Status::no_equilibrium) << name_of(method) << beyond.trajectory.message;
    }
}

TEST(FrictionLaw, OfTrescaKeepsTheTangentSymmetric) {
  for (const auto engine : {LinearAlgebra::Engine::sparse, LinearAlgebra::Engine::condensed})
    for (const auto& [law, symmetric] : {std::pair(Law(0.2), false), std::pair(Law(Tresca<Number>{0.2}), true)}) {
      const Scene s = drawn_block(law, 0.1);
      const Model model = make_model(s);
      const auto slots = make_slots<double>(model, s.as<double>());
      Workspace<double> workspace;
      RunOptions options;
      options.linear_algebra.engine = engine;
      ASSERT_TRUE(is_converged(solve(model, slots, Penalty{}, options, workspace).status));
      EXPECT_EQ(!workspace.engine->report().unsymmetric, symmetric);
    }
}

}  // namespace
}  // namespace stickslip::friction_law_test
