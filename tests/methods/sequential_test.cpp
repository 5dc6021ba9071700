/// Contact and bodies in turns (methods/rescue/sequential.hpp): its rule for branches, and what it costs. What it finds
/// stands in the tests of scenes with finite strain and metal, studies/shipped_scenes_test.cpp among them.
#include "methods/rescue/sequential.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <random>

#include "methods/method.hpp"
#include "tests/support/blocks.hpp"
#include "tests/support/sliding_scenes.hpp"

namespace stickslip::sequential_test {
namespace {

using States = std::vector<ContactState>;

/// A contact problem without friction: gaps g + W p >= 0 and pressures p >= 0, one of them 0 at each point.
struct Problem {
  Eigen::MatrixXd W;
  Eigen::VectorXd g;
};

/// The solution in which the points that are not open in `states` have no gap: the states that it asks for.
struct SequentialSolution {
  States wanted;
  std::vector<double> by;
  SequentialSolution(const Problem& problem, const States& states) {
    const Eigen::Index n = problem.g.size();
    std::vector<Eigen::Index> closed;
    for (Eigen::Index i = 0; i < n; ++i)
      if (states[i] != ContactState::open) closed.push_back(i);
    Eigen::VectorXd p = Eigen::VectorXd::Zero(n);
    if (!closed.empty()) {
      const Eigen::MatrixXd W = problem.W(closed, closed);
      const Eigen::VectorXd pressures = W.partialPivLu().solve(Eigen::VectorXd(-problem.g(closed)));
      p(closed) = pressures;
    }
    const Eigen::VectorXd gap = problem.g + problem.W * p;
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool is_closed = states[i] != ContactState::open;
      wanted.push_back((is_closed ? p[i] > 0 : gap[i] < 0) ? ContactState::slip : ContactState::open);
      by.push_back(is_closed ? std::abs(p[i]) * problem.W(i, i) : std::abs(gap[i]));
    }
  }
};

/// Solutions until the states stay, and these; -1 where they are more than 1000.
template <class Next>
std::pair<int, States> settle(const Problem& problem, Next&& next) {
  States states(problem.g.size(), ContactState::slip);
  for (int count = 1; count <= 1000; ++count) {
    const SequentialSolution at(problem, states);
    if (at.wanted == states) return {count, states};
    states = next(states, at);
  }
  return {-1, states};
}

/// A cantilever between stops on either side of it, n of them at random: each couples with all others, with either
/// sign.
Problem beam_between_stops(int n, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal;
  Eigen::VectorXd x(n), side(n), g(n);
  const double load = 0.1 * normal(random), tip = 0.5 + 0.5 * uniform(random), bend = uniform(random);
  for (int i = 0; i < n; ++i) {
    x[i] = 0.525 + 0.475 * uniform(random);
    side[i] = uniform(random) < 0 ? -1 : 1;
    g[i] = side[i] * (bend * (x[i] - tip) * (x[i] - tip) + load * x[i]) + 0.02 * normal(random);
  }
  Eigen::MatrixXd W = 1e-9 * Eigen::MatrixXd::Identity(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double near = std::min(x[i], x[j]), far = std::max(x[i], x[j]);
      W(i, j) += side[i] * side[j] * near * near * (3 * far - near) / 6;
    }
  return {W, g};
}

TEST(Pivoting, EndsWhereAllPointsChangingAtOnceCycle) {
  std::mt19937 random(7);
  int cycles = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Problem problem = beam_between_stops(20, random);
    const auto all = settle(problem, [](const States&, const SequentialSolution& at) { return at.wanted; });
    detail::Pivoting pivoting;
    const auto careful = settle(problem, [&](const States& taken, const SequentialSolution& at) {
      return pivoting.advance(taken, at.wanted, at.by);
    });
    EXPECT_GT(careful.first, 0) << trial;
    EXPECT_FALSE(pivoting.repeats()) << trial;
    if (all.first < 0)
      ++cycles;
    else
      EXPECT_EQ(careful.second, all.second) << trial;
  }
  EXPECT_GT(cycles, 30);
}

TEST(Pivoting, HardlyHangsOnTheOrderOfThePoints) {
  std::mt19937 random(11);
  int others = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Problem problem = beam_between_stops(12, random);
    const Problem turned{problem.W.reverse(), problem.g.reverse()};
    const auto count = [](const Problem& p) {
      detail::Pivoting pivoting;
      return settle(p, [&](const States& taken,
                           const SequentialSolution& at) { return pivoting.advance(taken, at.wanted, at.by); })
          .first;
    };
    others += count(problem) != count(turned);
  }
  EXPECT_LE(others, 3);  // (0; where the last point alone changes, Murty's rule, 15)
}

/// A tangent of the bodies serves for several contact problems, and where an equilibrium begins close to the last one.
TEST(Sequence, TakesFewerFactorsOfTheBodiesThanItTakesTangents) {
  for (const Method& method : scenes::all_methods()) {
    std::array<Trajectory<double>, 2> runs;
    for (const auto engine : {LinearAlgebra::Engine::sparse, LinearAlgebra::Engine::condensed}) {
      const Model model = make_model(scenes::sliding_die());
      const auto slots = make_slots<double>(model, scenes::sliding_die().as<double>());
      RunOptions options;
      options.linear_algebra.engine = engine;
      Workspace<double> workspace;
      auto& run = runs[engine == LinearAlgebra::Engine::condensed];
      run = solve(model, slots, method, options, workspace);
      ASSERT_TRUE(is_converged(run.status)) << name_of(method) << run.message;
    }
    const auto& [sparse, condensed] = runs;
    EXPECT_LT(condensed.counters.factorizations, condensed.counters.newton) << name_of(method);
    EXPECT_LT(3 * condensed.counters.factorizations, 2 * sparse.counters.factorizations) << name_of(method);
    if (std::holds_alternative<MonolithicAL>(method)) {  // (2 an increment)
      EXPECT_LE(condensed.counters.factorizations, 3 * static_cast<long>(condensed.increments.size()));
    }
    const Vector<double>&u = sparse.increments.back().state.displacement,
          &same = condensed.increments.back().state.displacement;
    // the tolerance of Uzawa's updates, and that of Newton's method times a condition
    EXPECT_LE((u - same).norm(), (std::holds_alternative<UzawaAL>(method) ? 1e-6 : 1e-9) * u.norm()) << name_of(method);
  }
}

}  // namespace
}  // namespace stickslip::sequential_test
