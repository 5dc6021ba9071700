/// Distances to the nearest change of a branch: against closed forms, and in random scenes near changes of state.
#include "sensitivity/nearest_change.hpp"

#include <gtest/gtest.h>

#include "sensitivity/adjoint.hpp"
#include "sensitivity/one_sided.hpp"
#include "tests/support/both_modes.hpp"
#include "tests/support/random_ties.hpp"

namespace stickslip::nearest_change_test {
namespace {

namespace ties = random_ties;

constexpr double inf = std::numeric_limits<double>::infinity();

/// A run with its derivatives in direct mode.
struct Certified : scenes::SolvedRun {
  Gradients gradients;
  std::optional<OneSided> sides;

  Certified(const Scene& scene, const Method& by) : SolvedRun(scene, by) {
    if (!trajectory.increments.back().usable()) return;
    gradients = direct();
    sides = both_sides();
  }
  /// {below, above} at increment n.
  std::pair<double, double> nearest(const std::string& parameter, std::size_t n = 0) const {
    const auto& all = model.scene.parameters;
    const auto j = std::find_if(all.begin(), all.end(), [&](auto& p) { return p.name == parameter; }) - all.begin();
    return {gradients.nearest_change[n](j, 0), gradients.nearest_change[n](j, 1)};
  }
};

std::vector<Method> all_methods() {
  UzawaAL uzawa;
  uzawa.tolerance = 1e-12;
  return {MonolithicAL{}, uzawa, Penalty{scenes::relative(1e6)}};
}

void expect_nearest(const std::pair<double, double>& found, double below, double above, double allowed) {
  for (const auto& [value, wanted] : {std::pair(found.first, below), std::pair(found.second, above)}) {
    if (wanted == inf)
      EXPECT_EQ(value, inf);
    else
      EXPECT_NEAR(value, wanted, allowed);
  }
}

TEST(NearestChange, OfAPressureThatIsABillionthOfTheWayIsNotZero) {
  // F is 1e-9 more than k g0 = 10. Both are rounded to 1e-16 of themselves, 1e-7 of what presses; a gap is rounded to
  // 1e-18, of which a spring of a million stiffnesses makes 0.1 of it. Uzawa leaves 1e-12 of F, 1e-3 of it.
  for (const auto& method : all_methods()) {
    const double soft = std::holds_alternative<Penalty>(method)   ? 0.1
                        : std::holds_alternative<UzawaAL>(method) ? 1e-3
                                                                  : 1e-5;
    const Certified run(scenes::stop(10 + 1e-8, 1000, 0.01), method);
    EXPECT_FALSE(run.sides);
    expect_nearest(run.nearest("F"), 1e-8, inf, soft * 1e-8);
    expect_nearest(run.nearest("g0"), inf, 1e-11, soft * 1e-11);
  }
}

TEST(NearestChange, OfAPressedSpringIsTheLoadThatPresses) {
  // F = 15, k g0 = 10: it opens where F falls by 5, where the stop goes away by 0.005, and where k grows by 500
  constexpr double soft = 1e-4;  // of a penalty of a million stiffnesses, and of the first order of nothing else
  for (const auto& method : all_methods()) {
    const Certified run(scenes::stop(15, 1000, 0.01), method);
    expect_nearest(run.nearest("F"), 5, inf, soft * 5);
    expect_nearest(run.nearest("g0"), inf, 0.005, soft * 0.005);
    expect_nearest(run.nearest("k"), inf, 500, soft * 500);
  }
}

TEST(NearestChange, OfAnOpenSpringIsTheLoadThatCloses) {
  for (const auto& method : all_methods()) {
    const Certified run(scenes::stop(5, 1000, 0.01), method);
    expect_nearest(run.nearest("F"), inf, 5, 1e-9 * 5);
    expect_nearest(run.nearest("g0"), 0.005, inf, 1e-9);
  }
}

TEST(NearestChange, IsZeroOnBothSidesOfATie) {
  for (const auto& method : all_methods()) {
    const Certified run(scenes::stop(10, 1000, 0.01), method);
    for (const char* parameter : {"F", "g0", "k"}) expect_nearest(run.nearest(parameter), 0, 0, 0);
  }
}

TEST(NearestChange, OfABlockIsTheWayToTheEdgeOfItsCone) {
  // sticks at U = 0.02, slips from 0.03 on; at 0.06 it slips by 0.03
  for (const Method& method : {Method(MonolithicAL{}), all_methods()[1]}) {
    const Certified sticks(scenes::slider({{0, 0}, {1, 0.02}}, 1), method);
    expect_nearest(sticks.nearest("U0"), 0.05, 0.01, 1e-9);  // (to the other side it slips at -0.03)
    expect_nearest(sticks.nearest("mu"), 0.1, inf, 1e-9);
    expect_nearest(sticks.nearest("N"), 10.0 / 3, inf, 1e-9);
    const Certified rests(scenes::slider({{0, 0}, {1, 0.02}, {2, 0}}, 2), method);  // without a tangential force
    expect_nearest(rests.nearest("mu", 1), 0.3, inf, 1e-9);
    const Certified slips(scenes::slider({{0, 0}, {1, 0.06}}, 1), method);
    expect_nearest(slips.nearest("U0"), 0.03, inf, 1e-9);
    expect_nearest(slips.nearest("mu"), inf, 0.3, 1e-9);
  }
}

TEST(NearestChange, IsNoneOfAPointThatNoParameterMoves) {
  // behind a front of slip that stopped, the points lie on their cones, and no parameter moves them off
  const Certified run(scenes::slider({{0, 0}, {1, 0.06}, {2, 0.06}}, 2), MonolithicAL{});
  expect_nearest(run.nearest("U0", 1), inf, inf, 0);
}

/// At small strain a point leaves the facet of a polyline that it faced at the start if a parameter moves an end of the
/// facet below it.
TEST(NearestChange, OfAPointOnAPolylineIsTheWayToTheEndsOfItsFacet) {
  for (const auto& method : all_methods()) {
    Scene s = scenes::stop(0, 1000, 0);
    const Number left = scenes::parameter(s, "left", -0.25), right = scenes::parameter(s, "right", 0.75);
    s.loads[0] = scenes::force("block.node", {0.0, -5.0});
    s.obstacles = {{"stop", Polyline{{{-2.0, -0.3}, {left, 0.0}, {right, 0.0}, {2.0, -0.1}}}, {}}};
    const Certified run(s, method);
    expect_nearest(run.nearest("left"), inf, 0.25, 1e-12);  // a dozen operations
    expect_nearest(run.nearest("right"), 0.75, inf, 1e-12);
  }
}

struct Tally {
  int scenes = 0, unsolved = 0, tied = 0, compared = 0, wrong = 0, beside = 0;
};

/// Whether the two sides of all derivatives of an increment by a parameter are one.
bool is_certain(const Certified& run, std::size_t n, int j) {
  const auto& responses = run.model.scene.responses;
  const bool listed = run.sides.has_value();
  if (!listed && run.gradients.from_below.empty()) return true;
  const auto& below = listed ? run.sides->backward[n] : run.gradients.from_below[n];
  const auto& above = listed ? run.sides->forward[n] : run.gradients.from_above[n];
  for (std::size_t i = 0; i < responses.size(); ++i) {
    const double a = below(i, j), b = above(i, j);
    if (!(std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b)))) return false;  // (as the program's has_kink)
  }
  return true;
}

/// The largest force of a contact point in a run, or, of lengths, what it moves its node by: the solver leaves rounding
/// of it also where no response shows it.
double size_of_forces(const Certified& run, const Response& response) {
  double force = 0, softest = inf;
  for (const double k : run.slots.stiffness) softest = smaller(softest, k);
  for (const auto& increment : run.trajectory.increments)
    for (std::size_t p = 0; p < run.model.points.size(); ++p) {
      const auto& point = run.model.points[p];
      const auto traction = increment.state.contact.traction.segment(point.multiplier, point.components());
      force = larger(force, run.slots.geometry[p].area * traction.norm());
    }
  const bool is_force = response.kind == Response::Kind::reaction || response.kind == Response::Kind::contact_force;
  return is_force ? force : force / softest;
}

/// Holds every derivative that has a certificate against differences inside of what it certifies.
void check(const Scene& scene, const Method& method, const std::string& what, Tally& tally) {
  ++tally.scenes;
  const Certified run(scene, method);
  const auto table = run.trajectory.step_table();
  const auto base = ties::responses(scene, method, table);
  if (run.gradients.of_responses.size() != table.size() || base.size() == 0 || run.trajectory.counters.cutbacks > 0) {
    ++tally.unsolved;
    return;
  }
  tally.tied += run.sides.has_value();
  double stiffest = 0;
  for (const double k : run.slots.stiffness) stiffest = larger(stiffest, k);
  for (int j = 0; j < static_cast<int>(scene.parameters.size()); ++j)
    for (int k : {0, 1}) {
      const double size = kinks::size_of(scene.parameters[j]);
      // (least: below it differences tell nothing; half: what is left of the first order)
      constexpr double least = 1e-6, most = 1e-4, half = 0.5;
      double h = most;
      std::size_t count = 0;  // increments that are certified by `least` at least
      for (; count < table.size() && is_certain(run, count, j); ++count) {
        const double next = std::min(h, half * run.gradients.nearest_change[count](j, k) / size);
        if (next < least) break;
        h = next;
      }
      tally.beside += count < table.size();
      if (count == 0) continue;
      const auto found = ties::differences(scene, method, table, j, k == 0 ? -1 : 1, base, h);
      for (std::size_t n = 0; found && n < count; ++n)
        for (Eigen::Index i = 0; i < base.rows(); ++i) {
          const double scale = std::max(largest_entry(found->value.row(i)), largest_entry(base.row(i)) / size);
          const auto& response = scene.responses[i];
          // (1e-11: what the tolerances of the methods, 1e-13 and 1e-12, leave)
          const double terms = std::max(ties::size_of_terms(response.kind, base, run.trajectory, stiffest),
                                        size_of_forces(run, response));
          const double noise = 1e-11 / h * terms / size;
          const double given = run.gradients.of_responses[n](i, j);
          ++tally.compared;
          if (std::abs(given - found->value(i, n)) <= 10 * ties::agreement * scale + noise + 1e-12) continue;
          if (++tally.wrong <= 20)
            ADD_FAILURE() << what << " " << response.name << "/" << scene.parameters[j].name << " side " << k
                          << " increment " << n << " of " << table.size() << ": " << given << " for "
                          << found->value(i, n) << ", h " << h << ", nearest "
                          << run.gradients.nearest_change[n](j, k) / size;
        }
    }
}

/// The scene with a parameter moved by a small share of its size, or by nothing.
Scene beside_a_tie(ties::Draw& draw, const Scene& scene) {
  const int j = draw.below(static_cast<int>(scene.parameters.size()));
  const double by = draw.of({0, 1e-5, -1e-5, 1e-4, -1e-4, 1e-3, -1e-3});
  Scene moved = kinks::moved(scene, j, by * kinks::size_of(scene.parameters[j]));
  moved.parameters[j].value += by * kinks::size_of(scene.parameters[j]);
  return moved;
}

TEST(SlowNearestChange, NoKinkIsNearerThanTheCertificateSays) {
  const unsigned first = ties::asked("STICKSLIP_RANDOM_FIRST", 0),
                 count = ties::asked("STICKSLIP_RANDOM_SCENES", 10000);
  Tally tally;
  for (unsigned seed = first; seed < first + count; ++seed) {
    ties::Draw draw(seed);
    int kind = 0;
    Scene scene = ties::any_scene(draw, kind);
    const Method method = ties::any_method(draw);
    scene = beside_a_tie(draw, scene);
    check(scene, method,
          "seed " + std::to_string(seed) + " kind " + std::to_string(kind) + " " + std::string(name_of(method)), tally);
  }
  std::printf(
      "%d scenes (%d not solved), %d with ties; %d certified derivatives compared, %d wrong; %d times a "
      "certificate ended beside a change\n",
      tally.scenes, tally.unsolved, tally.tied, tally.compared, tally.wrong, tally.beside);
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_GT(tally.beside, tally.scenes / 10);  // the scenes are about them
  EXPECT_LE(tally.unsolved, tally.scenes / 20);
}

/// Both modes of a scene: the same sides, or none.
void expect_same_sides(Scene scene, const Method& method, const std::string& what, int& tied) {
  SCOPED_TRACE(what);
  const Certified direct(scene, method);
  if (direct.gradients.of_responses.size() != direct.trajectory.increments.size()) return;
  scene.sensitivity_mode = SensitivityMode::adjoint;
  scenes::ask_for_objectives(scene);
  scenes::SolvedRun run(scene, method);
  const auto gradients = run.backward();
  const auto sides = run.both_sides();
  ASSERT_EQ(gradients.of_objectives.rows(), static_cast<Eigen::Index>(scene.objectives.size()));
  if (direct.sides) {
    ASSERT_TRUE(sides);
  }
  if (!sides) return;
  ++tied;
  const bool ties_of_contact = direct.sides.has_value();
  for (std::size_t n = 0; n < run.trajectory.increments.size(); ++n)
    for (const bool above : {false, true}) {
      const auto& wanted = ties_of_contact ? (above ? direct.sides->forward : direct.sides->backward)[n]
                                           : (above ? direct.gradients.from_above : direct.gradients.from_below)[n];
      const auto& found = (above ? sides->forward : sides->backward)[n];
      for (Eigen::Index i = 0; i < wanted.rows(); ++i)
        for (Eigen::Index j = 0; j < wanted.cols(); ++j) {
          const double size = std::max(largest_entry(wanted.row(i)), 1.0);
          // (direct and adjoint solve by factors that were updated in another order)
          if (std::isnan(wanted(i, j)))
            EXPECT_TRUE(std::isnan(found(i, j))) << n << " " << i << " " << j;
          else
            EXPECT_NEAR(found(i, j), wanted(i, j), 1e-9 * size) << n << " " << i << " " << j;
        }
    }
}

TEST(BothModes, HaveTheSameSidesInRandomScenesAtTies) {
  int tied = 0;
  constexpr unsigned count = 200;
  for (unsigned seed = 0; seed < count; ++seed) {
    ties::Draw draw(seed);
    int kind = 0;
    const Scene scene = ties::any_scene(draw, kind);
    expect_same_sides(scene, ties::any_method(draw), "seed " + std::to_string(seed), tied);
  }
  EXPECT_GT(tied, static_cast<int>(count) / 4);
}

TEST(BothModes, HaveTheSameSidesOfABarWhoseFrontOfSlipStops) {
  int tied = 0;
  for (int n : {10, 30}) expect_same_sides(scenes::pull_out(n, {0, 1, 0}, 4), MonolithicAL{}, std::to_string(n), tied);
  EXPECT_EQ(tied, 2);
}

}  // namespace
}  // namespace stickslip::nearest_change_test
