/// Newton's method on every shipped scene, by every method: its tangent against the complex step, and the order in
/// which it converges.
#include <gtest/gtest.h>

#include <set>

#include "core/engine/engine.hpp"
#include "methods/method.hpp"
#include "tests/studies/cases.hpp"
#include "tests/support/tangents.hpp"

namespace stickslip {
namespace {

namespace fs = std::filesystem;
/// A shipped scene by a method of its defaults.
struct Setting {
  std::string scene, method;
  friend void PrintTo(const Setting& of, std::ostream* out) { *out << of.scene << " by " << of.method; }
};

std::vector<Setting> settings() {
  std::vector<Setting> all;
  for (const auto& entry : fs::directory_iterator(cases::shipped))
    if (const auto name = entry.path().stem(); entry.path().extension() == ".json" && name.extension() != ".study")
      for (const char* method : {"penalty", "uzawa_al", "monolithic_al"}) all.push_back({name.string(), method});
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return std::tie(a.scene, a.method) < std::tie(b.scene, b.method); });
  return all;
}

/// The scene solved, with all iterates.
struct Solved {
  std::unique_ptr<Problem> problem;
  Method method;
  Trace trace;
  Trajectory<double> trajectory;
  explicit Solved(const Setting& setting) {
    const fs::path file = cases::shipped / (setting.scene + ".json");
    auto document = cases::load(file);
    document["method"] = {{setting.method, nlohmann::json::object()}};
    document.erase("parameters");
    const Input input = cases::read(document, file);
    problem = std::make_unique<Problem>(input.scene);
    method = input.method;
    RunOptions options{input.linear_algebra, input.backend};
    options.trace = &trace;
    trajectory = solve(problem->model, problem->slots, method, options);
  }
};

/// What a hundred roundings of their own terms may leave of the residuals (methods/newton/residuals.hpp), by increment.
std::vector<double> roundings(const Solved& s) {
  const auto& [model, slots, unused] = *s.problem;
  const auto multipliers = std::holds_alternative<MonolithicAL>(s.method) ? Multipliers::unknown : Multipliers::given;
  auto engine = sparse_engine(model, slots, system_kind(model, multipliers, ConeRadius::augmented, Backend::automatic));
  Account account;
  const Anchor<double> none;
  std::vector<double> all;
  const State<double>* before = &s.trajectory.initial;
  for (const auto& increment : s.trajectory.increments) {
    const auto& u = increment.state.displacement;
    const auto rho = scenes::rho_of(slots, s.method, increment);
    const ContactInput<double> input{model, slots, rho, before->history, ConeRadius::augmented, increment.time};
    const EquilibriumTask<double> task{input, multipliers, none};
    const Vector<double> in_frames = engine.begin(increment.time, u, before->history.bodies);
    if (!model.effects.linear_bulk) engine.linearise({u, before->history.bodies, increment.time});
    Evaluator<double> evaluate(engine, task, account);
    const auto found = evaluate({in_frames, increment.state.multiplier});
    account.scales = found.scales;
    const auto& floors = found.residuals;
    all.push_back(larger(floors.floor_equilibrium, larger(floors.floor_length, floors.floor_traction)));
    before = &increment.state;
  }
  return all;
}

/// Holds residuals a > b > c of iterates one after another, between 1e-2 and a hundred roundings, in states that stand,
/// to an order of 1.8 or more; returns how many there were.
int expect_quadratic_convergence(const Solved& s, double largest_constant) {
  // The order is that of the last two steps, log(c / b) / log(b / a), and tells nothing of a first step that took away
  // more than a quadratic one would. The constant c / b^2 is then that of the second alone: 40 where the traction of a
  // stiff penalty turns (tractrix), 7 elsewhere. A tangent that is off by 1e-3 gives 1e-3 / b. A residual of the
  // contact bends a thin ring, which is (R / t)^2 = 90 times as soft as what 7 is measured of (pinched_tube: 330).
  const auto rounding = roundings(s);
  const auto& iterates = s.trace.iterates;
  int count = 0;
  std::size_t increment = 0;
  for (std::size_t i = 2; i < iterates.size(); ++i) {
    const auto &first = iterates[i - 2], &second = iterates[i - 1], &third = iterates[i];
    while (increment + 1 < rounding.size() && s.trajectory.increments[increment].time < third.time) ++increment;
    const bool settled = first.solve == third.solve && second.record.changed + third.record.changed == 0 &&
                         first.flows == second.flows && second.flows == third.flows && second.record.step_length == 1 &&
                         third.record.step_length == 1;
    const double a = first.record.residual, b = second.record.residual, c = third.record.residual;
    if (!settled || a > 1e-2 || b >= a || c >= b || c < rounding[increment]) continue;
    ++count;
    const double order = std::log(c / b) / std::log(b / a);
    EXPECT_TRUE(order >= 1.8 || c <= largest_constant * b * b)
        << order << " of " << a << ", " << b << ", " << c << " at " << third.time;
  }
  return count;
}

class NewtonOnShippedScenes : public testing::TestWithParam<Setting> {};

TEST_P(NewtonOnShippedScenes, HasTheTangentOfTheComplexStepAndConvergesWithTheSecondOrder) {
  const Solved s(GetParam());
  ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
  const std::size_t count = s.trajectory.increments.size();
  for (std::size_t third = 1; third <= 3; ++third) {
    const std::size_t n = std::max<std::size_t>(1, count * third / 3) - 1;
    const auto error = scenes::errors_of_tangent(s.problem->model, s.problem->slots, s.method, s.trajectory, n);
    EXPECT_LE(error.bodies, 1e-10) << n;  // (some 1e-15)
    EXPECT_LE(error.contact, 1e-10) << n;
    EXPECT_LE(error.rows, 1e-10) << n;
  }
  // Of the other scenes no three residuals lie between 1e-2 and their rounding: they are linear while states stand, or
  // two steps take them there. (Where tangents are condensed, steps of the sequence are of third order and more.)
  const std::set<std::string> show_their_order{"tractrix penalty", "tractrix uzawa_al", "pinched_tube monolithic_al"};
  const int held = expect_quadratic_convergence(s, GetParam().scene == "pinched_tube" ? 500 : 50);
  if (show_their_order.contains(GetParam().scene + " " + GetParam().method)) {
    EXPECT_GT(held, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, NewtonOnShippedScenes, testing::ValuesIn(settings()),
                         [](const auto& info) { return info.param.scene + "_" + info.param.method; });

}  // namespace
}  // namespace stickslip
