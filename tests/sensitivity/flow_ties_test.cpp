/// One-sided derivatives where bodies begin to flow, or end at a corner of their table, exactly at the end of a step:
/// against closed forms, and against the complex step of the whole run on either side.
#include "sensitivity/ties/flow_tie.hpp"
#include "tests/support/both_modes.hpp"
#include "tests/support/sides.hpp"

namespace stickslip::flow_ties_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;

// --- bars, by closed forms -------------------------------------------------------------------------------------------

constexpr double E = 1000, H = 100, Et = E * H / (E + H), yield = 10;

/// A bar (length and area 1) that its end pushes onto a wall at no distance, by U1 at time 1, U2 at time 2, ...
Scene pushed_bar(const std::vector<double>& pushes, const std::vector<HardeningRow>& rows = {}) {
  Scene s;
  LineMesh line;
  line.from = {0.0, 0.0};
  line.to = {1.0, 0.0};
  line.cells = 2;
  s.bodies = {{"bar", line, J2Plastic{parameter(s, "E", E), 0.3, parameter(s, "sy", yield), parameter(s, "H", H), rows},
               "bar", 1.0}};
  s.obstacles = {{"wall", Plane{{0.0, 0.0}, {1.0, 0.0}}}};
  s.contacts = {contact("stop", "bar.start", "wall")};
  std::vector<std::pair<double, Number>> path{{0, 0.0}};
  for (std::size_t k = 0; k < pushes.size(); ++k) {
    const double time = static_cast<double>(k + 1);
    path.emplace_back(time, parameter(s, "U" + std::to_string(k + 1), -pushes[k]));
    s.legs.push_back({time, 1});
  }
  s.supports = {support("bar.nodes", {{'y', table({{0, 0.0}})}}), support("bar.end", {{'x', table(path)}})};
  s.responses = {response("force", Kind::contact_force, "stop", "normal")};
  return s;
}

/// [below, above] of the derivative of a response at increment n, and the one that stands for both.
struct Found {
  double below, above, given;
};
Found derivative_of(const Both& b, const std::string& response, const std::string& parameter, std::size_t n) {
  const auto& scene = b.solved.model.scene;
  const auto place = [](const auto& all, const std::string& name) {
    return std::find_if(all.begin(), all.end(), [&](const auto& x) { return x.name == name; }) - all.begin();
  };
  const auto i = place(scene.responses, response), j = place(scene.parameters, parameter);
  const double given = b.solved.gradients.of_responses[n](i, j);
  if (!b.sides) return {given, given, given};
  return {b.sides->backward[n](i, j), b.sides->forward[n](i, j), given};
}

/// Derivatives of `size` by chains of a few unknowns, Uzawa's to its tolerance: 1e-9. The one given is one of the two.
void expect_sides_of(const Both& b, const std::string& response, const std::string& parameter, std::size_t n,
                     double below, double above, double size) {
  const auto what = [&] { return response + " by " + parameter + ", increment " + std::to_string(n); };
  const auto found = derivative_of(b, response, parameter, n);
  EXPECT_NEAR(found.below, below, 1e-9 * size) << what();
  EXPECT_NEAR(found.above, above, 1e-9 * size) << what();
  EXPECT_LE(smaller(std::abs(found.given - below), std::abs(found.given - above)), 1e-9 * size) << what();
}

std::vector<Method> methods_that_enforce() { return {MonolithicAL{}, uzawa_with(UzawaAL::Sensitivity::iterated)}; }

TEST(FlowTies, OfABarThatReachesItsYieldStressAndIsUnloaded) {
  const double strain = yield / E, back = 0.008, last = 0.02;
  for (const Method& method : methods_that_enforce()) {
    SCOPED_TRACE(name_of(method));
    const auto b = both(pushed_bar({strain, back, last}), method);
    ASSERT_TRUE(b.sides);
    expect_sides_of(b, "force", "E", 0, strain, Et * yield / (E * E), strain);
    expect_sides_of(b, "force", "sy", 0, 1 - Et / E, 0, 1);
    expect_sides_of(b, "force", "H", 0, 0, 0, 1);
    expect_sides_of(b, "force", "U1", 0, -Et, -E, E);  // (a coordinate: less of it is a longer way)
    // withdrawn, E (U2 - e_p): what flowed stays, on one side alone
    expect_sides_of(b, "force", "E", 1, back, back - E * strain / (E + H), back);
    expect_sides_of(b, "force", "sy", 1, E / (E + H), 0, 1);
    expect_sides_of(b, "force", "U1", 1, E * E / (E + H), 0, E);
    expect_sides_of(b, "force", "U2", 1, -E, -E, E);
    // pushed on, the force is one of the strain alone
    const double by_E = H * H / ((E + H) * (E + H)) * (last - strain) + Et * yield / (E * E);
    expect_sides_of(b, "force", "E", 2, by_E, by_E, last);
    expect_sides_of(b, "force", "sy", 2, 1 - Et / E, 1 - Et / E, 1);
    expect_sides_of(b, "force", "U1", 2, 0, 0, E);
  }
}

TEST(FlowTies, OfABarThatEndsAtACornerOfItsTable) {
  // bound from 10 to 12 over a strain of .002, of slope 1000, then of slope H
  const double a = 0.002, top = 12, strain = a + top / E, first = 500;
  for (const Method& method : methods_that_enforce()) {
    SCOPED_TRACE(name_of(method));
    const auto b = both(pushed_bar({strain, 0.01, 0.02}, {{a, top}}), method);
    ASSERT_TRUE(b.sides);
    expect_sides_of(b, "force", "U1", 0, -Et, -first, E);
    expect_sides_of(b, "force", "E", 0, first * top / (E * E), Et * top / (E * E), strain);
    expect_sides_of(b, "force", "sy", 0, 0, 0, 1);
    expect_sides_of(b, "force", "U1", 1, E - Et, E - first, E);
    expect_sides_of(b, "force", "U2", 1, -E, -E, E);
    expect_sides_of(b, "force", "U1", 2, 0, 0, E);
    const double by_H = E * E / ((E + H) * (E + H)) * (0.02 - strain);
    expect_sides_of(b, "force", "H", 2, by_H, by_H, strain);
  }
}

TEST(FlowTies, OfABarThatRestsAtItsBound) {
  // as it was in the last increment: a tie that only what moves the two apart tells
  Scene scene = pushed_bar({0.02, 0.02});
  Parameter all{"U", {}, "/U", -0.02};
  for (std::size_t j : {3u, 4u}) all.slots.push_back(scene.parameters[j].slots[0]);
  scene.parameters.push_back(all);
  const double by_E = H * H / ((E + H) * (E + H)) * (0.02 - yield / E) + Et * yield / (E * E);
  for (const Method& method : methods_that_enforce()) {
    SCOPED_TRACE(name_of(method));
    const auto b = both(scene, method);
    ASSERT_TRUE(b.sides);
    for (std::size_t n : {0u, 1u}) {
      expect_sides_of(b, "force", "E", n, by_E, by_E, 0.02);
      expect_sides_of(b, "force", "sy", n, 1 - Et / E, 1 - Et / E, 1);
      expect_sides_of(b, "force", "U", n, -Et, -Et, E);
    }
    expect_sides_of(b, "force", "U1", 0, -Et, -Et, E);
    expect_sides_of(b, "force", "U1", 1, E * E / (E + H), 0, E);
    expect_sides_of(b, "force", "U2", 1, -Et, -E, E);
  }
}

TEST(FlowTies, OfABarThatYieldsAsItTouches) {
  // pulled by its yield stress, its end just reaches a wall: two ties in one
  Scene s = pushed_bar({0.0});
  s.parameters.resize(3);
  s.obstacles = {{"wall", Plane{{parameter(s, "x", -yield / E), 0.0}, {1.0, 0.0}}}};
  s.supports = {support("bar.nodes", {{'y', table({{0, 0.0}})}}), support("bar.end", {{'x', table({{0, 0.0}})}})};
  s.loads = {force("bar.start", {parameter(s, "F", -yield), 0.0})};
  s.responses.push_back(response("tip", Kind::displacement, "bar.start", "x"));
  for (const Method& method : methods_that_enforce()) {
    SCOPED_TRACE(name_of(method));
    const auto b = both(s, method);
    ASSERT_TRUE(b.sides);
    expect_sides_of(b, "force", "F", 0, -1, 0, 1);       // (less of F is a harder pull: the wall takes it)
    expect_sides_of(b, "tip", "F", 0, 0, 1 / E, 1 / E);  // (less pull: neither touches nor flows)
    expect_sides_of(b, "force", "x", 0, 0, E, E);
    expect_sides_of(b, "tip", "x", 0, 0, 1, 1);
    expect_sides_of(b, "force", "sy", 0, -(1 - Et / E), 0, 1);
    expect_sides_of(b, "force", "E", 0, -yield / E, 0, yield / E);
    expect_sides_of(b, "tip", "E", 0, 0, yield / (E * E), yield / (E * E));
  }
}

TEST(FlowTies, AreNoneWhereNothingTies) {
  for (const auto& scene : {pushed_bar({0.009, 0.013, 0.011, 0.02}), pushed_bar({0.012, 0.018}, {{0.002, 12.0}})})
    EXPECT_FALSE(both(scene, MonolithicAL{}).sides);
}

// --- continua, by the complex step on either side --------------------------------------------------------------------

struct FlowSetting {
  Space space;
  bool finite;
  const char* element;
};

std::string text_of(const FlowSetting& setting) {
  return std::to_string(static_cast<int>(setting.space)) + (setting.finite ? " finite " : " small ") + setting.element;
}

Body metal(Scene& s, const FlowSetting& setting, double yield_stress, const std::vector<HardeningRow>& rows) {
  const double left = setting.space == Space::axisymmetric ? 1.0 : 0.0;
  BoxMesh box;
  box.min = {left, 0.0};
  box.max = {left + 2, parameter(s, "height", 0.8)};
  box.cells = {2, 2};
  return {
      "block", box,
      J2Plastic{parameter(s, "E", 100), 0.3, parameter(s, "yield", yield_stress), parameter(s, "hardening", 12), rows},
      setting.element, 1.0};
}

/// A block under a pressure, in a state that is the same everywhere: up to a tie at the second increment, part of the
/// way back, and beyond.
Scene pressed_evenly(const FlowSetting& setting, double yield_stress, const std::vector<HardeningRow>& rows) {
  Scene s;
  s.space = setting.space;
  s.finite_strain = setting.finite;
  s.legs = {{1, 2}, {2, 1}, {3, 1}};
  s.bodies = {metal(s, setting, yield_stress, rows)};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}}};
  s.contacts = {contact("sole", "block.bottom", "floor")};
  if (setting.space != Space::axisymmetric) s.supports = {support("block.left", {{'x', table({{0, 0.0}})}})};
  s.loads = {traction("block.top", {0.0, parameter(s, "press", -3)})};
  s.loads[0].history = table({{0, 0.0}, {1, 1.0}, {2, 0.7}, {3, 1.3}});
  s.responses = {response("down", Kind::displacement, "block.top", "y"), response("energy", Kind::strain_energy, "")};
  return s;
}

/// A block that its top presses onto a rough disk and draws along it: one point of it is the first to flow.
Scene pressed_on_a_disk(const FlowSetting& setting, double yield_stress, const std::vector<HardeningRow>& rows) {
  Scene s;
  s.space = setting.space;
  s.finite_strain = setting.finite;
  s.legs = {{1, 2}, {2, 2}};
  s.bodies = {metal(s, setting, yield_stress, rows)};
  const double middle = setting.space == Space::axisymmetric ? 2.07 : 1.07;
  s.obstacles = {{"disk", Circle{{middle, -1.5}, 1.5}}};
  s.contacts = {contact("sole", "block.bottom", "disk")};
  s.contacts[0].friction = parameter(s, "mu", 0.3);
  s.supports = {support("block.top", {{'y', table({{0, 0.0}, {1, parameter(s, "down", -0.06)}, {2, -0.05}})},
                                      {'x', table({{0, 0.0}, {1, 0.0}, {2, parameter(s, "along", 0.03)}})}})};
  s.responses = {response("press", Kind::reaction, "block.top", "y"),
                 response("drag", Kind::reaction, "block.top", "x"), response("energy", Kind::strain_energy, "")};
  return s;
}

using Build = Scene (*)(const FlowSetting&, double, const std::vector<HardeningRow>&);

/// The largest trial stress, and the largest plastic strain, of the second increment of a run.
std::pair<double, double> reached(const Scene& scene, const Method& method) {
  const auto s = run(scene, method);
  EXPECT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
  std::pair<double, double> most{0, 0};
  for_each_flow_point<double>(
      s.model, s.slots,
      {s.trajectory.increments[1].state.displacement, s.trajectory.increments[0].state.history.bodies}, nullptr,
      [&](const FlowPoint<double>& point) {
        most.first = larger(most.first, point.trial.stress);
        most.second = larger(most.second, point.trial.after);
      });
  return most;
}

/// Whose first flow begins at the end of the second increment.
Scene about_to_flow(Build build, const FlowSetting& setting, const Method& method) {
  return build(setting, reached(build(setting, 1e30, {}), method).first, {});
}
/// Whose flow ends at a corner of the table then, behind which the bound rises more slowly.
Scene at_a_corner(Build build, const FlowSetting& setting, const Method& method) {
  const double begins = 1.5, strain = reached(build(setting, begins, {}), method).second;
  return build(setting, begins, {{strain, begins + 12 * strain}, {3 * strain, begins + 24 * strain}});
}

TEST(FlowTies, OfABlockThatYieldsEverywhereAtOnceHaveTheSidesOfTheRunByEveryScheme) {
  const FlowSetting setting{Space::plane_strain, false, "Q4_mean_dilatation"};
  for (const auto& scheme : schemes())
    EXPECT_GT(expect_sides(about_to_flow(pressed_evenly, setting, scheme.method), scheme), 3) << scheme.name;
}

class FlowTiesOfBlocks : public testing::TestWithParam<FlowSetting> {};

TEST_P(FlowTiesOfBlocks, HaveTheSidesOfTheRunAndOneOfThemInBothModes) {
  SCOPED_TRACE(text_of(GetParam()));
  Named monolithic = schemes().front();
  monolithic.resolved = false;
  for (Build build : {pressed_evenly, pressed_on_a_disk})
    for (Scene scene :
         {about_to_flow(build, GetParam(), monolithic.method), at_a_corner(build, GetParam(), monolithic.method)}) {
      EXPECT_GT(expect_sides(scene, monolithic), 1);
      ask_for_objectives(scene);
      EXPECT_LE(difference_of_modes(scene, monolithic.method), 1e-11);  // rounding, as where nothing ties
    }
}

INSTANTIATE_TEST_SUITE_P(SlowSettings, FlowTiesOfBlocks,
                         testing::Values(FlowSetting{Space::plane_strain, false, "Q4_mean_dilatation"},
                                         FlowSetting{Space::plane_stress, false, "Q4"},
                                         FlowSetting{Space::plane_strain, true, "Q4_mean_dilatation"},
                                         FlowSetting{Space::axisymmetric, true, "T3"}));

}  // namespace
}  // namespace stickslip::flow_ties_test
