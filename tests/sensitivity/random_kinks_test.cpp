/// Random small scenes at and near changes of state: no kink goes unflagged, and both sides of a flagged one are right,
/// by differences of the solver to either side on the same steps.
#include <gtest/gtest.h>

#include "tests/support/random_ties.hpp"
#include "tests/support/solved_run.hpp"

namespace stickslip::random_kinks_test {
namespace {

using namespace random_ties;

struct Tally {
  int scenes = 0, unsolved = 0, kinks = 0, compared = 0, unclear = 0, unknown = 0, wrong = 0;
};

void check(const Scene& scene, const Method& method, const std::string& what, Tally& tally) {
  ++tally.scenes;
  scenes::SolvedRun run(scene, method);
  const auto& trajectory = run.trajectory;
  const auto& stiffness = run.slots.stiffness;
  const auto table = trajectory.step_table();
  if (!trajectory.increments.back().usable() || trajectory.counters.cutbacks > 0) {
    ++tally.unsolved;
    return;
  }
  const auto gradients = run.direct();
  const auto sides = run.both_sides();
  const auto base = responses(scene, method, table);
  const double stiffest = stiffness.empty() ? 0 : *std::max_element(stiffness.begin(), stiffness.end());
  if (gradients.of_responses.size() != table.size() || base.size() == 0) {
    ++tally.unsolved;
    return;
  }
  for (int j = 0; j < static_cast<int>(scene.parameters.size()); ++j)
    for (int k : {0, 1}) {
      if (k == 0 && scene.parameters[j].name == "mu" && scene.parameters[j].value == 0) continue;
      const auto found = differences(scene, method, table, j, k == 0 ? -1 : 1, base);
      for (std::size_t n = 0; found && n < table.size(); ++n)
        for (Eigen::Index i = 0; i < base.rows(); ++i) {
          const double size = kinks::size_of(scene.parameters[j]);
          const double scale = std::max(largest_entry(found->value.row(i)), largest_entry(base.row(i)) / size);
          const double noise = 1e-7 * size_of_terms(scene.responses[i].kind, base, trajectory, stiffest) / size;
          const auto& ties = k == 0 ? gradients.from_below : gradients.from_above;
          const double given = sides             ? (k == 0 ? sides->backward : sides->forward)[n](i, j)
                               : ties.size() > n ? ties[n](i, j)
                                                 : gradients.of_responses[n](i, j);
          if (largest_entry(found->spread.row(i).head(n + 1)) > agreement * scale + noise) {
            ++tally.unclear;
            continue;
          }
          if (std::isnan(given)) {
            ++tally.unknown;
            continue;
          }
          ++tally.compared;
          if (std::abs(given - found->value(i, n)) <= 10 * agreement * scale + noise + 1e-12) continue;
          if (++tally.wrong <= 20)
            ADD_FAILURE() << what << " " << scene.responses[i].name << "/" << scene.parameters[j].name << " side " << k
                          << " increment " << n << " of " << table.size() << ": " << given << " for "
                          << found->value(i, n) << " (nominal " << gradients.of_responses[n](i, j) << ", sides "
                          << sides.has_value() << ")";
        }
    }
  tally.kinks += sides.has_value();
}

TEST(SlowRandomKinks, AreAllFlaggedAndRightOnBothSides) {
  const unsigned first = asked("STICKSLIP_RANDOM_FIRST", 0), count = asked("STICKSLIP_RANDOM_SCENES", 10000);
  Tally tally;
  for (unsigned seed = first; seed < first + count; ++seed) {
    Draw draw(seed);
    draw.below(2);
    int kind = 0;
    const Scene scene = any_scene(draw, kind);
    const Method method = any_method(draw);
    check(scene, method,
          "seed " + std::to_string(seed) + " kind " + std::to_string(kind) + " " + std::string(name_of(method)), tally);
  }
  std::printf(
      "%d scenes (%d not solved), %d with kinks; %d derivatives compared, %d wrong; %d at a jump or beside "
      "another kink, %d not known\n",
      tally.scenes, tally.unsolved, tally.kinks, tally.compared, tally.wrong, tally.unclear, tally.unknown);
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_GT(tally.kinks, tally.scenes / 4);  // the scenes are about them
  EXPECT_LE(tally.unsolved, tally.scenes / 20);
  EXPECT_EQ(tally.unknown, 0);
}

}  // namespace
}  // namespace stickslip::random_kinks_test
