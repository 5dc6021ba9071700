/// What plain Newton does not solve (methods/rescue/motion.hpp): points that friction couples strongly, bodies that
/// friction alone holds, several solutions; each against all solutions or the equations themselves, found apart from
/// the solver.
#include <gtest/gtest.h>

#include "methods/newton/regularisation.hpp"
#include "methods/rescue/solutions.hpp"
#include "methods/rescue/work_bound.hpp"
#include "tests/support/blocks.hpp"
#include "tests/support/every_branch.hpp"
#include "tests/support/random_contacts.hpp"
#include "tests/support/sliding_scenes.hpp"

namespace stickslip::motion_test {
namespace {

using scenes::coulomb_error;
using scenes::relative;
using Kind = Response::Kind;

struct MovedRun {
  Model model;
  Slots<double> slots;
  Trajectory<double> trajectory;
  const Increment<double>& last() const { return trajectory.increments.back(); }
  /// Largest error of an increment in the exact equations.
  double error() const {
    double worst = 0;
    const State<double>* before = &trajectory.initial;
    for (const auto& increment : trajectory.increments) {
      worst = larger(worst, coulomb_error(model, slots, *before, increment.state));
      before = &increment.state;
    }
    return worst;
  }
};

MovedRun solve_moving(const Scene& scene, const Method& method, RunOptions options = {}) {
  MovedRun r{make_model(scene), {}, {}};
  r.slots = make_slots<double>(r.model, scene.as<double>());
  Workspace<double> workspace;
  r.trajectory = solve(r.model, r.slots, method, options, workspace);
  return r;
}

// Newton's tolerance of 1e-12, and Uzawa's of 1e-10, times condition numbers up to some hundred.
constexpr double solved_motion = 1e-8;

std::vector<Method> at_scales(const std::vector<double>& scales) {
  std::vector<Method> methods;
  for (double scale : scales) {
    MonolithicAL monolithic;
    monolithic.scale = relative(scale);
    UzawaAL uzawa;
    uzawa.scale = relative(scale);
    methods.insert(methods.end(), {monolithic, uzawa});
  }
  return methods;
}

/// Whether one of `solutions` is the state, up to `allowed`, a length.
bool is_among(const std::vector<scenes::FoundSolution>& solutions, const State<double>& state, double allowed) {
  return std::any_of(solutions.begin(), solutions.end(),
                     [&](const scenes::FoundSolution& s) { return (s.u - state.displacement).norm() <= allowed; });
}

// --- one point: all solutions are known (A18) ------------------------------------------------------------------------

Scene klarbring(double mu, double push) { return scenes::point_on_floor({{1.0, -0.5}, {-0.5, 1.0}}, {push, -1.0}, mu); }

TEST(StronglyCoupledPoint, EndsInTheSameSolutionByEveryMethodFromEveryScale) {
  struct Case {
    double mu, push, u_t, u_n, p;
  };
  // stick where it can; at mu = 3 and a push of 2.5 slip and open are solutions too, which the motion from rest leaves
  for (const auto& c : {Case{1, 0.5, 0, 0, 1}, Case{1, 1.5, 1, 0, 0.5}, Case{1, 2.5, 8.0 / 3, 1.0 / 3, 0},
                        Case{3, 1.9, 0, 0, 1}, Case{3, 2.5, 0, 0, 1}, Case{3, 3.5, 4, 1, 0}})
    for (const auto& method : at_scales({0.01, 0.1, 1, 10, 100})) {
      const auto r = solve_moving(klarbring(c.mu, c.push), method);
      ASSERT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << c.mu << " " << c.push;
      EXPECT_NEAR(r.last().state.displacement[0], c.u_t, solved_motion) << name_of(method) << c.mu << " " << c.push;
      EXPECT_NEAR(r.last().state.displacement[1], c.u_n, solved_motion);
      EXPECT_NEAR(-r.last().state.contact.traction[0], c.p, solved_motion);
      EXPECT_EQ(r.trajectory.counters.cutbacks, 0);
    }
}

TEST(StronglyCoupledPoint, HasItsOtherSolutionsListed) {
  for (const auto& method : at_scales({0.1, 10})) {
    const auto r = solve_moving(klarbring(3, 2.5), method);
    ASSERT_TRUE(r.last().counted);
    ASSERT_EQ(r.last().others.size(), 2u);
    std::vector<double> u_t;
    for (const auto& other : r.last().others) u_t.push_back(other.displacement[0]);
    std::sort(u_t.begin(), u_t.end());
    EXPECT_NEAR(u_t[0], 1, solved_motion) << "slip";
    EXPECT_NEAR(u_t[1], 8.0 / 3, solved_motion) << "open";
    EXPECT_TRUE(solve_moving(klarbring(3, 1.9), method).last().others.empty());
    EXPECT_FALSE(solve_moving(klarbring(1, 1.5), method).last().counted)
        << "below the critical friction it is the only one";
  }
}

TEST(StronglyCoupledPoint, HasTheOtherSolutionsOfThePenaltyMethodListed) {
  // K = [[1, -.5], [-.5, 1]], t_N = rho u_n, and in slip t_T = mu rho u_n: u = (u_t, u_n) of two linear equations
  Penalty penalty;
  penalty.stiffness = relative(20);
  const Scene scene = klarbring(3, 2.5);
  const Model model = make_model(scene);
  const double rho = initial_regularisation(make_slots<double>(model, scene.as<double>()), penalty)[0].normal;
  const auto r = solve_moving(scene, penalty);
  ASSERT_TRUE(is_converged(r.trajectory.status));
  ASSERT_TRUE(r.last().counted);
  ASSERT_EQ(r.last().others.size(), 2u);
  int closed = 0;
  for (const auto& other : r.last().others) {
    const double u_t = other.displacement[0], u_n = other.displacement[1];
    if (other.contact.state[0] == ContactState::open) continue;
    ++closed;
    EXPECT_EQ(other.contact.state[0], ContactState::slip);
    EXPECT_NEAR(-other.contact.traction[0], -rho * u_n, solved_motion);
    EXPECT_NEAR(u_t - 0.5 * u_n, 2.5 + 3 * rho * u_n, solved_motion) << "friction holds back";
    EXPECT_NEAR(-0.5 * u_t + u_n, -1 - rho * u_n, solved_motion);
  }
  EXPECT_EQ(closed, 1);
}

TEST(StronglyCoupledPoint, IsSeenToJumpWhereItsBranchEnds) {
  // mu = 3, press 1, push to 3.5: it sticks until 3, then nothing but the open solution (4, 1) is left
  for (int steps : {1, 7}) {
    Scene scene = klarbring(3, 3.5);
    scene.loads[0].vector[1] = 0.0;
    scene.loads[0].history = scenes::ramp(1.0);
    scene.loads.push_back(scenes::force("point.node", {0.0, -1.0}));
    scene.legs = {{1, steps}};
    const auto r = solve_moving(scene, MonolithicAL{});
    ASSERT_TRUE(is_converged(r.trajectory.status));
    int jumps = 0;
    for (const auto& increment : r.trajectory.increments)
      if (increment.jump) {
        ++jumps;
        EXPECT_NEAR(*increment.jump, 3 / 3.5, 1e-3 / steps) << "a thousandth of a step";
      }
    EXPECT_EQ(jumps, 1) << steps;
  }
  for (const auto& increment : solve_moving(klarbring(3, 1.9), MonolithicAL{}).trajectory.increments)
    EXPECT_FALSE(increment.jump);
}

TEST(CriticalFriction, IsThatOfThePointThatTurnsFirst) {
  // K = [[1, -.5], [-.5, 1]] turns at mu = k_t / |k_nt| = 2, [[1, .2], [.2, 1]] at 5
  Scene scene = klarbring(1, 0.5);
  scene.bodies.push_back({"other", PointMesh{{3.0, 0.0}}, GroundedSpring{{{1.0, 0.2}, {0.2, 1.0}}}, "", 1.0});
  scene.contacts.push_back(scenes::contact("second", "other.node", scene.contacts[0].master));
  scene.contacts[1].friction = 1.0;
  const Model model = make_model(scene);
  auto slots = make_slots<double>(model, scene.as<double>());
  const Condensation<double> condensation(model, slots, Backend::automatic);
  const auto exceeds = [&](double first, double second) {
    slots.friction = {first, second};
    return exceeds_critical_friction(model, slots, condensation.schur());
  };
  EXPECT_FALSE(exceeds(1.99, 4.99));
  EXPECT_TRUE(exceeds(2.01, 4.99));
  EXPECT_TRUE(exceeds(1.99, 5.01));
}

// --- random problems -------------------------------------------------------------------------------------------------

/// Solves `count` random problems by every method, and holds them against all solutions; with more than `enumerated`
/// points against the equations.
template <class MakeScene>
void check_random_problems(int count, unsigned seed, std::size_t enumerated, MakeScene&& make) {
  std::mt19937 random(seed);
  for (int i = 0; i < count; ++i) {
    const Scene scene = make(random);
    std::optional<Vector<double>> first;
    for (const auto& method : at_scales({0.1, 10})) {
      UzawaAL tight;
      if (const auto* uzawa = std::get_if<UzawaAL>(&method)) tight = *uzawa;
      tight.tolerance = 1e-12;
      const auto r = solve_moving(scene, std::holds_alternative<UzawaAL>(method) ? Method(tight) : method);
      ASSERT_TRUE(is_converged(r.trajectory.status))
          << "problem " << i << ", " << name_of(method) << ": " << r.trajectory.message;
      EXPECT_LT(r.error(), solved_motion) << "problem " << i << ", " << name_of(method);
      if (r.model.dimension != 2 || r.model.points.size() > enumerated) continue;
      const auto all = scenes::every_solution(r.model, r.slots, 1);
      const double allowed = 1e-6 * scenes::free_motion(r.model, r.slots, 1);
      EXPECT_TRUE(is_among(all, r.last().state, allowed)) << "problem " << i << ", " << name_of(method);
      if (all.size() > 1) {
        ASSERT_TRUE(r.last().counted) << "problem " << i;
        EXPECT_EQ(r.last().others.size() + 1, all.size()) << "problem " << i << ", " << name_of(method);
      }
      if (!first) first = r.last().state.displacement;
      EXPECT_LT((*first - r.last().state.displacement).norm(), allowed)
          << "the same of " << all.size() << " solutions by every method: problem " << i << ", " << name_of(method);
    }
    const auto soft = solve_moving(scene, Penalty{});
    EXPECT_TRUE(is_converged(soft.trajectory.status)) << "problem " << i << ", penalty: " << soft.trajectory.message;
  }
}

TEST(RandomContacts, OfStripsAreSolvedByEveryMethod) {
  for (double mu : {0.2, 1.0, 2.0, 5.0})
    check_random_problems(25, 3, 2, [&](std::mt19937& random) { return scenes::random_strip(random, 2, mu); });
  for (double mu : {0.5, 5.0})
    check_random_problems(10, 4, 4, [&](std::mt19937& random) { return scenes::random_strip(random, 4, mu); });
}
TEST(RandomContacts, OfPointsInSpaceAreSolvedByEveryMethod) {
  for (double mu : {0.5, 2.0, 5.0})
    check_random_problems(40, 9, 0, [&](std::mt19937& random) { return scenes::random_point(random, 3, mu); });
}
TEST(SlowRandomContacts, OfStripsWithTwoToEightPointsAreSolvedByEveryMethod) {
  for (double mu : {0.2, 0.5, 1.0, 2.0, 5.0})
    for (int n : {2, 3, 4, 6, 8})
      check_random_problems(400, 11 + n, n < 4 ? 3 : 0,
                            [&](std::mt19937& random) { return scenes::random_strip(random, n, mu); });
}
TEST(SlowRandomContacts, OfPointsInSpaceAreSolvedByEveryMethod) {
  for (double mu : {0.2, 0.5, 1.0, 2.0, 5.0})
    check_random_problems(1000, 19, 0, [&](std::mt19937& random) { return scenes::random_point(random, 3, mu); });
}

// --- bodies that friction alone holds --------------------------------------------------------------------------------

Scene block_on_floor(std::array<double, 2> size, std::array<int, 2> cells, double mu, double shear) {
  Scene s;
  s.legs = {{1, 1}};
  s.bodies = {scenes::box_body("block", {0, 0}, size, cells)};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}}};
  s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  s.contacts[0].friction = mu;
  s.loads = {scenes::traction("block.top", {shear, -1.0})};
  return s;
}

/// Shares of the limit of slip; the block tips where mu times the share exceeds its width over its height.
void check_blocks(const std::vector<int>& cells, const std::vector<double>& frictions,
                  const std::vector<double>& shares) {
  for (int n : cells)
    for (double mu : frictions)
      for (double share : shares) {
        if (mu * share > 0.9) continue;
        for (const auto& method : scenes::all_methods()) {
          const auto r = solve_moving(block_on_floor({4, 2}, {n, std::max(1, n / 2)}, mu, share * mu), method);
          ASSERT_TRUE(is_converged(r.trajectory.status))
              << name_of(method) << ", " << n << " cells, mu " << mu << ", " << share << ": " << r.trajectory.message;
          EXPECT_EQ(r.trajectory.counters.cutbacks, 0);
          if (std::holds_alternative<Penalty>(method)) continue;
          EXPECT_LT(r.error(), solved_motion) << n << " " << mu << " " << share;
        }
      }
}

TEST(BlockOnFloor, IsHeldByFrictionAloneUpToItsLimit) {
  check_blocks({1, 2, 5, 12}, {0.01, 0.1, 0.3, 1}, {0.1, 0.7, 0.99});
}
TEST(SlowBlockOnFloor, IsHeldByFrictionAloneUpToItsLimit) {
  check_blocks({1, 2, 3, 4, 6, 8, 10, 12, 20, 50, 100, 199}, {0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.6, 1},
               {0.1, 0.3, 0.5, 0.7, 0.9, 0.99});
}

TEST(BlockOnFloor, HasNoEquilibriumBeyondSlipAndBeyondTipping) {
  for (const auto& method : scenes::all_methods())
    for (int n : {2, 8}) {
      for (double mu : {0.05, 0.3, 0.9}) {  // slip
        const auto r = solve_moving(block_on_floor({4, 2}, {n, n / 2}, mu, 1.0001 * mu), method);
        EXPECT_EQ(r.trajectory.status, Status::no_equilibrium) << name_of(method) << mu << r.trajectory.message;
        EXPECT_NE(r.trajectory.message.find("block"), std::string::npos);
      }
      // width 1, height 4: the load's line of action leaves the sole at a shear of 1/8 of the press
      const auto tips = solve_moving(block_on_floor({1, 4}, {n, 4 * n}, 1, 0.126), method);
      EXPECT_EQ(tips.trajectory.status, Status::no_equilibrium) << name_of(method) << tips.trajectory.message;
      const auto stands = solve_moving(block_on_floor({1, 4}, {n, 4 * n}, 1, 0.1), method);
      EXPECT_TRUE(is_converged(stands.trajectory.status)) << name_of(method) << stands.trajectory.message;
    }
}

TEST(BlockOnFloor, IsSolvedInBothEngines) {
  for (const auto& method : scenes::all_methods()) {
    std::vector<double> shift;
    for (const auto engine : {LinearAlgebra::Engine::sparse, LinearAlgebra::Engine::condensed}) {
      RunOptions options;
      options.linear_algebra.engine = engine;
      const auto r = solve_moving(block_on_floor({4, 2}, {6, 3}, 0.1, 0.07), method, options);
      ASSERT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << r.trajectory.message;
      shift.push_back(r.last().state.displacement.norm());
    }
    EXPECT_NEAR(shift[0], shift[1], solved_motion * shift[0]) << name_of(method);
  }
}

// --- a front of slip that turns back (A4) ----------------------------------------------------------------------------

TEST(PullOut, IsSolvedWithoutACutFromEveryScale) {
  for (int n : {10, 30, 100})
    for (int steps : {4, 16}) {
      if (n == 100 && steps > 4) continue;
      const Scene scene = scenes::pull_out(n, {0, 1, 0}, steps);
      std::optional<double> u;
      auto methods = at_scales({1e-6, 1e-2, 1, 1e4});
      for (double stiffness : {1e-6, 1.0, 1e4, 1e7}) {
        Penalty penalty;
        penalty.stiffness = relative(stiffness);
        methods.push_back(penalty);
      }
      for (auto method : methods) {
        if (auto* uzawa = std::get_if<UzawaAL>(&method)) uzawa->tolerance = 1e-12;
        const auto r = solve_moving(scene, method);
        ASSERT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << n << " " << steps << r.trajectory.message;
        EXPECT_EQ(r.trajectory.counters.cutbacks, 0) << name_of(method);
        if (std::holds_alternative<Penalty>(method)) continue;
        // the front of slip runs a node an iteration; the factor is updated
        if (std::holds_alternative<MonolithicAL>(method) && steps == 4) {
          EXPECT_LE(r.trajectory.counters.factorizations, 40) << name_of(method) << n;
        }
        if (!u) u = r.last().state.displacement[0];
        EXPECT_NEAR(r.last().state.displacement[0], *u, 1e-10 * std::abs(*u)) << name_of(method) << n << " " << steps;
      }
    }
}

// --- what no stiffness can close -------------------------------------------------------------------------------------

TEST(Penalty, AcceptsAnOverlapThatTheBodyCanLeaveOnlyAlongAnotherWall) {
  // pushed out of the floor the point meets a slanted wall, which is open where it rests, and slides off to the left
  Scene wedged = scenes::point_on_floor({{1000.0, 0.0}, {0.0, 1000.0}}, {0.0, -10.0}, 0.0);
  wedged.contacts[0].friction.reset();
  wedged.obstacles.push_back({"roof", Plane{{0.0, -0.0025}, {-0.6, -0.8}}});  // 0.002 within the point's start
  wedged.contacts.push_back(scenes::contact("above", "point.node", "roof"));
  Penalty method;
  method.stiffness = scenes::absolute(1000);
  const auto r = solve_moving(wedged, method);
  ASSERT_TRUE(is_converged(r.trajectory.status)) << r.trajectory.message;
  const auto& contact = r.trajectory.increments.back().state.contact;
  EXPECT_NEAR(contact.gap[0], -0.005, 1e-12);  // floor and spring in series: 10 / (1000 + 1000)
  EXPECT_EQ(contact.state[1], ContactState::open);
}

TEST(Penalty, NamesAnOverlapThatGrowsAForceWithTheStiffness) {
  Scene squeeze = scenes::stop();  // a point between two walls that are nearer than it is thick
  squeeze.obstacles.push_back({"back", Plane{{0.0, 0.005}, {0.0, 1.0}}});
  squeeze.contacts.push_back(scenes::contact("behind", "block.node", "back"));
  squeeze.obstacles[0].shape = Plane{{0.0, -0.005}, {0.0, -1.0}};
  Scene driven = scenes::stop();
  driven.loads.clear();
  driven.supports = {scenes::support("block.node", {{'y', scenes::ramp(0.02)}, {'x', scenes::ramp(0.0)}})};
  for (const bool is_driven : {false, true})
    for (double stiffness : {1.0, 1e3, 1e6}) {  // softer, the load pushes the point through one wall alone
      Penalty method;
      method.stiffness = relative(stiffness);
      const auto r = solve_moving(is_driven ? driven : squeeze, method);
      EXPECT_EQ(r.trajectory.status, Status::infeasible) << stiffness << r.trajectory.message;
      const char* const reason = is_driven ? "no stiffness removes" : "has no place";
      EXPECT_NE(r.trajectory.message.find(reason), std::string::npos) << r.trajectory.message;
    }
  Scene groove = scenes::point_on_floor({{1.0, 0.0}, {0.0, 1.0}}, {0.3, -1.0}, 0.2);  // two contacts that do not clash
  groove.obstacles.push_back({"wall", Plane{{0.0, 0.0}, {-1.0, 1.0}}});
  groove.contacts.push_back(scenes::contact("side", "point.node", "wall"));
  for (double stiffness : {1e-2, 1.0, 1e3, 1e6}) {
    Penalty method;
    method.stiffness = relative(stiffness);
    EXPECT_TRUE(is_converged(solve_moving(groove, method).trajectory.status)) << stiffness;
  }
}

constexpr int least_decides = 10'000;  // max_iterations so large that the least bound is the bound

/// Iterations in vain after which a bound is spent.
long iterations_allowed(const Model& model, Bodies bodies) {
  Counters counters;
  WorkBound bound(model, counters, least_decides, 0, bodies);
  bound.begin();
  while (!bound.is_spent()) ++counters.newton;
  return counters.newton;
}

/// The motion is the regular way of bodies that nothing but contact holds, and takes more than a step does else.
TEST(WorkBound, IsHigherIfABodyIsFree) {
  const Model model = make_model(scenes::sliding_die());
  EXPECT_EQ(iterations_allowed(model, Bodies::held), 4 * least_decides);
  EXPECT_EQ(iterations_allowed(model, Bodies::free), 12 * least_decides);
}

TEST(WorkBound, CountsNothingOfAttemptsThatConvergeAsTheyShould) {
  const Model model = make_model(scenes::sliding_die());
  Counters counters;
  WorkBound bound(model, counters, least_decides, 0, Bodies::held);
  const long held = iterations_allowed(model, Bodies::held);
  for (int attempt = 0; attempt < held / 10; ++attempt) {
    bound.begin();
    counters.newton += 20;
    bound.end(1);
    ASSERT_FALSE(bound.is_spent()) << attempt;
  }
  bound.begin();
  counters.newton += held;
  bound.end(0);
  EXPECT_TRUE(bound.is_spent());
}

}  // namespace
}  // namespace stickslip::motion_test
