/// Both one-sided derivatives of a run by every scheme, held against the complex step of its own discrete problem on a
/// path that is moved to that side.
#pragma once

#include <gtest/gtest.h>

#include "sensitivity/one_sided.hpp"
#include "tests/support/kinks.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::scenes {

struct Both {
  Solved solved;
  std::optional<OneSided> sides;
};

inline Both both(const Scene& scene, const Method& method) {
  Both out{{make_model(scene), {}, {}, {}, 0}, {}};
  auto& s = out.solved;
  s.slots = make_slots<double>(s.model, scene.as<double>());
  Workspace<double> workspace;
  s.trajectory = solve(s.model, s.slots, method, {}, workspace);
  EXPECT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
  s.condition = workspace.engine->condition_estimate();
  s.gradients = differentiate(s.model, s.slots, method, s.trajectory, workspace);
  out.sides = one_sided_derivatives(s.model, s.slots, method, s.trajectory, workspace);
  return out;
}

inline UzawaAL uzawa_with(UzawaAL::Sensitivity sensitivity, double multiple = 10) {
  UzawaAL method;
  method.sensitivity = sensitivity;
  method.tolerance = 1e-13;
  method.scale = relative(multiple);
  method.max_augmentations = sensitivity == UzawaAL::Sensitivity::truncated ? 400 : 5000;
  method.adapt = sensitivity != UzawaAL::Sensitivity::truncated;  // (its factors are no function of the scene)
  return method;
}

struct Named {
  std::string name;
  Method method;
  Method claimed;     ///< whose derivative it is: that of the solution, or of the loop
  double scheme = 0;  ///< what its derivatives are off by, relative: oversized 10 / kappa
  /// Whether the oracle finds both sides of every parameter. (A loop may make another number of updates on the way:
  /// then it has no derivative there. Nor is one found to 1e-9 where the next kink is near, or a response constant.)
  bool resolved = true;
};

inline std::vector<Named> schemes() {
  using S = UzawaAL::Sensitivity;
  auto oversized = uzawa_with(S::oversized);
  oversized.oversize = 1e6;
  const MonolithicAL exact;
  const Penalty penalty{relative(100)};
  const auto loop = uzawa_with(S::truncated, 100);
  return {{"monolithic", exact, exact},
          {"penalty", penalty, penalty},
          {"iterated", uzawa_with(S::iterated), exact},
          {"preconditioned", uzawa_with(S::preconditioned), exact},
          {"truncated", loop, loop, 0, false},
          {"oversized", oversized, exact, 1e-5}};
}

/// Holds both sides of all derivatives, and the one given, against the oracle: max(1e-9, 50 u cond), of the largest
/// derivative of the response, or the response over the parameter, in the run. Returns how many kinks there are.
inline int expect_sides(const Scene& scene, const Named& named) {
  SCOPED_TRACE(named.name);
  const auto b = both(scene, named.method);
  const auto& s = b.solved;
  const std::size_t count = s.trajectory.increments.size();
  EXPECT_EQ(s.gradients.of_responses.size(), count) << s.gradients.message;
  if (s.gradients.of_responses.size() != count) return 0;
  const double allowed = std::max({1e-9, 50 * unit_roundoff * s.condition, named.scheme});
  int kinks = 0;
  for (int j = 0; j < static_cast<int>(scene.parameters.size()); ++j) {
    std::optional<Matrix<double>> exact[2];
    for (int k : {0, 1})
      exact[k] = kinks::one_sided(scene, named.claimed, s.trajectory.step_table(), j, k == 0 ? -1 : 1, allowed);
    if (named.resolved) {
      EXPECT_TRUE(exact[0] && exact[1]) << scene.parameters[j].name;
    }
    if (!exact[0] || !exact[1]) continue;
    for (Eigen::Index i = 0; i < exact[0]->rows(); ++i) {
      double scale = larger(largest_entry(exact[0]->row(i)), largest_entry(exact[1]->row(i)));
      for (std::size_t n = 0; n < count; ++n)
        scale = larger(scale, std::abs(s.value(scene.responses[i].name, static_cast<int>(n))) /
                                  kinks::size_of(scene.parameters[j]));
      for (std::size_t n = 0; n < count; ++n) {
        const double lower = (*exact[0])(i, n), upper = (*exact[1])(i, n), given = s.gradients.of_responses[n](i, j);
        const auto what = [&] {
          return scene.responses[i].name + "/" + scene.parameters[j].name + " at " +
                 std::to_string(s.trajectory.increments[n].time);
        };
        const bool kink = std::abs(upper - lower) > 10 * allowed * scale;
        kinks += kink;
        if (b.sides) {
          EXPECT_NEAR(b.sides->backward[n](i, j), lower, allowed * scale) << what();
          EXPECT_NEAR(b.sides->forward[n](i, j), upper, allowed * scale) << what();
        } else {
          EXPECT_FALSE(kink) << what();
        }
        if (!kink) {
          EXPECT_NEAR(given, upper, allowed * scale) << what();
        }
      }
    }
  }
  return kinks;
}

}  // namespace stickslip::scenes
