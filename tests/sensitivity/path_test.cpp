#include <gtest/gtest.h>

#include "tests/support/both_modes.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::path_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;

Obstacle floor_plane(const std::string& name, std::array<Number, 2> point) {
  return {name, Plane{{point[0], point[1]}, {0.0, 1.0}}};
}

/// Half of a von Mises truss (A15) under a force at its top, followed by arc length; `floor`: where a stop ends the way
/// of the top, from its start.
Scene path_truss(double load, std::optional<double> floor, double length = 0.1) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 20}};
  s.arc_length = ArcLength{0, length, 200};
  s.bodies = {{"bar", LineMesh{{0.0, 0.0}, {10.0, parameter(s, "rise", 1)}, 1},
               LinearElastic{parameter(s, "E", 1e4), 0.0}, "", 1.0}};
  s.supports = {scenes::support("bar.start", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}),
                scenes::support("bar.end", {{'x', table({{0, 0.0}})}})};
  s.loads = {scenes::force("bar.end", {0.0, parameter(s, "F", -load)})};
  s.loads[0].history = table({{0, 0.0}, {1, 1.0}});
  s.loads[0].history->goes_on = true;
  s.responses = {response("w", Kind::displacement, "bar.end", "y")};
  if (!floor) return s;
  s.obstacles = {floor_plane("floor", {0.0, 1 - *floor})};
  s.contacts = {contact("top", "bar.end", "floor")};
  s.responses.push_back(response("press", Kind::contact_force, "top", "normal"));
  return s;
}

/// Force that holds half of the truss at a depth w of its top, and its derivative.
double force_of_truss(double w) {
  const double s = 1 - w;
  return 1e4 / std::pow(101, 1.5) * (s - s * s * s) / 2;
}
double truss_stiffness(double w) {
  const double s = 1 - w;
  return -1e4 / std::pow(101, 1.5) * (1 - 3 * s * s) / 2;
}

std::vector<Method> path_methods() { return {MonolithicAL{}, Penalty{scenes::relative(1e4)}, UzawaAL{}}; }

TEST(Path, FollowsATrussThroughBothLimitPointsToTheFullLoad) {
  constexpr double load = 2.5, most = 3.7919801295 / 2;
  for (const double length : {0.05, 0.1, 0.3}) {
    const auto s = run(path_truss(load, {}, length), MonolithicAL{});
    ASSERT_EQ(s.trajectory.status, Status::converged) << s.trajectory.message;
    double highest = 0, lowest = 0, before = 0, arc = 0;
    for (std::size_t n = 0; n < s.trajectory.increments.size(); ++n) {
      const auto& increment = s.trajectory.increments[n];
      const double w = -s.value("w", static_cast<int>(n));
      EXPECT_NEAR(load * increment.time, force_of_truss(w), 1e-9 * most) << w;  // the tolerance of equilibrium is 1e-10
      if (length == 0.05) {  // (of 0.1 the path bends within less than a step at its limit points)
        EXPECT_EQ(increment.cutbacks, 0) << w;
      }
      EXPECT_TRUE(increment.requested);
      const double then = n == 0 ? 0 : s.trajectory.increments[n - 1].time;
      arc = std::hypot((w - before) / length, (increment.time - then) * 20);
      if (length == 0.05 && n + 1 < s.trajectory.increments.size()) {
        EXPECT_NEAR(arc, 1, 1e-6) << w;  // Newton's last step but one is within the root of its tolerance
      }
      before = w;
      highest = larger(highest, w < 1 ? load * increment.time : 0);
      lowest = smaller(lowest, load * increment.time);
      if (std::abs(w - 0.4226497308) < 1e-3) continue;  // (at the limit point the derivative is infinite)
      EXPECT_NEAR(-s.derivative("w", "F", static_cast<int>(n)) * truss_stiffness(w), -increment.time,
                  1e-8 * std::abs(increment.time))
          << w;
    }
    EXPECT_LE(arc, 1 + 1e-6);
    // at its limit points the path is a parabola, whose top is less than half a step away
    const double missed = most * 1.5 * 3 * std::sqrt(3) * length * length / 4;
    EXPECT_GT(highest, most - missed);
    EXPECT_LT(lowest, -most + missed);
    EXPECT_EQ(s.trajectory.increments.back().time, 1);
  }
}

TEST(Path, EndsOnAStopByAllMethods) {
  for (const auto& method : path_methods())
    for (const double load : {3.79 / 2, 3.80 / 2, 2.5}) {  // below the limit point, and beyond it
      // (between the two points at which the path has a load just below its limit lies a hundredth of a step of 0.1)
      const auto s = run(path_truss(load, 1.2, 2 * load < 3.7919801295 ? 0.01 : 0.1), method);
      const std::string what = std::string(name_of(method)) + " " + std::to_string(2 * load);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << what << s.trajectory.message;
      EXPECT_EQ(s.trajectory.increments.back().time, 1) << what;
      if (2 * load < 3.7919801295) {
        EXPECT_LT(-s.value("w"), 0.4226497308) << what;
        EXPECT_NEAR(force_of_truss(-s.value("w")), load, 1e-9 * load) << what;
        continue;
      }
      const double overlap = std::holds_alternative<Penalty>(method) ? 1e-3 : 1e-9;
      EXPECT_NEAR(-s.value("w"), 1.2, overlap) << what;
      EXPECT_NEAR(s.value("press"), load - force_of_truss(-s.value("w")), 1e-9 * load) << what;
    }
}

TEST(Path, HasTheDerivativesOfItsPointsAtTheirLoads) {
  for (const auto& method : path_methods()) {
    Scene scene = path_truss(2.5, 1.2, 0.13);
    const auto s = run(scene, method);
    ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
    const auto repeat = repeating({}, s.model, s.trajectory);
    for (int j = 0; j < static_cast<int>(scene.parameters.size()); ++j) {
      const auto exact = oracle::complex_step(s.model, method, repeat, j);
      ASSERT_EQ(exact.cols(), static_cast<Eigen::Index>(s.trajectory.increments.size())) << name_of(method);
      for (Eigen::Index n = 0; n < exact.cols(); ++n)
        for (Eigen::Index i = 0; i < exact.rows(); ++i)
          EXPECT_NEAR(s.gradients.of_responses[n](i, j), exact(i, n), 1e-8 * std::max(1.0, largest_entry(exact.col(n))))
              << name_of(method) << " " << n << " " << scene.responses[i].name << " " << scene.parameters[j].name;
    }
    scenes::ask_for_objectives(scene);
    EXPECT_LE(scenes::difference_of_modes(scene, method), 1e-9) << name_of(method);
  }
}

/// A block of rubber that a force on its top pushes down, and over a rough floor.
Scene pushed_block(bool finite) {
  Scene s;
  s.finite_strain = finite;
  s.legs = {{1, 8}};
  s.arc_length = ArcLength{0, 0.02, 40};
  Body body{"block", BoxMesh{{0.0, 0.0}, {2.0, 1.0}, {6, 3}}};
  if (finite)
    body.material = NeoHookean{100.0, 0.3};
  else
    body.material = LinearElastic{100.0, 0.3};
  s.bodies = {body};
  s.obstacles = {floor_plane("floor", {0.0, 0.0})};
  s.contacts = {contact("sole", "block.bottom", "floor")};
  s.contacts[0].friction = Number(0.4);
  s.supports = {scenes::support("block.left", {{'x', table({{0, 0.0}})}})};
  s.loads = {Load{"block.top", Load::Kind::traction, {parameter(s, "push", 2), parameter(s, "press", -9)}, {}}};
  s.loads[0].history = table({{0, 0.0}, {1, 1.0}});
  s.loads[0].history->goes_on = true;
  s.responses = {response("slid", Kind::displacement, "block.right", "x"),
                 response("drag", Kind::contact_force, "sole", "x")};
  return s;
}

TEST(Path, IsTheSameByBothEngines) {
  for (const auto& method : path_methods()) {
    RunOptions sparse, condensed;
    sparse.linear_algebra.engine = LinearAlgebra::Engine::sparse;
    condensed.linear_algebra.engine = LinearAlgebra::Engine::condensed;
    const auto a = run(pushed_block(false), method, sparse), b = run(pushed_block(false), method, condensed);
    ASSERT_TRUE(is_converged(a.trajectory.status)) << a.trajectory.message;
    ASSERT_EQ(a.trajectory.increments.size(), b.trajectory.increments.size()) << name_of(method);
    for (int n = 0; n < static_cast<int>(a.trajectory.increments.size()); ++n) {
      EXPECT_NEAR(a.trajectory.increments[n].time, b.trajectory.increments[n].time, 1e-8) << name_of(method) << n;
      EXPECT_NEAR(a.value("drag", n), b.value("drag", n), 1e-7 * std::abs(b.value("drag"))) << name_of(method) << n;
    }
    EXPECT_EQ(b.trajectory.increments.back().time, 1);
  }
}

/// Load control to the same loads gives the same states: where the path does not turn, how its points were found does
/// not matter.
TEST(Path, PassesThroughWhatTheLoadAloneGives) {
  for (const bool finite : {false, true})
    for (const auto& method : path_methods()) {
      Scene scene = pushed_block(finite);
      const auto found = run(scene, method);
      ASSERT_TRUE(is_converged(found.trajectory.status)) << found.trajectory.message;
      scene.arc_length.reset();
      scene.loads[0].history->goes_on = false;
      RunOptions options;
      options.replay = found.trajectory.step_table();
      const auto given = run(scene, method, options);
      ASSERT_EQ(given.trajectory.increments.size(), found.trajectory.increments.size());
      for (int n = 0; n < static_cast<int>(found.trajectory.increments.size()); ++n)
        for (const char* name : {"slid", "drag"})
          EXPECT_NEAR(found.value(name, n), given.value(name, n), 1e-7 * std::abs(given.value(name)))
              << name_of(method) << finite << n << name;
    }
}

TEST(Path, EndsWithItsStepsOrSaysWhereItCannotGoOn) {
  Scene few = path_truss(2.5, {});
  few.arc_length->max = 5;
  const auto s = run(few, MonolithicAL{});
  EXPECT_EQ(s.trajectory.status, Status::converged);
  EXPECT_EQ(s.trajectory.increments.size(), 5u);
  EXPECT_LT(s.trajectory.increments.back().time, 1);
  // what is held from the start on has no equilibrium: a support pushes the top into the floor
  Scene impossible = path_truss(2.5, 1.2);
  impossible.supports[1].move['y'] = table({{0, -1.3}});
  for (const auto& method : path_methods()) {
    const auto lost = run(impossible, method);
    EXPECT_EQ(lost.trajectory.status, Status::infeasible) << name_of(method) << lost.trajectory.message;
    EXPECT_EQ(lost.trajectory.increments.size(), 1u) << name_of(method);
  }
}

/// Metal that flows under hardly more load: the path follows the motion there.
TEST(Path, FollowsABarOfMetalThatFlows) {
  constexpr double E = 1000, H = 1, yield = 10, load = 20;
  Scene s;
  s.legs = {{1, 10}};
  s.arc_length = ArcLength{0, 0.01, 30};
  s.bodies = {
      {"bar", LineMesh{{0.0, 0.0}, {1.0, 0.0}, 1}, J2Plastic{E, 0.0, parameter(s, "yield", yield), H}, "", 1.0}};
  s.supports = {scenes::support("bar.start", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}),
                scenes::support("bar.end", {{'y', table({{0, 0.0}})}})};
  s.loads = {scenes::force("bar.end", {load, 0.0})};
  s.loads[0].history = table({{0, 0.0}, {1, 1.0}});
  s.loads[0].history->goes_on = true;
  s.responses = {response("u", Kind::displacement, "bar.end", "x")};
  const auto run = scenes::run(s, MonolithicAL{});
  ASSERT_TRUE(is_converged(run.trajectory.status)) << run.trajectory.message;
  ASSERT_EQ(run.trajectory.increments.size(), 30u);
  EXPECT_GT(run.value("u"), 0.2);
  for (int n = 0; n < 30; ++n) {
    const double force = load * run.trajectory.increments[n].time;
    const bool flows = force > yield;
    EXPECT_NEAR(run.value("u", n), force / E + (flows ? (force - yield) / H : 0), 1e-9) << n;  // of the largest motion
    EXPECT_NEAR(run.derivative("u", "yield", n), flows ? -1 / H : 0, 1e-9) << n;
  }
}

/// Half of a thin rubber arch whose crown is loaded: its path snaps through. The load at each crown's place is the
/// force of a support that pushes the crown there.
Scene arch() {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 10}};
  s.bodies = {{"arch", RingMesh{{0.0, 0.0}, 9.8, 10.0, 70.0, 90.0, {1, 8}}, NeoHookean{1000.0, 0.3}, "Q8"}};
  s.supports = {scenes::support("arch.start", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}),
                scenes::support("arch.end", {{'x', table({{0, 0.0}})}})};
  s.responses = {response("down", Kind::displacement, "arch.end & arch.outer", "y")};
  return s;
}

TEST(Path, OfAnArchIsWhatASupportFinds) {
  constexpr double load = 3;
  Scene pushed = arch();
  pushed.arc_length = ArcLength{0, 0.05, 80};
  pushed.loads = {scenes::force("arch.end & arch.outer", {0.0, -load})};
  pushed.loads[0].history = table({{0, 0.0}, {1, 1.0}});
  pushed.loads[0].history->goes_on = true;
  const auto path = run(pushed, MonolithicAL{});
  ASSERT_TRUE(is_converged(path.trajectory.status)) << path.trajectory.message;
  const auto& points = path.trajectory.increments;
  double before = 0;
  int turns = 0;
  for (std::size_t n = 1; n < points.size(); ++n) {
    const double step = points[n].time - points[n - 1].time;
    turns += step * before < 0;
    before = step;
  }
  EXPECT_EQ(turns, 2);  // a highest load, and a lowest
  EXPECT_EQ(points.back().time, 1);
  std::vector<std::pair<double, Number>> way = {{0, 0.0}};
  for (std::size_t n = 0; n < points.size(); ++n)
    way.emplace_back(static_cast<double>(n + 1), path.value("down", static_cast<int>(n)));
  Scene held = arch();
  held.legs = {{static_cast<double>(points.size()), static_cast<int>(points.size())}};
  held.supports.push_back(scenes::support("arch.end & arch.outer", {{'y', table(way)}}));
  held.responses = {response("force", Kind::reaction, "arch.end & arch.outer", "y")};
  const auto found = run(held, MonolithicAL{});
  ASSERT_TRUE(is_converged(found.trajectory.status)) << found.trajectory.message;
  for (std::size_t n = 0; n < points.size(); ++n)
    EXPECT_NEAR(found.value("force", static_cast<int>(n)), -load * points[n].time, 1e-7 * load) << n;
}

/// In other units, and where the length is that of the scene's size by default.
TEST(Path, IsTheSameInOtherUnits) {
  Scene scene = path_truss(2.5, {}, 0);
  const auto s = run(scene, MonolithicAL{});
  ASSERT_TRUE(is_converged(s.trajectory.status));
  Scene milli = path_truss(2.5, {}, 0);  // lengths by 1000; the force is EA times an angle cubed
  milli.bodies[0].mesh = LineMesh{{0.0, 0.0}, {1e4, 1e3}, 1};
  const auto m = run(milli, MonolithicAL{});
  ASSERT_EQ(m.trajectory.increments.size(), s.trajectory.increments.size());
  for (int n = 0; n < static_cast<int>(s.trajectory.increments.size()); ++n)
    EXPECT_NEAR(m.value("w", n), 1e3 * s.value("w", n), 1e-6) << n;  // 1e-9 of the way
}

}  // namespace
}  // namespace stickslip::path_test
